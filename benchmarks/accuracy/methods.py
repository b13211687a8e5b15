"""How near the truth the methods come, on simulated worlds: one table, next to what is asked.

    PYTHONPATH=. python benchmarks/accuracy/methods.py [worlds]

Each world has ten seasons of 24 tows at 20 Hz and a seed of its own. "clean" worlds have all
instruments and disturbances, but logs that differ between seasons alone, no alterations and no
ageing; "history" worlds have everything. Cw is at the declared speed, relative to truth. A line
that misses what is asked is marked.
"""

import sys
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import polars as pl

from herijk.simulate import AirCoefficients, Defects, WorldSettings
from herijk.simulate.motion import RunTruth
from pipeline.curve import rebase
from pipeline.method.definition import parse_method, shipped_method
from pipeline.recompute.recompute import recompute
from pipeline.studies.ladder import ladder
from tests.worlds import Measured, measure

SEASONS = tuple(range(2009, 2019))
TOWS_PER_SEASON = 24
RATE_HZ = 20
PLANTED_COEFFICIENTS = (0.3, 0.5, 0.7)


@dataclass(frozen=True)
class Line:
    """One figure with what is asked of it."""

    what: str
    asked: str
    measured: str
    holds: bool


def settings(seed: int, defects=Defects.history, air: AirCoefficients | None = None):
    return WorldSettings(SEASONS, TOWS_PER_SEASON, RATE_HZ, seed, defects, air or AirCoefficients())


def main() -> None:
    worlds = int(sys.argv[1]) if len(sys.argv) > 1 else 8
    history = [measure(settings(100 + seed)) for seed in range(worlds)]
    clean = [measure(settings(200 + seed, Defects.clean)) for seed in range(worlds)]
    lines = [*cw_lines(history, clean), *b_lines(history, clean), *end_lines(clean)]
    lines += [*window_lines(history), *exact_lines(history[0])]
    lines += [*coefficient_lines(), *history_lines(history)]
    print(f"Simulated worlds: {worlds} history, {worlds} clean, {TOWS_PER_SEASON} tows per season")
    width = max(len(line.what) for line in lines)
    asked = max(len(line.asked) for line in lines)
    for line in lines:
        mark = " " if line.holds else "!"
        print(f"{mark} {line.what:{width}}  asked {line.asked:{asked}}  measured {line.measured}")


def errors(worlds: list[Measured], method: str, truth: str, first: int, last: int) -> pl.DataFrame:
    """Curves of a method with the truth and the relative error of each tow."""
    frames = [
        recompute(shipped_method(method), world.tows, world.blocks).curves.join(
            world.truth.drop("season"), on="tow_id"
        )
        for world in worlds
    ]
    found = pl.concat(frames).filter(pl.col("season").is_between(first, last))
    return found.drop_nulls("cw_kg_m").with_columns(
        (pl.col("cw_kg_m") / pl.col(truth) - 1.0).alias("error")
    )


def b_lines(history: list[Measured], clean: list[Measured]) -> Iterator[Line]:
    """Intervals of B against the hyperbola nearest to the true curve.

    An interval without upper bound holds every B above its lower bound. How many say so stands
    beside it: were it all of them, the coverage would say little.
    """
    for first, last in ((2014, 9999), (2012, 2013), (2009, 2011)):
        for name, worlds in (("clean", clean), ("history", history)):
            held = pl.concat([b_of_tows(world) for world in worlds]).filter(
                pl.col("season").is_between(first, last)
            )
            upper = pl.col("b_hi_m_s").fill_null(float("inf"))
            inside = held.select(pl.col("true_b").is_between("b_lo_m_s", upper)).to_series()
            when = f"{first} on" if last == 9999 else f"{first}-{last}"
            yield coverage("B", f"{when}, {name}", inside)
            open_above = held["b_hi_m_s"].is_null().mean()
            yield Line("  without an upper bound", "", f"{open_above:.1%}", True)


def b_of_tows(world: Measured) -> pl.DataFrame:
    """Tows with an interval of B, beside the true one."""
    curves = recompute(shipped_method("rebased"), world.tows, world.blocks).curves
    true_b = pl.DataFrame(
        {"tow_id": list(world.nearest_b_m_s), "true_b": list(world.nearest_b_m_s.values())}
    )
    return curves.drop_nulls("b_lo_m_s").join(true_b, on="tow_id")


def coverage(what: str, which: str, inside: pl.Series) -> Line:
    """The share of intervals that hold the truth, and of how many."""
    covered = float(inside.mean())
    return Line(
        f"95 % intervals of {what} cover, {which}",
        "90-98 %",
        f"{covered:.1%} of {inside.len()}",
        0.90 <= covered <= 0.98,
    )


