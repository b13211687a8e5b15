"""The kinds of chart, each drawn from rows of the tables. Nothing is computed here.

`draw_groups` has a value by season or tow, `draw_curves` resistance curves, `draw_scatter` the
tows of a type, `draw_gains` a bar for every crew, and `trace_lines` with `trace_frame` what
instruments said second by second.
"""

from collections.abc import Mapping, Sequence
from math import ceil
from typing import Any, Final

import polars as pl
from markupsafe import Markup, escape

from dashboards import words
from dashboards.language import Language
from dashboards.pictures import make_standalone
from dashboards.plot import (
    CHARACTER_WIDTH_PX,
    GREY,
    INKS,
    LegendEntry,
    Plot,
    Scale,
    fit_scale,
    get_ink,
)
from pipeline.history import ERAS
from pipeline.messages import say
from pipeline.method.definition import COMPLETE
from pipeline.method.reading import list_shipped_methods
from pipeline.tables.row import Row

SPEED: Final = say("Speed through water [m/s]")
SECONDS: Final = say("Seconds in a race of two hours [s]")

TRACES: Final = (
    (say("Speed [m/s]"), (("speed_m_s", None), ("gps_m_s", "3 2"))),
    (say("Tow force [N]"), (("force_n", None),)),
    (say("Apparent wind [m/s]"), (("wind_m_s", None),)),
)
"""From top to bottom: the title of a row, and of each of its lines the column and the dash."""

TRACE_WIDTH_PX, TRACE_HEIGHT_PX, TRACE_TOP_PX = 960, 430, 50
TRACE_ROW_PX: Final = 118
TRACE_GAP_PX: Final = 12
"""Between runs."""


def draw_groups(
    language: Language,
    rows: pl.DataFrame,
    group: str,
    value: str,
    ends: tuple[str, str],
    caption: str,
    *,
    with_one: bool = False,
    title: str = "",
) -> Markup:
    """Return a value of every method, side by side for each season or tow, with its interval.

    Args:
        language: of what is written.
        rows: with `method`, the columns named, and perhaps the `interval` of the method.
        group: the column by which rows are grouped.
        value: the column drawn.
        ends: the columns of its interval.
        caption: of the picture.
        with_one: draw a line at 1, for ratios.
        title: of the axis; that of the column when left out.
    """
    known = rows.drop_nulls(value)
    if known.is_empty():
        return Markup()
    methods = known["method"].unique(maintain_order=True).to_list()
    groups = known[group].unique(maintain_order=True).to_list()
    legend = _list_method_entries(language, methods)
    plot = Plot(language, legend=legend)
    drawn = _stack_columns(known, [value, ends[0], ends[1]])
    y = plot.fit_y(drawn, including=[1.0] if with_one else [], bulk=group == "tow")
    plot.add_axes(None, y, "", title or language.get_title(value))
    width = (plot.right - plot.left) / len(groups)
    if with_one:
        plot.add_path(
            f"M{plot.left} {y(1):.1f}H{plot.right}", GREY, style={"stroke-dasharray": "4 3"}
        )
    _label_groups(plot, list(map(language.name_code, map(str, groups))), width)
    for row in known.to_dicts():
        kind = _get_method_kind(row["method"])
        place = (methods.index(row["method"]) + 1) / (len(methods) + 1)
        x = plot.left + (groups.index(row[group]) + place) * width
        low, high = row[ends[0]], row[ends[1]]
        if low is not None and high is not None:
            is_dashed = row.get("interval", COMPLETE) != COMPLETE
            plot.add_interval(x, y(low), y(high), get_ink(kind), dashed=is_dashed)
        plot.add_point(x, y(row[value]), kind, _write_tip(language, row, group, "method", value))
    return plot.to_svg(caption)


LABEL_GAP_PX: Final = 6
LABEL_ROW_PX: Final = 14


