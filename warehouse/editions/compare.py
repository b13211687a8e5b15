"""Two editions side by side: every line with its causes, and what it does to races.

A change is explained in the order of history. A printed line is first held against its own tow
under the method that was in force when it was printed; then the old line's tow is re-based, step by
step, to the new method; what remains is another tow, other input, or other code. The numbers come
from `pipeline.register.changes`, `pipeline.studies.ladder` and `pipeline.register.replay`. An
edition holds its comparison with the one before.
"""

from dataclasses import dataclass, replace
from typing import Final

import polars as pl

from pipeline.blocks.run_blocks import stack_blocks
from pipeline.crews import STANDARD_CREWS
from pipeline.method.definition import RUNS_ALONE, Method, find_method_in_force
from pipeline.races.power import compute_line_cw
from pipeline.register.causes import (
    CAUSE,
    CLOSED_FORM,
    NO_FACTOR,
    REPRODUCTION,
    assign_steps,
    name_grounds,
    summarise_causes,
)
from pipeline.register.changes import compare_lines, sort_largest_first
from pipeline.register.printed import rebase_printed
from pipeline.register.register import LINE, TOW_DAY, list_tow_days
from pipeline.register.replay import RaceRules, compare_winners, race_changes, replay
from pipeline.tables.row import Row
from warehouse.derive.edition_lines import list_lines_in_time
from warehouse.editions.inputs import find_same_tows, read_tables_of_today
from warehouse.store.crew_classes import read_crew_classes
from warehouse.store.editions import CHANGES, Edition
from warehouse.store.methods import KnownMethods
from warehouse.store.store import Store

LARGEST: Final = 10


def compare(store: Store, old: Edition, new: Edition) -> pl.DataFrame:
    """Compare two editions line by line, with causes whose factors multiply to the change.

    With the edition before it an edition was compared when it was published; that is part of it.

    Returns:
        Lines as `pipeline.register.changes.compare_lines` has them, with the boat's `name`, and
        the status in both, which says why a line has no curve any more.
    """
    if CHANGES in new.tables and new.manifest.previous == old.manifest.edition:
        return new.tables[CHANGES]
    before, after = _add_printed_tows(old, new), new.register
    ladder = _compute_ladder(store, old, new)
    parts = assign_steps(before, ladder.filter(pl.col("position") > 0))
    if old.method is None and new.method is not None:
        printed = _explain_printed_lines(before, ladder, new, new.method)
        parts = pl.concat([printed, parts], how="vertical_relaxed")

    have_tows = "tows" in old.tables and "tows" in new.tables
    same = find_same_tows(old.tables, new.tables) if have_tows else frozenset[str]()
    ground = name_grounds(
        before,
        after,
        same,
        others=any(len(same) < one.tables["tows"].height for one in (old, new) if have_tows),
        method=old.manifest.method_hash != new.manifest.method_hash,
        code=old.manifest.code_version != new.manifest.code_version,
        rebased=parts,
    )
    lines = compare_lines(before, after, parts, ground)
    beside = lines.columns
    for side, edition in (("old", old), ("new", new)):
        facts = edition.register.select(
            pl.col(LINE),
            pl.col("name").alias(f"{side}_name"),
            pl.col("status").alias(f"{side}_status"),
        )
        lines = lines.join(facts, on=LINE, how="left", maintain_order="left")
    name = pl.coalesce("new_name", "old_name").alias("name")
    return lines.sort(LINE).select(pl.col(beside), name, "old_status", "new_status")


def _add_printed_tows(old: Edition, new: Edition) -> pl.DataFrame:
    """Add to each printed old line the tow of that day and line, where there is one."""
    if old.method is not None or "tows" not in new.tables:
        return old.register
    tows = new.tables["tows"]
    once = (
        list_tow_days(tows)
        .with_columns(tows["tow_id"])
        .unique(TOW_DAY, keep="none", maintain_order=True)
    )
    return old.register.drop("tow_id").join(once, on=TOW_DAY, how="left", maintain_order="left")


def _compute_ladder(store: Store, old: Edition, new: Edition) -> pl.DataFrame:
    """Apply the steps from the old method to the new one, one after another, to the same tows.

    From print it begins at the method that was in force when the register was printed.
    """
    # What may recompute tows is imported here: most comparisons are read as they were published.
    from pipeline.studies.ladder import ladder  # noqa: PLC0415
    from pipeline.tables.studies import CorrectionSteps  # noqa: PLC0415
    from warehouse.intake import seasons as intake  # noqa: PLC0415

    no_ladder = CorrectionSteps.create_empty()
    if new.method is None or old.manifest.method_hash == new.manifest.method_hash:
        return no_ladder
    today = read_tables_of_today(store)
    there = pl.col("tow_id").is_in(list(find_same_tows(new.tables, today)))
    tows, runs = today["tows"].filter(there), today["tow_runs"].filter(there)
    start = old.method
    if start is None:
        printed_in = old.manifest.printed_in or old.manifest.valid_from.year
        known = KnownMethods.from_store(store)
        start = find_method_in_force(printed_in, list(map(known.get, known.names)))
    if tows.is_empty() or start is None:
        return no_ladder
    blocks = stack_blocks(intake.read_all_blocks(store), runs)
    before = old.tables.get("tow_instruments")
    after = new.tables.get("tow_instruments")
    is_known = after is not None and (before is not None or old.method is None)
    return ladder(start, new.method, tows, blocks, (before, after) if is_known else None)


