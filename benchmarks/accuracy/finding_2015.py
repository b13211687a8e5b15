"""The finding of 2015 over many simulated histories: how its figures spread from seed to seed.

PYTHONPATH=. python benchmarks/accuracy/finding_2015.py [seeds]
"""

import sys
import warnings

import numpy as np
import polars as pl

from tests.pipeline.finding_2015 import AFTER, AGAINST, BEFORE, LETTERS, PAIR, find

FIRST_SEED = 101
"""The tests use other seeds: what is expected of them does not come from themselves."""


def shift(row):
    ends = (100 * (row[end] - 1) for end in ("shift_ratio", "lo", "hi"))
    text = "{:+5.1f} ({:+5.1f} to {:+5.1f})".format(*ends)
    return f"{text} {'apart' if row['apart'] else 'none '}, n {row['n']:2d}"


DRAWN = {
    "all tows": pl.lit(value=True),
    "newest": pl.col("newest"),
    "2014": pl.col("season") == 2014,
    "2014, men": (pl.col("season") == 2014) & (pl.col("crew_class") == "H"),
    "all tows, men": pl.col("crew_class") == "H",
}


def spread(name, values):
    mean, sd = np.mean(values), np.std(values, ddof=1)
    print(f"  {name:42s} {mean:.2f}  {sd:.2f}  {min(values):.2f}  {max(values):.2f}")


def main():
    warnings.simplefilter("error")
    seeds = range(FIRST_SEED, FIRST_SEED + (int(sys.argv[1]) if len(sys.argv) > 1 else 16))
    shares = {f"{y} on {x}": [] for x in AGAINST for y in LETTERS}
    all_tows = {
        f"{y} on weight, {m}": [] for y in LETTERS for m in (BEFORE, AFTER)
    }
    drawn = {(name, m, x): [] for name in DRAWN for m in (BEFORE, AFTER) for x in AGAINST}
    apart = {(t, m): [] for t in (*PAIR, "all") for m in (BEFORE, AFTER)}
    print("shift of Cw from 2009-2011 to the next tow, %")
    for seed in seeds:
        found = find(seed)
        for x in AGAINST:
            for y in LETTERS:
                shares[f"{y} on {x}"].append(found.explained(y, x))
        for y in LETTERS:
            for m in (BEFORE, AFTER):
                all_tows[f"{y} on weight, {m}"].append(found.explained(y, "weight", "all", m))
        for (name, m, x), values in drawn.items():
            values.append(found.drawn("A", x, DRAWN[name], m))
        for (boat_type, method), verdicts in apart.items():
            row = found.shift(boat_type, method)
            verdicts.append(row["apart"])
            print(f"  {seed:3d} {boat_type:15s} {method:13s} {shift(row)}", flush=True)
    print(f"stands apart, of {len(seeds)} seeds")
    for (boat_type, method), verdicts in apart.items():
        print(f"  {boat_type:15s} {method:13s} {sum(map(bool, verdicts))}")
    print("R2, mean of both types: mean, sd, lowest, highest over seeds")
    for name, values in shares.items():
        spread(name, values)
    print("the same over all tows of all seasons")
    for name, values in all_tows.items():
        spread(name, values)
    print("R2 of A as the dots of a chart lie")
    for name, values in drawn.items():
        spread(", ".join(name), values)
    for x in AGAINST:
        ahead = np.array(shares[f"Cw on {x}"]) - shares[f"A on {x}"]
        print(f"  Cw - A on {x:12s} {ahead.mean():.2f}  {ahead.std(ddof=1):.2f}  {ahead.min():.2f}")


if __name__ == "__main__":
    main()
