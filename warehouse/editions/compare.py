"""Two editions side by side: every line with its causes, and what it does to races.

The numbers come from `pipeline.register.changes`, `pipeline.studies.ladder` and
`pipeline.register.replay`. Here is decided what two editions do not share: tow, files, method,
code. The steps of the method are computed with the code and blocks of today; what they leave
unexplained is one factor, named after what else differs. An edition holds its comparison with the
one before.
"""

from collections.abc import Collection
from dataclasses import dataclass, replace
from typing import Final

import polars as pl

from pipeline.blocks.run_blocks import stack_blocks
from pipeline.method.definition import RUNS_ALONE
from pipeline.register.changes import (
    NO_FACTOR,
    NO_PARTS,
    PART_SCHEMA,
    compare_lines,
    largest_first,
    register_changes,
    steps_of_lines,
)
from pipeline.register.register import LINE, NO_EMPTY_THWART
from pipeline.register.replay import RaceRules, race_changes, replay, winner_changes
from pipeline.tables.frames import dtypes
from pipeline.tables.row import Row
from pipeline.tables.studies import CorrectionSteps
from warehouse.derive.published import lines_in_time
from warehouse.editions.inputs import INPUTS_HASH, same_tows, tables_of_today, unchanged_tows
from warehouse.store.code import code_version
from warehouse.store.editions import CHANGES, MEASURED, Edition, read_edition
from warehouse.store.store import Store, archive_root

STEP_COLUMNS: Final = ("tow_id", "position", "step", "factor")
NO_STEPS: Final = pl.DataFrame(schema={n: dtypes(CorrectionSteps)[n] for n in STEP_COLUMNS})
CAUSE: Final = pl.Struct({name: PART_SCHEMA[name] for name in ("cause", "step", "factor")})
LARGEST: Final = 10


@dataclass(frozen=True)
class Comparison:
    """Two editions side by side.

    Attributes:
        old, new: the editions.
        lines: lines as `pipeline.register.changes.compare_lines` has them, with the boat's `name`,
            and the status in both, which says why a line has no curve any more.
    """

    old: Edition
    new: Edition
    lines: pl.DataFrame


def diff(store: Store, old: str, new: str) -> Comparison:
    """Compares two published editions.

    With the edition before it an edition was compared when it was published; that is part of it.

    Raises:
        MissingKnowledgeError: there is no such edition.
        BrokenPromiseError: a file of it is missing or damaged.
    """
    before, after = read_edition(store, old), read_edition(store, new)
    if after.manifest.previous == old:
        return Comparison(before, after, after.tables[CHANGES])
    return compare(store, before, after)


def compare(store: Store, old: Edition, new: Edition) -> Comparison:
    """Compares two editions line by line, with causes whose factors multiply to the change."""
    code = _code_parts(store, old, new)
    steps = _steps(store, old, new)
    printed = _printed_parts(old, new)
    parts = pl.concat([code, printed, steps_of_lines(new.register, steps)], how="diagonal_relaxed")
    grounds = _grounds(old, new, steps["tow_id"], printed, code_known=not code.is_empty())
    lines = compare_lines(old.register, new.register, parts, grounds)
    names = pl.concat([new.register.select(*LINE, "name"), old.register.select(*LINE, "name")])
    lines = lines.join(
        names.unique(LINE, keep="first"), on=LINE, how="left", maintain_order="left"
    ).sort(LINE)
    for side, edition in (("old", old), ("new", new)):
        status = edition.register.select(*LINE, pl.col("status").alias(f"{side}_status"))
        lines = lines.join(status, on=LINE, how="left", maintain_order="left")
    return Comparison(old, new, lines)


