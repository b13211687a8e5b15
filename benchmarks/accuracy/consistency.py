"""False alarms, power and coverage of the consistency analysis on fleets whose truth is known.

    PYTHONPATH=. python benchmarks/accuracy/consistency.py [repetitions]

One type of like boats; run noise, true spread of B and of heights as stated per line.
"""

import sys
import time
import warnings

import numpy as np
import polars as pl

from pipeline.consistency.components import variance_components
from pipeline.consistency.homogeneity import pooled_curves, type_homogeneity
from pipeline.consistency.lines import type_outliers
from pipeline.consistency.observed import observe
from pipeline.consistency.prediction import predicted_cw, prediction_error
from pipeline.consistency.tables import consistency_tables
from tests.pipeline.consistency_fleet import NO_RACES, POWER, fleet, type_consistency


def share(values):
    return f"{100 * np.mean(values):5.1f} %"


def false_alarms_and_power(n):
    print(
        f"homogeneity test at 5 %, {n} repetitions, {4 * n} of like boats: "
        "boats, run noise, true CV of B, rejected, stated"
    )
    for boats in (5, 8, 12, 20):
        for noise in (0.01, 0.02, 0.03):
            for cv in (0.0, 0.05, 0.10):
                seed = [boats, round(1000 * noise), round(100 * cv)]
                found = type_homogeneity(
                    observe(*fleet(seed, n if cv else 4 * n, boats=boats, noise=noise, b_cv=cv))
                )
                stated = {0.05: "power_at_5pct", 0.10: "power_at_10pct"}.get(cv)
                said = f"{found[stated].mean():.2f}" if stated else ""
                rejected = share(found["p_value"].to_numpy() < 0.05)
                print(f"  {boats:3d} {noise:5.2f} {cv:5.2f}   {rejected}   {said}")


def coverage(n):
    print("slope intervals: boats, height sd, ln Cw on ln displacement, B on weight, q on speed")
    for boats in (5, 8, 12):
        for height in (0.0, 0.02, 0.05):
            lines = type_consistency(
                observe(*fleet(boats, n, boats=boats, b_cv=0.05, height_sd=height))
            )
            pairs = (
                ("ln_cw_standard", "ln_displacement", POWER),
                ("b_m_s", "weight_kg", 0.0),
                ("q", "declared_speed_m_s", 0.0),
            )
            text = []
            for quantity, explaining, truth in pairs:
                row = lines.filter(
                    (pl.col("quantity") == quantity) & (pl.col("explaining") == explaining)
                )
                inside = (row["slope_lo"] <= truth) & (truth <= row["slope_hi"])
                text.append(share(inside.to_numpy()))
            print(f"  {boats:3d} {height:5.2f}   {'   '.join(text)}")


def outliers(n):
    print("types of 12 like boats in which any boat is called outside (5 % wanted), by quantity")
    found = type_outliers(observe(*fleet(4, n, height_sd=0.02, b_cv=0.05)))
    for quantity, group in found.group_by("quantity", maintain_order=True):
        any_outside = group.group_by("method").agg(pl.col("outside").any())["outside"]
        print(f"  {quantity[0]:16s} {share(any_outside.to_numpy())}")


def pooling(n):
    print("RMSE of 1/B^2, pooled in part / own: true CV of B 0, 5, 10 % (12 boats, 2 % noise)")
    for cv in (0.0, 0.05, 0.10):
        tables = fleet(5, n, b_cv=cv)
        rng = np.random.default_rng(5)
        rng.normal(1000, 80, 12)
        rng.uniform(2.4, 2.6, 12)
        true = 1.0 / (4.6 * np.exp(cv * rng.normal(size=(n, 12)))) ** 2
        found = pooled_curves(observe(*tables)).sort("method", "tow_id")
        q = pl.col("q") / (1 + pl.col("q")) / pl.col("standard_speed_m_s") ** 2
        s = {
            p: found.filter(pl.col("pooling") == p).select(q)["q"].to_numpy().reshape(n, 12)
            for p in ("own", "partial", "shared")
        }
        rmse = {p: 100 * np.sqrt(((x / true - 1) ** 2).mean()) for p, x in s.items()}
        print(f"  CV {cv:.2f}: " + ", ".join(f"{p} {x:.1f} %" for p, x in rmse.items()))


def components(n):
    print("variance components (40 boats, 6 seasons): truth, mean estimate, coverage")
    truth = {"boat": 0.04, "season": 0.02, "boat_season": 0.015}
    tables = fleet(
        6,
        n,
        boats=40,
        seasons=range(2010, 2016),
        height_sd=truth["boat"],
        season_sd=truth["season"],
        tow_sd=truth["boat_season"],
        weights_kg=np.full(40, 1000.0),
    )
    found = variance_components(observe(*tables)).filter(pl.col("scope") == "fleet")
    for name, sd in truth.items():
        row = found.filter(pl.col("component") == name)
        inside = (row["lo"] <= sd) & (sd <= row["hi"].fill_null(9.0))
        print(f"  {name:12s} {sd:.3f}  {row['sd_ratio'].mean():.4f}  {share(inside.to_numpy())}")


def prediction(n):
    print("prediction from measures (30 boats, height sd 3 %, 2 % noise)")
    found = prediction_error(predicted_cw(observe(*fleet(7, n, boats=30, height_sd=0.03))))
    print(
        f"  RMSE {100 * found['rmse_ratio'].mean():.2f} %, "
        f"called disagreeing {100 * found['share_disagreeing'].mean():.1f} % (5 wanted)"
    )


def _named(frame, number):
    """Boats and tows of one type under names of their own."""
    own = [c for c in ("tow_id", "fsn_no") if c in frame.columns]
    frame = frame.with_columns((pl.lit(f"t{number}-") + pl.col(c)).alias(c) for c in own)
    if "boat_type" not in frame.columns:
        return frame
    return frame.with_columns(pl.lit(f"type {number}").alias("boat_type"))


def speed():
    parts = [
        fleet(k, 4, boats=20, seasons=range(2010, 2015), b_cv=0.05, height_sd=0.03, season_sd=0.02)
        for k in range(10)
    ]
    parts = [[_named(frame, k) for frame in part] for k, part in enumerate(parts)]
    tables = [pl.concat(frames) for frames in zip(*parts, strict=True)]
    start = time.perf_counter()
    consistency_tables(*tables, NO_RACES)
    print(
        f"everything, {tables[1].height} tows, 4 methods, 10 types: "
        f"{time.perf_counter() - start:.1f} s"
    )


def main():
    warnings.simplefilter("error")
    n = int(sys.argv[1]) if len(sys.argv) > 1 else 500
    speed()
    false_alarms_and_power(n)
    coverage(n)
    outliers(n)
    pooling(n)
    components(max(n // 5, 20))
    prediction(max(n // 10, 20))


if __name__ == "__main__":
    main()
