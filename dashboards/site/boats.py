"""One page per boat: the owner's answer, and folded below it how each number was made."""

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import replace
from functools import partial

import polars as pl

from dashboards.addresses import boat_path, race_path, type_path
from dashboards.site.parts import (
    Chart,
    Page,
    Section,
    Select,
    Table,
    default_method,
    draft_of,
    listed,
    methods_select,
    once_for_methods,
)
from dashboards.statements.boat import Answer, answers_by_boat
from pipeline.messages import Sentence, say
from warehouse.queries.answers import newest_edition
from warehouse.queries.views import DRAFT, Views, curve_figure

OF_THE_CURVE = {"tow_id": "tow_id", "method": "method"}
FOLLOWS = ["tow_id", "method"]
EXTRA = (
    (
        Section(
            "assessments",
            say("Checks"),
            say("Only what lies beyond its limit; all checks are in the table assessments."),
        ),
        ("check", "severity", "observed", "limit", "unit"),
    ),
    (
        Section(
            "hand_windows",
            say("Windows chosen by hand"),
            say("Windows that a person chose, with the reason."),
        ),
        ("run", "start_s", "end_s", "reason"),
    ),
    (
        Section(
            "lineage",
            say("Lineage"),
            say("The files, the method and the code behind every register line."),
        ),
        ("edition", "crew", "tow_id", "path", "sha256", "method_hash", "code_version"),
    ),
)
"""Tables that are shown where they hold anything of the boat, with the columns shown."""


def boat_pages(views: Views, methods: Sequence[str]) -> Iterator[tuple[str, Callable[[], Page]]]:
    """Every boat that the archive lists, with what makes its page."""
    frames = _frames(views)
    editions = frames["register"]["edition"].unique().sort().to_list()
    crews = answers_by_boat(views, newest_edition(editions, draft_of(methods)))
    published = views.table("editions")["method"].drop_nulls()
    frames = _of_methods(frames, {methods[0], default_method(methods), *published})
    frames |= {name: once_for_methods(frames[name]) for name in ALIKE if name in frames}
    parts = {
        name: frame.partition_by("fsn_no", as_dict=True, maintain_order=True)
        for name, frame in frames.items()
    }
    for fsn_no in frames["boats"]["fsn_no"]:
        own = {name: parts[name].get((fsn_no,), frame.clear()) for name, frame in frames.items()}
        yield fsn_no, partial(_page, fsn_no, own, methods, crews.get(fsn_no, ()))


def _of_methods(
    frames: dict[str, pl.DataFrame], methods: Collection[str]
) -> dict[str, pl.DataFrame]:
    """Rows of these methods: what a boat is compared by, as published and as decided."""
    return {
        name: frame.filter(pl.col("method").is_in(methods)) if "method" in frame.columns else frame
        for name, frame in frames.items()
    }


ALIKE = ("runs", "wind", "line", "point", "declared", "stages", "assessments")
"""Frames of which most rows are the same under several methods."""


def _frames(views: Views) -> dict[str, pl.DataFrame]:
    """Everything a boat's page draws, of all boats at once."""
    boat_of = views.table("tows").select("tow_id", "fsn_no")
    points = views.ask("run_points").with_columns(run_cw_kg_m="cw_kg_m")
    seconds = views.table("trace_seconds")
    ends = seconds.group_by("tow_id", "run", maintain_order=True).agg(
        run_end_s=pl.col("second").max() + 1
    )
    register = views.register()
    curves = views.ask("curves").with_columns(
        tow=pl.format("{} · {}{}", "tow_date", "rowers", "crew_class")
    )
    frames = {
        "boats": views.table("boats"),
        "register": _once(register),
        "curves": curves,
        "history": curves.select("fsn_no", *HISTORY),
        "runs": points.select("fsn_no", *FOLLOWS, *RUN_COLUMNS).sort(
            "tow_id", "run", maintain_order=True
        ),
        "wind": points.select("fsn_no", *WIND),
        **curve_figure(views.table("curve_points"), points, curves),
        "stages": _stages(points),
        "trace": _seconds(seconds.join(boat_of, on="tow_id", maintain_order="left")),
        "window": _kind(
            points.join(ends, on=["tow_id", "run"], maintain_order="left"),
            "window",
            "method",
            "run",
            *WINDOW,
        ),
        "lineage": views.table("lineage").with_columns(
            crew=pl.format("{}{}", "rowers", "crew_class")
        ),
        "budget": views.table("uncertainty_budget")
        .select(*FOLLOWS, "component", "shared", "u_ratio", "dof")
        .join(boat_of, on="tow_id", maintain_order="left"),
    }
    for name in ("assessments", "hand_windows"):
        if views.has(name):
            rows = views.ask("flagged") if name == "assessments" else views.table(name)
            frames[name] = rows.join(boat_of, on="tow_id", maintain_order="left")
    return frames


