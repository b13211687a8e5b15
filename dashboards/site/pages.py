"""Which page shows what. A section is there only if its table is, and holds rows."""

from collections.abc import Callable, Iterable, Sequence
from functools import cache, partial

import polars as pl

from dashboards import headlines
from dashboards.site.downloads import files_of
from dashboards.site.parts import (
    Chart,
    Page,
    Section,
    Select,
    Table,
    default_method,
    draft_of,
    edition_page,
    editions_select,
    listed,
    methods_select,
    once_for_methods,
    with_page,
)
from dashboards.site.prose import edition_pages, guide_pages
from dashboards.site.races import race_pages
from dashboards.site.start import CARDS, methods_table, start_page, words_page
from dashboards.site.types import type_pages, types_page
from pipeline.words.tables import TABLES_IN_DUTCH
from warehouse.derive.studies import JUDGEMENT
from warehouse.queries.answers import line_changes, newest_edition
from warehouse.queries.views import Views

MENU = ("index", *CARDS)


def shared_pages(views: Views) -> dict[str, Callable[[], Iterable[Page]]]:
    """What makes the pages of the site but those of boats and slides, by what they show."""
    methods = method_names(views)
    changes = cache(partial(line_changes, views))
    return {
        "start": lambda: [start_page(views, methods, changes())],
        "register": lambda: [_register(views, methods)],
        "due": lambda: [_due(views, methods)],
        "types": lambda: [types_page(views, methods)],
        "of types": lambda: type_pages(views, methods),
        "compare": lambda: [_compare(views, methods)],
        "races": lambda: race_pages(views, methods),
        "corrections": lambda: [_corrections(views, methods)],
        "reproducibility": lambda: [_reproducibility(views, methods)],
        "changes": lambda: [_changes(methods, changes())],
        "quality": lambda: [_quality(views, methods)],
        "words": lambda: [words_page()],
        "guides": guide_pages,
        "editions": lambda: edition_pages(views),
    }


def method_names(views: Views) -> list[str]:
    """Names of the methods, in the order of the database."""
    names: list[str] = views.table("methods")["method"].to_list()
    return names


def _whole(views: Views, name: str, title: str, columns: Sequence[str] = ()) -> list[Section]:
    """A section with a table as it is; none where there is no such table."""
    if not views.has(name):
        return []
    frame = views.table(name)
    return [Section(title, tables=[Table(name, frame, columns or frame.columns, title)])]


REGISTER_COLUMNS = (
    *("name", "fsn_no", "boat_type", "rowers", "crew_class", "empty_thwart", "tow_date"),
    *("valid_until", "status", "method"),
    *("declared_speed_m_s", "a_kg_m", "b_m_s", "cw_kg_m", "cw_lo_kg_m", "cw_hi_kg_m"),
    *("waterline_length_m", "beam_m", "bow_height_m", "weight_kg"),
    "verification_code",
)
REGISTER_CARDS = (
    *("name", "fsn_no", "boat_type", "rowers", "crew_class", "cw_kg_m", "cw_lo_kg_m"),
    *("cw_hi_kg_m", "valid_until", "status"),
)
EDITION_COLUMNS = (
    *("edition", "kind", "method", "valid_from", "published_on", "decision", "previous"),
    *("method_hash", "code_version", "seal"),
)


def _register(views: Views, methods: Sequence[str]) -> Page:
    lines = views.register()
    editions = lines["edition"].unique().sort().to_list()
    chosen = newest_edition(editions, draft_of(methods))
    table = Table(
        "register", lines, REGISTER_COLUMNS, "register", ["edition"], search=True,
        cards=REGISTER_CARDS,
    )  # fmt: skip
    headline = headlines.register(lines.filter(edition=chosen))
    return Page(
        "register.html",
        "register",
        [
            Section("register", "register_note", tables=[table], headline=headline),
            *_whole(views, "editions", "editions", EDITION_COLUMNS),
            *_downloads(views),
        ],
        selects=[editions_select("edition", editions, chosen)],
    )


def _downloads(views: Views) -> list[Section]:
    """The sheets of every published edition, which `render` puts beside the pages."""
    names = views.table("editions")["edition"].to_list()
    if not names:
        return []
    files = [file for name in names for file in files_of(name)]
    pages = [(edition_page(name), name) for name in names]
    return [Section("downloads", "downloads_note", pages=pages, files=files)]


