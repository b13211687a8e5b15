"""How often verdicts on types are false on boats of known truth, and how often they are found.

    PYTHONPATH=. python -m benchmarks.accuracy.types [--archives 100] [--write FILE]

Tows are drawn directly (`tests.pipeline.consistency_fleet`): a type of 8 or 14 boats towed in ten
seasons, and thirty boats of no type that are towed twice, whose repeat tows tell the measuring
errors. It takes two to three minutes.
"""

import os

os.environ["OPENBLAS_NUM_THREADS"] = "1"
os.environ["POLARS_MAX_THREADS"] = "1"

import argparse
from pathlib import Path

import numpy as np
import polars as pl

from tests.pipeline.consistency_fleet import compared, fleet

ARCHIVE = {
    "seasons": tuple(range(2009, 2019)),
    "seasons_in_turn": True,
    "others": 30,
    "noise": 0.012,
    "tow_sd": 0.006,
}
SETS = {"8 men's crews": (8, 0), "4 men's, 4 women's": (8, 4), "7 men's, 7 women's": (14, 7)}
"""Boats of the type, and how many of them have women's crews."""

EQUAL_BOATS = {
    "as the intervals say": {},
    "zero of the load cell 5 N": {"zero_sd_n": 5.0},
    "log reads v^(1 ± 0.03)": {"log_exponent_sd": 0.03},
    "errors 1.3 times the intervals": {"tow_sd": 0.01, "interval_ratio": 1.0 / 1.3},
    "2 % shared by a season": {"season_sd": 0.02},
    "hulls with a hump, no hyperbolas": {"hump": 0.02},
}
DIFFERENT_BOATS = {
    "Cw spreads 3 %": {"height_sd": 0.03},
    "Cw spreads 5 %": {"height_sd": 0.05},
    "B spreads 10 %": {"b_cv": 0.10},
    "one boat 8 % off": {"boat_off": 0.08},
}
QUANTITIES = ("cw_standard_kg_m", "b_m_s", "a_kg_m")
SEED = 6000


def judge(boats: int, women: int, archives: int, truth: dict[str, float]) -> pl.DataFrame:
    """Return the verdicts on the type in every archive."""
    options = ARCHIVE | truth | {"boats": boats, "women": women}
    return compared(*fleet(SEED, archives, **options)).consistency.filter(boat_type="like")


def share(rows: pl.DataFrame, column: str, *verdicts: str | bool) -> str:
    """Return the share of rows with such a verdict in per cent, by quantity."""
    shares = [
        rows.filter(quantity=quantity)[column].is_in(verdicts).mean() for quantity in QUANTITIES
    ]
    return " / ".join(f"{100 * value:.0f}" for value in shares)


def table(archives: int) -> list[str]:
    """Return the lines of the table, in Markdown."""
    error = 100.0 * np.sqrt(0.05 * 0.95 / archives)
    lines = [
        "# Verdicts on types of known truth",
        "",
        f"Made by `python -m benchmarks.accuracy.types`, {archives} archives a row; in per cent, "
        f"of Cw / B / A. A share of 5 % is known to ± {error:.1f}.",
        "",
        "Boats that are equal:",
        "",
        "| errors | boats | said to differ | said to be equal | follow weight | follow tow speed "
        "| a boat stands out |",
        "| --- | --- | --- | --- | --- | --- | --- |",
    ]
    for errors, truth in EQUAL_BOATS.items():
        for name, (boats, women) in SETS.items():
            rows = judge(boats, women, archives, truth)
            outside = rows.with_columns(outside=pl.col("outside").list.len() > 0)
            cells = [
                share(rows, "verdict", "differ"),
                share(rows, "verdict", "equal"),
                share(rows, "weight_verdict", "rises", "falls"),
                share(rows, "tow_speed_verdict", "rises", "falls"),
                share(outside, "outside", True),
            ]
            lines.append(f"| {errors} | {name} | {' | '.join(cells)} |")
    lines += [
        "",
        "Boats that differ:",
        "",
        "| truth | boats | said to differ | said to be equal | boat 0 is the farthest in Cw |",
        "| --- | --- | --- | --- | --- |",
    ]
    for name_of_truth, truth in DIFFERENT_BOATS.items():
        for name, (boats, women) in SETS.items():
            rows = judge(boats, women, archives, truth)
            farthest = rows.filter(quantity=QUANTITIES[0])["farthest"] == "FSN000"
            cells = [
                share(rows, "verdict", "differ"),
                share(rows, "verdict", "equal"),
                f"{100 * farthest.mean():.0f}",
            ]
            lines.append(f"| {name_of_truth} | {name} | {' | '.join(cells)} |")
    return lines


def main() -> None:
    """Print the table, and write it where asked."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--archives", type=int, default=100)
    parser.add_argument("--write", type=Path)
    asked = parser.parse_args()
    text = "\n".join(table(asked.archives)) + "\n"
    print(text)
    if asked.write:
        asked.write.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
