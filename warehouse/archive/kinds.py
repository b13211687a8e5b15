"""The lists of an archive: where each lies, its columns, and the table that declares its limits."""

from dataclasses import dataclass
from typing import Final, Literal

from pipeline.tables.declare import dy
from pipeline.tables.keys import MAX_THWARTS
from pipeline.tables.lake import (
    ListedAcceptances,
    ListedBoats,
    ListedForceChecks,
    ListedLamps,
    ListedRaces,
    ListedTows,
    PrintedLines,
    WrittenWindows,
)
from warehouse.archive.columns import Column

REMARK: Final = "remark"
"""A column that is not read: whatever is in it."""

FileKind = Literal[
    "boats", "tows", "samples", "windows", "force_checks", "lamps", "acceptances", "registers",
    "races",
]  # fmt: skip
"""Kinds of files, as `[files]` of `archief.toml` calls them."""
SAMPLES_PLACE: Final = "meetdata_{year}"
"""Folder of the samples of a season, unless `[files]` says otherwise."""

READ_APART: Final = frozenset({"file", "second_file", "use_runs", REMARK})
"""Columns that the table of a list does not hold: they become other columns or runs."""


@dataclass(frozen=True)
class ListKind:
    """A kind of list.

    Attributes:
        name: what `[files]` of `archief.toml` calls it.
        place: its folder and name without suffix, unless `[files]` says otherwise; `{year}` stands
            for the season, and `{name}` for whatever its writer likes.
        reason_code: what a bad value in it is called.
        table: declares the type and the limits of its values.
        columns: the columns to look for.
        about: `tow_id` where a row is a tow, `fsn_no` where it is a boat: lost with the row.
        spare: the optional columns of which a cell that cannot be read counts as empty; of others
            an empty cell would say something else, as that a boat was not altered.
    """

    name: FileKind
    place: str
    reason_code: str
    table: type[dy.Schema]
    columns: tuple[Column, ...]
    about: str = ""
    spare: frozenset[str] = frozenset()

    def __post_init__(self) -> None:
        """Refuse a column whose values the table could not hold: they would be lost.

        Raises:
            LookupError: a column is neither in `table` nor in `READ_APART`.
        """
        known = {*self.table.column_names(), *READ_APART}
        lost = [column.key for column in self.columns if column.key not in known]
        if lost:
            raise LookupError(
                f"the table {self.table.__name__} has no column {', '.join(lost)}: declare it in "
                "`pipeline/tables/`, or name it in `READ_APART` if something else is made of it."
            )

    @property
    def keys(self) -> list[str]:
        """The keys of its columns, in their order."""
        return [column.key for column in self.columns]

    def header(self, key: str) -> str:
        """Return the header of a column with its unit."""
        return next(column.named for column in self.columns if column.key == key)


def _length(key: str, header: str) -> Column:
    return Column(key, header, "length", "m", required=False)


def _mass(key: str, header: str) -> Column:
    return Column(key, header, "mass", "kg", required=False)


_SIZES: Final = (
    _length("waterline_length_m", "lengte"),
    _length("beam_m", "breedte"),
    _length("bow_height_m", "hoogte"),
    _mass("weight_kg", "gewicht"),
)
"""Sizes of a boat, as it is listed and as it was towed."""
_BOAT: Final = Column("fsn_no", "fsn_nr")
_CREW: Final = (Column("rowers", "roeiers"), Column("crew_class", "klasse"))
_SPEED: Final = Column("declared_speed_m_s", "roeisnelheid", "speed", "m/s")
_THWART: Final = Column("empty_thwart", "lege doft", required=False)
_RUN_SECONDS: Final = (
    Column("tow_id", "sleep_id"),
    Column("run", "run"),
    Column("start_s", "van", "duration", "s"),
    Column("end_s", "tot", "duration", "s"),
)
"""Some seconds of a run of a tow."""