def end_lines(worlds: list[Measured]) -> Iterator[Line]:
    """Intervals away from the declared speed, against the hyperbola nearest to the true curve."""
    frames = []
    for world in worlds:
        made = recompute(shipped_method("rebased"), world.tows, world.blocks)
        true_b = pl.DataFrame(
            {"tow_id": list(world.nearest_b_m_s), "true_b": list(world.nearest_b_m_s.values())}
        )
        frames.append(
            made.curve_points.join(world.tows.select("tow_id", "declared_speed_m_s"), on="tow_id")
            .join(world.truth, on="tow_id")
            .join(true_b, on="tow_id")
        )
    speed, declared, b = (pl.col(c) for c in ("speed_m_s", "declared_speed_m_s", "true_b"))
    true_cw = pl.col("cw_at_15c_kg_m") * (1.0 - (declared / b) ** 2) / (1.0 - (speed / b) ** 2)
    held = pl.concat(frames).with_columns(
        (speed / declared).round(3).alias("ratio"),
        true_cw.is_between("cw_lo_kg_m", "cw_hi_kg_m").alias("inside"),
    )
    for ratio in (0.9, 1.1):
        at = held.filter((pl.col("ratio") == ratio) & (pl.col("season") >= 2014))
        yield coverage(f"Cw at {ratio:.0%} of the declared speed", "2014 on, clean", at["inside"])


def cw_lines(history: list[Measured], clean: list[Measured]) -> Iterator[Line]:
    new = errors(history, "rebased", "cw_at_15c_kg_m", 2014, 9999)
    yield from bias_and_rmse("Cw, rebased, 2014 on", new["error"], 0.003, 0.010)
    within = (new["error"].abs() < 0.02).mean()
    yield Line("  tows within 2 %", "aim: all", f"{within:.1%}", True)
    old = errors(clean, "rebased", "cw_at_15c_kg_m", 2009, 2011)
    yield from bias_and_rmse("Cw, rebased, 2009-2011, clean", old["error"], 0.005, 0.016)
    at_2015 = errors(history, "rebased-2015", "cw_at_tow_temperature_kg_m", 2014, 9999)
    yield from bias_and_rmse("Cw, rebased-2015, 2014 on", at_2015["error"], None, 0.012)
    published = errors(history, "as-published", "cw_at_tow_temperature_kg_m", 2009, 2011)["error"]
    median = published.median()
    yield Line(
        "Cw, as-published, 2009-2011: median error",
        "12 to 25 %",
        f"{median:.1%}",
        0.12 <= median <= 0.25,
    )
    modern = errors(clean, "rebased", "cw_at_15c_kg_m", 2014, 9999)
    for name, held in (
        ("2014 on, history", new),
        ("2014 on, clean", modern),
        ("2012-2013, clean", errors(clean, "rebased", "cw_at_15c_kg_m", 2012, 2013)),
        ("2012-2013, history", errors(history, "rebased", "cw_at_15c_kg_m", 2012, 2013)),
        ("2009-2011, clean", old),
        ("2009-2011, history", errors(history, "rebased", "cw_at_15c_kg_m", 2009, 2011)),
        *(
            (f"{first}-{last}, history, none pulled askew", straight)
            for first, last in ((2012, 2013), (2009, 2011))
            for straight in [
                errors(history, "rebased", "cw_at_15c_kg_m", first, last).filter(askew_ratio=1.0)
            ]
        ),
    ):
        inside = held.select(pl.col("cw_at_15c_kg_m").is_between("cw_lo_kg_m", "cw_hi_kg_m"))
        yield coverage("Cw", name, inside.to_series())


def bias_and_rmse(
    what: str, error: pl.Series, most_bias: float | None, most_rmse: float
) -> Iterator[Line]:
    bias, rmse = error.mean(), float(np.sqrt((error**2).mean()))
    if most_bias is not None:
        yield Line(
            f"{what}: bias", f"within {most_bias:.1%}", f"{bias:+.2%}", abs(bias) <= most_bias
        )
    yield Line(f"{what}: RMSE", f"{most_rmse:.1%}", f"{rmse:.2%}", rmse <= most_rmse)


def window_lines(history: list[Measured]) -> Iterator[Line]:
    found = pl.concat([windows_with_truth(world) for world in history])
    disturbed = found.filter(pl.col("disturbed"))
    left = (disturbed["left_s"] > 2.0).mean()
    yield Line("runs with a ramp or gust: over 2 s of it left", "10 %", f"{left:.1%}", left <= 0.10)
    kept = found.filter(pl.col("clean"))["kept_s"].mean()
    yield Line("clean runs keep", "40 s", f"{kept:.1f} s", kept >= 40.0)