def _code_parts(store: Store, old: Edition, new: Edition) -> pl.DataFrame:
    """What the code alone changed: the old edition made again by the code of the new one.

    Known where the new edition was made by the code of today and the warehouse still has all
    inputs of the old one, unchanged.
    """
    versions = (old.manifest.code_version, new.manifest.code_version)
    if old.method is None or versions[0] == versions[1] or versions[1] != code_version():
        return NO_PARTS
    if len(unchanged_tows(store, old)) < old.tables["tows"].height:
        return NO_PARTS
    from warehouse.editions.making import made_again  # noqa: PLC0415 - much, and seldom needed

    again = made_again(store, old).register.with_columns(pl.lit("again").alias("edition"))
    changes = register_changes(old.register, again)
    return _parts("code", changes.with_columns(pl.col("cw_ratio").fill_null(1.0)))


def _parts(cause: str, changes: pl.DataFrame) -> pl.DataFrame:
    """All of what changed as the work of one cause."""
    return changes.select(
        *LINE, cause=pl.lit(cause), step=pl.lit(None, pl.String), factor="cw_ratio"
    )


def _printed_parts(old: Edition, new: Edition) -> pl.DataFrame:
    """Where another tow counts than the printed one: what the new method makes of the printed tow.

    Known where the new edition went by tows and has one of that day and line.
    """
    if old.method is not None or "curves" not in new.tables:
        return NO_PARTS
    thwart = pl.col("empty_thwart").fill_null(NO_EMPTY_THWART)
    tows = new.tables["tows"].select("tow_id", "tow_date", thwart)
    curves = new.tables["curves"].join(tows, on="tow_id", maintain_order="left")
    day = [*LINE, "tow_date"]
    same_tow = curves.join(old.register, on=day, how="semi").unique(day, keep="none")
    moved = same_tow.join(new.register, on="tow_id", how="anti")
    if moved.is_empty():
        return NO_PARTS
    moved = moved.with_columns(edition=pl.lit("printed"))
    return _parts("printed", register_changes(old.register, moved).drop_nulls("cw_ratio"))


def _steps(store: Store, old: Edition, new: Edition) -> pl.DataFrame:
    """The ladder from the old to the new method, on the new edition's tows that are still there."""
    if old.method is None or new.method is None:
        return NO_STEPS
    if old.method.content_hash == new.method.content_hash:
        return NO_STEPS
    from warehouse.intake import seasons as intake  # noqa: PLC0415 - as below

    there = pl.col("tow_id").is_in(list(unchanged_tows(store, new)))
    tows, runs = (table.filter(there) for table in tables_of_today(store).values())
    if tows.is_empty():
        return NO_STEPS
    from pipeline.studies.ladder import ladder  # noqa: PLC0415 - much, and seldom needed

    blocks = stack_blocks(intake.all_blocks(store), runs)
    before, after = (edition.tables.get("tow_instruments") for edition in (old, new))
    links = None if before is None or after is None else (before, after)
    return ladder(old.method, new.method, tows, blocks, links)


# What the known parts of a change leave unexplained is named after its ground


def grounds(
    old: pl.DataFrame,
    new: pl.DataFrame,
    same: Collection[str],
    *,
    others: bool,
    method: bool,
    code: bool,
    separated: Collection[str] = (),
) -> pl.DataFrame:
    """Per line of two registers of tows, the `ground` of what known parts do not explain.

    Args:
        old, new: the registers.
        same: tows with the same input in both.
        others: any tow has another input.
        method, code: whether these differ.
        separated: tows of which the work of the method is a known part.
    """
    pairs = old.select(*LINE, "tow_id").join(
        new.select(*LINE, "tow_id"), on=LINE, suffix="_new", nulls_equal=True, maintain_order="left"
    )
    tow = pl.col("tow_id_new")
    own = ~tow.is_in(list(same))
    redefined = ~tow.is_in(list(separated)) & method
    ground = (
        pl.when(pl.col("tow_id").ne_missing(tow))
        .then(pl.lit("tow"))
        .when(redefined & (own | code))
        .then(pl.lit("unseparated"))
        .when(redefined)
        .then(pl.lit("method"))
        .when(own)
        .then(pl.lit("input_and_code" if code else "input"))
        .when(others)
        .then(pl.lit("code_or_other_input" if code else "other_input"))
        .otherwise(pl.lit("code" if code else "unexplained"))
    )
    return pairs.select(*LINE, ground=ground)