_NAMES_OF_BOAT: Final = (
    _BOAT,
    Column("ht_no", "ht_nr", required=False),
    Column("name", "sloep"),
    Column("boat_type", "type", required=False),
)
_OPTIONAL_CREW: Final = (
    Column("rowers", "roeiers", required=False),
    Column("crew_class", "klasse", required=False),
)
BOATS: Final = ListKind(
    name="boats",
    place="sloepregister/sloependata",
    reason_code="bad_boat_row",
    table=ListedBoats,
    columns=_NAMES_OF_BOAT + _SIZES + _OPTIONAL_CREW,
    about="fsn_no",
    spare=frozenset({"ht_no", "boat_type"}),
)
_TOW: Final = (
    Column("tow_id", "sleep_id"),
    Column("tow_date", "datum"),
    _BOAT,
    Column("file", "meetfile"),
    Column("second_file", "meetfile2", required=False),
)
_DAY_OF_TOW: Final = (
    _mass("weight_after_kg", "gewicht na"),
    _mass("crew_weight_kg", "bemanning"),
    Column("water_temperature_c", "watertemperatuur", "temperature", "C", required=False),
    Column("salinity_g_kg", "zoutgehalte", "salinity", "g/kg", required=False),
    _length("water_depth_m", "waterdiepte"),
    Column("speed_correction_ratio", "correctie", "ratio", "%", required=False),
    Column("use_runs", "gebruik runs", required=False),
    Column("altered", "verbouwd", required=False),
    Column("sample_rate_hz", "meetfrequentie", "rate", "Hz", required=False),
    _THWART,
    _length("freeboard_lowest_m", "vrijboord laagst"),
    _length("freeboard_bow_m", "vrijboord boeg"),
    _length("freeboard_stern_m", "vrijboord achter"),
)
_THWARTS: Final = tuple(_length(f"thwart_{n}_m", f"doft {n}") for n in range(1, MAX_THWARTS + 1))
_RUDDER: Final = (
    _length("rudder_height_m", "roer hoogte"),
    _length("rudder_breadth_m", "roer breedte"),
    _length("rudder_thickness_m", "roer dikte"),
)
_PHOTOS: Final = (
    Column("photo_boat", "foto sloep", required=False),
    Column("photo_rudder", "foto roer", required=False),
)
_FOR_INSPECTION: Final = _THWARTS + _RUDDER + _PHOTOS
"""What an inspection at a race uses and no computation (Sleepproef, R. Pot 2017, "Opmetingen en
keuring")."""
TOWS: Final = ListKind(
    name="tows",
    place="sleeplijsten/sleeplijst_{year}",
    reason_code="bad_list_row",
    table=ListedTows,
    columns=_TOW
    + _CREW
    + (_SPEED,)
    + _SIZES
    + _DAY_OF_TOW
    + _FOR_INSPECTION
    + (Column(REMARK, "opmerking", required=False),),
    about="tow_id",
    spare=frozenset(
        {
            "waterline_length_m", "beam_m", "bow_height_m", "weight_kg",
            "weight_after_kg", "crew_weight_kg", "water_temperature_c", "salinity_g_kg",
            "water_depth_m",
            "freeboard_lowest_m", "freeboard_bow_m", "freeboard_stern_m",
        }
    )
    | {column.key for column in _THWARTS + _RUDDER},
)  # fmt: skip
WINDOWS: Final = ListKind(
    name="windows",
    place="sleeplijsten/vensters_{year}",
    reason_code="bad_window_row",
    table=WrittenWindows,
    columns=_RUN_SECONDS + (Column("reason", "reden", required=False),),
)
FORCE_CHECKS: Final = ListKind(
    name="force_checks",
    place="sleeplijsten/krachtijkingen_{year}",
    reason_code="bad_instrument_row",
    table=ListedForceChecks,
    columns=(
        Column("day", "datum"),
        Column("weight_kg", "gewicht", "mass", "kg"),
        Column("reading_n", "aflezing", "force", "N"),
    ),
)
"""The load cell read while a known weight hung on it, daily or more often (Sleepproef, R. Pot 2017,
"Krachtopnemer")."""
LAMPS: Final = ListKind(
    name="lamps",
    place="sleeplijsten/lampjes_{year}",
    reason_code="bad_instrument_row",
    table=ListedLamps,
    columns=_RUN_SECONDS,
)
"""When a lamp beside the beacon burned because the tow line was not square ("Recht sturen")."""
ACCEPTANCES: Final = ListKind(
    name="acceptances",
    place="sleeplijsten/beoordelingen",
    reason_code="bad_acceptance_row",
    table=ListedAcceptances,
    columns=(
        Column("tow_id", "sleep_id"),
        Column("accepted_on", "datum"),
        Column("accepted_by", "goedgekeurd door"),
        Column("redone_runs", "runs overgedaan", required=False),
        Column("explanation", "toelichting", required=False),
        Column("known_checks", "bevindingen", required=False),
    ),
)
"""Who let a boat go after the first assessment: it waits for that ("Eerste beoordeling")."""
_CURVE: Final = (
    Column("a_kg_m", "A"),
    Column("b_m_s", "B", "speed", "m/s"),
    Column("cw_kg_m", "Cw"),
    _SPEED,
    Column("tow_date", "sleepdatum"),
    _THWART,
)
REGISTERS: Final = ListKind(
    name="registers",
    place="sloepregister/sloepregister_{year}",
    reason_code="bad_register_row",
    table=PrintedLines,
    columns=(_BOAT,) + _CREW + _CURVE,
)
_RACE: Final = (
    Column("race", "wedstrijd"),
    Column("race_date", "datum"),
    Column("distance_m", "afstand", "length", "km"),
)
_RESULT: Final = (
    Column("rowing_time_s", "roeitijd"),
    Column("stream_m", "stroom", "length", "km", required=False),
    Column("penalty_w", "straf", "power", "W", required=False),
    _THWART,
)
RACES: Final = ListKind(
    name="races",
    place="wedstrijden/{name}_{year}",
    reason_code="bad_race_row",
    table=ListedRaces,
    columns=_RACE + (_BOAT,) + _CREW + _RESULT,
)
LIST_KINDS: Final = (
    BOATS, TOWS, WINDOWS, FORCE_CHECKS, LAMPS, ACCEPTANCES, REGISTERS, RACES,
)  # fmt: skip
