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
from pipeline.curve import cw
from pipeline.method.definition import RUNS_ALONE, Method, shipped_method
from pipeline.races.power import curve_of_lines
from pipeline.register.changes import (
    NO_FACTOR,
    NO_PARTS,
    PART_SCHEMA,
    compare_lines,
    largest_first,
    steps_of_lines,
)
from pipeline.register.register import LINE, NO_EMPTY_THWART
from pipeline.register.replay import RaceRules, race_changes, replay, winner_changes
from pipeline.tables.frames import dtypes
from pipeline.tables.row import Row
from pipeline.tables.studies import CorrectionSteps
from warehouse.derive.registers import lines_in_time
from warehouse.editions.inputs import INPUTS_HASH, same_tows, tables_of_today
from warehouse.store.editions import CHANGES, MEASURED, Edition
from warehouse.store.store import Store

STEP_COLUMNS: Final = ("tow_id", "position", "step", "factor")
NO_STEPS: Final = pl.DataFrame(schema={n: dtypes(CorrectionSteps)[n] for n in STEP_COLUMNS})
CAUSE: Final = pl.Struct({name: PART_SCHEMA[name] for name in ("cause", "step", "factor")})
LARGEST: Final = 10
AS_PUBLISHED: Final = "as-published"
"""The method that does what was done in each season: what is printed is held against it."""
REPRODUCTION: Final = "reproduction"
"""From print to the same tow as published: what was printed and cannot be explained."""


def compare(store: Store, old: Edition, new: Edition) -> pl.DataFrame:
    """Compares two editions line by line, with causes whose factors multiply to the change.

    With the edition before it an edition was compared when it was published; that is part of it.

    Returns:
        Lines as `pipeline.register.changes.compare_lines` has them, with the boat's `name`, and
        the status in both, which says why a line has no curve any more.
    """
    if CHANGES in new.tables and new.manifest.previous == old.manifest.edition:
        return new.tables[CHANGES]
    start = old.method or shipped_method(AS_PUBLISHED)
    steps = _steps(store, start, old, new)
    printed = _printed_parts(steps, old, new)
    parts = pl.concat([printed, steps_of_lines(new.register, steps)], how="diagonal_relaxed")
    manifests = old.manifest, new.manifest
    both_towed = all("tows" in edition.tables for edition in (old, new))
    same = same_tows(old.tables, new.tables) if both_towed else frozenset[str]()
    ground = grounds(
        old.register,
        new.register,
        same,
        others=any(len(same) < one.tables["tows"].height for one in (old, new) if both_towed),
        method=len({m.method_hash for m in manifests}) > 1,
        code=len({m.code_version for m in manifests}) > 1,
        separated=steps["tow_id"],
        computed=printed,
    )
    lines = compare_lines(old.register, new.register, parts, ground)
    columns = lines.columns
    for side, edition in (("old", old), ("new", new)):
        said = (pl.col(name).alias(f"{side}_{name}") for name in ("name", "status"))
        mine = edition.register.select(*LINE, *said)
        lines = lines.join(mine, on=LINE, how="left", maintain_order="left")
    named = pl.coalesce("new_name", "old_name").alias("name")
    return lines.sort(LINE).select(*columns, named, "old_status", "new_status")


def _printed_parts(rungs: pl.DataFrame, old: Edition, new: Edition) -> pl.DataFrame:
    """Where another tow counts than the printed one: from print to that tow as published.

    Known where the new edition has one tow of that day and line.

    Args:
        rungs: the ladder from `AS_PUBLISHED`.
        old, new: the editions; the old one may be printed.
    """
    if old.method is not None or rungs.is_empty():
        return NO_PARTS
    thwart = pl.col("empty_thwart").fill_null(NO_EMPTY_THWART)
    day = [*LINE, "tow_date"]
    printed = (
        new.tables["tows"]
        .select("tow_id", *LINE[:-1], thwart, "tow_date", v0="declared_speed_m_s")
        .join(
            rungs.filter(position=0).select("tow_id", first="cw_kg_m"),
            on="tow_id",
            maintain_order="left",
        )
        .join(old.register.drop("tow_id"), on=day, maintain_order="left")
        .unique(day, keep="none", maintain_order=True)
        .join(new.register, on="tow_id", how="anti")
    )
    before = cw(*curve_of_lines(printed), printed["v0"].to_numpy())
    known = printed.with_columns(factor=pl.col("first") / pl.Series(before))
    step = pl.lit(None, pl.String)
    return known.filter(pl.col("factor").is_finite()).select(
        *LINE, cause=pl.lit(REPRODUCTION), step=step, factor="factor"
    )


