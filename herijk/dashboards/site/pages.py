"""Which page shows what. A section is there only if its table is, and holds rows."""

from collections.abc import Iterator, Sequence

import polars as pl

from herijk.dashboards.site.boats import boat_pages
from herijk.dashboards.site.downloads import DOWNLOADS, SHEETS
from herijk.dashboards.site.parts import (
    Chart,
    Page,
    Section,
    Select,
    Table,
    default_method,
    with_page,
)
from herijk.dashboards.site.slides import slides_page
from herijk.dashboards.site.types import types_page
from herijk.warehouse.queries.views import Views

MENU = (
    *("index", "register", "due", "types", "slides", "corrections", "reproducibility"),
    *("changes", "quality"),
)


def all_pages(views: Views) -> Iterator[Page]:
    """Every page of the site."""
    methods = method_names(views)
    yield _index(views)
    yield _register(views)
    yield _due(views, methods)
    yield types_page(views, methods)
    yield slides_page(views, methods)
    yield _corrections(views, methods)
    yield _reproducibility(views, methods)
    yield _changes(views)
    yield _quality(views, methods)
    yield from boat_pages(views, methods)


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


def _method(methods: Sequence[str]) -> Select:
    return Select("method", "method", methods, default_method(methods))


def _index(views: Views) -> Page:
    pages = [(f"{name}.html", name, f"about_{name}") for name in MENU[1:]]
    return Page(
        "index.html",
        "index",
        [
            Section("index_pages", "index_intro", links=pages),
            Section(
                "methods",
                "methods_note",
                tables=[_methods_table(views)],
            ),
        ],
    )


def _methods_table(views: Views) -> Table:
    """The methods, with the title in the language of the page."""
    frame = views.table("methods").with_columns(titles=pl.concat_list("title", "title_en"))
    return Table("methods", frame, ["method", "titles", "content_hash"], "methods")


REGISTER_COLUMNS = (
    *("name", "fsn_no", "boat_type", "rowers", "crew_class", "tow_date", "valid_until", "status"),
    *("declared_speed_m_s", "a_kg_m", "b_m_s", "cw_kg_m", "cw_lo_kg_m", "cw_hi_kg_m"),
    *("verification_code", "method"),
)
EDITION_COLUMNS = (
    *("edition", "kind", "method", "valid_from", "published_on", "decision", "previous"),
    *("method_hash", "code_version", "seal"),
)


def _register(views: Views) -> Page:
    lines = views.register()
    editions = lines["edition"].unique().sort().to_list()
    table = Table("register", lines, REGISTER_COLUMNS, "register", ["edition"], search=True)
    return Page(
        "register.html",
        "register",
        [
            Section("register", "register_note", tables=[table]),
            *_whole(views, "editions", "editions", EDITION_COLUMNS),
            *_downloads(views),
        ],
        selects=[Select("edition", "edition", editions, _newest(editions))],
    )


def _downloads(views: Views) -> list[Section]:
    """The sheets of every published edition, which `render` puts beside the pages."""
    names = views.table("editions")["edition"].to_list()
    files = [(f"{DOWNLOADS}/{name}/{file}", f"{name} {file}") for name in names for file in SHEETS]
    return [Section("downloads", "downloads_note", files=files)] if files else []


def _newest(editions: Sequence[str]) -> str:
    """The last published edition, or the default method's draft where none is published."""
    published = [e for e in editions if not e.startswith("concept-")]
    return published[-1] if published else default_method(editions)


DUE_COLUMNS = (
    *("valid_until", "name", "fsn_no", "boat_type", "rowers", "crew_class", "status"),
    *("tow_speed_m_s", "speed_reason", "beyond_curve", "declared_speed_m_s", "power_w"),
    *("raced_speed_m_s", "lowest_speed_m_s", "highest_speed_m_s", "tow_id", "as_of"),
)
CHOICE_COLUMNS = (
    *("position", "name", "fsn_no", "rowers", "crew_class", "seasons", "valid_until"),
    *("tow_speed_m_s", "factor_sd_before_ratio", "factor_sd_after_ratio"),
)


