"""What changes for a boat between two registers, in the terms in which it is felt.

Compared are lines of the same boat and crew, at the old declared speed: resistance, power at that
speed, and time over a distance at equal power. Which registers are compared is not decided here.
"""

import json
from typing import Final

import numpy as np
import polars as pl

from pipeline.arrays import FloatArray
from pipeline.curve import cw, s_of_b
from pipeline.register import LINE

SAME_RATIO: Final = 5e-4
"""A difference up to 0.05 % counts as the same (research, method.md T21)."""

BISECTIONS: Final = 60


def register_changes(old: pl.DataFrame, new: pl.DataFrame) -> pl.DataFrame:
    """Compares two editions line by line.

    Args:
        old, new: rows of the table `register`, each of one edition.

    Returns:
        Rows of the table `register_changes`.
    """
    pairs = _with_curve(old).join(
        _with_curve(new), on=LINE, how="full", coalesce=True, suffix="_new"
    )
    both = (pl.col("cw_kg_m").is_not_null() & pl.col("cw_kg_m_new").is_not_null()).alias("both")
    pairs = pairs.with_columns(both)
    known = pairs["both"].to_numpy()
    cw_ratio, time_ratio = _ratios(
        pairs.with_columns(pl.col("^b_m_s.*$").fill_null(float("inf"))).fill_null(1.0)
    )
    same = np.abs(cw_ratio - 1.0) <= SAME_RATIO
    change = np.select(
        [known & same, known, pairs["cw_kg_m"].is_null().to_numpy()],
        ["same", "changed", "added"],
        "removed",
    )
    return pairs.select(
        pl.lit(old["edition"][0]).alias("from_edition"),
        pl.lit(new["edition"][0]).alias("to_edition"),
        *LINE,
        pl.Series("change", change, pl.String),
        *(
            pl.when("both").then(pl.Series(values)).alias(name)
            for name, values in (
                ("cw_ratio", cw_ratio),
                ("power_ratio", cw_ratio),
                ("time_ratio", time_ratio),
            )
        ),
        pl.Series("causes", _causes(pairs, known, cw_ratio), pl.String),
    )


def _with_curve(register: pl.DataFrame) -> pl.DataFrame:
    chosen = register.filter(pl.col("cw_kg_m").is_not_null())
    return chosen.select(*LINE, "tow_id", "declared_speed_m_s", "a_kg_m", "b_m_s", "cw_kg_m")


def _ratios(pairs: pl.DataFrame) -> tuple[FloatArray, FloatArray]:
    """New / old Cw at the old declared speed, and new / old time at the power of that speed."""
    speed = pairs["declared_speed_m_s"].to_numpy()
    old = pairs["a_kg_m"].to_numpy(), s_of_b(pairs["b_m_s"].to_numpy())
    new = pairs["a_kg_m_new"].to_numpy(), s_of_b(pairs["b_m_s_new"].to_numpy())
    power = cw(*old, speed) * speed**3
    return cw(*new, speed) / cw(*old, speed), speed / _speed_at_power(*new, power)


def _speed_at_power(a_kg_m: FloatArray, s_s2_m2: FloatArray, power_w: FloatArray) -> FloatArray:
    """The speed at which Cw(v) v^3 is the given power (of the whole crew), by bisection."""
    low = np.zeros_like(power_w)
    high = np.where(s_s2_m2 > 0, 1.0 / np.sqrt(np.where(s_s2_m2 > 0, s_s2_m2, 1.0)), 20.0)
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        below = cw(a_kg_m, s_s2_m2, middle) * middle**3 < power_w
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return low


def _causes(pairs: pl.DataFrame, known: np.ndarray, ratio: FloatArray) -> list[str]:
    """The causes of each change with their factors on Cw, as JSON."""
    same_tow = (pairs["tow_id"] == pairs["tow_id_new"]).fill_null(False).to_list()
    causes = ["method" if same else "tow" for same in same_tow]
    return [
        json.dumps([{"cause": cause, "factor": factor}] if both else [])
        for cause, factor, both in zip(causes, ratio.tolist(), known, strict=True)
    ]
