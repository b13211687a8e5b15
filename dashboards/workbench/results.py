"""The page about a question: what a method changes for registers, a boat, types and repeats.

Numbers come from `warehouse.queries.scenario`; sections, tables and charts are the site's.
"""

from collections.abc import Sequence

import polars as pl
from markupsafe import Markup

from dashboards import labels
from dashboards.figures.style import SCENARIO
from dashboards.option_labels import text
from dashboards.site.cells import Cells, Show
from dashboards.site.parts import Chart, Page, Section, Select, Table, types_select
from dashboards.speech import Headline
from dashboards.statements import Change
from dashboards.statements.season import reproducibility
from dashboards.workbench.bench import Asked, Bench
from pipeline.messages import Sentence, say
from warehouse.queries.scenario import Scenario
from warehouse.queries.views import ALL, NEWEST

REGISTER_COLUMNS = (
    "name fsn_no boat_type rowers crew_class change old_cw_kg_m new_cw_kg_m cw_ratio "
    "gain_in_two_hours_s old_rank new_rank exceeds_interval"
)
OF_TYPE = {"boat_type": "boat_type"}


class BenchCells(Cells):
    """Rows in which a boat leads to the same question about it, and a type to no page."""

    def _shower(self, name: str, root: str) -> Show:
        if name == "fsn_no":
            return lambda boat: Markup('<a href="?boat={0}">{0}</a>').format(boat)
        if name == "boat_type":
            return lambda boat_type: self.text(labels.code(boat_type))
        return super()._shower(name, root)


def results(bench: Bench, asked: Asked) -> Page:
    """The page about a question.

    Raises:
        HerijkError: the method does not cover a season, or cannot be.
    """
    scenario = bench.scenario(asked)
    sections = [
        _summary(scenario),
        _register(scenario, asked),
        _boat(scenario, asked),
        _types(scenario, asked),
        _repeats(scenario),
    ]
    selects = _selects(bench, scenario, asked)
    return Page("index.html", text("workbench"), sections, selects=selects)


def _leading(frame: pl.DataFrame, asked: Asked) -> pl.DataFrame:
    """Rows of boats, each with the address of the same question about it."""
    address = pl.lit(asked.address(boat="")) + pl.col("fsn_no") + pl.lit("#boat")
    return frame.with_columns(page=address)


def _summary(scenario: Scenario) -> Section:
    s = scenario.summary()
    median = s["median_ratio"]
    figures: list[tuple[Sentence, str | Headline]] = [
        (say("lines changed"), f"{s['changed']} / {s['lines']}"),
        (say("gain time"), str(s["gains"])),
        (say("lose time"), str(s["loses"])),
        (say("lines added"), str(s["added"])),
        (say("lines removed"), str(s["removed"])),
        (say("Cw, median"), Change(median) if isinstance(median, float) else "-"),
    ]
    repeats = reproducibility(_reproducibility(scenario), SCENARIO)
    return Section("overview", say("In short"), key_figures=figures, headline=repeats)


def _register(scenario: Scenario, asked: Asked) -> Section:
    lines = scenario.register_lines.select(*REGISTER_COLUMNS.split(), "time_ratio", "to_edition")
    return Section(
        "register",
        say("The register"),
        note=say(
            "Every line against the chosen method, the largest change first. Time: what the "
            "new line gives (+) or costs (-) in a two-hour race at equal power."
        ),
        charts=[
            Chart(
                "changes",
                [_leading(lines.filter(change="changed"), asked)],
                say("Cw and time of every changed line"),
            ),
            Chart(
                "season_change",
                [scenario.season_change()],
                say("Cw after / before per season: median and range"),
            ),
            Chart(
                "log_factors",
                [scenario.both(lambda draft: draft.made.log_factors)],
                say("True speed / log speed per season, with its 95 % interval"),
            ),
        ],
        tables=[Table("register", lines, REGISTER_COLUMNS, search=True, linked=True)],
    )


def _boat(scenario: Scenario, asked: Asked) -> Section:
    return Section(
        "boat",
        say("A boat"),
        note=say(
            "The curve and the runs before and after. Open marks do not count. The bar at the "
            "declared speed is the 95 % interval; a dashed bar is the spread of the runs "
            "alone, without the error of the log."
        ),
        charts=[
            Chart(
                "curves_compared",
                [scenario.boat_figure(asked.boat)],
                say("Resistance curves of this tow"),
                {"tow_id": "tow"},
            )
        ],
        tables=[
            Table(
                "boat_curves",
                scenario.boat_curves(asked.boat),
                "method tow_id declared_speed_m_s a_kg_m b_m_s cw_kg_m cw_lo_kg_m cw_hi_kg_m "
                "runs_used status flags",
            )
        ],
    )


def _types(scenario: Scenario, asked: Asked) -> Section:
    tests = scenario.both(lambda draft: draft.type_consistency)
    drawn = [_leading(scenario.type_tows(asked.tows), asked)]
    return Section(
        "types",
        say("Types: are equal boats equal?"),
        note=say(
            "The chosen tows, Cw at the standard speed of the type. Drag over a chart to see "
            "in the register which boats lie there. The table says whether boats of a type are "
            "equal, by the newest tow of each boat and crew."
        ),
        charts=[
            Chart("b_weight", drawn, say("B against weight"), OF_TYPE),
            Chart(
                "cw_standard_weight",
                drawn,
                say("Cw at the standard speed against weight"),
                OF_TYPE,
            ),
        ],
        tables=[
            Table(
                "type_consistency",
                tests,
                "method boat_type quantity n n_boats verdict difference_that_matters spread_ratio "
                "farthest farthest_ratio weight_verdict tow_speed_verdict",
                follows=["boat_type"],
            )
        ],
    )


def _repeats(scenario: Scenario) -> Section:
    repeats = _reproducibility(scenario)
    return Section(
        "repeats",
        say("Reproducibility: the same boat again"),
        note=say("Two consecutive tows of an unaltered boat with the same crew."),
        charts=[Chart("reproducibility", [repeats], say("Standard deviation of one tow"))],
        tables=[
            Table(
                "reproducibility",
                repeats,
                "method scope n_pairs sd_ratio lo hi share_within_1pct share_within_2pct",
            )
        ],
    )


def _reproducibility(scenario: Scenario) -> pl.DataFrame:
    return scenario.both(lambda draft: draft.reproducibility)


def _selects(bench: Bench, scenario: Scenario, asked: Asked) -> Sequence[Select]:
    names = bench.boats.select("fsn_no", "name").iter_rows()
    boats = {fsn_no: f"{name or ''} ({fsn_no})" for fsn_no, name in names}
    tows = scenario.boat_curves(asked.boat)["tow_id"].unique().sort(descending=True).to_list()
    judged = {tows: labels.code(tows) for tows in (ALL, NEWEST)}
    return [
        Select("boat", say("Choose boat"), boats, asked.boat, asks=True),
        Select("tow", say("Tow"), dict(zip(tows, tows, strict=True)), tows[0] if tows else ""),
        types_select(bench.boats["boat_type"]),
        Select("tows", say("Types judged by tows"), judged, asked.tows, asks=True),
    ]