def _label_groups(plot: Plot, names: Sequence[str], width: float) -> None:
    """Write the names of groups: in two rows where they would touch, else of every few groups."""
    label_px = CHARACTER_WIDTH_PX * max(map(len, names)) + LABEL_GAP_PX
    rows = 1 if label_px <= width else 2
    every = ceil(label_px / (rows * width))
    for number, place in enumerate(range(0, len(names), every)):
        x = plot.left + (place + 0.5) * width
        furthest = plot.width - 0.5 * label_px
        y = plot.bottom + 17 + LABEL_ROW_PX * (number % rows)
        plot.add_text(min(x, furthest), y, names[place], "middle")


SEASON_ROW_PX: Final = 26
ERA_ROW_PX: Final = 24
SEASON_LABEL_PX: Final = 52


def draw_seasons(language: Language, rows: pl.DataFrame, caption: str) -> Markup:
    """Return the change of Cw by every method, a row for each season, under what was measured with.

    Seasons lie below each other, so that the picture is as wide on a phone as on paper.

    Args:
        language: of what is written.
        rows: of `season_changes`.
        caption: of the picture.
    """
    known = rows.drop_nulls("median_ratio").sort("season")
    if known.is_empty():
        return Markup()
    methods = known["method"].unique(maintain_order=True).to_list()
    by_era = []
    for era in ERAS:
        of_era = known.filter(pl.col("season").is_between(era.first, era.last))
        if not of_era.is_empty():
            by_era.append((era, of_era))
    legend = _list_method_entries(language, methods)
    height = SEASON_ROW_PX * known["season"].n_unique() + ERA_ROW_PX * len(by_era) + 90
    plot = Plot(language, 480, height, SEASON_LABEL_PX, 30, legend)
    changes = 100.0 * (_stack_columns(known, ["lowest_ratio", "highest_ratio"]) - 1.0)
    x = plot.fit_x(changes, including=[0.0])
    plot.add_grid(x, language.say(say("Cw by the method / Cw as published [%]")), signed=True)
    top = float(plot.top)
    for era, of_era in by_era:
        plot.add_text(4, top + 16, language.say(era.measured), size=11)
        plot.add_path(f"M4 {top:.1f}H{plot.right}", GREY, style={"stroke-opacity": 0.5})
        top += ERA_ROW_PX
        for of_season in of_era.partition_by("season", maintain_order=True):
            plot.add_text(4, top + SEASON_ROW_PX / 2 + 4, str(of_season["season"][0]))
            for row in of_season.to_dicts():
                place = (methods.index(row["method"]) + 1) / (len(methods) + 1)
                _add_season(plot, x, top + place * SEASON_ROW_PX, row)
            top += SEASON_ROW_PX
    return plot.to_svg(caption)


def _add_season(plot: Plot, x: Scale, y: float, row: Row) -> None:
    """Add what a method makes of a season: the median, and the reach of its tows."""
    kind = _get_method_kind(row["method"])
    low = x(100.0 * (row["lowest_ratio"] - 1.0))
    middle = x(100.0 * (row["median_ratio"] - 1.0))
    high = x(100.0 * (row["highest_ratio"] - 1.0))
    ink = get_ink(kind)
    plot.add_path(f"M{low:.1f} {y:.1f}H{high:.1f}", ink, style={"stroke-width": 2})
    tip = _write_tip(plot.language, row, "season", "method", "median_ratio")
    plot.add_point(middle, y, kind, tip)


def _stack_columns(rows: pl.DataFrame, names: Sequence[str]) -> pl.Series:
    """Return the numbers of columns, one column below the other."""
    return rows.select(names).unpivot()["value"]


def _list_method_entries(language: Language, methods: Sequence[str]) -> list[LegendEntry]:
    """Return what a legend says of methods, each with its own mark."""
    return [
        LegendEntry.from_kind(language.name_method(name), _get_method_kind(name))
        for name in methods
    ]


def _get_method_kind(method: str) -> int:
    """Return the kind of mark of a method; one that ships has the same in every chart."""
    known = list(list_shipped_methods())
    return known.index(method) if method in known else len(known)