def _explain_printed_lines(
    printed: pl.DataFrame, ladder: pl.DataFrame, new: Edition, method: Method
) -> pl.DataFrame:
    """Return the known causes of printed lines before the steps of the method.

    With samples: from print to the tow by the method then in force. Without: the log error of its
    season under the new method, in closed form.
    """
    lines = printed.drop_nulls("cw_kg_m")
    computed = ladder.filter(position=0).select("tow_id", computed_cw="cw_kg_m")
    speeds = new.tables["tows"].select("tow_id", tow_speed="declared_speed_m_s")
    measured = lines.join(computed, on="tow_id", maintain_order="left").join(
        speeds, on="tow_id", maintain_order="left"
    )
    at_tow_speed = compute_line_cw(measured, measured["tow_speed"].to_numpy())
    reproduction = measured["computed_cw"] / pl.Series(at_tow_speed, dtype=pl.Float64)

    unmeasured = lines.join(measured, on=LINE, how="anti").select(lines.columns)
    rebased = rebase_printed(unmeasured, new.tables["log_factors"], method)
    unmeasured = unmeasured.join(rebased, on=LINE, how="semi", maintain_order="left")
    speed = unmeasured["declared_speed_m_s"].to_numpy()
    closed_form = compute_line_cw(rebased, speed) / compute_line_cw(unmeasured, speed)

    def parts(of: pl.DataFrame, cause: str, factor: pl.Series) -> pl.DataFrame:
        step = pl.lit(None, pl.String).alias("step")
        named = of.select(pl.col(LINE), pl.lit(cause).alias("cause"), step, factor.alias("factor"))
        return named.filter(pl.col("factor").is_finite())

    return pl.concat(
        [
            parts(measured, REPRODUCTION, reproduction),
            parts(unmeasured, CLOSED_FORM, pl.Series(closed_form, dtype=pl.Float64)),
        ]
    )


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
        causes: see `summarise_causes`.
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
    """Count who gains and loses, list causes, and every line of `compare`."""
    compared = lines.drop_nulls("cw_ratio")
    moved = compared.filter(change="changed")
    is_gain = pl.col("power_ratio") > 1
    return DiffReport(
        from_edition=old.manifest.edition,
        to_edition=new.manifest.edition,
        simulated=old.manifest.simulated or new.manifest.simulated,
        lines=lines.height,
        changes=dict(lines["change"].value_counts().sort("change").rows()),
        gain=_summarise(moved.filter(is_gain)),
        loss=_summarise(moved.filter(~is_gain)),
        exceeds_interval=int(moved["exceeds_interval"].fill_null(False).sum()),
        interval_unknown=int(moved["exceeds_interval"].null_count()),
        runs_alone=[
            edition.manifest.edition
            for edition in (old, new)
            if edition.method is not None and edition.method.interval == RUNS_ALONE
        ],
        causes=summarise_causes(compared),
        largest=_list_rows(sort_largest_first(moved).head(LARGEST)),
        rows=_list_rows(lines),
    )


def report_with_races(store: Store, old: Edition, new: Edition, rules: RaceRules) -> DiffReport:
    """Compare two editions, with power, rank, podium and winner of every race of the archive.

    Raises:
        MissingKnowledgeError: the rules ask for what is not known.
    """
    without_races = replace(report(old, new, compare(store, old, new)), race_rules=rules)
    if store.read_fingerprint("listed_races") is None or not store.count_rows("listed_races"):
        return without_races
    results = store.read("listed_races")
    crew_classes = read_crew_classes(store)
    before = replay(list_lines_in_time(store, old), results, rules, crew_classes)
    after = replay(list_lines_in_time(store, new), results, rules, crew_classes)
    members = new.tables.get("ensemble", pl.DataFrame())
    return replace(
        without_races,
        races=race_changes(before, after).to_dicts(),
        winners=compare_winners(before, after, members).to_dicts(),
    )


def _count_classes(lines: pl.DataFrame) -> dict[str, int]:
    """Return the number of lines of each class; of the default classes also where it is none."""
    counts = dict(lines["crew_class"].value_counts().sort("crew_class").rows())
    standard = STANDARD_CREWS["crew_class"].to_list()
    if set(counts) <= set(standard):
        return {crew_class: counts.get(crew_class, 0) for crew_class in standard}
    return counts


def _summarise(lines: pl.DataFrame) -> Row:
    power, seconds = lines.select("power_ratio", "gain_in_two_hours_s").median().row(0)
    return {
        "lines": lines.height,
        "of_class": _count_classes(lines),
        "median_power_ratio": power,
        "median_seconds": seconds,
    }


def _list_rows(lines: pl.DataFrame) -> list[Row]:
    """Return lines as rows, each with the causes that moved it."""
    rows = lines.with_columns(pl.col("causes").str.json_decode(pl.List(CAUSE))).to_dicts()
    for row in rows:
        moved = []
        for cause in row["causes"]:
            known = {name: value for name, value in cause.items() if value is not None}
            if abs(cause["factor"] - 1.0) > NO_FACTOR:
                moved.append(known)
        row["causes"] = moved
    return rows