def windows_with_truth(world: Measured) -> pl.DataFrame:
    points = recompute(shipped_method("rebased-2015"), world.tows, world.blocks).run_points
    truth = pl.DataFrame(
        [_run_row(tow_id, run) for tow_id, runs in world.run_truth.items() for run in runs],
        schema_overrides={"run": pl.Int8},
    )
    held = points.drop_nulls("window_start_s").join(truth, on=["tow_id", "run"])
    return held.with_columns(
        (pl.col("window_end_s") - pl.col("window_start_s")).alias("kept_s"),
        (
            (pl.col("from_s") - pl.col("window_start_s")).clip(0)
            + (pl.col("window_end_s") - pl.col("to_s")).clip(0)
        ).alias("left_s"),
    )


def _run_row(tow_id: str, run: RunTruth) -> dict[str, object]:
    kinds = {disturbance.kind for disturbance in run.disturbances}
    return {
        "tow_id": tow_id,
        "run": run.run,
        "from_s": run.undisturbed_start_s,
        "to_s": run.undisturbed_end_s,
        "disturbed": bool(kinds & {"ramp", "gust"}),
        "clean": not kinds,
    }


def exact_lines(world: Measured) -> Iterator[Line]:
    steps = ladder(
        shipped_method("as-published"), shipped_method("rebased"), world.tows, world.blocks
    ).sort("tow_id", "position")
    totals = steps.group_by("tow_id").agg(
        pl.col("factor").product(),
        (pl.col("cw_kg_m").last() / pl.col("cw_kg_m").first()).alias("total"),
    )
    worst = (totals["factor"] / totals["total"] - 1.0).abs().max()
    yield Line("ladder: factors against the total", "1e-4", f"{worst:.0e}", worst <= 1e-4)
    yield closed_form_line(world)


def closed_form_line(world: Measured) -> Line:
    """A / y^2 and B y against recomputing with log speeds multiplied by y, without wind."""
    y = 1.06
    scaled = world.tows.with_columns(pl.lit(y - 1.0).alias("speed_correction_ratio"))
    corrected = parse_method(
        'name = "corrected"\ntitle = "-"\nextends = "rebased-2015"\n[steps]\n'
        'wind = { model = "none" }\nspeed = { correction = "prescribed" }\n'
        'calibration = { rule = "none" }\ncurve = { b = "free" }\n'
        "runs = { highest_target_ratio = 1.5 }\n"
        '[[overrides]]\nrange = "2014:"\ncalibration = { rule = "none" }\n',
        "corrected.toml",
    )
    plain = world.tows.with_columns(pl.lit(0.0).alias("speed_correction_ratio"))
    old = recompute(corrected, plain, world.blocks).curves.sort("tow_id")
    new = recompute(corrected, scaled, world.blocks).curves.sort("tow_id")
    both = old.join(new, on="tow_id", suffix="_new").drop_nulls(["b_m_s", "b_m_s_new"])
    a, b = rebase(both["a_kg_m"].to_numpy(), both["b_m_s"].to_numpy(), y)
    worst = max(
        np.abs(a / both["a_kg_m_new"].to_numpy() - 1.0).max(),
        np.abs(b / both["b_m_s_new"].to_numpy() - 1.0).max(),
    )
    return Line("closed-form re-base against recomputing", "1e-10", f"{worst:.0e}", worst <= 1e-10)


def coefficient_lines() -> Iterator[Line]:
    for planted in PLANTED_COEFFICIENTS:
        world = measure(settings(300, air=AirCoefficients(head=planted, following=planted)))
        points = recompute(shipped_method("rebased"), world.tows, world.blocks).run_points
        found = points["wind_coefficient_ahead"].median()
        yield Line(
            f"archive-wide wind coefficient, planted {planted}",
            "within 0.03",
            f"{found:.3f}",
            abs(found - planted) <= 0.03,
        )


def history_lines(history: list[Measured]) -> Iterator[Line]:
    """How many of the coefficients searched run by run end at a bound, in 2.5 m/s of true wind.

    Counted is the coefficient of the side that the wind came from.
    """
    points = pl.concat(
        [recompute(shipped_method("as-published"), w.tows, w.blocks).run_points for w in history]
    )
    searched = points.filter(pl.col("used") & (pl.col("tow_id") < "2015")).select(
        pl.when(pl.col("wind_angle_deg").is_between(90.0, 270.0))
        .then("wind_coefficient_behind")
        .otherwise("wind_coefficient_ahead")
    )[:, 0]
    share = ((searched <= 0.0) | (searched >= 1.0)).mean()
    yield Line(
        "as-published: coefficients at 0 or 1", "30-60 %", f"{share:.0%}", 0.30 <= share <= 0.60
    )


if __name__ == "__main__":
    main()