WINDOW = ["window_start_s", "window_end_s", "run_end_s", "cut_reason"]
WIND = ["method", "tow_id", "run", "direction", "wind_m_s", "wind_angle_deg"]
HISTORY = [
    *("method", "tow", "cw_kg_m", "cw_lo_kg_m", "cw_hi_kg_m", "a_kg_m", "b_m_s", "power_w"),
    *("weight_kg", "altered", "status", "interval"),
]


def _kind(frame: pl.DataFrame, kind: str, *columns: str) -> pl.DataFrame:
    return frame.select("fsn_no", "tow_id", *columns, kind=pl.lit(kind))


def _stages(points: pl.DataFrame) -> pl.DataFrame:
    """The runs that count, before and after the air correction."""
    seen = points.filter("used")
    shared = ("fsn_no", "method", "tow_id", "run", "direction", "speed_m_s")
    return pl.concat(
        [
            seen.select(*shared, cw_kg_m="gross_cw_kg_m", stage=pl.lit("gross")),
            seen.select(*shared, "cw_kg_m", stage=pl.lit("net")),
        ]
    )


def _seconds(traces: pl.DataFrame) -> pl.DataFrame:
    """Seconds of every run, to the digits that a chart of 110 pixels can show."""
    rounded = traces.with_columns(
        pl.col("speed_m_s", "gps_m_s").round(2),
        pl.col("wind_m_s").round(1),
        pl.col("force_n").round().cast(pl.Int32),
    )
    fields = ("run", "second", "speed_m_s", "gps_m_s", "wind_m_s", "force_n")
    return _kind(rounded, "trace", *fields)


LINE_COLUMNS = (
    *("edition", "rowers", "crew_class", "tow_date", "valid_until", "status"),
    *("declared_speed_m_s", "a_kg_m", "b_m_s", "cw_kg_m", "cw_lo_kg_m", "cw_hi_kg_m"),
    *("verification_code", "method"),
)
RUN_COLUMNS = (
    *(
        "run",
        "direction",
        "window_start_s",
        "window_end_s",
        "cut_reason",
        "used",
        "reason",
        "choice",
    ),
    *("speed_m_s", "gross_cw_kg_m", "inertia_cw_kg_m", "air_cw_kg_m", "still_air_cw_kg_m"),
    *("temperature_cw_kg_m", "run_cw_kg_m", "cw_sd"),
    *("wind_m_s", "wind_angle_deg"),
)
FACT_COLUMNS = (
    *("name", "fsn_no", "ht_no", "boat_type", "waterline_length_m", "beam_m", "bow_height_m"),
    "weight_kg",
)


def _page(
    fsn_no: str, own: dict[str, pl.DataFrame], methods: Sequence[str], told: Sequence[Answer]
) -> Page:
    measures = Table("boats", own["boats"], FACT_COLUMNS)
    facts = Section("facts", say("Dimensions"), tables=[measures])
    boat = own["boats"].row(0, named=True)
    name = boat["name"]
    subtitle = " · ".join(filter(None, (fsn_no, boat["ht_no"], boat["boat_type"])))
    curves = own["curves"]
    named = dict(zip(curves["tow_id"], curves["tow"], strict=True))
    if not named:
        return Page(boat_path(fsn_no), say("Boat"), [facts], name=name, subtitle=subtitle)
    tows = list(named)
    selects = [
        Select("tow_id", say("Tow"), tows, tows[-1], named=lambda tow, _: named[tow]),
        methods_select([m for m in methods if m in curves["method"].unique()]),
    ]
    return Page(
        boat_path(fsn_no),
        say("Boat"),
        [*_related(told), replace(facts, folded=True), *_sections(own)],
        name=name,
        selects=selects,
        answers=told,
        subtitle=subtitle,
    )


