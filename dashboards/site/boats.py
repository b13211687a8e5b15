"""One page per boat: the owner's answer, and folded below it how each number was made."""

from collections.abc import Callable, Iterator, Sequence
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
    first_edition,
    methods_select,
    once_for_methods,
)
from dashboards.statements.boat import Answer, answers_by_boat
from pipeline.messages import Sentence, say
from pipeline.register.register import default_method
from warehouse.queries.views import DRAFT, Views, curve_figure

FOLLOWS = ["tow_id", "method"]
ALIKE = ("runs", "wind", "line", "point", "declared", "stages", "assessments")
"""Frames of which most rows are the same under several methods."""

RUN_COLUMNS = (
    "run direction window_start_s window_end_s cut_reason used reason choice speed_m_s "
    "gross_cw_kg_m inertia_cw_kg_m air_cw_kg_m still_air_cw_kg_m temperature_cw_kg_m run_cw_kg_m "
    "cw_sd wind_m_s wind_angle_deg"
)
HISTORY = (
    *("method", "tow", "cw_kg_m", "cw_lo_kg_m", "cw_hi_kg_m", "a_kg_m", "b_m_s", "power_w"),
    *("weight_kg", "altered", "status", "interval"),
)
WIND = ("run", "direction", "wind_m_s", "wind_angle_deg")
WINDOW = ("run", "window_start_s", "window_end_s", "run_end_s", "cut_reason")
STAGE = ("run", "direction", "speed_m_s")
BUDGET = ("component", "shared", "u_ratio", "dof")


def boat_pages(views: Views, methods: Sequence[str]) -> Iterator[tuple[str, Callable[[], Page]]]:
    """Every boat that the archive lists, with what makes its page."""
    frames = _frames(views)
    crews = answers_by_boat(views, first_edition(frames["register"]["edition"], methods))
    # What a boat is compared by: as published, and as decided.
    published = views.table("editions")["method"].drop_nulls()
    compared = pl.col("method").is_in([methods[0], default_method(methods), *published])
    parts = {}
    for name, frame in frames.items():
        own = frame.filter(compared) if "method" in frame.columns else frame
        frames[name] = once_for_methods(own) if name in ALIKE else own
        parts[name] = frames[name].partition_by("fsn_no", as_dict=True, maintain_order=True)
    for fsn_no in frames["boats"]["fsn_no"]:
        own_frames = {
            name: parts[name].get((fsn_no,), frame.clear()) for name, frame in frames.items()
        }
        yield fsn_no, partial(_page, fsn_no, own_frames, methods, crews.get(fsn_no, ()))


def _frames(views: Views) -> dict[str, pl.DataFrame]:
    """Everything a boat's page draws, of all boats at once."""
    points = views.ask("run_points").with_columns(run_cw_kg_m="cw_kg_m")
    seconds = views.table("trace_seconds")
    ends = seconds.group_by("tow_id", "run", maintain_order=True).agg(
        run_end_s=pl.col("second").max() + 1
    )
    curves = views.ask("curves").with_columns(
        tow=pl.format("{} · {}{}", "tow_date", "rowers", "crew_class")
    )
    boat_of = views.table("tows").select("tow_id", "fsn_no")

    def of_tows(rows: pl.DataFrame) -> pl.DataFrame:
        return rows.join(boat_of, on="tow_id", maintain_order="left")

    windows = points.join(ends, on=["tow_id", "run"], maintain_order="left")
    counting, own = points.filter("used"), ("fsn_no", *FOLLOWS)
    stages = {"gross": "gross_cw_kg_m", "net": "cw_kg_m"}
    return {
        "boats": views.table("boats"),
        "register": _once(views.register()),
        "curves": curves,
        "history": curves.select("fsn_no", *HISTORY),
        "runs": points.select(*own, *RUN_COLUMNS.split()).sort(
            "tow_id", "run", maintain_order=True
        ),
        "wind": points.select(*own, *WIND),
        **curve_figure(views.table("curve_points"), points, curves),
        "stages": pl.concat(
            counting.select(*own, *STAGE, cw_kg_m=column, stage=pl.lit(stage))
            for stage, column in stages.items()
        ),
        "trace": of_tows(_seconds(seconds)),
        "window": windows.select(*own, *WINDOW, kind=pl.lit("window")),
        "lineage": views.table("lineage").with_columns(
            crew=pl.format("{}{}", "rowers", "crew_class")
        ),
        "budget": of_tows(views.table("uncertainty_budget").select(*FOLLOWS, *BUDGET)),
        "assessments": of_tows(views.ask("flagged")),
        "hand_windows": of_tows(views.table("hand_windows")),
    }


def _seconds(seconds: pl.DataFrame) -> pl.DataFrame:
    """Seconds of every run, to the digits that a chart of 110 pixels can show."""
    return seconds.select(
        *("tow_id", "run", "second"),
        pl.col("speed_m_s", "gps_m_s").round(2),
        pl.col("wind_m_s").round(1),
        pl.col("force_n").round().cast(pl.Int32),
        kind=pl.lit("trace"),
    )


