"""How near the season log factors, run-point uncertainties and ensembles come to a known truth.

    PYTHONPATH=. python benchmarks/accuracy/season.py [worlds]

Worlds are those of tests/pipeline/season_worlds.py; the limits in
the table are the goals of the project.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"  # read when numpy is imported, so before it
os.environ["OPENBLAS_NUM_THREADS"] = "1"

import sys
import time
from dataclasses import replace

import numpy as np
import polars as pl

from pipeline import season_log
from pipeline.uncertainty import ensemble
from pipeline.uncertainty import propagation as uncertainty
from tests.pipeline import season_worlds
from tests.pipeline.season_worlds import CLEAN, HARD, simulate

OLD = (2009, 2010, 2011)


def recovered(setup, worlds):
    """Errors in percentage points and whether the intervals hold the truth, (worlds, seasons)."""
    held = {name: [] for name in ("error", "covered", "other_error", "other_covered", "agreement")}
    ageing = []
    for seed in range(worlds):
        world = simulate(setup, seed)
        found = season_log.estimate_season_factors(world.tows)
        ageing.append((found.ageing_per_year - setup.ageing_per_year) / found.ageing_sd)
        column = {c: found.factors[c].to_numpy() for c in found.factors.columns}
        truth = np.exp([world.ln_factor[season] for season in column["season"]])
        held["error"].append(100 * (column["factor"] - truth))
        held["covered"].append((column["lo"] <= truth) & (truth <= column["hi"]))
        held["other_error"].append(100 * (column["factor_no_boats"] - truth))
        inside = (column["lo_no_boats"] <= truth) & (truth <= column["hi_no_boats"])
        held["other_covered"].append(inside)
        held["agreement"].append(column["agreement"])
    return {name: np.array(values) for name, values in held.items()}, np.array(ageing)


def report_recovery(name, setup, worlds, limit, aim):
    held, ageing = recovered(setup, worlds)
    error, covered, other = held["error"], held["covered"], held["other_error"]
    rmse = np.sqrt((error**2).mean(axis=0))
    old = error[:, : len(OLD)]
    within = (np.abs(old).max(axis=1) <= limit).mean()
    print(f"\n{name}: {worlds} worlds, percentage points of speed")
    print(f"  RMSE 2009..2013      {rmse.round(3)}")
    print(f"  bias 2009..2013      {error.mean(axis=0).round(3)}")
    rms = np.sqrt((old**2).mean())
    print(f"  RMSE of 2009-2011    {rms:.3f}   (at least {limit}, aim {aim})")
    print(f"  within {limit}           {(np.abs(old) <= limit).mean():.3f} of the seasons,", end="")
    print(f" {within:.3f} of the worlds in all three seasons")
    print(
        f"  95 % interval holds  {covered.mean():.3f} of {covered.size} (at least 0.90-0.99,"
        f" aim 0.93-0.97)   by season {covered.mean(axis=0).round(3)}"
    )
    print(f"  ageing: beyond 2 sd in {(np.abs(ageing) > 2).mean():.3f}")
    print(f"  without boats: RMSE  {np.sqrt((other**2).mean(axis=0)).round(3)}")
    print(f"    its interval holds {held['other_covered'].mean():.3f}", end="")
    print(f"; disagreement beyond 2 sd in {(np.abs(held['agreement']) > 2).mean():.3f}")


def named(setup, season, worlds):
    """Share of worlds by named cause."""
    causes = []
    for seed in range(worlds):
        world = simulate(setup, seed)
        found = season_log.estimate_season_factors(world.tows)
        causes.append(found.steps.filter(pl.col("season") == season)["cause"][0])
    names, counts = np.unique(causes, return_counts=True)
    return dict(zip(names.tolist(), (counts / worlds).round(3).tolist(), strict=True))


def report_causes(worlds):
    log = ((2010, 1.06),)
    none = ((2010, 1.0),)
    print(f"\nplanted steps, {worlds} worlds each (at least 95 % in clean worlds)")
    for name, base in (
        ("clean", CLEAN),
        ("clean, 2 % run noise", replace(CLEAN, run_noise=0.02)),
        ("hard", HARD),
    ):
        print(f"  {name}")
        print(f"    6 % log in 2010      {named(replace(base, log_factors=log), 2010, worlds)}")
        force = replace(base, log_factors=none, force_step=(2010, 0.16))
        print(f"    16 % force in 2010   {named(force, 2010, worlds)}")
        late = replace(base, force_step=(2016, 0.16))
        both = replace(base, force_step=(2010, 0.16))
        print(f"    the same, log off too {named(both, 2010, worlds)}")
        print(f"    16 % force in 2016   {named(late, 2016, worlds)}")


def report_run_points():
    print("\nrun-point uncertainty, estimate / truth (goal: within 15 % pooled over 36 runs)")
    for runs in (6, 36, 144):
        for seconds in (30, 50):
            ratio = season_worlds.run_point_ratios(runs, seconds)
            print(
                f"  {runs:4d} runs of {seconds} s   {ratio.mean():.2f} +- {ratio.std():.2f}, "
                f"within 15 % in {(np.abs(ratio - 1) < 0.15).mean():.2f}"
            )


def report_ensemble():
    found, lines, held = season_worlds.register(simulate(HARD, 1))
    members = ensemble.register_ensemble(lines, held, found)
    u = lines.join(uncertainty.combine(held), on="tow_id", maintain_order="left")["u_ratio"]
    ratio = np.log(members).std(axis=0, ddof=1) / u.to_numpy()
    print(f"\nensemble of {len(members)}, {lines.height} lines: sd / analytic u", end=" ")
    print(f"{ratio.mean():.3f} +- {ratio.std():.3f} (sampling error 0.050),", end=" ")
    print(f"within 10 % in {(np.abs(ratio - 1) < 0.1).mean():.3f} (expected 0.954, goal 0.95)")


def report_speed():
    world = simulate(replace(HARD, boats=400, tows_a_season=100), 1)
    start = time.perf_counter()
    found, lines, held = season_worlds.register(world)
    middle = time.perf_counter()
    ensemble.as_frame(lines, ensemble.register_ensemble(lines, held, found))
    end = time.perf_counter()
    print(
        f"\n{world.tows.height} tows, one thread: factors and budget {middle - start:.2f} s,",
        end="",
    )
    print(f" 200 members {end - middle:.2f} s (goal 5 s)")


def main():
    worlds = int(sys.argv[1]) if len(sys.argv) > 1 else 300
    start = time.perf_counter()
    report_recovery("clean", CLEAN, worlds, 0.5, 0.15)
    report_recovery("hard", HARD, worlds, 0.8, 0.35)
    report_recovery(
        "clean, 150 boats", replace(CLEAN, boats=150, tows_a_season=37), worlds, 0.5, 0.15
    )
    report_recovery(
        "thin: hard, 20 boats", replace(HARD, boats=20, tows_a_season=6), worlds, 2.0, 1.13
    )
    report_causes(max(worlds // 3, 20))
    report_run_points()
    report_ensemble()
    report_speed()
    print(f"\n{time.perf_counter() - start:.0f} s in all")


if __name__ == "__main__":
    main()