WAYS: Final = {0: 1, 1: -1}
"""The direction of a run by the kind of its mark: a circle out, a square back."""


def draw_curves(
    language: Language, rows: pl.DataFrame, caption: str, width: int = 480, height: int = 300
) -> Markup:
    """Return the curves of Cw of a tow: lines with their bands, run points and intervals.

    Every method has its colour on the same axes.

    Args:
        language: of what is written.
        rows: of `kind` line, point and declared, as `prepare_curve_figure` gives them.
        caption: of the picture.
        width: of the picture [px].
        height: of the picture [px].
    """
    methods = rows["method"].unique(maintain_order=True).to_list()
    inks = {name: get_ink(_get_method_kind(name)) for name in methods}
    legend = []
    if "point" in rows["kind"]:
        for kind, way in WAYS.items():
            name = language.say(words.name_direction(way))
            legend.append(LegendEntry(name, kind, "currentColor"))
    if len(methods) > 1:
        legend += [LegendEntry(language.name_method(name), None, ink) for name, ink in inks.items()]
    plot = Plot(language, width, height, legend=legend)
    x = plot.fit_x(rows["speed_m_s"])
    y = plot.fit_y(_stack_columns(rows, ["cw_kg_m", "cw_lo_kg_m", "cw_hi_kg_m"]))
    plot.add_axes(x, y, language.say(SPEED), "Cw [kg/m]")
    for method, ink in inks.items():
        _add_curve(plot, x, y, rows.filter(method=method), ink)
    return plot.to_svg(caption)


def _add_curve(plot: Plot, x: Scale, y: Scale, rows: pl.DataFrame, ink: str) -> None:
    """Add what a method makes of a tow: band, line, interval at declared speed and run points."""
    line = rows.filter(kind="line")
    band = line.drop_nulls("cw_lo_kg_m")
    low, high = map(y, band["cw_lo_kg_m"]), map(y, band["cw_hi_kg_m"])
    plot.add_band(list(map(x, band["speed_m_s"])), list(low), list(high), ink)
    through = zip(map(x, line["speed_m_s"]), map(y, line["cw_kg_m"]), strict=True)
    plot.add_line(list(through), ink, style={"stroke-width": 2})
    for row in rows.filter(kind="declared").drop_nulls("cw_lo_kg_m").to_dicts():
        is_dashed = row["interval"] != COMPLETE
        lower, upper = y(row["cw_lo_kg_m"]), y(row["cw_hi_kg_m"])
        plot.add_interval(x(row["speed_m_s"]), lower, upper, ink, dashed=is_dashed)
    language = plot.language
    for row in rows.filter(kind="point").to_dicts():
        tip = language.say(say("run {run}: {speed_m_s} m/s, {cw_kg_m} kg/m")).format(
            run=row["run"],
            speed_m_s=language.write("speed_m_s", row["speed_m_s"]),
            cw_kg_m=language.write("cw_kg_m", row["cw_kg_m"]),
        )
        kind = int(row["direction"] < 0)
        at, up = x(row["speed_m_s"]), y(row["cw_kg_m"])
        plot.add_point(at, up, kind, tip, ink=ink, filled=row["used"])