def _steps(store: Store, start: Method, old: Edition, new: Edition) -> pl.DataFrame:
    """The ladder to the new method, on the new edition's tows that are still there.

    It begins at the old method; from print, at `AS_PUBLISHED`.
    """
    if new.method is None or old.manifest.method_hash == new.manifest.method_hash:
        return NO_STEPS
    from warehouse.intake import seasons as intake  # noqa: PLC0415 - as below

    today = tables_of_today(store)
    there = pl.col("tow_id").is_in(list(same_tows(new.tables, today)))
    tows, runs = (table.filter(there) for table in today.values())
    if tows.is_empty():
        return NO_STEPS
    from pipeline.studies.ladder import ladder  # noqa: PLC0415 - much, and seldom needed

    blocks = stack_blocks(intake.all_blocks(store), runs)
    before, after = (edition.tables.get("tow_instruments") for edition in (old, new))
    is_known = after is not None and (before is not None or old.method is None)
    return ladder(start, new.method, tows, blocks, (before, after) if is_known else None)


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
    computed: pl.DataFrame = NO_PARTS,
) -> pl.DataFrame:
    """Per line of two registers the `ground` of what known parts do not explain.

    Args:
        old, new: the registers; a line of which the `basis` is not `MEASURED` is of print.
        same: tows with the same input in both.
        others: any tow has another input.
        method, code: whether these differ.
        separated: tows of which the work of the method is a known part.
        computed: lines of which the printed tow was computed.
    """
    facts = (*LINE, "tow_id", "tow_date", INPUTS_HASH, "basis")
    mine = computed.select(LINE).with_columns(is_computed=pl.lit(value=True))
    pairs = (
        old.select(facts)
        .join(new.select(facts), on=LINE, suffix="_new", nulls_equal=True, maintain_order="left")
        .join(mine, on=LINE, how="left", maintain_order="left")
    )

    def moved(name: str) -> pl.Expr:
        return pl.col(name).ne_missing(pl.col(f"{name}_new"))

    of_print = pl.any_horizontal(pl.col("basis", "basis_new").ne_missing(MEASURED))
    own = ~pl.col("tow_id_new").is_in(list(same))
    stepped = pl.col("tow_id_new").is_in(list(separated))
    redefined = ~stepped & method
    holds = {
        "closed_form": of_print & ~moved(INPUTS_HASH),
        "tow": pl.when(of_print).then(pl.col("is_computed") & stepped).otherwise(moved("tow_id")),
        "printed_and_tow": of_print & moved("tow_date"),
        REPRODUCTION: of_print & stepped,
        "printed": of_print,
        "unseparated": redefined & (own | code),
        "method": redefined,
        "input_and_code": own & code,
        "input": own,
        "code_or_other_input": pl.lit(others and code),
        "other_input": pl.lit(others),
        "code": pl.lit(code),
        "unexplained": pl.lit(value=True),
    }
    first = pl.coalesce(pl.when(it).then(pl.lit(ground)) for ground, it in holds.items())
    return pairs.select(*LINE, ground=first)


# Summary


@dataclass(frozen=True)
class DiffReport:
    """A comparison of two editions as plain data.

    Attributes:
        from_edition, to_edition: the editions.
        simulated: whether either is of a simulated archive.
        lines: lines in either.
        changes: lines by kind of change.
        gain, loss: how many `lines` gain power for the same race or lose it, how many `of_class`,
            and their `median_power_ratio` and `median_seconds` in a race of two hours.
        exceeds_interval: lines that moved by more than their intervals.
        interval_unknown: lines whose interval is not known.
        runs_alone: editions whose intervals are the spread of the runs alone.
        causes: see `causes_of`.
        largest: the lines that changed most.
        rows: all lines: rows of `register_changes` with the causes that moved each.
        race_rules: how races are worked out, where that was asked.
        races, winners: results of the archive's races under both, and who wins; None where not
            asked, or where the archive has no races.
    """

    from_edition: str
    to_edition: str
    simulated: bool
    lines: int
    changes: dict[str, int]
    gain: Row
    loss: Row
    exceeds_interval: int
    interval_unknown: int
    runs_alone: list[str]
    causes: list[Row]
    largest: list[Row]
    rows: list[Row]
    race_rules: RaceRules | None = None
    races: list[Row] | None = None
    winners: list[Row] | None = None


def report(old: Edition, new: Edition, lines: pl.DataFrame) -> DiffReport:
    """Counts, who gains and loses, causes, and every line of `compare`."""
    compared = lines.drop_nulls("cw_ratio")
    moved = compared.filter(change="changed")
    gains = pl.col("power_ratio") > 1
    return DiffReport(
        from_edition=old.manifest.edition,
        to_edition=new.manifest.edition,
        simulated=any(edition.manifest.simulated for edition in (old, new)),
        lines=lines.height,
        changes=dict(lines["change"].value_counts().sort("change").rows()),
        gain=_group(moved.filter(gains)),
        loss=_group(moved.filter(~gains)),
        exceeds_interval=int(moved["exceeds_interval"].fill_null(False).sum()),
        interval_unknown=int(moved["exceeds_interval"].null_count()),
        runs_alone=[
            edition.manifest.edition
            for edition in (old, new)
            if edition.method is not None and edition.method.interval == RUNS_ALONE
        ],
        causes=causes_of(compared),
        largest=_rows(largest_first(moved).head(LARGEST)),
        rows=_rows(lines),
    )


def report_with_races(store: Store, old: Edition, new: Edition, rules: RaceRules) -> DiffReport:
    """Compares two editions, with power, rank, podium and winner of every race of the archive.

    Raises:
        MissingKnowledgeError: the rules ask for what is not known.
    """
    without_races = replace(report(old, new, compare(store, old, new)), race_rules=rules)
    if store.made_from("listed_races") is None or not store.count_rows("listed_races"):
        return without_races
    results = store.read("listed_races")
    before, after = (replay(lines_in_time(store, one), results, rules) for one in (old, new))
    members = new.tables.get("ensemble", pl.DataFrame())
    return replace(
        without_races,
        races=race_changes(before, after).to_dicts(),
        winners=winner_changes(before, after, members).to_dicts(),
    )


def _group(lines: pl.DataFrame) -> Row:
    power, seconds = lines.select("power_ratio", "gain_in_two_hours_s").median().row(0)
    return {
        "lines": lines.height,
        "of_class": {c: lines.filter(crew_class=c).height for c in ("H", "D")},
        "median_power_ratio": power,
        "median_seconds": seconds,
    }


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