DUE_COLUMNS = (
    *("name", "fsn_no", "boat_type", "rowers", "crew_class", "empty_thwart", "valid_until"),
    "status",
    *("tow_speed_m_s", "speed_reason", "beyond_curve", "declared_speed_m_s", "power_w"),
    *("raced_speed_m_s", "lowest_speed_m_s", "highest_speed_m_s", "last_tow", "as_of"),
)
DUE_CARDS = ("name", "fsn_no", "rowers", "crew_class", "valid_until", "status", "tow_speed_m_s")
CHOICE_COLUMNS = (
    *("position", "name", "fsn_no", "rowers", "crew_class", "seasons", "valid_until"),
    *("tow_speed_m_s", "factor_sd_before_percent", "factor_sd_after_percent"),
)


def _due(views: Views, methods: Sequence[str]) -> Page:
    """Who has to tow again, at what speed, and which boats to tow again."""
    rows = views.due_list().rename({"tow_date": "last_tow"})
    due = Table("due_list", rows, DUE_COLUMNS, "due_list", ["method"], search=True, cards=DUE_CARDS)
    headline = headlines.due(rows.filter(method=default_method(methods)))
    choice = views.retow_choice()
    sd = choice.select((pl.col("^factor_sd.*$") * 100).name.replace("ratio", "percent"))
    retow, said = choice.hstack(sd), headlines.retow(choice)
    return Page(
        "due.html",
        "due",
        [
            Section("due_list", "due_list_note", tables=[due], headline=headline),
            *listed("retow_choice", "retow_choice", retow, CHOICE_COLUMNS, headline=said),
        ],
        selects=[methods_select(methods)],
    )


PART = pl.col("part") + 1
"""Parts of a season as people count them."""

LINK_COLUMNS = (
    *("method", "season", "part", "log", "source", "n_tows", "n_links", "factor", "lo", "hi"),
    *("influence", "influence_boat"),
)
STEP_COLUMNS = (
    *("method", "season", "part", "log", "n_boats", "level_step_percent"),
    *("level_sd_percent", "force_step_percent", "force_sd_percent", "cause"),
)


FACTOR_COLUMNS = ("method", "season", "factor", "lo", "hi", "source")
LADDER_COLUMNS = ("from_method", "to_method", "season", "step", "factor", "tows")
SEASON_COLUMNS = ("method", "season", "tows", "median_ratio", "lowest_ratio", "highest_ratio")
OPTION_COLUMNS = ("option", "tows", "median_ratio", "lo_ratio", "hi_ratio")


def _corrections(views: Views, methods: list[str]) -> Page:
    factors, changes = views.table("log_factors"), views.table("season_changes")
    links = views.table("season_links").with_columns(PART)
    steps = views.season_steps().with_columns(PART)
    ladder = views.table("season_ladder")
    options = views.table("option_summary").filter(study=JUDGEMENT)
    said = headlines.log_factors(factors.filter(method=default_method(methods)))
    of_factors = Chart("log_factors", "log_factors", "log_factors")
    of_ladder = Chart("ladder", "ladder", "ladder", {"to_method": "method"})
    of_seasons = Chart("season_change", "season_change", "season_change")
    of_options = Chart("options", "options", "options")
    to_method = ladder.with_columns(method="to_method")
    return Page(
        "corrections.html",
        "corrections",
        [
            *listed(
                "log_factors", "log_factors", factors, FACTOR_COLUMNS, [of_factors], headline=said
            ),
            *listed("season_links", "season_links", links, LINK_COLUMNS),
            *listed("season_steps", "season_steps", steps, STEP_COLUMNS, exact=False),
            *listed("ladder", "season_ladder", to_method, LADDER_COLUMNS, [of_ladder]),
            *listed("season_change", "season_changes", changes, SEASON_COLUMNS, [of_seasons]),
            *listed("options", "option_summary", options, OPTION_COLUMNS, [of_options], ()),
        ],
        selects=[methods_select(methods)],
        data={
            "log_factors": [factors],
            "ladder": [ladder],
            "season_change": [changes],
            "options": [options],
        },
    )


AGREEMENT = {
    "reproducibility": "method scope n_pairs sd_ratio lo hi share_within_1pct share_within_2pct",
    "eras": "method boat_type era n shift_percent lo_percent hi_percent apart ageing_per_year",
    "repeats": "name fsn_no rowers crew_class season_before season cw_ratio e_n",
    "components": "method scope component n n_boats sd_ratio lo hi share",
    "predicted": "name fsn_no boat_type rowers crew_class cw_kg_m predicted_cw_kg_m disagrees",
}
"""Columns of the table below each figure of agreement."""


