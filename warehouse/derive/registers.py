"""Registers: a draft per method, what changes between them, and the published editions beside them.

Editions are read as they lie; nothing of them is compared or computed again.
"""

import datetime as dt
from collections.abc import Mapping, Sequence

import polars as pl

from pipeline.method.definition import Method
from pipeline.recompute.facts import list_samples_files
from pipeline.recompute.results import Recomputed
from pipeline.register import due, replay
from pipeline.register.causes import assign_steps
from pipeline.register.changes import compare_lines
from pipeline.register.printed import carry_lines
from pipeline.register.register import (
    LINE,
    apply_rule,
    draft_register,
    find_reference_day,
    find_unmeasured_tows,
    flag_unmeasured,
    list_lines_of_all_days,
    name_draft,
)
from pipeline.tables.keys import SIZES
from pipeline.tables.register import RaceChanges, RegisterChanges
from pipeline.tables.schemas import TABLES, conform
from pipeline.uncertainty.ensemble import draw_ensemble
from warehouse.derive.edition_lines import list_lines_in_time, tabulate_history
from warehouse.store.code import code_version
from warehouse.store.editions import (
    CHANGES,
    Edition,
    list_edition_names,
    read_edition,
)
from warehouse.store.store import Store

EDITIONS = ("from_edition", "to_edition")


def register_tables(
    curves: pl.DataFrame,
    tows: pl.DataFrame,
    boats: pl.DataFrame,
    listed_boats: pl.DataFrame,
    listed_races: pl.DataFrame,
    listed_tows: pl.DataFrame,
    printed_registers: pl.DataFrame,
    log_factors: pl.DataFrame,
    decisions: pl.DataFrame,
    published: Mapping[str, pl.DataFrame],
    correction_steps: pl.DataFrame,
    methods: Sequence[Method],
    crew_classes: pl.DataFrame,
) -> dict[str, pl.DataFrame]:
    """Make draft registers, their changes and lineage, and the list of boats that are due.

    The newest tow counts: where it has no samples, a line that the archive has in print is re-based
    and stands in the draft; else the line is flagged. Drafts are compared with the first method's,
    by the steps from there. The published editions stand beside the drafts.
    """
    as_of = find_reference_day(tows, listed_races)
    unmeasured = find_unmeasured_tows(listed_tows, printed_registers, tows, as_of)
    printed = printed_registers.filter("has_valid_curve").sort("season", maintain_order=True)
    lines: dict[str, pl.DataFrame] = {}
    drafts: list[pl.DataFrame] = []
    histories = []
    changes: list[pl.DataFrame] = [RegisterChanges.create_empty()]
    ladders = correction_steps.filter(pl.col("position") > 0, from_method=methods[0].name)
    for method in methods:
        own_curves = curves.filter(method=method.name)
        factors = log_factors.filter(method=method.name)
        carried = carry_lines(printed, factors, method, tows)
        rule = method.validity
        on_day = draft_register(own_curves, tows, listed_boats, as_of, rule, decisions, carried)
        in_time = list_lines_of_all_days(own_curves, tows, rule, decisions, carried)
        lines[method.name] = flag_unmeasured(on_day, unmeasured, decisions)
        drafts.append(_make_draft(method.name, lines[method.name], tows))
        histories.append(tabulate_history(in_time, name_draft(method.name), method.name))
        if method != methods[0]:
            steps = assign_steps(drafts[0], ladders.filter(to_method=method.name))
            compared = compare_lines(drafts[0], drafts[-1], steps)
            changes.append(compared.select(RegisterChanges.column_names()))
    register = pl.concat(drafts)
    hashes = {method.name: method.content_hash for method in methods}
    made = {
        "register": register,
        "register_history": pl.concat(histories),
        "register_changes": pl.concat(changes),
        "lineage": tabulate_lineage(register, tows, hashes, code_version()),
    }
    with_editions = {
        name: pl.concat([conform(name, frame), published[name]]) for name, frame in made.items()
    }
    return with_editions | {
        "due_list": list_due_lines(lines, boats, listed_races, as_of, crew_classes)
    }


