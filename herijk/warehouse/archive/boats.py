"""The boats of the archive: `sloependata.csv`."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import polars as pl

from herijk.pipeline.errors import DefectiveInputError
from herijk.warehouse.archive.faults import Fault, fault_from
from herijk.warehouse.archive.files import BOATS_FILE
from herijk.warehouse.archive.lists import ListRow, read_rows
from herijk.warehouse.archive.text import Column

# Generous limits of what a rowing sloop and its crew can be, in SI units.
LENGTH_M: Final = (2.0, 25.0)
BEAM_M: Final = (0.5, 6.0)
BOW_HEIGHT_M: Final = (0.1, 4.0)
WEIGHT_KG: Final = (50.0, 20_000.0)
ROWERS: Final = (1, 30)

COLUMNS: Final = (
    Column("fsn_no", "fsn_nr"),
    Column("ht_no", "ht_nr"),
    Column("name", "sloep"),
    Column("boat_type", "type"),
    Column("waterline_length_m", "lengte", "length", "m"),
    Column("beam_m", "breedte", "length", "m"),
    Column("bow_height_m", "hoogte", "length", "m"),
    Column("weight_kg", "gewicht", "mass", "kg"),
    Column("rowers", "roeiers"),
    Column("crew_class", "klasse"),
)
SCHEMA: Final[dict[str, pl.DataType]] = {
    "fsn_no": pl.String(),
    "ht_no": pl.String(),
    "name": pl.String(),
    "boat_type": pl.String(),
    "waterline_length_m": pl.Float64(),
    "beam_m": pl.Float64(),
    "bow_height_m": pl.Float64(),
    "weight_kg": pl.Float64(),
    "rowers": pl.Int32(),
    "crew_class": pl.String(),
}


@dataclass(frozen=True)
class Boats:
    """The boat list: the good boats by `fsn_no`, and why others cannot be used."""

    good: Mapping[str, Mapping[str, Any]]
    bad: Mapping[str, Fault]
    faults: tuple[Fault, ...]

    def frame(self) -> pl.DataFrame:
        """Return the good boats, in the order of the list."""
        return pl.DataFrame(list(self.good.values()), schema=SCHEMA)


def read_boats(data: bytes) -> Boats:
    """Read the boat list; a defective row or an ambiguous boat becomes a fault.

    Identical rows are harmless. Dimensions, weight and crew may be empty.

    Raises:
        DefectiveInputError: the list as a whole cannot be read.
    """
    good: dict[str, Mapping[str, Any]] = {}
    bad: dict[str, Fault] = {}
    faults: list[Fault] = []
    for row in read_rows(data, COLUMNS, "bad_boat_row"):
        fsn_no = row.optional_text("fsn_no")
        try:
            boat = _boat(row)
            _check_once(row, boat, good)
        except DefectiveInputError as error:
            fault = fault_from(error, BOATS_FILE)
            faults.append(fault)
            if fsn_no is not None:
                bad[fsn_no] = fault
            continue
        good[boat["fsn_no"]] = boat
    usable = {fsn_no: boat for fsn_no, boat in good.items() if fsn_no not in bad}
    return Boats(usable, bad, tuple(faults))


def _boat(row: ListRow) -> dict[str, Any]:
    row.check_whole()
    return {
        "fsn_no": row.text("fsn_no"),
        "ht_no": row.optional_text("ht_no"),
        "name": row.text("name"),
        "boat_type": row.optional_text("boat_type"),
        "waterline_length_m": row.optional_number("waterline_length_m", *LENGTH_M),
        "beam_m": row.optional_number("beam_m", *BEAM_M),
        "bow_height_m": row.optional_number("bow_height_m", *BOW_HEIGHT_M),
        "weight_kg": row.optional_number("weight_kg", *WEIGHT_KG),
        "rowers": row.optional_integer("rowers", *ROWERS),
        "crew_class": row.crew_class("crew_class") if row.optional_text("crew_class") else None,
    }


def _check_once(
    row: ListRow, boat: Mapping[str, Any], good: Mapping[str, Mapping[str, Any]]
) -> None:
    before = good.get(boat["fsn_no"])
    if before is not None and before != boat:
        different = next(key for key in boat if boat[key] != before[key])
        raise DefectiveInputError(
            "duplicate_boat",
            f"Line {row.line}: boat {boat['fsn_no']} stands in the list twice and the rows differ "
            f"in {different} ({before[different]} and {boat[different]}).",
            row.line,
        )