def _due(views: Views, methods: Sequence[str]) -> Page:
    """Who has to tow again, at what speed, and which tows would tell most."""
    due = Table("due_list", views.due_list(), DUE_COLUMNS, "due_list", ["method"], search=True)
    sections = [Section("due_list", "due_list_note", tables=[due])]
    choice = views.retow_choice()
    if choice.height:
        table = Table("retow_choice", choice, CHOICE_COLUMNS, "retow_choice", ["method"])
        sections.append(Section("retow_choice", "retow_choice_note", tables=[table]))
    return Page("due.html", "due", sections, selects=[_method(methods)])


LINK_COLUMNS = (
    *("method", "season", "part", "log", "source", "n_tows", "n_links", "factor", "lo", "hi"),
    *("influence", "influence_boat", "factor_no_boats", "agreement"),
)
STEP_COLUMNS = (
    *("method", "season", "part", "log", "n_boats", "level_step", "level_step_sd", "force_step"),
    *("force_step_sd", "cause"),
)


def _corrections(views: Views, methods: list[str]) -> Page:
    sections, data = [], {}
    if views.has("log_factors"):
        data["log_factors"] = views.table("log_factors")
        table = Table(
            "log_factors",
            data["log_factors"],
            ["method", "season", "factor", "lo", "hi", "source"],
            "log_factors",
            ["method"],
        )
        chart = Chart("log_factors", "log_factors", "log_factors")
        sections.append(Section("log_factors", "log_factors_note", [chart], [table]))
    for name, columns in (("season_links", LINK_COLUMNS), ("season_steps", STEP_COLUMNS)):
        if views.has(name):
            table = Table(name, views.table(name), columns, name, ["method"])
            sections.append(Section(name, f"{name}_note", tables=[table]))
    if views.has("correction_steps"):
        data["ladder"] = views.table("season_ladder")
        data["season_change"] = views.table("season_changes")
        sections += [_ladder(data["ladder"]), _season_change(data["season_change"])]
    if views.has("option_effects"):
        data["options"] = views.table("option_summary")
        columns = ["option", "tows", "median_ratio", "lo_ratio", "hi_ratio"]
        table = Table("option_summary", data["options"], columns, "options")
        chart = Chart("options", "options", "options")
        sections.append(Section("options", "options_note", [chart], [table]))
    return Page(
        "corrections.html",
        "corrections",
        sections,
        selects=[_method(methods)],
        data={name: [frame] for name, frame in data.items()},
    )


def _ladder(frame: pl.DataFrame) -> Section:
    columns = ["from_method", "to_method", "season", "step", "factor", "tows"]
    shown = frame.with_columns(method="to_method")
    table = Table("season_ladder", shown, columns, "ladder", ["method"])
    chart = Chart("ladder", "ladder", "ladder", {"to_method": "method"})
    return Section("ladder", "ladder_note", [chart], [table])


def _season_change(frame: pl.DataFrame) -> Section:
    columns = ["method", "season", "tows", "median_ratio", "lowest_ratio", "highest_ratio"]
    table = Table("season_changes", frame, columns, "season_change", ["method"])
    chart = Chart("season_change", "season_change", "season_change")
    return Section("season_change", "season_change_note", [chart], [table])


def _reproducibility(views: Views, methods: list[str]) -> Page:
    parts = {
        "reproducibility": (
            "repro",
            "repro_note",
            lambda: views.table("reproducibility"),
            "method scope n_pairs sd_ratio lo hi share_within_1pct share_within_2pct",
        ),
        "era_shifts": (
            "eras",
            "eras_note",
            lambda: views.table("era_shifts").drop_nulls("shift_ratio"),
            "method boat_type era n shift_ratio lo hi apart ageing_per_year",
        ),
        "repeat_pairs": (
            "repeats",
            "repeats_note",
            lambda: with_page(views.repeat_pairs()),
            "method name fsn_no rowers crew_class season_before season ln_ratio e_n",
        ),
        "variance_components": (
            "components",
            "components_note",
            lambda: views.table("variance_components").drop_nulls("sd_ratio"),
            "method scope component n n_boats sd_ratio lo hi share",
        ),
        "predicted_cw": (
            "predicted",
            "predicted_note",
            lambda: with_page(views.predicted()),
            "method name fsn_no boat_type rowers crew_class cw_kg_m predicted_cw_kg_m disagrees",
        ),
    }
    figures = {
        "reproducibility": Chart("reproducibility", "reproducibility", "repro"),
        "era_shifts": Chart("eras", "era_shifts", "eras"),
        "repeat_pairs": Chart("repeats", "repeat_pairs", "repeats"),
        "variance_components": Chart("components", "variance_components", "components"),
        "predicted_cw": Chart("predicted", "predicted_cw", "predicted", {"method": "method"}),
    }
    sections, data = [], {}
    for name, (title, note, read, columns) in parts.items():
        frame = read() if views.has(name) else pl.DataFrame()
        if frame.height:
            data[name] = frame if name != "era_shifts" else frame.filter(boat_type="all")
            table = Table(name, frame, columns.split(), title, ["method"])
            sections.append(Section(title, note, [figures[name]], [table]))
    return Page(
        "reproducibility.html",
        "reproducibility",
        sections,
        selects=[_method(methods)],
        data={name: [frame] for name, frame in data.items()},
    )


