"""The least that gives the same curves: per tow with pandas and NumPy, in DuckDB's SQL, in Polars.

Each takes files of samples, gives the run points of one method and the curve through those of
each tow, and does only what that method needs: no checks, no other sums, nothing written. The
method is the simplest that corrects for wind (`METHOD`), because a steady window has no natural
form in SQL. All that a rebuild does is in `benchmarks.same`.
"""

import math
from pathlib import Path

import duckdb
import numpy as np
import pandas as pd
import polars as pl
from scipy.optimize import least_squares

from benchmarks.harness import THREADS
from benchmarks.world import HEADERS

METHOD = """
name = "plain"
title = "Method of the benchmark"
description = "Whole runs, log 1, oblique wind with fixed coefficients, a free curve."

[register]
valid_years = 5

[steps]
speed = { source = "log1", correction = "none" }
calibration = { rule = "none" }
window = { rule = "all" }
wind = { model = "oblique", ahead = 0.5, behind = 0.5, side = AIR_SIDE }
run_point = { estimator = "mean_of_ratios" }
temperature = { rule = "none" }
runs = { highest_target_ratio = 1.15 }
curve = { b = "free" }
"""
AHEAD = BEHIND = 0.5
HIGHEST_TARGET_RATIO = 1.15
HALF_RHO = 0.5 * 1.225
CHANNELS = {
    HEADERS[name]: name
    for name in ("run", "log1_m_s", "force_n", "wind_speed_m_s", "wind_angle_deg")
}
MEANS = ["speed_m_s", "gross_kg_m", "ahead", "behind", "side"]
"""Of each run: speed, F/v^2, and the air terms over v^2."""


def pandas_means(tow_id: str, path: Path) -> pd.DataFrame:
    """Means of the runs of one tow."""
    if path.suffix == ".parquet":
        samples = pd.read_parquet(path, columns=list(CHANNELS.values()))
    else:
        samples = pd.read_csv(path, sep=";", decimal=",", usecols=list(CHANNELS)).rename(
            columns=CHANNELS
        )
    values = {name: samples[name].to_numpy(np.float64) for name in CHANNELS.values()}
    speed, angle = values["log1_m_s"], np.radians(values["wind_angle_deg"])
    cos = np.cos(angle)
    along = values["wind_speed_m_s"] * cos
    head = along * np.abs(along) / speed**2
    front = head * np.abs(cos)
    terms = {
        "speed_m_s": speed,
        "gross_kg_m": values["force_n"] / speed**2,
        "ahead": np.maximum(front, 0.0),
        "behind": np.minimum(front, 0.0),
        "side": head * np.abs(np.sin(angle)),
    }
    means = pd.DataFrame(terms).groupby(samples["run"].to_numpy()).mean()
    return means.rename_axis("run").reset_index().assign(tow_id=tow_id)


DUCKDB_MEANS = """
select tow_id, run, avg(v) as speed_m_s, avg(force / (v * v)) as gross_kg_m,
       avg(greatest(head * abs(cosine), 0) / (v * v)) as ahead,
       avg(least(head * abs(cosine), 0) / (v * v)) as behind,
       avg(head * abs(sine) / (v * v)) as side
from (select *, wind * cosine * abs(wind * cosine) as head
      from (select tow_id, run, v::double as v, force::double as force, wind::double as wind,
                   cos(radians(angle::double)) as cosine, sin(radians(angle::double)) as sine
            from ({samples}) join files using (filename)))
group by tow_id, run
"""


def duckdb_means(files: dict[str, str]) -> pl.DataFrame:
    """Means of the runs of all tows in one query."""
    named = pl.DataFrame({"tow_id": list(files), "filename": list(files.values())})
    with duckdb.connect() as connection:
        connection.execute(f"set threads = {THREADS}")
        connection.register("files", named.to_arrow())
        names = list(CHANNELS.values())
        if next(iter(files.values())).endswith(".parquet"):
            source = f"read_parquet({list(files.values())}, filename = true)"
        else:
            names = list(CHANNELS)
            source = (
                f"read_csv({list(files.values())}, filename = true, delim = ';', header = true, "
                "decimal_separator = ',', union_by_name = true)"
            )
        asked = ", ".join(
            f'"{name}" as {short}'
            for name, short in zip(names, ("run", "v", "force", "wind", "angle"), strict=True)
        )
        query = DUCKDB_MEANS.format(samples=f"select filename, {asked} from {source}")
        return pl.DataFrame(connection.sql(query).to_arrow_table())


