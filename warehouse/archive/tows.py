"""The rows of the tow lists held against each other, the files, the boats and `archief.toml`.

Every check sets rows aside and leaves a fault; a tow falls out at the first that it does not pass.
"""

import re
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any, Final

import polars as pl

from pipeline.channels import FEWEST_RUNS, SECOND_FILE_OFFSET
from pipeline.messages import say
from pipeline.tables.declare import dy
from pipeline.tables.frames import make_frame
from pipeline.tables.lake import ListedRuns
from warehouse.archive.files import (
    PARTS,
    SAMPLES,
    ArchiveFile,
    Hashes,
    combine_hashes,
    fold_file_name,
)
from warehouse.archive.kinds import TOWS
from warehouse.archive.list_rules import Boats, name_boats
from warehouse.archive.lists import split_runs
from warehouse.archive.profile import RUN_PLACE, Plan, Profiles, SeasonProfile
from warehouse.archive.rows import Rows, cell

TWICE: Final = 2.0
"""A size this many times that of the boat list cannot be right (inferred)."""
_SIZES: Final = ("waterline_length_m", "beam_m", "bow_height_m")
"""What a tow or else its boat must have; the height of the bow only where wind was measured."""
_LISTED_SIZES: Final = _SIZES + ("weight_kg",)
"""What the boat list says that a tow's own measure can be held against."""
_TOW_ID: Final = r"^[^/\\\x00-\x1f]{1,64}$"


def check_tows(
    rows: Rows,
    samples: pl.DataFrame,
    boats: Boats,
    profiles: Profiles,
    checks: pl.DataFrame,
    burned: pl.DataFrame,
    recordings: Mapping[str, str],
) -> dict[str, frozenset[int]]:
    """Keep the rows of tows that can be used, with all that is known of them.

    Args:
        rows: of all tow lists.
        samples: as `index_samples` gives them.
        boats: the boat lists.
        profiles: `archief.toml`.
        checks: the load cell by season and day, as `read_force_checks` gives it.
        burned: how long a lamp burned, as `read_lamps` gives it.
        recordings: begin and end of the runs of tows whose file is one recording, as text.

    Returns:
        The runs to use of every tow; runs of the second file are 21 and on.
    """
    text = say("'{tow}' cannot be a sleep_id: it is too long, or has a slash.")
    rows.drop(~pl.col("tow_id").str.contains(_TOW_ID), text, tow=pl.col("tow_id"))
    text = say(
        "sleep_id {of} is also on line {line} of {other}, and the rows differ: neither counts."
    )
    rows.drop_repeated(["tow_id"], text, "duplicate_tow_id")
    rows.drop_other_years("tow_date", "date_outside_season")
    name_boats(rows, boats)
    selections = _read_selections(rows, profiles)
    samples = _add_run_files(rows, samples, profiles)
    for key in ("file", "second_file"):
        _add_samples(rows, key, samples)
    _check_own_samples(rows)
    _add_boat(rows, boats)
    _add_season(rows, profiles)
    _add_instruments(rows, profiles, checks, burned)
    _add_windows(rows, recordings, profiles)
    rows.frame = rows.frame.with_columns(list_path="path", list_line="line")
    return selections


def _add_windows(rows: Rows, recordings: Mapping[str, str], profiles: Profiles) -> None:
    """Add begin and end of the runs in a recording, or set rows aside that have none."""
    windows = pl.col("tow_id").replace_strict(recordings, default=None, return_dtype=pl.String)
    rows.frame = rows.frame.with_columns(run_windows=windows)
    is_recording = _look_up(
        rows, "season", lambda season: profiles.find(season).runs == "windows", pl.Boolean()
    )
    text = say(
        "tow {tow} is one recording, and nobody says where its runs are: give begin and end of "
        "each in sleeplijsten/vensters_{season}.csv, with columns sleep_id; run; van [s]; tot [s]."
    )
    has_none = is_recording & pl.col("run_windows").is_null()
    rows.drop(has_none, text, "missing_run", tow=pl.col("tow_id"), season=pl.col("season"))