def _once(register: pl.DataFrame) -> pl.DataFrame:
    """Without the drafts that say what an edition of the same method says."""
    same = ["method", "fsn_no", "rowers", "crew_class", "tow_id", "cw_kg_m"]
    is_draft = pl.col("edition").str.starts_with(DRAFT)
    editions = register.filter(~is_draft)
    repeated = register.filter(is_draft).join(editions, on=same, how="semi", nulls_equal=True)
    return register.join(repeated, on=["edition", *same], how="anti", nulls_equal=True)


def _page(
    fsn_no: str, own: dict[str, pl.DataFrame], methods: Sequence[str], told: Sequence[Answer]
) -> Page:
    boat, curves = own["boats"].row(0, named=True), own["curves"]
    tows: dict[str, str] = dict(zip(curves["tow_id"], curves["tow"], strict=True))
    measures = Table(
        "boats",
        own["boats"],
        "name fsn_no ht_no boat_type waterline_length_m beam_m bow_height_m weight_kg",
    )
    facts = Section("facts", say("Dimensions"), tables=[measures], folded=bool(tows))
    selects = (
        [
            Select("tow_id", say("Tow"), tows, next(reversed(tows))),
            methods_select([m for m in methods if m in curves["method"].unique()]),
        ]
        if tows
        else []
    )
    return Page(
        boat_path(fsn_no),
        say("Boat"),
        [*_related(told), facts, *_sections(own)] if tows else [facts],
        name=boat["name"],
        selects=selects,
        answers=told if tows else (),
        subtitle=" · ".join(filter(None, (fsn_no, boat["ht_no"], boat["boat_type"]))),
    )


def _related(answers: Sequence[Answer]) -> Iterator[Section]:
    """The pages of its type and of its races."""
    names = filter(None, (one.line["boat_type"] for one in answers))
    types = {name: type_path(name) for name in names}
    races = {
        f"{race['race']} {race['race_date']}": race_path(race["race"], race["race_date"])
        for one in answers
        for race in one.races
    }
    links = [(path, name, "") for name, path in (types | races).items()]
    if links:
        yield Section("boat_related", say("Its type and its races"), links=links)


def _sections(own: dict[str, pl.DataFrame]) -> list[Section]:
    """How the numbers were made: all of it folded."""

    def drawn(figure: str, *kinds: str, caption: Sentence | None = None) -> Chart:
        rows = [own[kind].drop("fsn_no") for kind in kinds]
        follows = {name: name for name in FOLLOWS if "tow_id" in rows[0].columns}
        return Chart(figure, rows, caption, follows)

    def listed(name: str, kind: str, columns: str) -> list[Table]:
        rows = own[kind]
        follows = [one for one in FOLLOWS if one in rows.columns and kind != "register"]
        return [Table(name, rows, columns, follows=follows)]

    sections = [
        Section(
            "boat_lines",
            say("In the register"),
            tables=listed(
                "register",
                "register",
                "edition rowers crew_class tow_date valid_until status declared_speed_m_s a_kg_m "
                "b_m_s cw_kg_m cw_lo_kg_m cw_hi_kg_m verification_code method",
            ),
        ),
        Section(
            "boat_history",
            say("Through the years"),
            say(
                "Cw at the declared speed of every tow, by every method. A solid line is its "
                "95 % interval, a dashed one the spread of the runs alone: the log's error is "
                "not in it."
            ),
            [drawn("history", "history")],
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
            [drawn("resistance_curve", "line", "point", "declared")],
        ),
        Section(
            "boat_runs",
            say("Runs"),
            say(
                "How each run comes to its Cw, from left to right: gross F/v², less "
                "acceleration, less wind, plus still air, plus temperature."
            ),
            tables=listed("run_points", "runs", RUN_COLUMNS),
        ),
        Section(
            "boat_traces",
            say("What the instruments said"),
            say(
                "Means per second; speed: solid log 1, dashed GPS. Grey parts are cut, for "
                "the reason above them; the rest counts."
            ),
            [drawn("traces", "trace", "window")],
        ),
        Section(
            "boat_out_back",
            say("Out against back, and the wind"),
            say(
                "Cw before and after the air correction, out (runs 1-3) and back (runs 4-6). "
                "After the correction out and back should coincide. Wind angle: 0 degrees is "
                "from ahead, minus from port, 180 from behind."
            ),
            [
                drawn("out_and_back", "stages"),
                drawn("wind", "wind", caption=say("Apparent wind [m/s]")),
            ],
        ),
        Section(
            "uncertainty_budget",
            say("What the uncertainty is made of"),
            say(
                "Relative standard uncertainty of Cw by cause; the table says which tows share it."
            ),
            [drawn("budget", "budget")],
        ),
        Section(
            "assessments",
            say("Checks"),
            say("Only results beyond a limit; all checks are in the table assessments."),
            tables=listed("assessments", "assessments", "check severity observed limit unit"),
        ),
        Section(
            "hand_windows",
            say("Windows chosen by hand"),
            say("Windows that a person chose, with the reason."),
            tables=listed("hand_windows", "hand_windows", "run start_s end_s reason"),
        ),
        Section(
            "lineage",
            say("Lineage"),
            say("The files, the method and the code behind every register line."),
            tables=listed(
                "lineage", "lineage", "edition crew tow_id path sha256 method_hash code_version"
            ),
        ),
    ]
    return [replace(section, folded=True) for section in sections]
