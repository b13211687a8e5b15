"""The pages about all boats: start, register, due list, years, seasons, changes, races, quality."""

import datetime as dt
from collections import Counter
from collections.abc import Sequence
from typing import Final

import polars as pl

from dashboards.guides import find_guide_file
from dashboards.queries.boats import find_changed_options, find_decided_steps, list_causes
from dashboards.queries.methods import get_method_page, group_by_status
from dashboards.queries.results import Data, Results
from pipeline.errors import MissingKnowledgeError
from pipeline.messages import LANGUAGES
from pipeline.method.options import START
from pipeline.races.race import FATIGUE_REFERENCE
from pipeline.register.causes import explode_causes, summarise_causes
from pipeline.tables.display import STEP_FACTOR
from pipeline.tables.keys import LINE, SEASON_LEVEL, WOULD_NOT_SHOW
from pipeline.tables.row import Row
from warehouse.queries.answers import estimate_race_chances
from warehouse.queries.change_report import read_last_changes
from warehouse.queries.views import DRAFT
from warehouse.queries.years import summarise_years
from warehouse.store.crew_classes import read_crew_classes
from warehouse.store.editions import CSV, NOTICE, NOTICE_EN, XLSX, get_edition_path
from warehouse.store.methods import KnownMethods

MONTHS_AHEAD: Final = dt.timedelta(days=365)
"""How far the due list looks ahead."""

SHEETS: Final = (CSV, XLSX)
"""Files of an edition that the site offers."""

SOUND_VERDICTS: Final = ("sound", "estimated")
"""Verdicts on an instrument that need no look."""


# -- Start ------------------------------------------------------------------------------------


def read_start(results: Results) -> Data:
    """Return where things stand: the edition that counts, what it changes, and the seasons."""
    views, season = results.views, pl.col("season")
    editions = views.table("editions").sort("valid_from")
    seasons = views.table("seasons").select(first=season.min(), last=season.max())
    lines = results.line_changes.filter(to_edition=results.edition)
    years = summarise_years(results.rows("register_years"), views.store.read("printed_registers"))
    return {
        "in_force": editions.row(-1, named=True) if editions.height else None,
        "as_of": views.table("due_list")["as_of"].max(),
        "n_boats": views.table("boats").height,
        "n_tows": views.table("tows").height,
        "seasons": seasons.row(0, named=True),
        "changed": sum_up_changes(lines),
        "vote": sum_up_gains(lines),
        "has_parts": bool(results.vote_switches),
        "then": find_most_changed(years.filter(method=results.method), "year"),
        "rebuilt": read_last_changes(views.store),
        **read_season_changes(results),
    }


def sum_up_gains(lines: pl.DataFrame) -> Data | None:
    """Return the seconds that an edition gives or costs crews over two hours at equal power.

    Args:
        lines: rows of `warehouse.queries.answers.line_changes` of two editions.

    Returns:
        Numbers of `crews` that change, of `slower` that may take longer and `faster` that must take
        less, and the `median_s` of what they gain or lose; None where nothing changes.
    """
    gain_s = lines["gain_in_two_hours_s"].drop_nulls()
    moved_s = gain_s.filter(gain_s.round() != 0)
    if moved_s.is_empty():
        return None
    return {
        "crews": gain_s.len(),
        "slower": (moved_s > 0).sum(),
        "faster": (moved_s < 0).sum(),
        "median_s": gain_s.abs().median(),
    }


def sum_up_changes(lines: pl.DataFrame) -> Data:
    """Return how many lines an edition changes, by more than their uncertainty, and mostly why.

    Args:
        lines: rows of `warehouse.queries.answers.line_changes` of two editions.

    Returns:
        `old` and `new`, the editions; numbers of `lines`, `changed`, `compared` with their
        uncertainty and `beyond` it; `cause`, what most lines change by most, with its `cause` and
        `step`, and `cause_known`; `log_unknown`, the editions whose uncertainty leaves out the
        error of the log.
    """
    changed = lines.filter(change="changed")
    compared = changed.drop_nulls("exceeds_interval")
    main_causes = Counter(
        (largest["cause"], largest.get("step"))
        for line in changed.to_dicts()
        for largest in list_causes(line)[:1]
    )
    main = main_causes.most_common(1)
    log_unknown = [
        compared[f"{end}_edition"][0]
        for side, end in (("old", "from"), ("new", "to"))
        if compared.height and not compared[f"{side}_log_known"].fill_null(value=False).all()
    ]
    return {
        "old": lines["from_edition"].first(),
        "new": lines["to_edition"].first(),
        "lines": lines.height,
        "changed": changed.height,
        "compared": compared.height,
        "beyond": int(compared["exceeds_interval"].sum() or 0),
        "cause": {"cause": main[0][0][0], "step": main[0][0][1]} if main else None,
        "cause_known": bool(main) and main[0][0][0] != "printed",
        "log_unknown": log_unknown,
    }


