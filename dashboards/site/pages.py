"""Which page shows what. A section is there only if its table is, and holds rows."""

from collections.abc import Iterator, Sequence

import polars as pl

from dashboards.site.boats import boat_pages
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
    counts = views.row_counts()
    tables = pl.DataFrame({"table": list(counts), "rows": list(counts.values())})
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
            Section(
                "tables",
                "tables_note",
                tables=[Table("tables", tables, ["table", "rows"], "tables")],
            ),
        ],
    )


REGISTER_COLUMNS = (
    *("name", "fsn_no", "boat_type", "rowers", "crew_class", "tow_date", "valid_until", "status"),
    *("declared_speed_m_s", "a_kg_m", "b_m_s", "cw_kg_m", "cw_lo_kg_m", "cw_hi_kg_m"),
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
            *_whole(views, "editions", "editions"),
        ],
        selects=[Select("edition", "edition", editions, _newest(editions))],
    )


def _newest(editions: Sequence[str]) -> str:
    """The last published edition, or the default method's draft where none is published."""
    published = [e for e in editions if not e.startswith("concept-")]
    return published[-1] if published else default_method(editions)


def _types(views: Views, methods: list[str]) -> Page:
    if not views.has("pooled_curves"):
        return Page("types.html", "types", [])
    boats = _with_page(views.type_boats())
    figures = ("b_weight", "b_speed", "cw_weight", "cw_speed")
    charts = [
        Chart(figure, "type_boats", side, {"method": side, "boat_type": "boat_type"})
        for figure in figures
        for side in ("before", "after")
    ]
    columns = (
        *("name", "fsn_no", "boat_type", "rowers", "crew_class", "season", "weight_kg"),
        *("declared_speed_m_s", "b_m_s", "b_lo_m_s", "b_hi_m_s", "cw_kg_m", "cw_lo_kg_m"),
        "cw_hi_kg_m",
    )
    table = Table(
        "type_boats", boats.with_columns(after="method"), columns, "types_list",
        ["after", "boat_type"], search=True, linked=True,
    )  # fmt: skip
    types = boats["boat_type"].unique().sort().to_list()
    return Page(
        "types.html",
        "types",
        [
            Section("types_charts", "types_note", charts),
            Section("types_list", tables=[table]),
            *_type_tables(views),
        ],
        selects=[
            Select("before", "before", methods, methods[0]),
            Select("after", "after", methods, default_method(methods)),
            Select("boat_type", "type", types, "", with_all=True),
            Select("boat_type_2", "type_second", types, "", with_all=True),
        ],
        data={"type_boats": [boats.drop("a_kg_m", "tow_id")]},
    )


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
        data["ladder"] = views.season_ladder()
        data["season_change"] = views.season_change()
        sections += [_ladder(data["ladder"]), _season_change(data["season_change"])]
    if views.has("option_effects"):
        data["options"] = views.option_spread()
        columns = ["option", "tows", "median_ratio", "lo_ratio", "hi_ratio"]
        table = Table("options", data["options"], columns, "options")
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
    table = Table("season_change", frame, columns, "season_change", ["method"])
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
    races = [s for t in ("race_replays", "races") for s in _whole(views, t, "races")]
    return Page(
        "changes.html",
        "changes",
        [Section("changes_list", "changes_note", [chart], [table]), *races],
        selects=[Select("to_edition", "edition", editions, _newest(editions))],
        data={"changes": [drawn]},
    )


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
    for name, title, note, frame in (
        ("flags", "flags", "flags_note", views.flag_counts()),
        ("run_reasons", "run_reasons", None, views.run_reason_counts()),
    ):
        if frame.height:
            table = Table(name, frame, frame.columns, title, ["method"])
            sections.append(Section(title, note, tables=[table]))
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
