"""What must hold in the rows of each list, beside the type and the limits of its values.

What lists say about each other belongs to `index`.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import polars as pl

from pipeline.channels import SECOND_FILE_OFFSET
from pipeline.hull import GRAVITY_M_S2
from pipeline.messages import say
from pipeline.register.register import NO_EMPTY_THWART
from pipeline.tables.bases import TowFacts
from pipeline.tables.frames import limits
from pipeline.tables.lake import ListedBoats, ListedWindows
from warehouse.archive.columns import fold_word
from warehouse.archive.faults import Fault, make_fault, say_at_line
from warehouse.archive.files import ArchiveFile, list_files
from warehouse.archive.kinds import (
    ACCEPTANCES,
    BOATS,
    FORCE_CHECKS,
    LAMPS,
    RACES,
    REGISTERS,
    WINDOWS,
    ListKind,
)
from warehouse.archive.lists import read_lists, split_runs
from warehouse.archive.profile import Profiles, read_profiles
from warehouse.archive.rows import Rows, cell
from warehouse.archive.samples import write_windows_text

OF_THE_BOAT: Final = (
    "ht_no", "boat_type", "waterline_length_m", "beam_m", "bow_height_m", "weight_kg",
)  # fmt: skip
"""What a boat has once; it may have had several names, and be rowed by several crews."""
NO_TYPE: Final = ("overig", "overige", "diversen", "eenling")
"""Types that say that a boat is of none: those named so are not alike."""
ONE_READING_SD: Final = 0.003
"""Spread of the ratio of one reading, where a day has too few to show it (inferred)."""
WEIGHT_SD: Final = 0.001
"""Relative error of the known weight (inferred)."""
FEWEST_READINGS: Final = 3
NEVER_TOWED_CW: Final = (0.995, 1.005)
"""Published Cw of boats without a valid tow: 1, as printed in two decimals. No hull comes near."""
CW_AS_PRINTED: Final = 0.01
"""By how much a printed Cw may differ from its A and B, beside what rounding does: an intermediate
result was sometimes rounded too."""
_CURVE: Final = ("a_kg_m", "b_m_s", "cw_kg_m")
_SPEED_KEY: Final = "declared_speed_m_s"
_Read = tuple[pl.DataFrame, list[Fault]]


@dataclass(frozen=True)
class Boats:
    """The boat lists.

    Attributes:
        listed: the boats that can be used (`ListedBoats`), a row for each crew that rows them; the
            last row of a boat gives its name.
        lost: why others cannot be used, by their number.
        faults: what is wrong in the lists.
    """

    listed: pl.DataFrame
    lost: dict[str, Fault]
    faults: list[Fault]


def read_boats(files: Iterable[ArchiveFile], profiles: Profiles) -> Boats:
    """Read all boat lists. Rows that contradict each other cost the boat."""
    rows = read_lists(files, BOATS, profiles)
    text = say(
        "boat {boat} is listed twice and the rows differ in '{column}': {one} here, {other} on "
        "line {line} of {path}."
    )
    for key in OF_THE_BOAT:
        one = pl.col(key)
        first = one.drop_nulls().first().over("fsn_no")
        place_of_first = pl.col("line", "path").filter(one.is_not_null()).first().over("fsn_no")
        rows.frame = rows.frame.with_columns(place_of_first.name.prefix("first_"))
        facts: dict[str, Any] = {
            "boat": pl.col("fsn_no"),
            "column": BOATS.header(key),
            "one": one,
            "other": first,
            "line": pl.col("first_line"),
            "path": pl.col("first_path"),
        }
        rows.drop(one != first, text, "duplicate_boat", **facts)
    is_no_type = pl.col("boat_type").str.to_lowercase().is_in(NO_TYPE)
    sound = rows.frame.filter(~pl.col("fsn_no").is_in(list(rows.lost))).with_columns(
        boat_type=pl.when(~is_no_type).then("boat_type")
    )
    of_boat = pl.exclude("fsn_no", "rowers", "crew_class")
    listed = sound.select(ListedBoats.column_names()).with_columns(
        of_boat.drop_nulls().last().over("fsn_no")
    )
    return Boats(ListedBoats.cast(listed.unique(maintain_order=True)), rows.lost, rows.faults)


def name_boats(rows: Rows, boats: Boats) -> None:
    """Give rows that name a boat by its exact name in the boat list its number."""
    known = boats.listed.with_columns(
        folded=pl.col("name").map_elements(fold_word, pl.String)
    ).select("folded", number="fsn_no")
    known = known.unique(maintain_order=True).filter(pl.col("folded") != "")
    by_name = known.group_by("folded", maintain_order=True).agg("number")
    numbers: dict[str, list[str]] = dict(by_name.iter_rows())
    listed = boats.lost.keys() | set(boats.listed["fsn_no"])
    number_of: dict[str, str] = {}
    several: list[str] = []
    for written in rows.frame["fsn_no"].drop_nulls().unique():
        found = numbers.get(fold_word(written), [])
        if written in listed or not found:
            continue
        if len(found) > 1:
            several.append(written)
        else:
            number_of[written] = found[0]
    text = say("'{boat}' is the name of several boats: give the number.")
    rows.drop(pl.col("fsn_no").is_in(several), text, "unknown_boat", boat=pl.col("fsn_no"))
    rows.frame = rows.frame.with_columns(pl.col("fsn_no").replace(number_of))


def read_window_lists(
    files: Iterable[ArchiveFile], profiles: Profiles, listed: pl.DataFrame
) -> Rows:
    """Read the lists of windows: within runs, or of the runs within a recording.

    Args:
        files: those of the archive.
        profiles: how the lists are worded.
        listed: `season` and `tow_id` of every listed tow.
    """
    rows = read_lists(files, WINDOWS, profiles)
    rows.drop_copies(per_file=True)
    _drop_out_of_order(rows)
    text = say("sleep_id {tow} is not in the tow list of that year.")
    known = pl.struct("season", "tow_id").is_in(listed.to_struct().implode())
    rows.drop(~known, text, "window_unknown_tow", tow=pl.col("tow_id"))
    return rows


def find_recordings(rows: Rows, profiles: Profiles) -> dict[str, str]:
    """Return begin and end of the runs of tows whose file is one recording, and drop their rows.

    Two rows for one run, and runs that overlap, cost these runs.
    """
    seasons = [
        season
        for season in rows.frame["season"].unique()
        if profiles.find(season).runs == "windows"
    ]
    tow, run = pl.col("tow_id"), pl.col("run")
    is_recording = pl.col("season").is_in(seasons)
    is_twice = pl.struct("tow_id", "run").is_duplicated()
    text = say("run {run} of tow {tow} has more than one window; none of them counts.")
    rows.drop(is_recording & is_twice, text, "window_given_twice", run=run, tow=tow)
    rows.frame = rows.frame.sort("tow_id", "start_s", maintain_order=True)
    is_second = run > SECOND_FILE_OFFSET
    before = pl.col("end_s").shift(1).over("tow_id", is_second)
    after = pl.col("start_s").shift(-1).over("tow_id", is_second)
    overlaps = (pl.col("start_s") < before) | (pl.col("end_s") > after)
    text = say("run {run} of tow {tow} overlaps another run of the recording.")
    rows.drop(is_recording & overlaps, text, run=run, tow=tow)
    found: dict[str, dict[int, tuple[float, float]]] = {}
    own = rows.frame.filter(is_recording).select("tow_id", "run", "start_s", "end_s")
    for tow_id, number, start, end in own.iter_rows():
        found.setdefault(tow_id, {})[number] = float(start), float(end)
    rows.frame = rows.frame.filter(~is_recording)
    return {tow_id: write_windows_text(windows) for tow_id, windows in found.items()}


def check_hand_windows(rows: Rows, runs: pl.DataFrame) -> pl.DataFrame:
    """Return the windows given by hand (`ListedWindows`) for runs of tows that are not set aside.

    Two windows for one run cost both, as nobody can know which is right. How long a run is, is only
    known when its samples are read: `find_windows_outside_run`.

    Args:
        rows: as `read_window_lists` gives them, without those of recordings.
        runs: `tow_id` and `run` of those that are not set aside.
    """
    tow, run = pl.col("tow_id"), pl.col("run")
    rows.drop(pl.col("reason").is_null(), say("column 'reden' is empty."))
    _, most = limits(ListedWindows, "end_s")
    start, end = pl.col("start_s"), pl.col("end_s")
    is_in_run = (start % 1 == 0) & (end % 1 == 0) & (end <= most)
    text = say(
        "'van' is {start:g} s and 'tot' {end:g} s; in a run these are whole seconds, up to {most}."
    )
    rows.drop(~is_in_run, text, start=start, end=end, most=most)
    rows.frame = rows.frame.filter(tow.is_in(runs["tow_id"].implode()))
    planned = runs.select(pl.struct("tow_id", "run")).to_series().implode()
    is_unplanned = ~pl.struct("tow_id", "run").is_in(planned)
    text = say("tow {tow} has no run {run}.")
    rows.drop(is_unplanned, text, "window_unknown_run", tow=tow, run=cell("run"))
    text = say("run {run} of tow {tow} has more than one window; none of them counts.")
    is_twice = pl.struct("tow_id", "run").is_duplicated()
    rows.drop(is_twice, text, "window_given_twice", run=run, tow=tow)
    return rows.to_table(ListedWindows)


def _drop_out_of_order(rows: Rows) -> None:
    """Set aside windows, and times that a lamp burned, that do not end after they begin."""
    start, end = pl.col("start_s"), pl.col("end_s")
    text = say("'van' is {start:g} s and 'tot' {end:g} s; a window ends after it begins.")
    rows.drop(start >= end, text, start=start, end=end)


def find_windows_outside_run(windows: pl.DataFrame, seconds: pl.DataFrame) -> list[Fault]:
    """Return a fault for each window that ends after its run.

    Args:
        windows: rows of `ListedWindows`.
        seconds: `tow_id`, `run` and the run's length in whole `seconds`.
    """
    listed = windows.join(seconds, on=["tow_id", "run"], maintain_order="left")
    beyond = listed.filter(pl.col("end_s") > pl.col("seconds"))
    text = say(
        "the window of run {run} of tow {tow} ends at {end} s, but the run lasts {seconds} s."
    )
    faults = []
    for row in beyond.iter_rows(named=True):
        said = say(
            text, run=row["run"], tow=row["tow_id"], end=row["end_s"], seconds=row["seconds"]
        )
        fault = Fault(
            path=row["path"],
            line=row["line"],
            reason_code="window_outside_run",
            message=say_at_line(row["line"], said),
        )
        faults.append(fault)
    return faults


def read_within_border(
    kind: ListKind, files: Iterable[ArchiveFile], read: Callable[[Iterable[ArchiveFile]], _Read]
) -> _Read:
    """Read lists of a kind; one on which Herijk fails costs these lists, and nothing else."""
    own = [file for file in files if file.kind == kind]
    try:
        return read(own)
    except BaseException as error:
        fault = make_fault(error, own[0].path if own else kind.name)
        nothing, _ = read([])
        return nothing, [fault]


def read_force_checks(files: Iterable[ArchiveFile], profiles: Profiles) -> _Read:
    """Return the days on which the load cell was checked: reading / weight as a ratio, and its sd.

    The sd holds the scatter of that day's readings and the weight itself.
    """
    rows = read_lists(files, FORCE_CHECKS, profiles)
    rows.drop_copies(per_file=True)
    rows.drop_other_years("day")
    ratio = pl.col("reading_n") / (pl.col("weight_kg") * GRAVITY_M_S2)
    own_sd = pl.when(pl.len() >= FEWEST_READINGS).then(ratio.std()).otherwise(ONE_READING_SD)
    sd = (own_sd**2 / pl.len() + WEIGHT_SD**2).sqrt()
    days = rows.to_table(FORCE_CHECKS.table).group_by("season", "day", maintain_order=True)
    return days.agg(load_cell_ratio=ratio.mean(), load_cell_sd=sd).sort("day"), rows.faults


def read_lamps(files: Iterable[ArchiveFile], profiles: Profiles, tow_ids: pl.Series) -> _Read:
    """Read how long a lamp burned (`burned_s`) in the run of each tow where it burned longest."""
    rows = read_lists(files, LAMPS, profiles)
    rows.drop_copies()
    text, tow = say("sleep_id {tow} is not in the tow list of that year."), pl.col("tow_id")
    rows.drop(~tow.is_in(tow_ids.implode()), text, tow=tow)
    _drop_out_of_order(rows)
    burned = rows.to_table(LAMPS.table).group_by("tow_id", "run", maintain_order=True)
    of_run = burned.agg(burned_s=(pl.col("end_s") - pl.col("start_s")).sum())
    of_tow = of_run.group_by("tow_id", maintain_order=True).agg(pl.col("burned_s").max())
    return of_tow, rows.faults


def read_acceptances(
    files: Iterable[ArchiveFile], profiles: Profiles, listed: pl.DataFrame, planned: pl.DataFrame
) -> _Read:
    """Read who accepted which tow (`ListedAcceptances`). A tow may be accepted again later.

    Two different acceptances of one tow on one day cost both, as nobody can know which is right.

    Args:
        files: those of the archive.
        profiles: how the lists are worded.
        listed: `tow_id` and `tow_date` of every listed tow.
        planned: `tow_id` and `run` of tows that are not set aside.
    """
    rows = read_lists(files, ACCEPTANCES, profiles)
    tow, day, runs = pl.col("tow_id"), pl.col("accepted_on"), pl.col("redone_runs")
    text = say("sleep_id {tow} is in no tow list.")
    rows.drop(~tow.is_in(listed["tow_id"].implode()), text, tow=tow)
    dated = listed.select("tow_id", "tow_date").drop_nulls()
    towed = dated.group_by("tow_id", maintain_order=True).agg(pl.col("tow_date").min())
    number = pl.col("run").cast(pl.Int32)
    in_second = pl.format("b{}", number - SECOND_FILE_OFFSET)
    name = pl.when(number > SECOND_FILE_OFFSET).then(in_second).otherwise(number.cast(pl.String))
    names = planned.group_by("tow_id", maintain_order=True).agg(planned=name)
    for known in (towed, names):
        rows.frame = rows.frame.join(known, on="tow_id", how="left", maintain_order="left")
    text = say("tow {tow} is accepted on {day}, before it was towed on {towed}.")
    rows.drop(day < pl.col("tow_date"), text, tow=tow, day=day, towed=pl.col("tow_date"))
    rows.frame = rows.frame.with_columns(
        redone_runs=runs.map_elements(lambda cell: ",".join(split_runs(cell)), pl.String)
    )
    lacking = runs.str.split(",").list.set_difference("planned")
    text = say("column 'runs overgedaan' is '{cell}', and tow {tow} has no run {run}.")
    has_lacking = lacking.list.len() > 0
    rows.drop(has_lacking, text, cell=cell("redone_runs"), tow=tow, run=lacking.list.join(", "))
    text = say(
        "the acceptance of {of} is also on line {line} of {other}, and the two differ: neither "
        "counts. Keep the right one."
    )
    rows.drop_repeated(["tow_id", "accepted_on"], text)
    table = ACCEPTANCES.table
    return table.validate(rows.frame.select(table.column_names()), cast=True), rows.faults


def read_races(root: Path, profiles: Profiles | None = None) -> _Read:
    """Read every `wedstrijden/<naam>_<jaar>.csv`: `ListedRaces`, and the lines set aside.

    A crew has one result in a race; of equal rows the first counts.
    """
    return _read_with_boats(root, RACES, _check_races, profiles)


def read_published_registers(root: Path, profiles: Profiles | None = None) -> _Read:
    """Read every `sloepregister/sloepregister_<jaar>.csv`: `PrintedLines`, and lines set aside.

    A boat without a valid curve (published as Cw = 1) has no A, B and Cw. Of any other line Cw is
    A / (1 - (v/B)^2), however the numbers were rounded; else one of them is mistyped.
    """
    return _read_with_boats(root, REGISTERS, _check_registers, profiles)


def _read_with_boats(
    root: Path, kind: ListKind, check: Callable[[Rows], None], profiles: Profiles | None
) -> _Read:
    """Read the lists of a kind in which each row is about a boat."""
    known = read_profiles(root) if profiles is None else profiles
    files = list_files(root, known)
    boats = read_boats(files, known)

    def read(own: Iterable[ArchiveFile]) -> _Read:
        rows = read_lists(own, kind, known)
        name_boats(rows, boats)
        check(rows)
        return rows.to_table(kind.table), rows.faults

    return read_within_border(kind, files, read)


def _check_races(rows: Rows) -> None:
    """Set aside results at a speed that no boat has, and crews with two results in a race."""
    rows.drop_other_years("race_date")
    through_water_m = pl.col("distance_m") - pl.col("stream_m").fill_null(0.0)
    speed = through_water_m / pl.col("rowing_time_s")
    low, high = limits(TowFacts, "declared_speed_m_s")
    text = say(
        "'roeitijd' is {cell} for {km:g} km through the water: {speed:.3g} m/s; {low:g} to "
        "{high:g} can be right."
    )
    rows.drop(
        ~speed.is_between(low, high),
        text,
        cell=cell("rowing_time_s"),
        km=through_water_m / 1000,
        speed=speed,
        low=low,
        high=high,
    )
    of_crew = ("race", "race_date", "fsn_no", "rowers", "crew_class")
    text = say("{of} is also on line {line} of {other}, and the rows differ: neither counts.")
    rows.drop_repeated(of_crew, text)


def _check_registers(rows: Rows) -> None:
    """Add whether a line has a valid curve, and set aside lines that contradict their curve."""
    rows.drop_copies()
    lowest_never_towed, highest_never_towed = NEVER_TOWED_CW
    is_never_towed = pl.col("cw_kg_m").is_between(lowest_never_towed, highest_never_towed)
    has_curve = ~is_never_towed.fill_null(value=False)
    rows.frame = rows.frame.with_columns(has_valid_curve=has_curve)
    for key in _CURVE:
        is_empty = pl.col(key).is_null() & pl.col("has_valid_curve")
        rows.drop(is_empty, say("column '{column}' is empty."), column=key)
    rows.frame = rows.frame.with_columns(
        pl.when("has_valid_curve").then(pl.col(_CURVE)),
        pl.col("empty_thwart").fill_null(NO_EMPTY_THWART),
    )
    a, b, cw, speed = pl.col("a_kg_m"), pl.col("b_m_s"), pl.col("cw_kg_m"), pl.col(_SPEED_KEY)
    printed: dict[str, Any] = {key: cell(key) for key in _CURVE + (_SPEED_KEY,)}
    text = say("B is {b_m_s} m/s and the speed {declared_speed_m_s}; B must be higher.")
    rows.drop(b <= speed, text, **printed)
    half_a = _half_unit("a_kg_m")
    half_b = _half_unit("b_m_s")
    half_cw = _half_unit("cw_kg_m")
    half_speed = _half_unit(_SPEED_KEY)
    slowest = (speed - half_speed) / (b + half_b)
    fastest = pl.min_horizontal((speed + half_speed) / (b - half_b), 0.999)
    lowest = ((a - half_a) / (1.0 - slowest**2) - half_cw) * (1.0 - CW_AS_PRINTED)
    highest = ((a + half_a) / (1.0 - fastest**2) + half_cw) * (1.0 + CW_AS_PRINTED)
    text = say(
        "Cw is {cw_kg_m}, but A {a_kg_m} and B {b_m_s} give {given:.2f} at "
        "{declared_speed_m_s} m/s; one of them is wrong, or two are exchanged."
    )
    given = a / (1.0 - (speed / b) ** 2)
    rows.drop(~cw.is_between(lowest, highest), text, **printed, given=given)


def _half_unit(key: str) -> pl.Expr:
    """Return half a unit of the last digit that is printed."""
    decimals = cell(key).str.extract(r"[.,]([0-9]+)").str.len_chars().fill_null(0)
    return 0.5 / pl.lit(10.0).pow(decimals.cast(pl.Int32))