def read_season_changes(results: Results) -> Data:
    """Return the change of Cw by method and season, and the season that changes most."""
    changes = results.rows("season_changes")
    own = changes.filter(method=results.method)
    return {"season_changes": changes, "most_changed": find_most_changed(own, "season")}


def find_most_changed(rows: pl.DataFrame, by: str) -> Row | None:
    """Return the row whose `median_ratio` is farthest from 1, of equals the first; None if none is.

    Args:
        rows: with `median_ratio`.
        by: the column that orders them.
    """
    size = pl.col("median_ratio").log().abs()
    by_size = rows.drop_nulls("median_ratio").sort(size, by, descending=[True, False])
    return by_size.row(0, named=True) if by_size.height else None


# -- Registers --------------------------------------------------------------------------------


def read_register(results: Results, edition: str | None = None) -> Data:
    """Return the lines of all editions and drafts; those of one are shown first.

    Raises:
        MissingKnowledgeError: there is no such edition.
    """
    chosen = results.choose_edition(edition)
    own = results.register.filter(edition=chosen)
    return {
        "edition": chosen,
        "as_of": own["as_of"].max(),
        "n_lines": own.height,
        "n_known": own["cw_kg_m"].count(),
        "lines": results.register,
        "names": results.register["edition"].unique().sort().to_list(),
        "editions": results.views.table("editions"),
        "chosen": {"edition": chosen},
    }


URGENCIES: Final = ("expired", "this_year", "without_curve", "later")
"""In this order the due list of a terminal names crews."""


def read_due_list(results: Results, method: str | None = None) -> Data:
    """Return who has to tow again and when, and at what speed.

    Args:
        results: the tables.
        method: whose curves give the speeds; the one shown first when left out.

    Raises:
        MissingKnowledgeError: the method was not applied by the last rebuild.
    """
    chosen = method or results.method
    lines = results.views.ask("due_list").filter(method=chosen)
    if lines.is_empty():
        raise MissingKnowledgeError(
            "there is no due list of method {}; make it with: herijk rebuild "
            "--archive DIR --data {} --method {}",
            chosen,
            results.views.store.root,
            chosen,
        )
    until, as_of = pl.col("valid_until"), lines["as_of"][0]
    urgency = (
        pl.when(until.is_null())
        .then(pl.lit("without_curve"))
        .when(pl.col("status") == "expired")
        .then(pl.lit("expired"))
        .when(until.dt.year() == as_of.year)
        .then(pl.lit("this_year"))
        .otherwise(pl.lit("later"))
    )
    return {
        "method": chosen,
        "as_of": as_of,
        "lines": lines.with_columns(urgency=urgency),
        "crew_classes": read_crew_classes(results.views.store).to_dicts(),
        "n_soon": lines.filter(until.is_between(as_of, as_of + MONTHS_AHEAD)).height,
        "n_over": lines.filter(until < as_of).height,
        "urgencies": URGENCIES,
    }


