"""What an owner asks of a line: old and new number, why, how certain, and the boat's new place.

Joins the tables and `pipeline.register.changes`; computes nothing else. Words are in `dashboards`.
"""

import datetime as dt
from collections.abc import Callable
from typing import Final

import polars as pl

from pipeline.method.definition import COMPLETE
from pipeline.register.changes import compare_lines
from pipeline.register.register import LINE, choose_default_method
from pipeline.register.replay import (
    RaceRules,
    compare_winners,
    race_changes,
    replay,
)
from pipeline.tables.row import Row
from warehouse.queries.views import DRAFT, Views
from warehouse.store.crew_classes import read_crew_classes
from warehouse.store.database import make_unknown_edition_error
from warehouse.store.editions import Edition, read_edition
from warehouse.store.methods import KnownMethods

PAIR: Final = ("from_edition", "to_edition")


def choose_newest_edition(editions: list[str], default: str) -> str:
    """Return the last published edition; else the draft `default`, or else the last of all."""
    draft = default if default in editions or not editions else editions[-1]
    return next((e for e in reversed(editions) if not e.startswith(DRAFT)), draft)


def choose_current_edition(views: Views) -> str:
    """Return the edition that people ask about: the newest that is published, or the best draft."""
    published = views.table("editions").sort("valid_from", "published_on", "edition")["edition"]
    drafts = set(views.table("register")["edition"]) - set(published)
    draft = choose_default_method(sorted(drafts)) if drafts else ""
    return choose_newest_edition(sorted(drafts) + published.to_list(), draft)


def line_changes(views: Views, to_edition: str | None = None) -> pl.DataFrame:
    """Return every pair of lines that is compared: `register_changes` with the numbers of both.

    Args:
        views: the open database.
        to_edition: only the pairs of this edition, as the newer of both.

    Returns:
        Columns of `compare_lines`, ranks as `old_speed_rank` and `new_speed_rank`, the boat's
        `name` and `boat_type`, and of both editions whether an interval holds the error of the log
        (`old_log_known`, `new_log_known`).
    """
    kept, register = views.table("register_changes"), views.table("register")
    if to_edition is not None:
        kept = kept.filter(to_edition=to_edition)
    compared_pairs = [compare_lines(register.clear(), register.clear())]
    for old, new in kept.select(PAIR).unique().sort(PAIR).iter_rows():
        before, after = register.filter(edition=old), register.filter(edition=new)
        compared_pairs.append(compare_lines(before, after))
    both = pl.concat(compared_pairs)
    key = PAIR + LINE
    beside = both.drop(set(kept.columns) - set(key))
    changes = kept.join(beside, on=key, how="left", nulls_equal=True, maintain_order="left")
    return _add_names(views, changes)


def compare_editions(
    views: Views, old: str, new: str, valid_from: dt.date | None = None
) -> pl.DataFrame:
    """Compare any two editions or drafts as on publication; columns as of `line_changes`.

    Args:
        valid_from: the day on which drafts would begin to count; theirs of today when left out.

    Raises:
        MissingKnowledgeError: there is no such edition or draft.
    """
    from warehouse.editions.compare import compare  # noqa: PLC0415 - it may recompute tows

    before = _find_edition(views, old, valid_from)
    after = _find_edition(views, new, valid_from)
    lines = compare(views.store, before, after)
    return _add_names(views, lines.drop("name", "old_status", "new_status"))


def _find_edition(views: Views, name: str, valid_from: dt.date | None) -> Edition:
    """Return a published edition, or what publishing a draft would give."""
    known = views.table("register")["edition"].unique()
    if name not in known:
        raise make_unknown_edition_error(name, known)
    if not name.startswith(DRAFT):
        return read_edition(views.store, name)
    from warehouse.editions.publish import draft_edition  # noqa: PLC0415 - all that makes an edition

    method = KnownMethods.from_store(views.store).get(name.removeprefix(DRAFT))
    return draft_edition(views.store, method, valid_from)


def _add_names(views: Views, changes: pl.DataFrame) -> pl.DataFrame:
    """Add name and type of the boat by the newer edition, and `log_known` of both."""
    boats = views.register().select("edition", pl.col(LINE), "name", "boat_type")
    known = log_known(views)
    for side, edition in (("new", "to_edition"), ("old", "from_edition")):
        named = boats.rename(
            {"edition": edition, "name": f"{side}_name", "boat_type": f"{side}_boat_type"}
        )
        with_log = known.rename({"edition": edition, "log_known": f"{side}_log_known"})
        changes = (
            changes.join(named, on=(edition,) + LINE, how="left", maintain_order="left")
            .join(with_log, on=edition, how="left", maintain_order="left")
            .rename({f"{side}_rank": f"{side}_speed_rank"})
        )
    return changes.with_columns(
        name=pl.coalesce("new_name", "old_name"),
        boat_type=pl.coalesce("new_boat_type", "old_boat_type"),
    ).drop("^(old|new)_(name|boat_type)$")