def _reproducibility(views: Views, methods: list[str]) -> Page:
    frames = {
        "reproducibility": views.table("reproducibility"),
        "era_shifts": _in_per_cent(views.table("era_shifts").drop_nulls("shift_ratio")),
        "repeat_pairs": with_page(views.repeat_pairs()),
        "variance_components": views.table("variance_components").drop_nulls("sd_ratio"),
        "predicted_cw": with_page(views.predicted()),
    }
    said = {"repro": headlines.reproducibility(frames["reproducibility"], default_method(methods))}
    sections: list[Section] = []
    for (name, frame), (figure, columns) in zip(frames.items(), AGREEMENT.items(), strict=True):
        title, shown = "repro" if figure == name else figure, columns.split()
        rows = frame if "method" in shown else once_for_methods(frame.select("method", *shown))
        follows = {"method": "method"} if figure == "predicted" else {}
        chart = Chart(figure, name, title, follows)
        sections += listed(title, name, rows, shown, [chart], exact=False, headline=said.get(title))
    drawn = frames | {"era_shifts": frames["era_shifts"].filter(boat_type="all")}
    return Page(
        "reproducibility.html",
        "reproducibility",
        sections,
        selects=[methods_select(methods)],
        data={name: [frame] for name, frame in drawn.items()},
    )


def _in_per_cent(eras: pl.DataFrame) -> pl.DataFrame:
    """With the change of Cw from an era to later in per cent, as it is said everywhere."""
    ends = {"shift_percent": "shift_ratio", "lo_percent": "lo", "hi_percent": "hi"}
    return eras.with_columns(**{name: 100 * (pl.col(of) - 1) for name, of in ends.items()})


def _changes(methods: Sequence[str], changes: pl.DataFrame) -> Page:
    changed = changes.filter(pl.col("change") != "same")
    if changed.is_empty():
        return Page("changes.html", "changes", [Section("changes_list", empty="no_changes")])
    editions = changed["to_edition"].unique().sort().to_list()
    chosen = newest_edition(editions, draft_of(methods))
    table = Table(
        "changes", changed, CHANGE_COLUMNS, "changes_list", ["to_edition"], search=True,
        cards=CHANGE_CARDS,
    )  # fmt: skip
    chart = Chart("changes", "changes", "changes_list", {"to_edition": "to_edition"})
    drawn = with_page(changed.select(*DRAWN_CHANGES)).drop_nulls("cw_ratio")
    headline = headlines.changes(changes.filter(to_edition=chosen))
    return Page(
        "changes.html",
        "changes",
        [Section("changes_list", "changes_note", [chart], [table], headline=headline)],
        selects=[editions_select("to_edition", editions, chosen)],
        data={"changes": [drawn]},
    )


CHANGE_COLUMNS = (
    *("name", "fsn_no", "rowers", "crew_class", "change", "old_cw_kg_m", "new_cw_kg_m"),
    *(
        "cw_ratio",
        "gain_in_two_hours_s",
        "exceeds_interval",
        "old_speed_rank",
        "new_speed_rank",
        "causes",
    ),
    "from_edition",
)
CHANGE_CARDS = (
    *("name", "fsn_no", "rowers", "crew_class", "old_cw_kg_m", "new_cw_kg_m"),
    *("gain_in_two_hours_s", "exceeds_interval"),
)
DRAWN_CHANGES = (
    *("from_edition", "to_edition", "fsn_no", "name", "rowers", "crew_class", "cw_ratio"),
    "time_ratio",
)


def _compare(views: Views, methods: Sequence[str]) -> Page:
    """Any two boats over each other, by the tow that counts."""
    method = default_method(methods)
    lines = views.register().filter(edition=draft_of(methods)).drop_nulls("cw_kg_m")
    called = pl.format("{} · {} · {}{}", "name", "fsn_no", "rowers", "crew_class")
    curves = (
        lines.select("tow_id", crew=called)
        .join(views.table("curve_points").filter(method=method), on="tow_id", maintain_order="left")
        .select("crew", "speed_m_s", "cw_kg_m", "cw_lo_kg_m", "cw_hi_kg_m")
        .sort("crew", "speed_m_s")
    )
    crews = curves["crew"].unique().sort().to_list()
    if len(crews) < len(PAIR_OF_BOATS):
        return Page("compare.html", "compare", [Section("compare", empty="no_values")])
    chart = Chart("boats_compared", "curves", "compare", {"crew": PAIR_OF_BOATS})
    first, second = PAIR_OF_BOATS
    return Page(
        "compare.html",
        "compare",
        [Section("compare_boats", "compare_note", [chart])],
        selects=[
            Select(first, "pair_first", crews, crews[0]),
            Select(second, "pair_second", crews, _another(crews)),
        ],
        data={"curves": [curves]},
    )


