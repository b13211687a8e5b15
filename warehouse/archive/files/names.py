"""What the name of a file says: its kind, its tow, its run."""

import re
from functools import lru_cache
from pathlib import Path
from typing import Final

from warehouse.archive.files.list_kinds import LIST_KINDS
from warehouse.archive.spelling.text import MOST_NAMES, fold_word

BOATS_FILE: Final = "sloepregister/sloependata.csv"
PROFILE_FILE: Final = "archief.toml"

SAMPLES: Final = "meetdata"
LIST_SUFFIXES: Final = (".csv", ".txt", ".tsv", ".xlsx", ".xlsm", ".xls", ".ods")

SPREADSHEETS: Final = (".xlsx", ".xlsm", ".xls", ".ods")
TEXT_SUFFIXES: Final = (".csv", ".txt", ".tsv", ".dat", ".asc", ".lvm")
PACKED: Final = (".zip", ".7z", ".rar")
"""Suffixes of files that hold others, which nobody here unpacks."""

COMPRESSION: Final = {".gz": "gzip", ".zst": "zstd"}
SAMPLE_SUFFIXES: Final = (
    *(text + packed for packed in (".gz", ".zst") for text in TEXT_SUFFIXES),
    *(*TEXT_SUFFIXES, ".parquet", ".tdms", *SPREADSHEETS),
)
PARTS: Final = " | "
"""Between the paths of files that are a run each; no file's name can hold it in Windows."""
STANDS_FOR: Final = re.compile(
    rf"({'|'.join(kind.name for kind in LIST_KINDS)}|{SAMPLES})(?:_([0-9]{{4}}))?"
)
"""What a file or folder can be said to be under `[files]`: `sleeplijst_2014`, `meetdata_2014`."""
_SHEET_OF: Final = re.compile(r"(.*?\.(?:xlsx|xlsm|xls|ods))#(.+)", re.IGNORECASE)
_ONE_RUN: Final = re.compile(
    r"(.*?[^0-9])[ _.-]*(?:run|vaart|lauf|r)?[ _.-]*([0-9]{1,2})", re.IGNORECASE
)
_RUN_ALONE: Final = re.compile(r"(?:run|vaart|lauf|r|no|nr)?[ _.-]*([0-9]{1,2})", re.IGNORECASE)


@lru_cache(MOST_NAMES)
def split_sheet(path: str) -> tuple[str, str]:
    """File and sheet of `Lijsten.xlsx#Proeven`; an empty sheet where none is named."""
    match = _SHEET_OF.fullmatch(path)
    return (match[1], match[2]) if match else (path, "")


@lru_cache(MOST_NAMES)
def sample_suffix(name: str) -> str:
    """The suffix of a samples file, in lower case; empty for any other file."""
    folded = name.casefold()
    return next((suffix for suffix in SAMPLE_SUFFIXES if folded.endswith(suffix)), "")


def kind_of(path: Path) -> str:
    """The suffix of a file as it is unpacked, in lower case: `.csv` of `x.csv.gz`."""
    name = split_sheet(path.name)[0].casefold()
    for packed in COMPRESSION:
        name = name.removesuffix(packed)
    return name[name.rfind(".") :]


@lru_cache(MOST_NAMES)
def match_key(name: str) -> str:
    """The name of a samples file for comparing: folded, without suffix or sheet."""
    folded = fold_word(split_sheet(name)[0])
    return folded.removesuffix(sample_suffix(folded)).strip()


def as_one_run(name: str) -> tuple[str, int] | None:
    """The tow and the run that the name of a samples file says, None where it says none.

    `snol 8h 2014 run 3.csv`, `snol 8h 2014_3.lvm` and `snol 8h 2014 r03.txt` are run 3 of
    `snol 8h 2014`.
    """
    _, sheet = split_sheet(name)
    key = fold_word(sheet) or match_key(name)
    number = _RUN_ALONE.fullmatch(key)
    if number:
        return "", int(number[1])
    match = _ONE_RUN.fullmatch(key)
    return (match[1].strip(" _.-"), int(match[2])) if match else None