def log_known(views: Views) -> pl.DataFrame:
    """Return per edition and draft whether its intervals hold the error of the log.

    An edition has it from its own method, also where the warehouse makes that no longer.
    """
    drafts = views.table("methods").select(
        "interval", edition=pl.concat_str(pl.lit(DRAFT), pl.col("method"))
    )
    of_each = pl.concat([views.table("editions").select("interval", "edition"), drafts])
    return of_each.select("edition", log_known=pl.col("interval") == COMPLETE)


def add_peers(lines: pl.DataFrame) -> pl.DataFrame:
    """Add `peers`: Cw of the other boats of the same type and class; none without a type.

    Args:
        lines: rows of one register, with `boat_type`.
    """
    of_types = lines.filter(pl.col("boat_type") != "", pl.col("cw_kg_m").is_not_null())
    others = of_types.select("boat_type", "crew_class", other="fsn_no", peers="cw_kg_m")
    pairs = lines.join(
        others, on=["boat_type", "crew_class"], how="inner", maintain_order="left_right"
    ).filter(pl.col("other") != pl.col("fsn_no"))
    peers = pairs.group_by(LINE, maintain_order=True).agg("peers")
    added = lines.join(peers, on=LINE, how="left", maintain_order="left", nulls_equal=True)
    return added.with_columns(pl.col("peers").fill_null(pl.lit([], pl.List(pl.Float64))))


def read_line_answers(views: Views, edition: str) -> pl.DataFrame:
    """Return every line of an edition with its changes, next tow, best estimate and prediction.

    What stands behind the lines comes from the edition's own folder, which holds no weights and no
    pairs: those are said of drafts alone. The next tow and races are those of today.

    Returns:
        Rows of `register` of that edition, with the columns of `line_changes` where it is compared
        with another. Added are:

        - `old_type_place`, `new_type_place` and `type_size` among boats of its type and class;
        - `old_log_known` and `new_log_known`: whether the interval holds the error of the log;
        - whether the boat was `altered` before this tow, and the `old_tow_date`;
        - what `due_list` says of the next tow;
        - its best estimate `cw_best_*`, and `own_weight`, the share that rests on the tow itself;
        - by what factor the tow (`moved_ratio`) and its best estimate (`best_moved_ratio`) differ
          from those of `season_before`, the tow before of the same, unaltered boat and crew;
        - `log_factor` of its season with `log_lo`, `log_hi` and `log_source`;
        - `predicted_cw_kg_m` with its ends: Cw at `predicted_speed_m_s` as the other boats predict
          it without a tow; `cw_there_kg_m` by the tow, and whether it `disagrees`.
    """
    changes = line_changes(views, edition)
    lines = views.register().filter(edition=edition)
    changed_lines = changes.drop("name", "boat_type", "to_edition", "new_log_known")
    known = log_known(views).rename({"log_known": "new_log_known"})
    due = views.table("due_list").select("method", pl.col(LINE), "tow_speed_m_s", "speed_reason")
    tables = _choose_tables(views, edition)
    logs = tables("log_factors").select(
        "method", "season", log_factor="factor", log_lo="lo", log_hi="hi", log_source="source"
    )
    tows = tables("tows").select("tow_id", "season", "altered")
    old_days = views.table("register").select(
        pl.col(LINE), from_edition="edition", old_tow_date="tow_date"
    )
    best = _select_best_estimates(tables)
    predicted = tables("predicted_cw").select(
        "method", "tow_id", "predicted_cw_kg_m", "predicted_lo_kg_m", "predicted_hi_kg_m",
        "disagrees", predicted_speed_m_s="standard_speed_m_s", cw_there_kg_m="cw_kg_m",
    )  # fmt: skip
    joined = (
        lines.join(changed_lines, on=LINE, how="left", maintain_order="left")
        .join(known, on="edition", how="left", maintain_order="left")
        .join(tows, on="tow_id", how="left", maintain_order="left")
        .join(old_days, on=("from_edition",) + LINE, how="left", maintain_order="left")
        .join(due, on=("method",) + LINE, how="left", maintain_order="left")
        .join(best, on=["method", "tow_id"], how="left", maintain_order="left")
        .join(logs, on=["method", "season"], how="left", maintain_order="left")
        .join(predicted, on=["method", "tow_id"], how="left", maintain_order="left")
    )
    like = ("boat_type", "crew_class")
    old_rank, new_rank = pl.col("old_speed_rank"), pl.col("new_speed_rank")
    return joined.with_columns(
        old_type_place=old_rank.rank("min").over(like).cast(pl.Int32),
        new_type_place=new_rank.rank("min").over(like).cast(pl.Int32),
        type_size=new_rank.count().over(like).cast(pl.Int32),
    )