def race_changes(
    register_changes: pl.DataFrame,
    register_history: pl.DataFrame,
    listed_races: pl.DataFrame,
    crew_classes: pl.DataFrame,
) -> pl.DataFrame:
    """Replay all races in the archive under both editions of every pair that is compared."""
    pairs = register_changes.select(EDITIONS).unique().sort(EDITIONS)
    replayed = {}
    for edition in pairs.unpivot()["value"].unique():
        lines = register_history.filter(edition=edition)
        replayed[edition] = replay.replay(lines, listed_races, replay.RaceRules(), crew_classes)
    frames = []
    for old, new in pairs.iter_rows():
        changes = replay.race_changes(replayed[old], replayed[new])
        frames.append(changes.with_columns(from_edition=pl.lit(old), to_edition=pl.lit(new)))
    return pl.concat(frames) if frames else RaceChanges.create_empty()


def draw_members(method: Method, made: Recomputed) -> pl.DataFrame:
    """Return equally likely numbers of every tow: rows of the table `ensemble`."""
    ruled = apply_rule(made.curves, method.validity)
    return draw_ensemble(method.name, made.curves, ruled, made.uncertainty_budget, made.factors)


def list_due_lines(
    lines: Mapping[str, pl.DataFrame],
    boats: pl.DataFrame,
    races: pl.DataFrame,
    as_of: dt.date,
    crew_classes: pl.DataFrame,
) -> pl.DataFrame:
    """Return rows of `due_list`, of the lines of each method."""
    of_methods = []
    for method, own in lines.items():
        part = due.due_list(own, boats, races, as_of, crew_classes)
        of_methods.append(part.select(pl.lit(method).alias("method"), pl.all()))
    return pl.concat(of_methods)


def _make_draft(method: str, lines: pl.DataFrame, tows: pl.DataFrame) -> pl.DataFrame:
    """Return rows of `register`: the lines of a method with the sizes of the boats."""
    sizes = tows.select("tow_id", pl.col(SIZES))
    return lines.join(sizes, on="tow_id", how="left", maintain_order="left").select(
        pl.lit(name_draft(method)).alias("edition"),
        pl.lit(method).alias("method"),
        pl.all(),
        pl.lit(None, pl.String).alias("verification_code"),
    )


# Published editions


def read_published_tables(store: Store) -> dict[str, pl.DataFrame]:
    """Return rows of `editions`, and of the register's tables and `lineage` of every edition.

    Raises:
        BrokenPromiseError: a file of an edition is missing or damaged.
    """
    names = ("editions", "register", "register_history", CHANGES, "lineage")
    parts: dict[str, list[pl.DataFrame]] = {name: [TABLES[name].create_empty()] for name in names}
    for name in list_edition_names(store):
        edition = read_edition(store, name)
        rows = {
            "editions": _describe_edition(edition),
            "register": edition.register,
            "register_history": list_lines_in_time(store, edition),
        }
        if CHANGES in edition.tables:
            rows[CHANGES] = edition.tables[CHANGES]
        if edition.method is not None:
            hashes = {edition.method.name: edition.manifest.method_hash}
            tows, code_version = edition.tables["tows"], edition.manifest.code_version
            rows["lineage"] = tabulate_lineage(edition.register, tows, hashes, code_version)
        for table, frame in rows.items():
            parts[table].append(conform(table, frame))
    return {table: pl.concat(frames) for table, frames in parts.items()}


def _describe_edition(edition: Edition) -> pl.DataFrame:
    """Return the row of `editions` about an edition."""
    about = edition.manifest.model_dump(include=set(TABLES["editions"].column_names()))
    interval = edition.method and edition.method.interval
    strings = ("previous", "method", "method_hash", "interval")
    return pl.DataFrame([about | {"interval": interval}]).cast(dict.fromkeys(strings, pl.String))


def tabulate_lineage(
    register: pl.DataFrame, tows: pl.DataFrame, hashes: Mapping[str, str | None], code_version: str
) -> pl.DataFrame:
    """Return rows of the table `lineage`: one per line that has a tow and samples file of it.

    Args:
        register: rows of `register`.
        tows: the tows behind them.
        hashes: content hash of each method.
        code_version: of the code that made the lines.
    """
    lines = register.drop_nulls("tow_id").select("edition", pl.col(LINE), "tow_id", "method")
    return lines.join(list_samples_files(tows), on="tow_id", maintain_order="left").with_columns(
        method_hash=pl.col("method").replace_strict(hashes, return_dtype=pl.String),
        code_version=pl.lit(code_version),
    )