def read_years(results: Results, method: str | None = None) -> Data:
    """Return the register of every past year, as published and as methods would have had it.

    Args:
        results: the tables.
        method: the method that is shown first, also beside `Results.compared_methods`; that of
            `Results.method` when left out.

    Raises:
        MissingKnowledgeError: the method was not applied by the last rebuild.
    """
    views, chosen = results.views, method or results.method
    shown = list(dict.fromkeys([*results.compared_methods, chosen]))
    is_shown = pl.col("method").is_in(shown)
    lines = views.ask("register_years").filter(is_shown)
    if method is not None and lines.filter(method=method).is_empty():
        raise MissingKnowledgeError("method {} was not applied by the last rebuild", method)
    years = summarise_years(lines, views.store.read("printed_registers"))
    most_changed = find_most_changed(years.filter(method=chosen), "year")
    causes = [
        {"year": year, "method": name, "main_cause": pick_cause(cause)} | cause
        for (year, name), rows in lines.group_by("year", "method", maintain_order=True)
        for cause in summarise_causes(rows.drop_nulls("cw_ratio"))
    ]
    return {
        "method": chosen,
        "most_changed": most_changed,
        "years": years,
        "causes": pl.DataFrame(causes, infer_schema_length=None),
        "lines": lines,
        "changed_lines": lines.filter(pl.col("change") != "same"),
        "winners": views.ask("year_winners").filter(is_shown),
        "methods": shown,
        "names": list(map(str, years["year"].unique().sort())),
        "chosen": {"method": chosen, "year": str(most_changed["year"] if most_changed else 0)},
    }


def pick_cause(found: Row) -> Row:
    """Return the code of a cause and, where it is the method, the step."""
    return {"cause": found["cause"], "step": found["step"]}


# -- Seasons ----------------------------------------------------------------------------------


def read_seasons(results: Results, method: str | None = None) -> Data:
    """Return the instrument errors of each season, and how well tows repeat.

    Args:
        results: the tables.
        method: the method that is shown first; that of `Results.method` when left out.
    """
    views, chosen = results.views, method or results.method
    is_shown = pl.col("method").is_in([*results.methods, chosen])
    is_compared = pl.col("method").is_in([*results.compared_methods, chosen])
    factors = views.ask("log_factors").filter(is_shown)
    own = factors.filter(method=chosen).drop_nulls("factor")
    by_size = own.sort((pl.col("factor") - 1).abs(), descending=True)
    known = factors.filter(method=chosen)["season"].unique().sort().to_list()
    between = range(min(known, default=0), max(known, default=0))
    part = pl.col("part") + 1  # as people count
    parts = views.table("season_links").with_columns(part)
    divided = parts.filter(method=chosen).filter(pl.col("part") > 1)
    spread = name_ends(results.rows("reproducibility"))
    diagnosis = views.ask("season_diagnosis")
    is_level = pl.col("instrument") == SEASON_LEVEL
    is_found = ~pl.col("verdict").is_in([*SOUND_VERDICTS, WOULD_NOT_SHOW])
    eras = results.rows("era_shifts").filter(boat_type="all").drop_nulls("shift_ratio")
    return {
        "method": chosen,
        "factors": factors,
        "furthest": by_size.row(0, named=True) if by_size.height else None,
        "lacking": [year for year in between if year not in known],
        "links": parts,
        "parts": parts.filter(pl.col("season").is_in(divided["season"].implode())),
        "diagnosis": diagnosis.filter(is_found).with_columns(part),
        "unseen": list_unseen_faults(diagnosis.filter(~is_level, method=chosen)),
        "levels": diagnosis.filter(is_level),
        "spread": spread.filter(pl.col("scope") != "all"),
        **sum_up_repeats(spread, chosen),
        "repeat_pairs": views.ask("repeat_pairs").filter(is_compared),
        "ladder": _tabulate_ladder(
            views.table("season_ladder").filter(pl.col("to_method").is_in(results.methods))
        ),
        "eras": eras,
        "methods": results.methods,
        "chosen": {"method": chosen},
        **read_season_changes(results),
    }


def list_unseen_faults(diagnosis: pl.DataFrame) -> list[Row]:
    """Return of which instruments a fault would not show, and in which seasons.

    Args:
        diagnosis: rows of `season_diagnosis` of a method.

    Returns:
        `instrument`, and `spans`: the first and last of seasons in a row.
    """
    hidden = diagnosis.filter(verdict=WOULD_NOT_SHOW).sort("instrument", "season")
    return [
        {"instrument": instrument, "spans": _join_years(own["season"].unique().sort().to_list())}
        for (instrument,), own in hidden.group_by("instrument", maintain_order=True)
    ]


def _join_years(years: Sequence[int]) -> list[tuple[int, int]]:
    """Return the first and last of years in a row."""
    spans: list[tuple[int, int]] = []
    for year in years:
        if spans and spans[-1][1] == year - 1:
            spans[-1] = (spans[-1][0], year)
        else:
            spans.append((year, year))
    return spans


