"""Which page shows what. A section is there only if its table is, and holds rows."""

from collections.abc import Iterator, Sequence

import polars as pl

from dashboards.site.boats import boat_pages
from dashboards.site.downloads import DOWNLOADS, SHEETS
from dashboards.site.parts import Chart, Page, Section, Select, Table, boat_path, default_method
from warehouse.views import Views

MENU = ("index", "register", "types", "corrections", "reproducibility", "changes", "quality")


def all_pages(views: Views) -> Iterator[Page]:
    """Every page of the site."""
    methods = method_names(views)
    yield _index(views)
    yield _register(views)
    yield _types(views, methods)
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


def _with_page(frame: pl.DataFrame) -> pl.DataFrame:
    """With the page of each boat, for charts whose points are links."""
    page = pl.col("fsn_no").map_elements(boat_path, return_dtype=pl.String)
    return frame.with_columns(page.alias("page"))


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
                tables=[
                    Table(
                        "methods",
                        views.table("methods"),
                        ["method", "title", "content_hash"],
                        "methods",
                    )
                ],
            ),
        ],
    )


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


QUANTITIES = ("b_weight", "b_speed", "cw_weight", "cw_speed")
SIDES = ("before", "after")
PAIR = ("kromhout", "kuiken")
"""Two types of which many boats are said to be equal: shown side by side at first."""


def _types(views: Views, methods: list[str]) -> Page:
    if not views.has("pooled_curves"):
        return Page("types.html", "types", [])
    boats = _with_page(views.type_boats())
    types = boats["boat_type"].unique().sort().to_list()
    columns = (
        *("name", "fsn_no", "boat_type", "rowers", "crew_class", "season", "weight_kg"),
        *("declared_speed_m_s", "b_m_s", "b_lo_m_s", "b_hi_m_s", "cw_kg_m", "cw_lo_kg_m"),
        "cw_hi_kg_m",
    )
    table = Table(
        "type_boats", boats.with_columns(after="method"), columns, "types_list",
        ["after", "boat_type"], search=True, linked=True,
    )  # fmt: skip
    first, second = _pair(types)
    return Page(
        "types.html",
        "types",
        [
            Section("types_charts", "types_note", _before_after("", "boat_type")),
            Section("types_list", tables=[table]),
            Section("types_pair", "types_pair_note", _before_after("pair_", "pair")),
            *_type_tables(views),
        ],
        selects=[
            Select("before", "before", methods, methods[0]),
            Select("after", "after", methods, default_method(methods)),
            Select("boat_type", "type", types, "", with_all=True),
            Select("pair", "pair_first", types, first),
            Select("pair_2", "pair_second", types, second),
        ],
        data={"type_boats": [boats.drop("a_kg_m", "tow_id")]},
    )


def _before_after(prefix: str, of_type: str) -> list[Chart]:
    return [
        Chart(f"{prefix}{name}", "type_boats", side, {"method": side, "boat_type": of_type})
        for name in QUANTITIES
        for side in SIDES
    ]


def _pair(types: Sequence[str]) -> tuple[str, str]:
    """The types of `PAIR` where the archive has them, else the first and last."""
    known = [next((t for t in types if t.lower().startswith(name)), None) for name in PAIR]
    return known[0] or types[0], known[1] or types[-1]


def _type_tables(views: Views) -> list[Section]:
    found = []
    outliers = views.outliers() if views.has("type_outliers") else pl.DataFrame()
    if outliers.height:
        columns = (
            *("name", "fsn_no", "boat_type", "rowers", "crew_class", "season", "quantity", "value"),
            *("expected", "deviation_sd", "candidates"),
        )
        shown = outliers.with_columns(after="method")
        table = Table("type_outliers", shown, columns, "types_outliers", ["after", "boat_type"])
        found.append(Section("types_outliers", tables=[table]))
    wanted = {
        "type_consistency": (
            "types_lines",
            "types_lines_note",
            "boat_type quantity explaining n slope slope_lo slope_hi r2 residual_sd_ratio",
        ),
        "type_homogeneity": (
            "types_homogeneity",
            None,
            "boat_type n n_boats p_value power_at_10pct noise_share shared_b_m_s",
        ),
    }
    for name, (title, note, columns) in wanted.items():
        if views.has(name):
            shown = views.table(name).with_columns(after="method")
            table = Table(name, shown, columns.split(), title, ["after", "boat_type"])
            found.append(Section(title, note, tables=[table]))
    return found


SEASON_LINKS = (
    *("method", "season", "part", "log", "source", "n_tows", "n_links", "factor", "lo", "hi"),
    *("influence", "influence_boat", "factor_no_boats", "agreement"),
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
        [*sections, *_whole(views, "season_links", "season_links", SEASON_LINKS)],
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
        "repeat_pairs": (
            "repeats",
            "repeats_note",
            lambda: _with_page(views.repeat_pairs()),
            "method name fsn_no rowers crew_class season_before season ln_ratio e_n",
        ),
        "variance_components": (
            "components",
            None,
            lambda: views.table("variance_components").drop_nulls("sd_ratio"),
            "method scope component n n_boats sd_ratio lo hi share",
        ),
        "predicted_cw": (
            "predicted",
            "predicted_note",
            lambda: _with_page(views.predicted()),
            "method name fsn_no boat_type rowers crew_class cw_kg_m predicted_cw_kg_m disagrees",
        ),
    }
    figures = {
        "reproducibility": Chart("reproducibility", "reproducibility", "repro"),
        "repeat_pairs": Chart("repeats", "repeat_pairs", "repeats"),
        "variance_components": Chart("components", "variance_components", "components"),
        "predicted_cw": Chart("predicted", "predicted_cw", "predicted", {"method": "method"}),
    }
    sections, data = [], {}
    for name, (title, note, read, columns) in parts.items():
        frame = read() if views.has(name) else pl.DataFrame()
        if frame.height:
            data[name] = frame
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
    drawn = _with_page(changes.drop("causes")).drop_nulls("cw_ratio")
    return Page(
        "changes.html",
        "changes",
        [Section("changes_list", "changes_note", [chart], [table]), _races(views)],
        selects=[Select("to_edition", "edition", editions, _newest(editions))],
        data={"changes": [drawn], "races": [_with_page(views.races())]},
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
    columns = ["path", "tow_id", "line", "reason_code", "message", "first_seen"]
    table = Table("quarantine", views.table("quarantine"), columns, "set_aside", search=True)
    return Section("set_aside", "set_aside_note", tables=[table])


def _rebuilt(views: Views) -> Section:
    """What the rebuild read, applied and made."""
    shown = {
        "seasons": ("season", "listed", "tows"),
        "methods": ("method", "title", "content_hash"),
        "contents": ("table", "rows", "meaning"),
    }
    captions = {"contents": "tables"}
    return Section(
        "rebuilt",
        "rebuilt_note",
        tables=[
            Table(name, views.table(name), columns, captions.get(name, name))
            for name, columns in shown.items()
        ],
    )
