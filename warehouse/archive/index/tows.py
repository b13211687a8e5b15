"""The rows of the tow lists held against each other, the files, the boats and the profiles.

Every check takes rows, and gives those that pass with what it found; the others leave a fault.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, Final

import polars as pl

from pipeline.channels import SECOND_FILE_OFFSET
from pipeline.errors import DefectiveInputError
from pipeline.messages import say
from pipeline.tables.declare import dy
from pipeline.tables.frames import frame_of
from pipeline.tables.lake import ListedRuns, ListedTows
from warehouse.archive.faults import Fault, fault_from
from warehouse.archive.files.list_kinds import TOWS
from warehouse.archive.index.files import FilesByName, Hashes, hash_samples, the_file
from warehouse.archive.lists.boats import Boats
from warehouse.archive.lists.instruments import load_cell_of
from warehouse.archive.profile.definition import Profiles
from warehouse.archive.profile.season import SeasonProfile
from warehouse.archive.sheets.cells import WrongError
from warehouse.archive.sheets.rows import (
    PLACE,
    Problem,
    cell,
    fault_at,
    faults_of,
    header,
    keep,
    misfits,
    one_of_each,
    place_of,
)

TWICE: Final = 2.0
"""A size this many times that of the boat list cannot be right (inferred)."""
_DIMENSIONS: Final = {
    column.key: column
    for column in TOWS.columns
    if column.key in {"waterline_length_m", "beam_m", "bow_height_m"}
}
"""What a tow or else its boat must have; the height of the bow only where wind was measured."""
_SAMPLES: Final = ("samples_path", "samples_sha256", "second_path", "second_sha256")


def of_one_row(rows: pl.DataFrame, faults: list[Fault]) -> pl.DataFrame:
    """The rows whose `sleep_id` is their own, and the first of rows that are equal."""
    tow, place = pl.col("tow_id"), place_of("line", "path")
    second, first = (other.first().over(tow) for other in (place.shift(-1), place))
    other = pl.when(tow.is_first_distinct()).then(second).otherwise(first)
    text = say("sleep_id {tow} is also on {where}; {ending}")
    facts = {"tow": tow, "where": pl.col("other")}
    rows = rows.with_columns(other=other)
    return one_of_each(rows, faults, ["tow_id"], ["cells"], "duplicate_tow_id", text, **facts)


def with_files(
    rows: pl.DataFrame, by_name: FilesByName, hashes: Hashes, faults: list[Fault]
) -> pl.DataFrame:
    """The rows whose samples files are there, with their paths and hashes."""
    found = []
    named = rows.select("row", *PLACE, "season", "file", "second_file")
    for row in named.iter_rows(named=True):
        try:
            files = [
                (file.path, hash_samples(file, hashes))
                for name in (row["file"], row["second_file"])
                if name is not None
                for file in [the_file(name, row["season"], by_name)]
            ]
        except WrongError as error:
            text = say(error.text, **error.values)
            faults.append(fault_at(row, error.code or TOWS.reason_code, text))
        except DefectiveInputError as error:
            faults.append(fault_from(error, row["path"], row["of_tow"]))
        else:
            second = files[1] if len(files) > 1 else (None, None)
            found.append((row["row"], *files[0], *second))
    schema = {"row": pl.Int64, **dict.fromkeys(_SAMPLES, pl.String)}
    files_of = pl.DataFrame(found, schema, orient="row")
    return rows.join(files_of, on="row", maintain_order="left")


def with_own_samples(rows: pl.DataFrame, faults: list[Fault]) -> pl.DataFrame:
    """The rows whose samples are their own, by content.

    A first file may be the second file of another tow of the same boat: that is how two tows are
    combined.
    """
    own, second, boat = "samples_sha256", "second_sha256", "fsn_no"
    rows = rows.with_columns(crew=pl.format("{}{}", "rowers", "crew_class"))
    firsts = rows.select("row", boat, "crew", content=own)
    seconds = rows.select("row", boat, "crew", content=second).drop_nulls("content")
    users = pl.concat([firsts, seconds]).sort("row", maintain_order=True)
    others = [
        _another(rows, own, boat, users),
        _another(rows, second, boat, users),
        _another(rows, own, "crew", firsts),
    ]
    same = [own, "crew"]
    rows = rows.with_columns(
        other=pl.coalesce(others),
        earliest=pl.col("row").first().over(same),
        where=place_of("line", "path").first().over(same),
    )
    named = rows.select(
        other="row", other_boat=boat, other_crew="crew", other_place=place_of("line", "path")
    )
    rows = rows.join(named, on="other", how="left", maintain_order="left")
    text = say("meetfile and meetfile2 hold the same samples.")
    is_twice = pl.col(own) == pl.col(second)
    rows = keep(rows, faults, is_twice, "samples_listed_twice", text)
    text = say("the samples are also used for {boat} {crew} on {where}; whose they are is unclear.")
    facts = {"boat": pl.col("other_boat"), "crew": pl.col("other_crew")}
    facts |= {"where": pl.col("other_place")}
    is_of_others = pl.col("other").is_not_null()
    rows = keep(rows, faults, is_of_others, "samples_listed_twice", text, **facts)
    text = say("'{path}' holds the samples that {where} uses already for {boat}.")
    facts = {"path": pl.col("samples_path"), "where": pl.col("where"), "boat": pl.col(boat)}
    is_again = pl.col("row") != pl.col("earliest")
    return keep(rows, faults, is_again, "duplicate_tow", text, **facts)


def _another(rows: pl.DataFrame, content: str, who: str, users: pl.DataFrame) -> pl.Series:
    """The first row that uses the same content for another boat or crew; null for none."""
    first = pl.col(who).first()
    users_of = users.group_by("content", maintain_order=True).agg(
        first_who=first,
        first_row=pl.col("row").first(),
        other_row=pl.col("row").filter(pl.col(who) != first).first(),
    )
    mine = rows.select(who, content=content)
    mine = mine.join(users_of, on="content", how="left", maintain_order="left")
    is_first = pl.col(who) == pl.col("first_who")
    another = pl.when(is_first).then("other_row").otherwise("first_row")
    return mine.select(another.alias(f"{content} {who}")).to_series()


def with_boat(
    rows: pl.DataFrame, boats: Boats, profiles: Profiles, faults: list[Fault], lost: list[Problem]
) -> pl.DataFrame:
    """The tows with their boat, and its sizes where those of that day were not written down."""
    rows = _with_number(rows, boats, faults)
    sizes = boats.listed.unique("fsn_no", maintain_order=True).select(
        pl.col("fsn_no").alias("boat"), pl.col(*_DIMENSIONS, "weight_kg").name.prefix("listed_")
    )
    rows = rows.join(sizes, on="boat", how="left", maintain_order="left")
    text = say(
        "column '{column}' is {cell} and the boat list says {listed:g}; one of the two cannot be "
        "right."
    )

    def apart(key: str) -> tuple[pl.Expr, dict[str, pl.Expr]]:
        """No rebuilding makes a boat twice as long or heavy: in feet, or a digit too many."""
        listed = pl.col(f"listed_{key}")
        ratio = pl.col(key) / listed
        is_apart = ~((ratio > 1 / TWICE) & (ratio < TWICE))
        return is_apart, {"column": header(key), "cell": cell(key), "listed": listed}

    for key in _DIMENSIONS:
        is_apart, facts = apart(key)
        rows = keep(rows, faults, is_apart, TOWS.reason_code, text, **facts)
    is_apart, facts = apart("weight_kg")
    for row in rows.filter(is_apart).select("row", **facts).iter_rows(named=True):
        number = row.pop("row")
        lost.append(Problem(number, "weight_kg", TOWS.reason_code, say(text, **row)))
    has_wind = _by(
        rows, "season", lambda s: "wind" not in profiles.for_season(s).absent, pl.Boolean
    )
    filled = {key: pl.coalesce(key, f"listed_{key}") for key in _DIMENSIONS}
    weight = pl.when(is_apart.fill_null(value=False)).then(None).otherwise("weight_kg")
    rows = rows.with_columns(weight_kg=weight, **filled)
    lacking = {
        key: pl.col(key).is_null() & (has_wind if key == "bow_height_m" else pl.lit(value=True))
        for key in _DIMENSIONS
    }
    each = [
        pl.when(lacks).then(pl.lit(f"'{_DIMENSIONS[key].named}'")) for key, lacks in lacking.items()
    ]
    names = pl.concat_str(each, separator=", ", ignore_nulls=True)
    text = say("{names} must be there, here or in the boat list.")
    is_lacking = pl.any_horizontal(*lacking.values())
    rows = keep(rows, faults, is_lacking, TOWS.reason_code, text, names=names)
    return rows.with_columns(fsn_no="boat")


def _with_number(rows: pl.DataFrame, boats: Boats, faults: list[Fault]) -> pl.DataFrame:
    """The rows whose boat can be used, with its number as `boat`."""
    found = {named: boats.find(named) for named in rows["fsn_no"].unique()}
    why = {
        named: fault
        for named, number in found.items()
        if (fault := boats.bad.get(named) or (boats.unread if number is None else None))
    }
    text = say("boat {boat} cannot be used, see {path}: {why}")
    is_bad = pl.col("fsn_no").is_in([*why])
    for row in rows.filter(is_bad).select(*PLACE, "fsn_no").iter_rows(named=True):
        fault = why[row["fsn_no"]]
        said = say(text, boat=row["fsn_no"], path=fault.path, why=fault.message)
        faults.append(fault_at(row, fault.reason_code, said))
    boat = pl.col("fsn_no").replace_strict(found, default=None, return_dtype=pl.String)
    rows = rows.filter(~is_bad).with_columns(boat=boat)
    text, named = say("boat {boat} is not in the boat list."), pl.col("fsn_no")
    return keep(rows, faults, pl.col("boat").is_null(), "unknown_boat", text, boat=named)


def of_days_in_use(rows: pl.DataFrame, profiles: Profiles, faults: list[Fault]) -> pl.DataFrame:
    """The rows of days that are not set aside, with the instruments that were on board."""
    reason = _by(rows, "tow_date", profiles.reason_set_aside, pl.String)
    text = say("{day} is set aside in archief.toml: {reason}.")
    facts = {"day": pl.col("tow_date"), "reason": reason}
    rows = keep(rows, faults, reason.is_not_null(), "day_set_aside", text, **facts)

    def of_season(read: Callable[[SeasonProfile], object], dtype: type[pl.DataType]) -> pl.Expr:
        return _by(rows, "season", lambda year: read(profiles.for_season(year)), dtype)

    return rows.with_columns(
        wind_measured=of_season(lambda p: "wind" not in p.absent, pl.Boolean),
        log2_measured=of_season(lambda p: "log2" not in p.absent, pl.Boolean),
        sample_rate_hz=pl.coalesce(
            "sample_rate_hz", of_season(lambda p: p.sample_rate_hz, pl.Int32)
        ),
        log1_part=_by(rows, "tow_date", partial(profiles.part_of_log, "log1"), pl.Int64),
        log2_part=_by(rows, "tow_date", partial(profiles.part_of_log, "log2"), pl.Int64),
    )


def _by(
    rows: pl.DataFrame, key: str, read: Callable[[Any], object], dtype: type[pl.DataType]
) -> pl.Expr:
    """What follows from the value of a column, read once for each."""
    found = {value: read(value) for value in rows[key].unique()}
    nothing = pl.lit(None, dtype)
    return pl.col(key).replace_strict(found, return_dtype=dtype) if found else nothing


def with_instruments(
    rows: pl.DataFrame, profiles: Profiles, checks: pl.DataFrame, burned: pl.DataFrame
) -> pl.DataFrame:
    """The tows with what is known of the load cell and the warning lamps.

    Args:
        rows: the tows.
        profiles: how long their runs are meant to last.
        checks: of the load cell (`ListedForceChecks`).
        burned: how long a lamp burned, as `lamp_seconds` says.
    """
    days = rows.select("season", "tow_date").unique(maintain_order=True).rows()
    cells = [
        (season, day, *(load_cell_of(season, day, checks) or (None, None))) for season, day in days
    ]
    schema = {"season": pl.Int64, "tow_date": pl.Date}
    schema |= {"load_cell_ratio": pl.Float64, "load_cell_sd": pl.Float64}
    of_days = pl.DataFrame(cells, schema, orient="row")
    rows = rows.join(of_days, on=["season", "tow_date"], how="left", maintain_order="left")
    rows = rows.join(burned, on="tow_id", how="left", maintain_order="left")
    plans = (profiles.plan_of(*tow) for tow in rows.select("tow_id", "season").rows())
    planned_s = pl.Series([plan.seconds for plan in plans], dtype=pl.Float64)
    return rows.with_columns(lamp_ratio=pl.col("burned_s") / planned_s)


def within_limits(rows: pl.DataFrame, faults: list[Fault]) -> pl.DataFrame:
    """The tows within the limits of the table `tows`."""
    why = {row["tow_id"]: text for row, text in misfits(ListedTows, as_listed(rows))}
    is_misfit = pl.col("tow_id").is_in([*why])
    places = rows.filter(is_misfit).select(*PLACE).iter_rows(named=True)
    faults += (fault_at(place, TOWS.reason_code, why[place["of_tow"]]) for place in places)
    return rows.filter(~is_misfit)


def as_listed(rows: pl.DataFrame) -> dy.DataFrame[ListedTows]:
    """The tows with the columns of their table."""
    placed = rows.with_columns(list_path="path", list_line="line")
    return ListedTows.cast(placed.select(ListedTows.column_names()))


def lost_cells(rows: pl.DataFrame, lost: Sequence[Problem]) -> Iterator[Fault]:
    """A fault for each cell that a tow does without."""
    for fault in faults_of(rows, lost):
        text = say("{what} The cell counts as empty.", what=fault.message)
        yield replace(fault, message=text, lost="cell")


def runs_of(
    rows: pl.DataFrame, selections: Mapping[int, frozenset[int]], profiles: Profiles
) -> dy.DataFrame[ListedRuns]:
    """The runs that the tows are meant to have; those of a second file are 21 and on."""
    runs = []
    facts = rows.select("row", "tow_id", "season", pl.col("second_path").is_not_null())
    for row, tow_id, season, has_second in facts.iter_rows():
        plan = profiles.plan_of(tow_id, season)
        ways = {0: plan.directions, SECOND_FILE_OFFSET: plan.second_directions or plan.directions}
        runs += [
            {
                "tow_id": tow_id,
                "run": offset + number,
                "direction": ways[offset][number - 1],
                "target_speed_ratio": plan.targets[number - 1],
                "selected": offset + number in selections[row],
                "planned_s": plan.seconds,
            }
            for offset in list(ways)[: 1 + has_second]
            for number in plan.runs
        ]
    return frame_of(ListedRuns, runs)