def name_ends(spread: pl.DataFrame) -> pl.DataFrame:
    """Return rows of `reproducibility` whose interval says of what it is: of `sd_ratio`."""
    return spread.rename({"lo": "sd_lo_ratio", "hi": "sd_hi_ratio"})


def sum_up_repeats(spread: pl.DataFrame, method: str) -> Data:
    """Return how well tows of each era repeat, under the first method and under another.

    Eras are kept apart: what instruments gained from one era to the next would otherwise look like
    a gain of the method.

    Args:
        spread: rows of `name_ends`.
        method: the other.

    Returns:
        `repeats_by_era`: for every era its name, `now` and `then`.
    """
    by_era = spread.filter(pl.col("scope") != "all").drop_nulls("sd_ratio")
    repeats = []
    for (era,), rows in by_era.group_by("scope", maintain_order=True):
        by_method = rows.rows_by_key("method", named=True, unique=True, include_key=True)
        then, now = next(iter(by_method.values())), by_method.get(method)
        if now is not None:
            repeats.append({"era": era, "now": now, "then": then})
    return {"repeats_by_era": repeats}


def _tabulate_ladder(ladder: pl.DataFrame) -> pl.DataFrame:
    """Return a row per method and season with the factor of each step on Cw."""
    steps = ladder.filter(pl.col("step") != START).with_columns(column=pl.col("step") + STEP_FACTOR)
    wide = steps.pivot(
        "column", index=["to_method", "season"], values="factor", aggregate_function="first"
    )
    return wide.rename({"to_method": "method"})


# -- Changes and races ------------------------------------------------------------------------


def read_changes(results: Results, edition: str | None = None) -> Data:
    """Return the changes from one edition to the next, by crew, and the races.

    Args:
        results: the tables.
        edition: what is shown first; the one that counts when left out.
    """
    changed = results.line_changes.filter(pl.col("change") != "same")
    names = changed["to_edition"].unique().sort().to_list()
    chosen = edition or (results.edition if results.edition in names or not names else names[-1])
    own = results.line_changes.filter(to_edition=chosen)
    return {
        "lines": changed,
        "changed": sum_up_changes(own),
        "vote": sum_up_gains(own),
        "motion": read_motion(results, own),
        "has_parts": bool(results.vote_switches),
        "names": names,
        "races": results.views.race_days(),
        "chosen": {"to_edition": chosen},
    }


def read_motion(results: Results, lines: pl.DataFrame) -> Data | None:
    """Return the motion about a draft; None where nothing is put to the vote.

    Args:
        results: the tables.
        lines: rows of `Results.line_changes` of two editions.

    Returns:
        `method`, its `titles` by language and its `page`; the options that change by who decided
        them (`voted`) and the `validity` of a tow; and, over the lines that change, the median
        factor on Cw of all that was `decided` before, and of all that is `proposed` now.
    """
    if lines.is_empty():
        return None
    new = lines["to_edition"][0]
    changed = find_changed_options(results, lines["from_edition"][0], new)
    if not changed:
        return None
    method = KnownMethods.from_store(results.views.store).get(new.removeprefix(DRAFT))
    is_decided = pl.col("step").is_in(find_decided_steps(changed)).fill_null(value=False)
    parts = explode_causes(lines.filter(change="changed"))
    return {
        "method": method.name,
        "titles": {tag: method.get_title(tag) for tag in LANGUAGES},
        "page": get_method_page(results, method.name),
        "voted": group_by_status(changed),
        "validity": method.validity,
        "decided": _measure_factor(parts.filter(is_decided)),
        "proposed": _measure_factor(parts.filter(~is_decided)),
    }


def _measure_factor(parts: pl.DataFrame) -> float | None:
    """Return the median over lines of what these parts of their change multiply to."""
    of_lines = parts.group_by(LINE, maintain_order=True).agg(pl.col("factor").product())
    median: float | None = of_lines.select(pl.col("factor").median()).item()
    return median