def draw_scatter(
    language: Language,
    tows: pl.DataFrame,
    lines: pl.DataFrame,
    quantity: str,
    ends: tuple[str, str],
    explaining: str,
    caption: str,
) -> Markup:
    """Return a quantity of the tows of a type against what may explain it, a panel per method.

    Args:
        language: of what is written.
        tows: rows of `compared_tows` with the `interval` of the method, the `label` of the tow and
            the `page` of its boat.
        lines: rows of `type_line_points` of the same type and methods.
        quantity: the column along the side.
        ends: the columns of its interval.
        explaining: the column along the bottom.
        caption: of the picture.
    """
    known = tows.drop_nulls([quantity, explaining])
    every = _stack_columns(known, [quantity, ends[0], ends[1]])
    kinds = dict(zip([code for code, _ in language.list_crews()], CREW_KINDS, strict=False))
    crews = [LegendEntry.from_kind(language.name_crew(crew), kind) for crew, kind in kinds.items()]
    panels = []
    for method in known["method"].unique(maintain_order=True):
        plot = Plot(language, 380, 290, legend=crews)
        x, y = plot.fit_x(known[explaining], bulk=True), plot.fit_y(every, bulk=True)
        named = language.name_method(method)
        plot.add_axes(x, y, language.get_title(explaining), language.get_title(quantity))
        own = lines.filter(method=method, quantity=quantity, explaining=explaining)
        for of_class in own.partition_by("crew_class", maintain_order=True):
            at = list(map(x, of_class["x"]))
            plot.add_band(at, list(map(y, of_class["lo"])), list(map(y, of_class["hi"])))
            plot.add_line(list(zip(at, map(y, of_class["y"]), strict=True)), GREY)
        for row in known.filter(method=method).to_dicts():
            kind = kinds.get(row["crew_class"], CREW_KINDS[0])
            _add_tow(plot, x, y, row, kind, quantity, ends, explaining)
        picture = plot.to_svg(f"{caption}: {named}")
        panels.append(Markup("<div><b>{}</b>{}</div>").format(named, picture))
    return Markup('<div class="panels">{}</div>').format(Markup("").join(panels))


CREW_KINDS: Final = (0, 2, 1, 3, 4)
"""The mark of each class of crews, in order: a circle for men's crews, a triangle for women's."""


def _add_tow(
    plot: Plot,
    x: Scale,
    y: Scale,
    row: Row,
    kind: int,
    quantity: str,
    ends: tuple[str, str],
    explaining: str,
) -> None:
    """Add a tow with its interval, and its name where it stands out in Cw."""
    at, up = x(row[explaining]), y(row[quantity])
    low, high = row[ends[0]], row[ends[1]]
    if low is not None:
        is_dashed = row["interval"] != COMPLETE
        reach = plot.top if high is None else y(high)  # no upper end: to the edge
        plot.add_interval(at, y(low), reach, get_ink(kind), dashed=is_dashed)
    tip = f"{row['label']} · {_write_tip(plot.language, row, explaining, quantity)}"
    plot.add_point(at, up, kind, tip, filled=not row["beyond_curve"], page=row["page"])
    if row["cw_outside"] or not y.low <= row[quantity] <= y.high:
        is_right = at > (plot.left + plot.right) / 2
        anchor, side = ("end", -7) if is_right else ("start", 7)
        plot.add_text(at + side, up - 5, row["label"], anchor, size=10)


NUMBER_ROW_PX: Final = 28
NUMBER_LABEL_PX: Final = 64


def draw_number(language: Language, line: Row, caption: str) -> Markup:
    """Return the old and the new Cw of a line on one axis, with the other boats of its type.

    Args:
        language: of what is written.
        line: with both numbers, their intervals and whether these hold the log's error, and
            `peers`: Cw of the other boats of its type.
        caption: of the picture.
    """
    old = (line["old_cw_kg_m"], line["old_cw_lo_kg_m"], line["old_cw_hi_kg_m"])
    new = (line["cw_kg_m"], line["cw_lo_kg_m"], line["cw_hi_kg_m"])
    if new[0] is None:
        return Markup()
    rows = [(say("was"), old, line["old_log_known"]), (say("becomes"), new, line["new_log_known"])]
    shown = [row for row in rows if row[1][0] is not None]
    n_rows = len(shown) + bool(line["peers"])
    plot = Plot(language, 380, NUMBER_ROW_PX * n_rows + 50, NUMBER_LABEL_PX, 8)
    x = plot.fit_x([*old, *new, *line["peers"]])
    plot.add_grid(x, "Cw [kg/m]")
    for place, (name, (cw, low, high), is_complete) in enumerate(shown):
        y = plot.top + (place + 0.5) * NUMBER_ROW_PX
        plot.add_text(plot.left - 8, y + 4, language.say(name), "end")
        if low is not None and high is not None:
            dash = None if is_complete else "3 3"
            style = {"stroke-width": 3, "stroke-dasharray": dash}
            plot.add_path(f"M{x(low):.1f} {y:.1f}H{x(high):.1f}", INKS[place], style=style)
        plot.add_point(x(cw), y, place, language.write("cw_kg_m", cw))
    if line["peers"]:
        y = plot.top + (len(shown) + 0.5) * NUMBER_ROW_PX
        plot.add_text(plot.left - 8, y + 4, language.say(say("its type")), "end")
        for cw in line["peers"]:
            dot = f"M{x(cw) - 3:.1f} {y:.1f}a3 3 0 1 0 6 0a3 3 0 1 0 -6 0z"
            plot.add_path(dot, GREY, language.write("cw_kg_m", cw), {"fill": GREY})
    return plot.to_svg(caption)