def polars_means(files: dict[str, str]) -> pl.DataFrame:
    """Means of the runs of all tows from one lazy query."""
    if next(iter(files.values())).endswith(".parquet"):
        samples = pl.scan_parquet(
            list(files.values()), include_file_paths="filename", hive_partitioning=False
        ).select("filename", *CHANNELS.values())
    else:
        samples = pl.concat(
            pl.scan_csv(path, separator=";", decimal_comma=True)
            .select(
                pl.lit(path).alias("filename"), *(pl.col(a).alias(b) for a, b in CHANNELS.items())
            )
            .with_columns(pl.col(b).cast(pl.Float64) for b in list(CHANNELS.values())[1:])
            for path in files.values()
        )
    v, force, wind = (pl.col(c).cast(pl.Float64) for c in ("log1_m_s", "force_n", "wind_speed_m_s"))
    angle = pl.col("wind_angle_deg").cast(pl.Float64).radians()
    along = wind * angle.cos()
    head = along * along.abs() / (v * v)
    front = head * angle.cos().abs()
    found = (
        samples.group_by("filename", "run")
        .agg(
            v.mean().alias("speed_m_s"),
            (force / (v * v)).mean().alias("gross_kg_m"),
            front.clip(lower_bound=0.0).mean().alias("ahead"),
            front.clip(upper_bound=0.0).mean().alias("behind"),
            (head * angle.sin().abs()).mean().alias("side"),
        )
        .collect(engine="streaming")
    )
    tow_of = {path: tow_id for tow_id, path in files.items()}
    return found.with_columns(
        pl.col("filename").replace_strict(tow_of, return_dtype=pl.String).alias("tow_id")
    )


def curves(means: pl.DataFrame, runs: pl.DataFrame, side: float) -> pl.DataFrame:
    """A and 1/B^2 of each tow from the means of its runs, by `least_squares`.

    Args:
        means: `tow_id`, `run` and `MEANS`.
        runs: runs that are selected, with the dimensions and the declared speed of their boat.
        side: drag coefficient of the side.
    """
    front = pl.col("beam_m") * pl.col("bow_height_m") + 0.5
    flank = pl.col("waterline_length_m") * pl.col("bow_height_m") + 1.0
    air = front * (AHEAD * pl.col("ahead") + BEHIND * pl.col("behind")) + flank * side * pl.col(
        "side"
    )
    points = (
        runs.join(means.with_columns(pl.col("run").cast(pl.Int8)), on=["tow_id", "run"])
        .filter(pl.col("speed_m_s") <= HIGHEST_TARGET_RATIO * pl.col("declared_speed_m_s"))
        .with_columns(
            (pl.col("gross_kg_m") - HALF_RHO * air + HALF_RHO * front * AHEAD).alias("cw_kg_m")
        )
        .sort("tow_id", "run")
    )
    fitted = [
        (tow_id, *_fit(rows["speed_m_s"].to_numpy(), rows["cw_kg_m"].to_numpy()))
        for (tow_id,), rows in points.group_by("tow_id", maintain_order=True)
    ]
    return pl.DataFrame(fitted, schema=["tow_id", "a_kg_m", "s_s2_m2"], orient="row")


def _fit(speed: np.ndarray, cw: np.ndarray) -> tuple[float, float]:
    pivot = math.sqrt(float((speed**2).mean()))
    x = (speed / pivot) ** 2 - 1.0
    found = least_squares(
        lambda p: p[0] / (1.0 - p[1] * x) - cw,
        [cw.mean(), 0.1],
        lambda p: np.stack([1.0 / (1.0 - p[1] * x), p[0] * x / (1.0 - p[1] * x) ** 2], axis=1),
        method="lm",
        xtol=1e-14,
        ftol=1e-14,
        gtol=1e-14,
    ).x
    return float(found[0] / (1.0 + found[1])), float(found[1] / (1.0 + found[1]) / pivot**2)