def _grounds(
    old: Edition,
    new: Edition,
    separated: Collection[str],
    printed_parts: pl.DataFrame,
    *,
    code_known: bool,
) -> pl.DataFrame:
    """The ground of every line, of tows or of print.

    Args:
        old, new: the editions.
        separated: tows with a ladder.
        printed_parts: lines whose printed tow was computed.
        code_known: what the code changed is a known part.
    """
    shared = [*LINE, "tow_date", INPUTS_HASH, "basis"]
    pairs = old.register.select(shared).join(
        new.register.select(shared), on=LINE, suffix="_new", nulls_equal=True, maintain_order="left"
    )
    computed = printed_parts.select(LINE).with_columns(computed=pl.lit(value=True))
    days = pl.col("tow_date"), pl.col("tow_date_new")
    of_print = (
        pl.when(pl.col(INPUTS_HASH).eq_missing(pl.col(f"{INPUTS_HASH}_new")))
        .then(pl.lit("closed_form"))
        .when("computed")
        .then(pl.lit("tow"))
        .when(days[0] != days[1])
        .then(pl.lit("printed_and_tow"))
        .otherwise(pl.lit("printed"))
    )
    named = pairs.join(computed, on=LINE, how="left", maintain_order="left")
    named = named.with_columns(ground=of_print)
    if "tows" in old.tables and "tows" in new.tables:
        same = same_tows(old.tables, new.tables)
        manifests = old.manifest, new.manifest
        of_tows = grounds(
            old.register,
            new.register,
            same,
            others=any(edition.tables["tows"].height > len(same) for edition in (old, new)),
            method=len({m.method_hash for m in manifests}) > 1,
            code=not code_known and len({m.code_version for m in manifests}) > 1,
            separated=separated,
        )
        measured = pl.all_horizontal(pl.col("basis", "basis_new").eq_missing(MEASURED))
        of_tow = pl.when(measured).then("of_tows").otherwise("ground")
        of_tows = of_tows.rename({"ground": "of_tows"})
        named = named.join(of_tows, on=LINE, maintain_order="left").with_columns(ground=of_tow)
    return named.select(*LINE, "ground")


# Summary


@dataclass(frozen=True)
class Group:
    """Lines that gain power for the same race, or lose it.

    Attributes:
        lines: how many.
        of_class: how many of each class.
        median_power_ratio: new / old power for the same race.
        median_seconds: what the new register gives in a race of two hours [s].
        most: the lines that it moves most, as in `DiffReport.rows`.
    """

    lines: int
    of_class: dict[str, int]
    median_power_ratio: float | None
    median_seconds: float | None
    most: list[Row]


@dataclass(frozen=True)
class DiffReport:
    """A comparison of two editions as plain data.

    Attributes:
        from_edition, to_edition: the editions.
        simulated: whether either is of a simulated archive.
        lines: lines in either.
        changes: lines by kind of change.
        gain, loss: lines to which the new register gives more power for the same race, and less.
        exceeds_interval: lines that moved by more than their intervals.
        interval_unknown: lines whose interval is not known.
        runs_alone: editions whose intervals are the spread of the runs alone.
        causes: see `causes_of`.
        largest: the lines that changed most.
        rows: all lines: rows of `register_changes` with the causes that moved each.
        race_rules: how races are worked out, where that was asked.
        races, winners: results of the archive's races under both, and who wins; None where not
            asked, or where the archive is not there or has no races.
    """

    from_edition: str
    to_edition: str
    simulated: bool
    lines: int
    changes: dict[str, int]
    gain: Group
    loss: Group
    exceeds_interval: int
    interval_unknown: int
    runs_alone: list[str]
    causes: list[Row]
    largest: list[Row]
    rows: list[Row]
    race_rules: RaceRules | None = None
    races: list[Row] | None = None
    winners: list[Row] | None = None