def _another(crews: Sequence[str]) -> str:
    """The first crew of another boat than the first, if there is one."""
    boat = crews[0].rpartition(" · ")[0]
    return next((crew for crew in crews if not crew.startswith(boat)), crews[1])


PAIR_OF_BOATS = ("boat_first", "boat_second")


def _quality(views: Views, methods: list[str]) -> Page:
    statuses = views.status_counts()
    sections = [
        Section(
            "statuses",
            headline=headlines.statuses(statuses.filter(method=default_method(methods))),
            charts=[Chart("statuses", "statuses", "statuses", {"method": "method"})],
            tables=[
                Table("statuses", statuses, statuses.columns, "statuses", ["method"]),
            ],
        ),
        _set_aside(views),
        *_season_diagnosis(views),
    ]
    for kind, title, note in (("flag", "flags", "flags_note"), ("run", "run_reasons", None)):
        frame = views.counts(kind)
        if frame.height:
            tables = [Table(title, frame, ["code", "number"], title, ["method"])]
            if kind == "flag":
                tables.append(_flagged_boats(views))
            sections.append(Section(title, note, tables=tables))
    checks = views.checks()
    columns = ["method", "check", "severity", "tows", "beyond"]
    table = Table("check_counts", checks, columns, "checks", ["method"])
    sections += [Section("checks", "checks_note", tables=[table]), _rebuilt(views)]
    return Page(
        "quality.html",
        "quality",
        sections,
        selects=[methods_select(methods)],
        data={"statuses": [statuses]},
    )


SOUND_VERDICTS = ("sound", "estimated")
DIAGNOSIS_COLUMNS = (
    *("method", "season", "part", "instrument", "verdict", "p_fault", "size", "size_lo", "size_hi"),
    *("unit", "first_tow", "confused_with"),
)


def _season_diagnosis(views: Views) -> list[Section]:
    """What may be wrong with the instruments of a season; none where no method asks."""
    if not views.has("season_diagnosis"):
        return []
    doubted = views.season_diagnosis().filter(~pl.col("verdict").is_in(SOUND_VERDICTS))
    # What else it could be: the kinds, without their seasons.
    rows = doubted.with_columns(
        PART, pl.col("confused_with").str.replace_all(r" \d+", "").str.replace_all(", ", ",")
    )
    title = "season_diagnosis"
    table = Table(title, rows, DIAGNOSIS_COLUMNS, title, ["method"], exact=False)
    return [Section(title, f"{title}_note", tables=[table])]


def _flagged_boats(views: Views) -> Table:
    """Which boats each flag is about."""
    columns = ("flag", "name", "fsn_no", "rowers", "crew_class", "tow_date")
    rows = views.flagged_boats()
    return Table("flagged_boats", rows, columns, "flagged_boats", ["method"], search=True)


def _set_aside(views: Views) -> Section:
    if not views.has("quarantine"):
        return Section("set_aside", "set_aside_note", empty="nothing_set_aside")
    columns = ["path", "tow_id", "line", "lost", "run", "lost_s", "reason_code", "messages"]
    columns.append("first_seen")
    faults = views.table("quarantine").with_columns(
        lost="lost_" + pl.col("lost"), messages=pl.concat_list("message_nl", "message")
    )
    table = Table("quarantine", faults, columns, "set_aside", search=True)
    return Section("set_aside", "set_aside_note", tables=[table])


def _rebuilt(views: Views) -> Section:
    """What the rebuild read, applied and made."""
    seasons, tables = views.table("seasons"), views.table("contents")
    dutch = pl.col("table").replace(TABLES_IN_DUTCH)
    tables = tables.with_columns(meanings=pl.concat_list(dutch, "meaning"))
    return Section(
        "rebuilt",
        "rebuilt_note",
        tables=[
            Table("seasons", seasons, seasons.columns, "seasons"),
            methods_table(views),
            Table("contents", tables, ("table", "rows", "meanings"), "tables"),
        ],
    )
