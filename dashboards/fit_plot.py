"""The picture of `herijk fit`: points, curve and the 95 % band, as SVG."""

from pathlib import Path

import altair as alt
import numpy as np
import polars as pl

from dashboards import drawn
from dashboards.figures.style import HEIGHT, OKABE_ITO, WIDTH, number
from herijk.library.curves import Fit
from pipeline.messages import speaker
from warehouse.store.files import written_beside

BAND_POINTS = 41
MARGIN = 0.05
"""The curve is drawn so much beyond the slowest and the fastest point."""


def write_fit_plot(fit: Fit, path: Path, language: str) -> None:
    """Writes the picture of a fitted curve, in Dutch (nl) or English (en)."""
    say = speaker(language)
    speeds = fit.points.speed_m_s[0]
    speed = np.linspace(speeds.min() * (1 - MARGIN), speeds.max() * (1 + MARGIN), BAND_POINTS)
    band = [{"speed_m_s": v, **fit.cw(float(v))._asdict()} for v in speed]
    points = pl.DataFrame({"speed_m_s": speeds, "value": fit.points.cw_kg_m[0]})
    x = number(alt.X, "speed_m_s", say("Speed through water [m/s]"))
    y = number(alt.Y, "value", say("Cw [kg/m]"))
    low, high = alt.Y("lo:Q", title=say("Cw [kg/m]")), alt.Y2("hi:Q")
    curve = alt.Chart(pl.DataFrame(band))
    chart = alt.layer(
        curve.mark_area(color=OKABE_ITO[5], opacity=0.35).encode(x, low, high),
        curve.mark_line(color="black").encode(x, y),
        alt.Chart(points).mark_point(size=90, filled=True, color=OKABE_ITO[0]).encode(x, y),
    ).properties(width=WIDTH, height=HEIGHT)
    with written_beside(path) as beside:
        beside.write_text(drawn.svg(chart.to_dict(), language), encoding="utf-8")