def read_race(results: Results, race: str, day: dt.date) -> Data:
    """Return the results of a race by every pair of editions that is compared."""
    all_races = results.views.ask("races")
    names = all_races["to_edition"].unique().sort().to_list()
    chosen = results.edition if results.edition in names else names[-1]
    rows = all_races.filter(race=race, race_date=day)
    now = rows.filter(to_edition=chosen)
    chances: dict[tuple[str, str], float | None] = {}
    if now.height:
        chances = estimate_race_chances(results.views, now["from_edition"][0], chosen)
    classes = now.partition_by("crew_class", maintain_order=True)
    return {
        "race": race,
        "on": day,
        "sheets": results.last_races.filter(race=race)["key"].first(),
        "rows": rows,
        "winners": [
            sum_up_class(own, chances.get((f"{race} {day}", own["crew_class"][0])))
            for own in classes
        ],
        "is_timed": rows["new_corrected_time_s"].is_not_null().any(),
        "names": names,
        "chosen": {"to_edition": chosen},
    }


def sum_up_class(rows: pl.DataFrame, chance: float | None) -> Row:
    """Return who wins a class of a race by both editions, and among whom.

    Args:
        rows: of a race and class under two editions.
        chance: how likely it is that another wins than before; None where not known.
    """
    winners = {}
    for side in ("old", "new"):
        winners[side] = rows.filter(pl.col(f"{side}_rank") == 1)["name"].first()
    has_power = pl.any_horizontal(pl.col("old_power_w", "new_power_w", "new_rank").is_not_null())
    n_known, n_placed = rows.filter(has_power).height, rows["new_rank"].count()
    is_among_few = n_placed < n_known
    by_power = rows.filter(pl.col("new_corrected_time_s").is_null())
    return {
        "crew_class": rows["crew_class"][0],
        **winners,
        "n_known": n_known,
        "n_placed": n_placed,
        # Who else might have won is not known of crews without a place.
        "chance": None if is_among_few else chance,
        **measure_fatigue_range(by_power.drop_nulls("new_rank")["rowing_time_s"]),
    }


def measure_fatigue_range(times_s: pl.Series) -> Row:
    """Return whether times [s] lie outside those that the correction for fatigue was made for.

    Returns:
        `is_stretched`, `fastest_s` and `slowest_s`.
    """
    (first, _), (last, _) = FATIGUE_REFERENCE
    is_stretched = not times_s.is_between(first, last).all()
    return {"is_stretched": is_stretched, "fastest_s": times_s.min(), "slowest_s": times_s.max()}


# -- Quality and guides -----------------------------------------------------------------------


def read_quality(results: Results) -> Data:
    """Return the quarantine, the flags, and how often each check found something."""
    views = results.views
    statuses = views.ask("statuses").filter(method=results.method)
    by_status = statuses.group_by("status", maintain_order=True).agg(pl.col("number").sum())
    counts = dict.fromkeys(("accepted", "flagged", "rejected"), 0) | dict(by_status.rows())
    faults = views.table("quarantine").with_columns(
        lost="lost_" + pl.col("lost"), messages=pl.concat_list("message_nl", "message")
    )
    is_shown = pl.col("method").is_in(results.methods)
    has_found = pl.col("beyond") > 0
    is_usual = pl.col("beyond") > 0.5 * pl.col("tows")  # what most tows have says nothing of one
    return {
        "statuses": counts,
        "set_aside": faults,
        "flags": views.ask("flagged_boats").filter(is_shown),
        "doubted": views.ask("doubted_acceptances").filter(is_shown),
        "run_reasons": views.ask("counts", "run").filter(is_shown),
        "checks": views.ask("checks").filter(is_shown & has_found & ~is_usual),
        "methods": results.methods,
        "chosen": {"method": results.method},
    }


def read_guide(name: str) -> Data:
    """Return a document of the project by language."""
    texts = {tag: find_guide_file(name, tag).read_text("utf-8") for tag in LANGUAGES}
    return {"guide": texts}


def read_edition_page(results: Results, edition: str) -> Data:
    """Return the notice of a published edition by language, and which files it offers."""
    folder = get_edition_path(results.views.store, edition)
    notices = {"nl": folder / NOTICE, "en": folder / NOTICE_EN}
    return {
        "name": edition,
        "notices": {tag: file.read_text("utf-8") for tag, file in notices.items()},
        "sheets": SHEETS,
    }