def _read_selections(rows: Rows, profiles: Profiles) -> dict[str, frozenset[int]]:
    """Return the runs to use of every tow."""
    selections = {}
    facts = rows.frame.select("tow_id", "season", "use_runs", "second_file")
    for tow_id, season, written, second in facts.iter_rows():
        plan = profiles.find_plan(tow_id, season)
        selections[tow_id] = read_selection(written or "", second is not None, plan)
    unread = [tow_id for tow_id, runs in selections.items() if not runs]
    text = say(
        "column 'gebruik runs' is '{cell}'; runs are numbers of the plan with commas between them, "
        "each once, and b1 and on of meetfile2."
    )
    rows.drop(pl.col("tow_id").is_in(unread), text, cell=pl.col("use_runs"))
    return selections


def read_selection(written: str, has_second: bool, plan: Plan) -> frozenset[int]:
    """Return the runs to use: none where the cell cannot be read, all of the first file if empty.

    Args:
        written: what the list says: `1,2,3`, `1-6`, `1,2,3,b4,b5,b6`.
        has_second: the tow has a second file; all of its runs count too where the plan has them.
        plan: the runs of the tow.
    """
    planned = {str(run): run for run in plan.runs}
    if has_second and (written or plan.second_directions):
        for run in plan.runs:
            planned[f"b{run}"] = SECOND_FILE_OFFSET + run
    if not written:
        return frozenset(planned.values())
    parts = split_runs(written)
    is_good = planned.keys() >= set(parts) and len(set(parts)) == len(parts)
    return frozenset(planned[part] for part in parts) if is_good else frozenset()


def index_samples(files: Iterable[ArchiveFile], hashes: Hashes) -> pl.DataFrame:
    """Return the samples files by `season` and the `name` that they answer to.

    Of several with one name, their `number` and the first: whether it is `inside`, its `path`, and
    its `sha256`, null where it cannot be read.
    """
    found = []
    for file in files:
        if file.kind == SAMPLES:
            sha256, _ = hashes.get(file.path, (None, 0))
            name = fold_file_name(file.full_path.name)
            found.append((file.season, name, file.inside, file.path, sha256))
    schema = {
        "season": pl.Int32,
        "name": pl.String,
        "inside": pl.Boolean,
        "path": pl.String,
        "sha256": pl.String,
    }
    frame = pl.DataFrame(found, schema, orient="row")
    first = pl.col("inside", "path", "sha256").first()
    return frame.group_by("season", "name", maintain_order=True).agg(
        first, number=pl.len(), runs=pl.lit(None, pl.String)
    )


def name_run_files(cell: str, profile: SeasonProfile, plan: Plan) -> dict[int, str]:
    """Return the names of the files of each run of a tow; none where all runs are in one file.

    The cell of the tow list has `{run}` for the number of the run, or else the profile says that
    there is a file for each run, and how these are named.
    """
    if re.search(RUN_PLACE, cell):
        pattern = cell
    elif profile.runs == "file":
        pattern = profile.run_files.replace("{meetfile}", fold_file_name(cell))
    else:
        return {}
    names = {}
    for run in plan.runs:
        name = re.sub(RUN_PLACE, lambda found: str(run).zfill(int(found[1] or 1)), pattern)  # noqa: B023
        names[run] = fold_file_name(name)
    return names


