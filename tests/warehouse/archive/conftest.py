"""A tiny good archive, simulated: three tows at 20 Hz, one file each, and a way to spoil it."""

import shutil
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import polars as pl
import pytest

from pipeline.errors import DefectiveInputError
from warehouse.archive import (
    ArchiveIndex,
    Fault,
    FileHashes,
    index_archive,
    judge_samples,
    make_fault,
    read_tow_samples,
)
from warehouse.archive.profile import Profiles, read_profiles

RATE_HZ = 20
ROWS = 50 * RATE_HZ
TOWS = "sleeplijsten/sleeplijst_2014.csv"
BOATS = "sloepregister/sloependata.csv"
FIRST = "meetdata_2014/eerste boot 8h 2014.csv"
HEADER = "run;log1 [m/s];log2 [m/s];gps [m/s];kracht [N];wind [m/s];wind [gra]"


def line_of(run: int, row: int = 0) -> int:
    """Line in a tiny samples file of a row (from 0) of a run."""
    return 2 + (run - 1) * ROWS + row


@dataclass(frozen=True)
class Archive:
    """An archive in a temporary folder that a test may spoil."""

    root: Path

    def edit(self, path: str, change: Callable[[str], str]) -> None:
        """Rewrite a text file."""
        file = self.root / path
        file.write_text(change(file.read_text("utf-8")), "utf-8", newline="")

    def replace(self, path: str, old: str, new: str) -> None:
        """Replace the first occurrence of a text that must be there."""
        assert old in (self.root / path).read_text("utf-8")
        self.edit(path, lambda text: text.replace(old, new, 1))

    def cells(
        self,
        column: int,
        change: Callable[[str, int], str],
        first: int,
        last: int,
        path: str = FIRST,
    ) -> None:
        """Change the cells of a column on lines first..last; `change` gets the cell and line."""

        def rewrite(text: str) -> str:
            lines = text.split("\n")
            for line in range(first, last + 1):
                fields = lines[line - 1].split(";")
                fields[column] = change(fields[column], line)
                lines[line - 1] = ";".join(fields)
            return "\n".join(lines)

        self.edit(path, rewrite)

    def scan(self) -> "Scan":
        """Read everything, setting aside what cannot be used."""
        index = index_archive(self.root, FileHashes().hash_file)
        scan = self._read(index, index.tows, index.profiles)
        return replace(scan, faults=[*index.faults, *scan.faults])

    def read_first(self, index: ArchiveIndex) -> "Scan":
        """Read the first tow, of which only samples or profile changed since `index` was made."""
        return self._read(index, index.tows.filter(tow_id="2014-001"), read_profiles(self.root))

    def _read(self, index: ArchiveIndex, tows: pl.DataFrame, profiles: Profiles) -> "Scan":
        """Read and judge the samples of some tows."""
        good: dict[str, pl.DataFrame] = {}
        faults: list[Fault] = []
        for tow in tows.iter_rows(named=True):
            try:
                profile = profiles.find(tow["season"])
                samples, place, defects = read_tow_samples(self.root, tow, profile)
                judged = judge_samples(samples, place, tow, index.runs, defects)
            except DefectiveInputError as error:
                faults.append(make_fault(error, tow["samples_path"], tow["tow_id"]))
            else:
                good[tow["tow_id"]] = judged.samples
                faults += judged.faults
        return Scan(index, good, faults)


@dataclass(frozen=True)
class Scan:
    """What came of an archive."""

    index: ArchiveIndex
    good: dict[str, pl.DataFrame]
    faults: list[Fault]


def _samples(seed: int, declared_m_s: float) -> str:
    rng = np.random.default_rng(seed)
    lines = [HEADER]
    for run in range(1, 7):
        speed = declared_m_s * (0.9, 1.0, 1.1)[(run - 1) % 3]
        log1 = speed + rng.normal(0, 0.03, ROWS)
        log2 = speed + rng.normal(0, 0.03, ROWS)
        gps = np.repeat((speed + rng.normal(0, 0.02, ROWS // RATE_HZ)).round(2), RATE_HZ)
        force = 40 * speed**2 + rng.normal(0, 80, ROWS)
        wind = 4 + rng.normal(0, 0.3, ROWS)
        angle = (rng.normal(5 if run < 4 else 190, 15, ROWS)) % 360
        lines += [
            ";".join([str(run), *(f"{value:.3f}".replace(".", ",") for value in row)])
            for row in zip(log1, log2, gps, force, wind, angle, strict=True)
        ]
    return "\n".join(lines) + "\n"


@pytest.fixture(scope="session")
def _template(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return small_archive(tmp_path_factory.mktemp("template"))


def small_archive(folder: Path) -> Path:
    """Make a good archive of three tows in a folder; return its root."""
    root = folder / "archive"
    for name in ("sloepregister", "sleeplijsten", "meetdata_2014", "wedstrijden"):
        (root / name).mkdir(parents=True)
    (root / BOATS).write_text(
        "fsn_nr;ht_nr;sloep;type;lengte [m];breedte [m];hoogte [m];gewicht [kg];roeiers;klasse\n"
        "FSN1;0001;eerste boot;Kuikensloep;8,08;2,25;0,90;1417;8;H\n"
        "FSN2;0002;tweede boot;;7,73;2,10;0,80;969;6;D\n"
        "FSN3;0003;derde boot;Pollux;10,05;2,73;1,05;864;12;H\n"
    )
    (root / TOWS).write_text(
        "sleep_id;datum;fsn_nr;meetfile;meetfile2;roeiers;klasse;roeisnelheid [m/s];lengte [m];"
        "breedte [m];hoogte [m];gewicht [kg];gewicht na [kg];bemanning [kg];watertemperatuur [C];"
        "correctie [%];gebruik runs;verbouwd;meetfrequentie [Hz];opmerking\n"
        "2014-001;2014-03-01;FSN1;eerste boot 8h 2014;;8;H;2,40;8,00;2,20;0,90;1400;1405;760;8,7;6;"
        "1,2,3,4,5,6;nee;20;\n"
        "2014-002;02-03-2014;FSN2;tweede boot 6d 2014;;6;D;2,10;;;;;;;;;;ja;20;\n"
        "2014-003;2014-03-03;FSN3;derde boot 12h 2014;;12;H;2,80;10,05;2,73;1,05;864;870;1140;5,2;;"
        "1,2,3,4,5,6;nee;20;roer los\n"
    )
    for seed, (name, speed) in enumerate(
        [("eerste boot 8h", 2.4), ("tweede boot 6d", 2.1), ("derde boot 12h", 2.8)]
    ):
        (root / f"meetdata_2014/{name} 2014.csv").write_text(_samples(seed, speed))
    return root


@pytest.fixture(scope="session")
def good_scan(_template: Path) -> Scan:
    return Archive(_template).scan()


@pytest.fixture
def archive(_template: Path, tmp_path: Path) -> Archive:
    root = tmp_path / "archive"
    shutil.copytree(_template, root)
    return Archive(root)
