"""The finding of 2015 over many simulated histories: how its figures spread from seed to seed.

PYTHONPATH=. python benchmarks/accuracy/finding_2015.py [first seed] [seeds]
"""

import sys
import warnings
from itertools import product

import numpy as np
import polars as pl

from tests.pipeline.finding_2015 import AFTER, AGAINST, BEFORE, LETTERS, PAIR, find

DEFAULTS = ("101", "20")
"""First seed and how many. The tests use others: what is expected does not come from themselves."""
PLACES = list(product((*PAIR, "all"), (BEFORE, AFTER)))


def shift(row):
    ends = (100 * (row[end] - 1) for end in ("shift_ratio", "lo", "hi"))
    text = "{:+5.1f} ({:+5.1f} to {:+5.1f})".format(*ends)
    return f"{text} {'apart' if row['apart'] else 'none '}, n {row['n']:2d}"


DRAWN = {
    "all tows": pl.lit(value=True),
    "newest": pl.col("newest"),
    "all tows, men": pl.col("crew_class") == "H",
}


def spread(name, values):
    mean, sd = np.mean(values), np.std(values, ddof=1)
    print(f"  {name:42s} {mean:.2f}  {sd:.2f}  {min(values):.2f}  {max(values):.2f}")


def main():
    warnings.simplefilter("error")
    first, number = (int(text) for text in (*sys.argv[1:], *DEFAULTS[len(sys.argv) - 1 :]))
    found = []
    print("shift of Cw from 2009-2011 to the next tow, %")
    for seed in range(first, first + number):
        found.append(find(seed))
        for boat_type, method in PLACES:
            line = shift(found[-1].shift(boat_type, method))
            print(f"  {seed:3d} {boat_type:15s} {method:13s} {line}", flush=True)
    print(f"stands apart, of {number} seeds")
    for boat_type, method in PLACES:
        apart = sum(bool(one.shift(boat_type, method)["apart"]) for one in found)
        print(f"  {boat_type:15s} {method:13s} {apart}")
    print("R2 of the lines, mean of both types: mean, sd, lowest, highest over seeds")
    for y, x in product(LETTERS, AGAINST):
        spread(f"{y} on {x}, newest", [one.explained(y, x) for one in found])
    for y, method in product(LETTERS, (BEFORE, AFTER)):
        values = [one.explained(y, "weight", "all", method) for one in found]
        spread(f"{y} on weight, all tows, {method}", values)
    print("R2 of A as the dots of a chart lie")
    for (name, tows), method, x in product(DRAWN.items(), (BEFORE, AFTER), AGAINST):
        spread(f"{name}, {method}, {x}", [one.drawn("A", x, tows, method) for one in found])


if __name__ == "__main__":
    main()