def _add_run_files(rows: Rows, samples: pl.DataFrame, profiles: Profiles) -> pl.DataFrame:
    """Return the samples with an entry for each tow that has a file for each run."""
    known = samples.rows_by_key(("season", "name"), named=True, unique=True, include_key=True)
    together: dict[tuple[int, str], dict[str, Any]] = {}
    facts = rows.frame.select("tow_id", "season", "file", "second_file")
    for tow_id, season, first_cell, second_cell in facts.iter_rows():
        plan, profile = profiles.find_plan(tow_id, season), profiles.find(season)
        for cell_text in (first_cell, second_cell):
            names = name_run_files(cell_text, profile, plan) if cell_text else {}
            runs: list[str] = []
            parts: list[dict[str, Any]] = []
            for run, name in names.items():
                if (season, name) in known:
                    runs.append(str(run))
                    parts.append(known[season, name])
            if not parts:
                continue
            hashes = [part["sha256"] for part in parts]
            together[season, fold_file_name(cell_text)] = {
                "season": season,
                "name": fold_file_name(cell_text),
                "inside": all(part["inside"] for part in parts),
                "path": PARTS.join(part["path"] for part in parts),
                "sha256": None if None in hashes else combine_hashes(hashes),
                "number": max(part["number"] for part in parts),
                "runs": ",".join(runs),
            }
    entries = known | together
    return pl.DataFrame(list(entries.values()), samples.schema, orient="row")


def _add_samples(rows: Rows, key: str, samples: pl.DataFrame) -> None:
    """Add path and hash of the samples that a cell names, or set the row aside."""
    prefix = {"file": "samples", "second_file": "second"}[key]
    text = say("'{name}' is a path; only the name of a file in meetdata_{season}/ is given here.")
    cell_of = pl.col(key)
    facts: dict[str, Any] = {"name": pl.col(key), "season": pl.col("season")}
    rows.drop(cell_of.str.contains(r"[/\\]|^\.\."), text, "path_outside_archive", **facts)
    named = samples.rename(
        {"path": f"{prefix}_path", "sha256": f"{prefix}_sha256", "runs": f"{prefix}_runs"}
    )
    name = cell_of.map_elements(fold_file_name, pl.String)
    rows.frame = rows.frame.with_columns(name=name).join(
        named, on=["season", "name"], how="left", maintain_order="left"
    )
    path, is_named = pl.col(f"{prefix}_path"), cell_of.is_not_null()
    is_missing = is_named & path.is_null()
    parts = _count_parts(rows.frame.filter(is_missing).select("season", "name"), samples)
    rows.frame = rows.frame.join(parts, on=["season", "name"], how="left", maintain_order="left")
    text = say(
        "there is no file '{name}' in meetdata_{season}/, but {parts} with that in their name, as "
        "'{part}'. If each run has a file, say so and how these are named, under [[profile]] in "
        'archief.toml: runs = "file", run_files = "{{meetfile}} run {{run}}".'
    )
    heading = '[[profile]]\nseasons = "{season}"\n'
    ask = (heading + 'runs = "?"', heading + 'run_files = "?"')
    has_parts = is_missing & pl.col("parts").is_not_null()
    several: dict[str, Any] = {"parts": pl.col("parts"), "part": pl.col("part")}
    rows.drop(has_parts, text, "samples_missing", ask=ask, **facts, **several)
    text = say("there is no file '{name}' in meetdata_{season}/.")
    rows.drop(is_missing, text, "samples_missing", **facts)
    text = say("'{name}' can be any of {number} files in meetdata_{season}/.")
    number = pl.col("number")
    rows.drop(number > 1, text, "ambiguous_file", **facts, number=number)
    text = say("'{path}' leads outside the archive, where nothing is read.")
    rows.drop(~pl.col("inside"), text, "path_outside_archive", path=path)
    is_unread = path.is_not_null() & pl.col(f"{prefix}_sha256").is_null()
    rows.drop(is_unread, say("'{path}' cannot be read."), "unreadable_file", path=path)
    rows.frame = rows.frame.drop("name", "inside", "number", "parts", "part")


