"""The kinds of lists in an archive: where each lies, its columns, and the table with its limits."""

from dataclasses import dataclass
from typing import Final

from pipeline.tables.declare import dy
from pipeline.tables.lake import (
    ListedBoats,
    ListedForceChecks,
    ListedLamps,
    ListedRaces,
    ListedTows,
    ListedWindows,
    PrintedLines,
)
from warehouse.archive.spelling.columns import Column


@dataclass(frozen=True)
class ListKind:
    """A kind of list.

    Attributes:
        folder: its folder.
        pattern: its name there without suffix; group 1 is the season, where the name tells it.
        name: its name under `[files]` of `archief.toml`, without the year.
        reason_code: what a bad value in it is called.
        table: declares the type and the limits of its values.
        columns: the columns to look for.
    """

    folder: str
    pattern: str
    name: str
    reason_code: str
    table: type[dy.Schema]
    columns: tuple[Column, ...]


_SIZES: Final = (
    Column("waterline_length_m", "lengte", "length", "m", required=False),
    Column("beam_m", "breedte", "length", "m", required=False),
    Column("bow_height_m", "hoogte", "length", "m", required=False),
    Column("weight_kg", "gewicht", "mass", "kg", required=False),
)
"""Sizes of a boat, as it is listed and as it was towed."""

BOATS: Final = ListKind(
    "sloepregister",
    r"sloependata()",
    "sloependata",
    "bad_boat_row",
    ListedBoats,
    (
        Column("fsn_no", "fsn_nr"),
        Column("ht_no", "ht_nr", required=False),
        Column("name", "sloep"),
        Column("boat_type", "type", required=False),
        *_SIZES,
        Column("rowers", "roeiers", required=False),
        Column("crew_class", "klasse", required=False),
    ),
)
TOWS: Final = ListKind(
    "sleeplijsten",
    r"sleeplijst(?:[ _-]*([0-9]{4}))?",
    "sleeplijst",
    "bad_list_row",
    ListedTows,
    (
        Column("tow_id", "sleep_id", required=False),
        Column("tow_date", "datum"),
        Column("fsn_no", "fsn_nr", or_else="name"),
        Column("name", "sloep", required=False),
        Column("file", "meetfile"),
        Column("second_file", "meetfile2", required=False),
        Column("rowers", "roeiers"),
        Column("crew_class", "klasse"),
        Column("declared_speed_m_s", "roeisnelheid", "speed", "m/s"),
        *_SIZES,
        Column("weight_after_kg", "gewicht na", "mass", "kg", required=False),
        Column("crew_weight_kg", "bemanning", "mass", "kg", required=False),
        Column("water_temperature_c", "watertemperatuur", "temperature", "C", required=False),
        Column("speed_correction_ratio", "correctie", "ratio", "%", required=False),
        Column("use_runs", "gebruik runs", required=False),
        Column("altered", "verbouwd", required=False),
        Column("sample_rate_hz", "meetfrequentie", "rate", "Hz", required=False),
        Column("empty_thwart", "lege doft", required=False),
        Column("freeboard_lowest_m", "vrijboord laagst", "length", "m", required=False),
        Column("freeboard_bow_m", "vrijboord boeg", "length", "m", required=False),
        Column("freeboard_stern_m", "vrijboord achter", "length", "m", required=False),
        Column("remark", "opmerking", required=False),
    ),
)
WINDOWS: Final = ListKind(
    "sleeplijsten",
    r"vensters[ _-]*([0-9]{4})",
    "vensters",
    "bad_window_row",
    ListedWindows,
    (
        Column("tow_id", "sleep_id"),
        Column("run", "run"),
        Column("start_s", "van", "time", "s"),
        Column("end_s", "tot", "time", "s"),
        Column("reason", "reden"),
    ),
)
FORCE_CHECKS: Final = ListKind(
    "sleeplijsten",
    r"krachtijkingen[ _-]*([0-9]{4})",
    "krachtijkingen",
    "bad_instrument_row",
    ListedForceChecks,
    (
        Column("day", "datum"),
        Column("weight_kg", "gewicht", "mass", "kg"),
        Column("reading_n", "aflezing", "force", "N"),
    ),
)
"""The load cell read while a known weight hung on it, daily or more often (Sleepproef, R. Pot 2017,
"Krachtopnemer")."""
LAMPS: Final = ListKind(
    "sleeplijsten",
    r"lampjes[ _-]*([0-9]{4})",
    "lampjes",
    "bad_instrument_row",
    ListedLamps,
    (
        Column("tow_id", "sleep_id"),
        Column("run", "run"),
        Column("start_s", "van", "time", "s"),
        Column("end_s", "tot", "time", "s"),
    ),
)
"""When a lamp beside the beacon burned because the tow line was not square ("Recht sturen")."""
REGISTERS: Final = ListKind(
    "sloepregister",
    r"sloepregister[ _-]*([0-9]{4})",
    "sloepregister",
    "bad_register_row",
    PrintedLines,
    (
        Column("fsn_no", "fsn_nr"),
        Column("rowers", "roeiers"),
        Column("crew_class", "klasse"),
        Column("a_kg_m", "A"),
        Column("b_m_s", "B", "speed", "m/s"),
        Column("cw_kg_m", "Cw"),
        Column("declared_speed_m_s", "roeisnelheid", "speed", "m/s"),
        Column("tow_date", "sleepdatum"),
        Column("empty_thwart", "lege doft", required=False),
    ),
)
RACES: Final = ListKind(
    "wedstrijden",
    r".+?(?:[ _-]*([0-9]{4}))?",
    "wedstrijden",
    "bad_race_row",
    ListedRaces,
    (
        Column("race", "wedstrijd"),
        Column("race_date", "datum"),
        Column("distance_m", "afstand", "length", "km"),
        Column("fsn_no", "fsn_nr"),
        Column("rowers", "roeiers"),
        Column("crew_class", "klasse"),
        Column("rowing_time_s", "roeitijd"),
        Column("stream_m", "stroom", "length", "km", required=False),
        Column("penalty_w", "straf", "power", "W", required=False),
        Column("empty_thwart", "lege doft", required=False),
    ),
)
LIST_KINDS: Final = (BOATS, TOWS, LAMPS, WINDOWS, FORCE_CHECKS, REGISTERS, RACES)
"""Where a header fits several kinds equally, the first is meant: lamps before windows."""