_Tables = Callable[[str], pl.DataFrame]


def _choose_tables(views: Views, edition: str) -> _Tables:
    """Return the tables behind a register by name: its own of an edition, today's of a draft."""
    if edition.startswith(DRAFT):
        return views.table
    from pipeline.tables.schemas import TABLES  # noqa: PLC0415 - for editions alone

    own = read_edition(views.store, edition).tables
    return lambda name: own[name] if name in own else TABLES[name].create_empty()


def _select_best_estimates(tables: _Tables) -> pl.DataFrame:
    """Return the best estimate of each tow, and how far both numbers moved since its last."""
    key = ("method", "tow_id")
    best = tables("curves").select(pl.col(key), "^cw_best_.*$", kept=_BEST_TO_MEASURED)
    mine = pl.col("tow_id") == pl.col("rests_on")  # shares of next to nothing are left out
    own = (
        tables("best_estimate_weights")
        .group_by(key, maintain_order=True)
        .agg(own_weight=pl.col("weight").filter(mine).sum())
    )
    pairs = tables("repeat_pairs").select(pl.col(key), "tow_id_before", "season_before", "ln_ratio")
    before = best.select("method", tow_id_before="tow_id", kept_before="kept")
    moved = pl.col("ln_ratio").exp()
    return (
        best.join(own, on=key, how="left", maintain_order="left")
        .join(pairs, on=key, how="left", maintain_order="left")
        .join(before, on=["method", "tow_id_before"], how="left", maintain_order="left")
        .with_columns(
            moved_ratio=moved,
            best_moved_ratio=moved * pl.col("kept") / pl.col("kept_before"),
        )
        .drop("tow_id_before", "ln_ratio", "kept", "kept_before")
    )


_BEST_TO_MEASURED: Final = pl.col("cw_best_kg_m") / pl.col("cw_kg_m")
"""The best estimate over the number as measured, at the tow's declared speed. With the ratio of two
tows at one speed it gives that of their best estimates."""


def list_season_faults(views: Views) -> dict[tuple[str, int], list[Row]]:
    """Return faults of the instruments of a season, certain or possible, by method and season.

    Returns:
        Rows of `season_diagnosis` with their `size`, that a person should look at.
    """
    alarms = views.ask("season_diagnosis").filter("alarm")
    by_season = alarms.partition_by("method", "season", as_dict=True)
    return {(str(method), int(season)): f.to_dicts() for (method, season), f in by_season.items()}


def select_own_races(views: Views, old: str | None, edition: str) -> pl.DataFrame:
    """Return race results under two editions, with how many of a class have a place in both."""
    races = views.ask("races").filter(from_edition=old or "", to_edition=edition)
    size = pl.col("new_rank").count().over("race", "race_date", "crew_class").alias("race_size")
    return races.with_columns(size)


def estimate_race_chances(views: Views, old: str, new: str) -> dict[tuple[str, str], float | None]:
    """Return how likely another crew wins under the new edition, by race and class.

    Returns:
        By race with its day, and class; None where the new register has no ensemble.
    """
    winners, _ = compare_races(views, old, new)
    chances = {}
    for row in winners.iter_rows(named=True):
        race = f"{row['race']} {row['race_date']}"
        chances[race, row["crew_class"]] = row["change_probability"]
    return chances


def compare_races(views: Views, old: str, new: str) -> tuple[pl.DataFrame, tuple[int, int]]:
    """Return who wins the races under two editions, and how many results change place.

    Returns:
        Rows of `pipeline.register.replay.compare_winners`; results that change place among those
        with one under both, and how many those are.
    """
    history, results = views.table("register_history"), views.store.read("listed_races")
    crew_classes = read_crew_classes(views.store)
    before = replay(history.filter(edition=old), results, RaceRules(), crew_classes)
    after = replay(history.filter(edition=new), results, RaceRules(), crew_classes)
    ranked = race_changes(before, after).drop_nulls("new_rank")
    moved = ranked.filter(pl.col("old_rank") != pl.col("new_rank")).height
    members = pl.DataFrame()
    if not new.startswith(DRAFT):
        members = read_edition(views.store, new).tables.get("ensemble", members)
    elif views.store.read_fingerprint("ensemble") is not None:
        members = views.store.read("ensemble", new.removeprefix(DRAFT))
    return compare_winners(before, after, members), (moved, ranked.height)