def _count_parts(missing: pl.DataFrame, samples: pl.DataFrame) -> pl.DataFrame:
    """Return how many files have a missing name within theirs, and the first of them."""
    found = []
    for season, name in missing.unique(maintain_order=True).iter_rows():
        names = samples.filter(season=season)["name"]
        parts = names.filter(names.str.contains(name, literal=True)).sort()
        if len(parts) >= FEWEST_RUNS:
            found.append((season, name, len(parts), parts[0]))
    schema = {"season": pl.Int32, "name": pl.String, "parts": pl.Int64, "part": pl.String}
    return pl.DataFrame(found, schema, orient="row")


def _check_own_samples(rows: Rows) -> None:
    """Set aside rows whose samples are not their own, by content.

    A first file may be the second file of another tow of the same boat: that is how two tows are
    combined.
    """
    first, second, boat = "samples_sha256", "second_sha256", pl.col("fsn_no")
    text = say("meetfile and meetfile2 hold the same samples.")
    rows.drop(pl.col(first) == pl.col(second), text, "samples_listed_twice")
    crew = pl.format("{}{}", "rowers", "crew_class").alias("crew")
    firsts = rows.frame.select(boat, crew, content=first)
    seconds = rows.frame.select(boat, content=second).drop_nulls()
    users = pl.concat([firsts, seconds], how="diagonal").group_by("content", maintain_order=True)
    users_of = users.agg(pl.col("fsn_no").n_unique(), pl.col("crew").drop_nulls().n_unique())
    shared = users_of.filter((pl.col("fsn_no") > 1) | (pl.col("crew") > 1))["content"]
    is_shared = pl.any_horizontal(pl.col(first, second).is_in(shared.implode()))
    text = say("'{path}' is used for several boats or crews; whose samples they are is unclear.")
    path = pl.col("samples_path")
    rows.drop(is_shared, text, "samples_listed_twice", path=path)
    text = say("'{path}' holds the samples that line {line} uses already for {boat}.")
    facts: dict[str, Any] = {"path": path, "line": pl.col("line").first().over(first), "boat": boat}
    rows.drop(~pl.col(first).is_first_distinct(), text, "duplicate_tow", **facts)


def _add_boat(rows: Rows, boats: Boats) -> None:
    """Add the sizes of the boat where those of that day were not written down."""
    text = say("boat {boat} cannot be used, see {path}: {why}")
    for boat, fault in boats.lost.items():
        facts: dict[str, Any] = {"boat": boat, "path": fault.path, "why": fault.message}
        rows.drop(pl.col("fsn_no") == boat, text, fault.reason_code, **facts)
    text, boat_of = say("boat {boat} is not in the boat list."), pl.col("fsn_no")
    is_known = boat_of.is_in(boats.listed["fsn_no"].implode())
    rows.drop(~is_known, text, "unknown_boat", boat=boat_of)
    sizes = boats.listed.unique("fsn_no", maintain_order=True).select(
        "fsn_no", pl.col(_LISTED_SIZES).name.prefix("listed_")
    )
    rows.frame = rows.frame.join(sizes, on="fsn_no", how="left", maintain_order="left")
    text = say(
        "column '{column}' is {cell} and the boat list says {listed:g}; one of the two cannot be "
        "right."
    )
    for key in _LISTED_SIZES:
        # No rebuilding makes a boat twice as long or heavy: in feet, or a digit too many.
        listed = pl.col(f"listed_{key}")
        is_apart = ~(pl.col(key) / listed).is_between(1 / TWICE, TWICE, closed="none")
        facts = {"column": TOWS.header(key), "cell": cell(key), "listed": listed}
        if key in _SIZES:
            rows.drop(is_apart, text, **facts)
            rows.frame = rows.frame.with_columns(pl.coalesce(key, listed).alias(key))
        else:  # a tow can do without
            rows.empty(key, is_apart, text, **facts)


