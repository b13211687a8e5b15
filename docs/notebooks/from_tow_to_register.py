"""From a tow to a line of the register: a marimo notebook.

Look at it with `marimo edit docs/notebooks/from_tow_to_register.py`; run it without a browser as
any Python file. It reads the data folder that HERIJK_DATA names, or that of `make demo`.
"""

import marimo

app = marimo.App()

with app.setup:
    import os

    import marimo as mo
    import polars as pl

    import herijk
    from dashboards.language import Language
    from dashboards.plot import INKS, Plot

    METHOD = "rebased-2015"


@app.cell
def _():
    mo.md("""
    # From a tow to a line of the register

    A boat is towed six times, three out and three back, at about 90, 100 and 110 % of the speed its
    crew declared. A log reads the speed and a load cell the force. This page follows one tow from
    those samples to the line of the register.
    """)


@app.cell
def _():
    data = herijk.open_data(os.environ.get("HERIJK_DATA", "demo/data"))
    register = data.register(f"concept-{METHOD}")
    known = register.drop_nulls("cw_kg_m").sort("tow_date", "fsn_no", "rowers")
    line = known.row(-1, named=True)
    tow = data.table("tows").filter(pl.col("tow_id") == line["tow_id"]).row(0, named=True)
    return data, line, tow


@app.cell
def _(data, tow):
    samples = data.samples(tow["tow_id"])
    rate_hz = tow["sample_rate_hz"]
    seconds = samples.with_columns(second=pl.int_range(pl.len()).over("run") // rate_hz)
    means = seconds.group_by("run", "second", maintain_order=True).agg(pl.col(pl.Float32).mean())
    _plot = Plot(Language("en"))
    _x, _y = _plot.fit_x(means["second"]), _plot.fit_y(means["log1_m_s"])
    _plot.add_axes(_x, _y, "time in the run [s]", "speed by log 1 [m/s]")
    for _ink, (_, _run) in zip(INKS, means.group_by("run", maintain_order=True), strict=False):
        _places = zip(map(_x, _run["second"]), map(_y, _run["log1_m_s"]), strict=True)
        _plot.add_line(list(_places), _ink)
    trace = mo.Html(_plot.to_svg("Speed in each run"))
    mo.vstack([mo.md(f"## 1. Samples\n\n{samples.height} of tow {tow['tow_id']}."), trace])
    return rate_hz, samples


@app.cell
def _(rate_hz, samples, tow):
    found = herijk.apply_method(herijk.method(METHOD), samples, tow, rate_hz)
    points = found.run_points.select("run", "speed_m_s", "cw_kg_m", "used")
    mo.vstack(
        [
            mo.md(
                "## 2. Run points\n\nOf each run the method takes a steady window, corrects speed,"
                " wind and temperature, and has one point: speed and Cw = F / v^2 [kg/m]."
            ),
            points,
        ]
    )
    return found, points


@app.cell
def _(found, points):
    curve = found.curves.row(0, named=True)
    drawn = herijk.Curve.from_a_b(curve["a_kg_m"], curve["b_m_s"])
    speeds = [0.8 * curve["declared_speed_m_s"] + 0.01 * i for i in range(120)]
    heights = list(drawn.cw_kg_m(speeds))
    _plot = Plot(Language("en"))
    _x, _y = _plot.fit_x(speeds), _plot.fit_y([*heights, *points["cw_kg_m"]])
    _plot.add_axes(_x, _y, "speed through water [m/s]", "Cw [kg/m]")
    _plot.add_line(list(zip(map(_x, speeds), map(_y, heights), strict=True)), INKS[0])
    for _speed, _cw in points.select("speed_m_s", "cw_kg_m").drop_nulls().rows():
        _plot.add_point(_x(_speed), _y(_cw), 1, f"{_cw:.2f} kg/m at {_speed:.2f} m/s")
    picture = mo.Html(_plot.to_svg("The curve and the points of the runs"))
    b_text = "no B" if curve["b_m_s"] is None else f"B = {curve['b_m_s']:.2f} m/s"
    mo.vstack(
        [
            mo.md(
                "## 3. The curve\n\nThrough the points goes Cw = A / (1 - (v/B)^2):"
                f" A = {curve['a_kg_m']:.2f} kg/m, {b_text}."
            ),
            picture,
        ]
    )
    return (curve,)


@app.cell
def _(curve, line):
    mo.md(f"""
    ## 4. The register

    The line of the register has Cw at the declared speed: **{line["cw_kg_m"]:.2f} kg/m**
    ({line["cw_lo_kg_m"]:.2f} to {line["cw_hi_kg_m"]:.2f}), from this tow:
    {curve["cw_kg_m"]:.2f} kg/m. At {line["declared_speed_m_s"]:.2f} m/s that takes
    {curve["cw_kg_m"] * line["declared_speed_m_s"] ** 3 / line["rowers"]:.0f} W per rower.
    """)


if __name__ == "__main__":
    app.run()