def report(comparison: Comparison) -> DiffReport:
    """Counts, who gains and loses, causes, and every line of a comparison."""
    lines = comparison.lines
    compared = lines.drop_nulls("cw_ratio")
    moved = compared.filter(change="changed")
    gains = pl.col("power_ratio") > 1
    editions = (comparison.old, comparison.new)
    return DiffReport(
        from_edition=comparison.old.manifest.edition,
        to_edition=comparison.new.manifest.edition,
        simulated=any(edition.manifest.simulated for edition in editions),
        lines=lines.height,
        changes=dict(lines["change"].value_counts().sort("change").rows()),
        gain=_group(moved.filter(gains).sort("power_ratio", "fsn_no", descending=True)),
        loss=_group(moved.filter(~gains).sort("power_ratio", "fsn_no")),
        exceeds_interval=int(moved["exceeds_interval"].fill_null(False).sum()),
        interval_unknown=int(moved["exceeds_interval"].null_count()),
        runs_alone=[
            edition.manifest.edition
            for edition in editions
            if edition.method is not None and edition.method.interval == RUNS_ALONE
        ],
        causes=causes_of(compared),
        largest=_rows(largest_first(moved).head(LARGEST)),
        rows=_rows(lines),
    )


def report_with_races(store: Store, comparison: Comparison, rules: RaceRules) -> DiffReport:
    """The same with power, rank, podium and winner of every race in the archive under both.

    Raises:
        MissingKnowledgeError: the rules ask for what is not known.
    """
    without_races = replace(report(comparison), race_rules=rules)
    results = pl.DataFrame() if archive_root(store) is None else store.read("listed_races")
    if results.is_empty():
        return without_races
    editions = (comparison.old, comparison.new)
    before, after = (replay(lines_in_time(store, one), results, rules) for one in editions)
    members = comparison.new.tables.get("ensemble", pl.DataFrame())
    return replace(
        without_races,
        races=race_changes(before, after).to_dicts(),
        winners=winner_changes(before, after, members).to_dicts(),
    )


def _group(lines: pl.DataFrame) -> Group:
    power, seconds = lines.select("power_ratio", "gain_in_two_hours_s").median().row(0)
    return Group(
        lines=lines.height,
        of_class={c: lines.filter(crew_class=c).height for c in ("H", "D")},
        median_power_ratio=power,
        median_seconds=seconds,
        most=_rows(lines.head(LARGEST)),
    )


def parts_of(lines: pl.DataFrame) -> pl.DataFrame:
    """The causes of lines, one a row: `LINE`, `cause`, `step` and `factor`; null where none is."""
    causes = pl.col("causes").str.json_decode(pl.List(CAUSE))
    return lines.select(*LINE, causes).explode("causes").unnest("causes")


def causes_of(lines: pl.DataFrame) -> list[Row]:
    """What each cause, or step of a method, did; that with the most lines first.

    Returns:
        Rows of `cause`, `step` (where a method is the cause), `lines` (how many it moved), and of
        its factors on Cw there `median_factor`, `lowest_factor`, `highest_factor`.
    """
    factor = pl.col("factor")
    return (
        parts_of(lines)
        .filter((factor - 1.0).abs() > NO_FACTOR)
        .group_by("cause", "step", maintain_order=True)
        .agg(
            pl.len().alias("lines"),
            factor.median().alias("median_factor"),
            factor.min().alias("lowest_factor"),
            factor.max().alias("highest_factor"),
        )
        .sort("lines", "cause", "step", descending=[True, False, False])
        .to_dicts()
    )


def _rows(lines: pl.DataFrame) -> list[Row]:
    """Lines with the causes that changed something."""
    rows = lines.with_columns(pl.col("causes").str.json_decode(pl.List(CAUSE))).to_dicts()
    return [row | {"causes": list(map(_named, filter(_moves, row["causes"])))} for row in rows]


def _moves(cause: Row) -> bool:
    return abs(float(cause["factor"]) - 1.0) > NO_FACTOR


def _named(cause: Row) -> Row:
    return {name: value for name, value in cause.items() if value is not None}
