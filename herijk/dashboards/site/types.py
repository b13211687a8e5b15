"""The page of boat types: are equal boats equal, before and after."""

from collections.abc import Iterator, Sequence

import polars as pl

from herijk.dashboards.site import headlines
from herijk.dashboards.site.parts import (
    Chart,
    Page,
    Section,
    Select,
    Table,
    default_method,
    methods_select,
    type_path,
    with_page,
)
from herijk.warehouse.queries.views import Views

QUANTITIES = ("b_weight", "b_speed", "cw_weight", "cw_speed")
SIDES = ("before", "after")
"""Selectors of the two methods that stand side by side."""
PAIR = ("kromhout", "kuiken")
"""Two types of which many boats are said to be equal: shown side by side at first."""
PAIR_SELECTORS = ("pair_first", "pair_second")


def types_page(views: Views, methods: Sequence[str]) -> Page:
    """B and Cw of every boat against weight and speed, types side by side, and what differs."""
    if not views.has("pooled_curves"):
        return Page("types.html", "types", [])
    boats = with_page(views.type_boats())
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
    links = [(type_path(name), name) for name in types]
    return Page(
        "types.html",
        "types",
        [
            Section("types_pages", "types_pages_note", pages=links),
            Section("types_charts", "types_note", _before_after("", "boat_type")),
            Section("types_list", tables=[table]),
            Section("types_pair", "types_pair_note", _before_after("pair_", PAIR_SELECTORS)),
            *_type_tables(views),
        ],
        selects=[
            methods_select(methods, "before", methods[0]),
            methods_select(methods, "after"),
            Select("boat_type", "type", types, "", with_all=True),
            Select("pair_first", "pair_first", types, first),
            Select("pair_second", "pair_second", types, second),
        ],
        data={"type_boats": [boats.select("method", "page", *columns)]},
    )


TYPE_COLUMNS = (
    *("name", "fsn_no", "rowers", "crew_class", "season", "weight_kg", "cw_standard_kg_m"),
    *("declared_speed_m_s", "cw_kg_m", "cw_lo_kg_m", "cw_hi_kg_m", "a_kg_m", "b_m_s"),
)
TYPE_CARDS = ("name", "fsn_no", "rowers", "crew_class", "cw_standard_kg_m", "cw_kg_m")
LINE_COLUMNS = (
    *("quantity", "explaining", "n", "slope", "slope_lo", "slope_hi", "r2", "residual_sd_ratio"),
)


def type_pages(views: Views, methods: Sequence[str]) -> Iterator[Page]:
    """A page for every type: the verdict, its boats, the fitted lines."""
    if not views.has("pooled_curves"):
        return
    boats = with_page(views.type_boats(), "../")
    lines, tests = views.table("type_consistency"), views.table("type_homogeneity")
    for boat_type in views.type_names():
        own = boats.filter(boat_type=boat_type)
        of_type = (lines.filter(boat_type=boat_type), tests.filter(boat_type=boat_type))
        yield _type_page(boat_type, own, *of_type, methods)


def _type_page(
    boat_type: str,
    boats: pl.DataFrame,
    lines: pl.DataFrame,
    tests: pl.DataFrame,
    methods: Sequence[str],
) -> Page:
    table = Table(
        "type_boats", boats, TYPE_COLUMNS, "types_list", ["method"], search=True, cards=TYPE_CARDS
    )
    charts = [
        Chart(name, "boats", name, {"method": "method"})
        for name in ("type_cw_weight", "type_cw_speed")
    ]
    verdict = headlines.homogeneity(tests.filter(method=default_method(methods)))
    fitted = Table("type_consistency", lines, LINE_COLUMNS, "types_lines", ["method"])
    drawn = ("method", "page", *TYPE_COLUMNS)
    return Page(
        type_path(boat_type),
        "types",
        [
            Section("type_verdict", "type_note", charts, [table], headline=verdict),
            Section("types_lines", "types_lines_note", tables=[fitted], folded=True),
        ],
        name=boat_type,
        selects=[methods_select(methods)],
        data={"boats": [boats.select(drawn)]},
    )


def _before_after(prefix: str, of_type: str | Sequence[str]) -> list[Chart]:
    follows = {"method": SIDES, "boat_type": of_type}
    return [Chart(f"{prefix}{name}", "type_boats", name, follows) for name in QUANTITIES]


def _pair(types: Sequence[str]) -> tuple[str, str]:
    """The types of `PAIR` where the archive has them, else the first and last."""
    known = [next((t for t in types if t.lower().startswith(name)), None) for name in PAIR]
    return known[0] or types[0], known[1] or types[-1]


def _type_tables(views: Views) -> list[Section]:
    sections = []
    outliers = views.outliers() if views.has("type_outliers") else pl.DataFrame()
    if outliers.height:
        shown_columns = (
            *("name", "fsn_no", "boat_type", "rowers", "crew_class", "season", "quantity", "value"),
            *("expected", "deviation_sd", "candidates"),
        )
        shown = outliers.with_columns(after="method")
        table = Table(
            "type_outliers", shown, shown_columns, "types_outliers", ["after", "boat_type"]
        )
        sections.append(Section("types_outliers", "types_outliers_note", tables=[table]))
    wanted = {
        "type_consistency": (
            "types_lines",
            "types_lines_note",
            "boat_type quantity explaining n slope slope_lo slope_hi r2 residual_sd_ratio",
        ),
        "type_homogeneity": (
            "types_homogeneity",
            "types_homogeneity_note",
            "boat_type n n_boats p_value power_at_10pct noise_share shared_b_m_s",
        ),
    }
    for name, (title, note, columns) in wanted.items():
        if views.has(name):
            shown = views.table(name).with_columns(after="method")
            table = Table(name, shown, columns.split(), title, ["after", "boat_type"])
            sections.append(Section(title, note, tables=[table]))
    return sections