GAIN_ROW_PX: Final = 18
GAIN_LABEL_PX: Final = 176
"""Room for the name of a crew."""
MAX_BARS: Final = 45
"""Crews in one picture: as many as can be read on a page of paper."""
WITHIN_OPACITY: Final = 0.45
"""How a change within its uncertainty is drawn."""


def draw_gains(language: Language, lines: pl.DataFrame, caption: str) -> Markup:
    """Return a bar for every crew: what a race of two hours at equal power gains or loses.

    More crews than a page of paper has room for take several pictures, on one scale.

    Args:
        language: of what is written.
        lines: with `gain_in_two_hours_s` [s], the boat and crew, and `exceeds_interval` if known.
        caption: of the picture.
    """
    known = lines.drop_nulls("gain_in_two_hours_s")
    rows = known.sort("gain_in_two_hours_s", "fsn_no", descending=[True, False])
    ends_s = [*rows["gain_in_two_hours_s"], 0.0]
    pictures = []
    for part in rows.iter_slices(MAX_BARS):
        plot = Plot(language, 480, GAIN_ROW_PX * part.height + 70, GAIN_LABEL_PX, 16)
        x = fit_scale(ends_s, plot.left + 36, plot.right - 36)
        plot.add_grid(x, language.say(SECONDS), signed=True)
        for place, row in enumerate(part.to_dicts()):
            _add_gain(plot, x, plot.top + (place + 0.5) * GAIN_ROW_PX, row)
        pictures.append(plot.to_svg(caption))
    return Markup("\n").join(pictures)


def _add_gain(plot: Plot, x: Scale, y: float, row: Row) -> None:
    """Add the bar of a crew, with its name and its seconds."""
    gain_s = row["gain_in_two_hours_s"]
    crew = f"{row['name'] or row['fsn_no']} {row['rowers']}{row['crew_class']}"
    written = plot.language.write_number(gain_s, 0, "+")
    opacity = WITHIN_OPACITY if row.get("exceeds_interval") is False else None
    style = {"stroke-width": 0.7 * GAIN_ROW_PX, "stroke-opacity": opacity}
    ink = INKS[1] if gain_s < 0 else INKS[0]
    plot.add_path(f"M{x(0):.1f} {y:.1f}H{x(gain_s):.1f}", ink, f"{crew}: {written} s", style)
    plot.add_text(GAIN_LABEL_PX - 6, y + 4, crew, "end", size=11)
    side, anchor = (-5, "end") if gain_s < 0 else (5, "start")
    plot.add_text(x(gain_s) + side, y + 4, written, anchor, size=10)


# -- Traces -----------------------------------------------------------------------------------


def _plot_traces(language: Language, seconds: pl.DataFrame) -> tuple[Plot, Mapping[int, Scale]]:
    """Return an empty plot of traces, and by run the scale of its seconds."""
    runs = seconds.partition_by("run", as_dict=True, maintain_order=True)
    plot = Plot(language, TRACE_WIDTH_PX, TRACE_HEIGHT_PX, top=TRACE_TOP_PX)
    width = (plot.right - plot.left) / max(len(runs), 1)
    scales = {}
    for place, ((run,), own) in enumerate(runs.items()):
        start = plot.left + place * width
        last = float(own["second"].max() or 1)  # type: ignore[arg-type]
        scales[int(run)] = Scale(0, last, start, start + width - TRACE_GAP_PX)
    return plot, scales