def _add_season(rows: Rows, profiles: Profiles) -> None:
    """Add what `archief.toml` says of season and day, and set aside the days that it names."""
    reason = _look_up(rows, "tow_date", profiles.find_reason_set_aside, pl.String())
    text = say("{day} is set aside in archief.toml: {reason}.")
    facts: dict[str, Any] = {"day": pl.col("tow_date"), "reason": reason}
    rows.drop(reason.is_not_null(), text, "day_set_aside", **facts)

    def look_up_season(read: Callable[[SeasonProfile], object], dtype: pl.DataType) -> pl.Expr:
        return _look_up(rows, "season", lambda season: read(profiles.find(season)), dtype)

    def count_changes(log: str) -> pl.Expr:
        return _look_up(rows, "tow_date", partial(profiles.count_log_changes, log), pl.Int32())

    rate = look_up_season(lambda profile: profile.sample_rate_hz, pl.Float64())
    rows.frame = rows.frame.with_columns(
        wind_measured=look_up_season(lambda profile: "wind" not in profile.absent, pl.Boolean()),
        log2_measured=look_up_season(lambda profile: "log2" not in profile.absent, pl.Boolean()),
        sample_rate_hz=pl.coalesce("sample_rate_hz", rate),
        log1_part=count_changes("log1"),
        log2_part=count_changes("log2"),
    )
    for key in _SIZES:
        is_needed = pl.col("wind_measured") if key == "bow_height_m" else pl.lit(value=True)
        text = say("'{names}' must be there, here or in the boat list.")
        rows.drop(pl.col(key).is_null() & is_needed, text, names=TOWS.header(key))


def _look_up(rows: Rows, key: str, read: Callable[[Any], object], dtype: pl.DataType) -> pl.Expr:
    """Return an expression that looks up each value of a column in a function."""
    found = {value: read(value) for value in rows.frame[key].unique()}
    if not found:
        return pl.lit(None, dtype)
    return pl.col(key).replace_strict(found, return_dtype=dtype)


def _add_instruments(
    rows: Rows, profiles: Profiles, checks: pl.DataFrame, burned: pl.DataFrame
) -> None:
    """Add what is known of the load cell and the warning lamps.

    Of the load cell the last day counts on which it was checked before the tow, else the first
    after it in the season.
    """
    frame = rows.frame.with_row_index("_row").sort("tow_date")
    checked = checks.rename({"day": "tow_date"})
    before = frame.join_asof(
        checked, on="tow_date", by="season", strategy="backward", check_sortedness=False
    )
    after = frame.join_asof(
        checked, on="tow_date", by="season", strategy="forward", check_sortedness=False
    )
    for name in ("load_cell_ratio", "load_cell_sd"):
        frame = frame.with_columns(before[name].fill_null(after[name]))
    frame = frame.sort("_row").join(burned, on="tow_id", how="left", maintain_order="left")
    planned_s = []
    for tow_id, season in frame.select("tow_id", "season").iter_rows():
        planned_s.append(profiles.find_plan(tow_id, season).seconds)
    lamp_ratio = pl.col("burned_s") / pl.Series(planned_s, dtype=pl.Float64)
    rows.frame = frame.with_columns(lamp_ratio=lamp_ratio)


def plan_runs(
    tows: pl.DataFrame, selections: Mapping[str, frozenset[int]], profiles: Profiles
) -> dy.DataFrame[ListedRuns]:
    """Return the runs that the tows are meant to have; those of a second file are 21 and on."""
    runs = []
    facts = tows.select("tow_id", "season", pl.col("second_path").is_not_null())
    for tow_id, season, has_second in facts.iter_rows():
        plan = profiles.find_plan(tow_id, season)
        files = [(0, plan.directions)]
        if has_second:
            files.append((SECOND_FILE_OFFSET, plan.second_directions or plan.directions))
        for offset, directions in files:
            for number, direction, target in zip(plan.runs, directions, plan.targets, strict=True):
                run = offset + number
                selected = run in selections[tow_id]
                runs.append((tow_id, run, direction, target, selected, plan.seconds))
    return make_frame(ListedRuns, runs)