def _related(answers: Sequence[Answer]) -> list[Section]:
    """The pages of its type and of its races."""
    names = filter(None, (one.line["boat_type"] for one in answers))
    types = {name: type_path(name) for name in names}
    races = {
        f"{race['race']} {race['race_date']}": race_path(race["race"], race["race_date"])
        for one in answers
        for race in one.races
    }
    links = [(path, name, "") for name, path in (types | races).items()]
    return [Section("boat_related", say("Its type and its races"), links=links)] if links else []


def _sections(own: dict[str, pl.DataFrame]) -> list[Section]:
    """How the numbers were made: all of it folded."""

    def drawn(figure: str, *kinds: str, caption: Sentence | None = None) -> Chart:
        rows = [own[kind].drop("fsn_no") for kind in kinds]
        return Chart(figure, rows, caption, OF_THE_CURVE if "tow_id" in rows[0].columns else {})

    curve = drawn("resistance_curve", "line", "point", "declared")
    history = drawn("history", "history")
    traces = drawn("traces", "trace", "window")
    budget = drawn("budget", "budget")
    sides = [
        drawn("out_and_back", "stages"),
        drawn("wind", "wind", caption=say("Apparent wind [m/s]")),
    ]
    runs = Table("run_points", own["runs"], RUN_COLUMNS, follows=FOLLOWS)
    lines = Table("register", own["register"], LINE_COLUMNS)
    sections = [
        Section("boat_lines", say("In the register"), tables=[lines]),
        Section(
            "boat_history",
            say("Through the years"),
            say(
                "Cw at the declared speed of every tow, by every method. A solid line is its "
                "95 % interval, a dashed one the spread of the runs alone: the log's error is "
                "not in it."
            ),
            [history],
        ),
        Section(
            "boat_curve",
            say("Resistance curve"),
            say(
                "The line is Cw = A / (1 - (v/B)^2) over the valid range, 85 to 115 % of the "
                "declared speed; the bar is the interval at that speed. A full band and bar "
                "are the 95 % interval, with all that the uncertainty is made of; a light band "
                "and a dashed bar the spread of the runs alone: the log's error is not in it. "
                "Open marks do not count."
            ),
            [curve],
        ),
        Section(
            "boat_runs",
            say("Runs"),
            say(
                "How each run comes to its Cw, from left to right: gross F/v², less "
                "acceleration, less wind, plus still air, plus temperature."
            ),
            tables=[runs],
        ),
        Section(
            "boat_traces",
            say("What the instruments said"),
            say(
                "Means per second; speed: solid log 1, dashed GPS. What is grey is cut for the "
                "reason above it; the rest counts."
            ),
            [traces],
        ),
        Section(
            "boat_out_back",
            say("Out against back, and the wind"),
            say(
                "Cw before and after the air correction, out (runs 1-3) and back (runs 4-6). "
                "After the correction out and back should coincide. Wind angle: 0 degrees is "
                "from ahead, minus from port, 180 from behind."
            ),
            sides,
        ),
        Section(
            "uncertainty_budget",
            say("What the uncertainty is made of"),
            say(
                "Relative standard uncertainty of Cw by cause; the table says which tows share it."
            ),
            [budget],
        ),
    ]
    for section, columns in EXTRA:
        rows = own.get(section.name)
        if rows is not None:
            follows = [name for name in FOLLOWS if name in rows.columns]
            sections += listed(section, section.name, rows, columns, follows=follows)
    return [replace(section, folded=True) for section in sections]


def _once(register: pl.DataFrame) -> pl.DataFrame:
    """Without the drafts that say what an edition of the same method says."""
    same = ["method", "fsn_no", "rowers", "crew_class", "tow_id", "cw_kg_m"]
    is_draft = pl.col("edition").str.starts_with(DRAFT)
    editions = register.filter(~is_draft)
    repeated = register.filter(is_draft).join(editions, on=same, how="semi", nulls_equal=True)
    return register.join(repeated, on=["edition", *same], how="anti", nulls_equal=True)