def _fit_trace_row(seconds: pl.DataFrame, plot: Plot, row: int) -> Scale:
    """Return the scale of a row of traces."""
    top = plot.top + row * TRACE_ROW_PX
    drawn = _stack_columns(seconds, list(dict(TRACES[row][1])))
    return fit_scale(drawn, top + TRACE_ROW_PX - 22, top)


def trace_lines(seconds: pl.DataFrame) -> Markup:
    """Return the lines of the traces of a tow: a picture without words, for both languages.

    Args:
        seconds: rows of `trace_seconds` of a tow.
    """
    plot, scales = _plot_traces(Language("en"), seconds)
    for row, (_, lines) in enumerate(TRACES):
        y = _fit_trace_row(seconds, plot, row)
        for run, x in scales.items():
            own = seconds.filter(run=run)
            for place, (name, dash) in enumerate(lines):
                known = own.drop_nulls(name)
                points = list(zip(map(x, known["second"]), map(y, known[name]), strict=True))
                plot.add_line(points, INKS[place], parts=1, style={"stroke-dasharray": dash})
    return make_standalone(plot.to_svg())


def trace_frame(
    language: Language,
    seconds: pl.DataFrame,
    windows: Sequence[tuple[str, pl.DataFrame]],
    caption: str,
) -> Markup:
    """Return the axes about `trace_lines`, with grey over what does not count and the reason.

    Args:
        language: of what is written.
        seconds: rows of `trace_seconds` of a tow.
        windows: for each method, attributes by which it is chosen, and its rows of `run_points`.
        caption: of the picture.
    """
    plot, scales = _plot_traces(language, seconds)
    for row, (title, _) in enumerate(TRACES):
        y = _fit_trace_row(seconds, plot, row)
        plot.add_text(4, plot.top + row * TRACE_ROW_PX - 6, language.say(title))
        for tick in y.ticks[:: 1 + len(y.ticks) // 5]:
            number = language.write_number(tick, y.decimals)
            plot.add_text(plot.left - 6, y(tick) + 4, number, "end", 10)
    for run, x in scales.items():
        plot.add_text(x.start, 12, f"{language.get_title('run')} {run}", size=11)
    for attributes, points in windows:
        plot.add_group(attributes, "".join(_draw_cuts(language, points, scales, plot)))
    return plot.to_svg(caption)


def _draw_cuts(
    language: Language, points: pl.DataFrame, scales: Mapping[int, Scale], plot: Plot
) -> list[str]:
    """Return grey over the seconds of each run that do not count, with the reason above them."""
    texts = []
    shape = ""
    height = len(TRACES) * TRACE_ROW_PX - 16
    for row in points.to_dicts():
        if row["run"] not in scales:
            continue
        x = scales[row["run"]]
        start, end = row["window_start_s"], row["window_end_s"]
        cuts = [(0, x.high)] if start is None or end is None else [(0, start), (end, x.high)]
        for first, last in cuts:
            if last > first:
                right = x(last)
                shape += f"M{x(first):.1f} {plot.top - 4}H{right:.1f}v{height}H{x(first):.1f}z"
        why = language.write("reason", row["reason"] or row["cut_reason"])
        if why:
            texts.append(f'<text x="{x.start:.1f}" y="25" font-size="9">{escape(why)}</text>')
    return [f'<path d="{shape}" fill="{GREY}" fill-opacity="0.3"/>', *texts]


def _write_tip(language: Language, row: Mapping[str, Any], *names: str) -> str:
    """Return columns of a row with their titles, as pointing at its mark shows them."""
    return ", ".join(f"{language.get_title(n)}: {language.write(n, row[n])}" for n in names)
