"""Registers as they were published: what the recomputed history is compared with."""

from pathlib import Path
from typing import Final

import polars as pl

from pipeline.messages import say
from pipeline.register.register import NO_EMPTY_THWART
from warehouse.archive.faults import Fault
from warehouse.archive.files.finding import files_of
from warehouse.archive.files.list_kinds import REGISTERS
from warehouse.archive.profile.definition import Profiles
from warehouse.archive.profile.reading import read_profiles
from warehouse.archive.sheets.reading import read_lists
from warehouse.archive.sheets.rows import cell, header, keep, sound_rows, to_table

NEVER_TOWED_CW: Final = (0.995, 1.005)
"""Published Cw of boats without a valid tow: 1, as printed in two decimals. No hull comes near."""

CW_AS_PRINTED: Final = 0.01
"""By how much a printed Cw may differ from its A and B, beside what rounding does: an intermediate
result was sometimes rounded too."""
_BELOW_ONE: Final = 0.999
_CURVE: Final = ("a_kg_m", "b_m_s", "cw_kg_m")


def read_published_registers(
    root: Path, profiles: Profiles | None = None
) -> tuple[pl.DataFrame, list[Fault]]:
    """Reads every `sloepregister/sloepregister_<jaar>.csv`.

    Returns:
        One row per line of a register (`PrintedLines`), and the lines that cannot be read. A boat
        without a valid curve (published as Cw = 1) has `has_valid_curve` false and no A, B and Cw.
    """
    profiles = profiles or read_profiles(root)
    rows, problems, faults = read_lists(files_of(root, profiles.files), REGISTERS, profiles)
    is_valid = ~pl.col("cw_kg_m").is_between(*NEVER_TOWED_CW)
    rows = rows.with_columns(has_valid_curve=is_valid)
    never_towed = {*rows.filter(~pl.col("has_valid_curve"))["row"]}
    rows = sound_rows(
        rows, (p for p in problems if p.row not in never_towed or p.key not in _CURVE), faults
    )
    for key in ("cw_kg_m", "a_kg_m", "b_m_s"):
        is_empty = pl.col(key).is_null() & pl.col("has_valid_curve").fill_null(value=True)
        text = say("column '{column}' is empty.")
        rows = keep(rows, faults, is_empty, REGISTERS.reason_code, text, column=header(key))
    rows = rows.with_columns(
        *(pl.when(pl.col("has_valid_curve")).then(pl.col(key)).alias(key) for key in _CURVE),
        pl.col("empty_thwart").fill_null(NO_EMPTY_THWART),
    )
    rows = _fitting(rows, faults)
    return to_table(REGISTERS.table, rows, faults, REGISTERS.reason_code), faults


def _fitting(rows: pl.DataFrame, faults: list[Fault]) -> pl.DataFrame:
    """The lines whose Cw is A / (1 - (v/B)^2), however the numbers were rounded.

    Others have two of them exchanged, or one mistyped.
    """
    keys = (*_CURVE, "declared_speed_m_s")
    a, b, cw, speed = map(pl.col, keys)
    printed = {key: cell(key) for key in keys}
    text = say("B is {b_m_s} m/s and the speed {declared_speed_m_s}; B must be higher.")
    rows = keep(rows, faults, b <= speed, REGISTERS.reason_code, text, **printed)
    half_a, half_b, half_cw, half_v = map(_half_unit, keys)
    slowest = (speed - half_v) / (b + half_b)
    fastest = pl.min_horizontal((speed + half_v) / (b - half_b), _BELOW_ONE)
    lowest = (a - half_a) / (1.0 - slowest**2) - half_cw
    highest = (a + half_a) / (1.0 - fastest**2) + half_cw
    fits = (cw >= lowest * (1.0 - CW_AS_PRINTED)) & (cw <= highest * (1.0 + CW_AS_PRINTED))
    text = say(
        "Cw is {cw_kg_m}, but A {a_kg_m} and B {b_m_s} give {given:.2f} at "
        "{declared_speed_m_s} m/s; one of them is wrong, or two are exchanged."
    )
    given = a / (1.0 - (speed / b) ** 2)
    return keep(rows, faults, ~fits, REGISTERS.reason_code, text, **printed, given=given)


def _half_unit(key: str) -> pl.Expr:
    """Half a unit of the last digit that is printed."""
    decimals = cell(key).str.extract(r"[.,]([0-9]+)").str.len_chars().fill_null(0)
    return 0.5 / pl.lit(10.0).pow(decimals.cast(pl.Int32))