def _changes(views: Views) -> Page:
    changes = views.changes() if views.has("register_changes") else pl.DataFrame()
    if changes.is_empty():
        return Page("changes.html", "changes", [Section("changes_list", empty="no_changes")])
    editions = changes["to_edition"].unique().sort().to_list()
    columns = (
        *("from_edition", "to_edition", "name", "fsn_no", "rowers", "crew_class", "change"),
        *("cw_ratio", "power_ratio", "time_ratio", "causes"),
    )
    table = Table("changes", changes, columns, "changes_list", ["to_edition"], search=True)
    chart = Chart("changes", "changes", "changes_list", {"to_edition": "to_edition"})
    drawn = with_page(changes.drop("causes")).drop_nulls("cw_ratio")
    return Page(
        "changes.html",
        "changes",
        [Section("changes_list", "changes_note", [chart], [table]), _races(views)],
        selects=[Select("to_edition", "edition", editions, _newest(editions))],
        data={"changes": [drawn], "races": [with_page(views.races())]},
    )


def _races(views: Views) -> Section:
    races = views.races()
    if races.is_empty():
        return Section("races", empty="no_races")
    columns = (
        *("from_edition", "to_edition", "race", "race_date", "crew_class", "name", "fsn_no"),
        *("rowers", "rowing_time_s", "old_power_w", "new_power_w", "old_rank", "new_rank"),
        "podium_changed",
    )
    table = Table("race_changes", races, columns, "races", ["to_edition"], search=True)
    chart = Chart("race_ranks", "races", "races", {"to_edition": "to_edition"})
    return Section("races", "races_note", [chart], [table])


def _quality(views: Views, methods: list[str]) -> Page:
    statuses = views.status_counts()
    sections = [
        Section(
            "statuses",
            charts=[Chart("statuses", "statuses", "statuses", {"method": "method"})],
            tables=[
                Table("statuses", statuses, statuses.columns, "statuses", ["method"]),
            ],
        ),
        _set_aside(views),
    ]
    for kind, title, note in (("flag", "flags", "flags_note"), ("run", "run_reasons", None)):
        frame = views.counts(kind)
        if frame.height:
            table = Table(title, frame, ["method", "code", "number"], title, ["method"])
            sections.append(Section(title, note, tables=[table]))
    checks = views.checks()
    columns = ["method", "check", "severity", "tows", "beyond"]
    table = Table("check_counts", checks, columns, "checks", ["method"])
    sections += [Section("checks", "checks_note", tables=[table]), _rebuilt(views)]
    return Page(
        "quality.html",
        "quality",
        sections,
        selects=[_method(methods)],
        data={"statuses": [statuses]},
    )


def _set_aside(views: Views) -> Section:
    if not views.has("quarantine"):
        return Section("set_aside", "set_aside_note", empty="nothing_set_aside")
    columns = ["path", "tow_id", "line", "lost", "run", "lost_s", "reason_code", "message"]
    columns.append("first_seen")
    faults = views.table("quarantine").with_columns(lost="lost_" + pl.col("lost"))
    table = Table("quarantine", faults, columns, "set_aside", search=True)
    return Section("set_aside", "set_aside_note", tables=[table])


def _rebuilt(views: Views) -> Section:
    """What the rebuild read, applied and made."""
    seasons, tables = views.table("seasons"), views.table("contents")
    return Section(
        "rebuilt",
        "rebuilt_note",
        tables=[
            Table("seasons", seasons, seasons.columns, "seasons"),
            _methods_table(views),
            Table("contents", tables, ("table", "rows", "meaning"), "tables"),
        ],
    )
