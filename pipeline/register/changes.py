"""What changes for a boat between two registers, and why.

Lines of the same boat and crew are compared at the old declared speed: resistance, power, and time
at equal power. The change is written as a product of factors with a cause each: first what the old
line becomes under the new method (the old tow is re-based, step by step), then what remains.
"""

import json
import math
from typing import Final

import numpy as np
import polars as pl

from pipeline.arrays import FloatArray
from pipeline.crews import STANDARD_CREWS, get_usual_power
from pipeline.curve import VALID_RATIO, cw
from pipeline.races.power import find_line_curves, speed_at_power
from pipeline.races.race import power_per_rower_w
from pipeline.register.causes import NO_FACTOR
from pipeline.register.register import LINE
from pipeline.tables.row import Row, get_key

SAME_RATIO: Final = 5e-4
"""A curve that differs by at most 0.05 % anywhere between 85 and 115 % of the declared speed is the
same curve (docs/method-details.md, 11; inferred)."""

RACE_S: Final = 7200.0
"""Duration of the race in which a change is expressed in seconds."""

OTHER_POWER_W: Final = 70.0
"""Power per rower at which boats of another federation's classes are ranked by speed."""

SHOWN: Final = ("a_kg_m", "b_m_s", "cw_kg_m", "declared_speed_m_s", "rank", "tow_id")
"""Columns of both registers that stand beside each other in a comparison."""

COMPARED: Final = (
    "tow_id", "a_kg_m", "b_m_s", "cw_kg_m", "declared_speed_m_s", "cw_lo_kg_m", "cw_hi_kg_m",
)  # fmt: skip


def compare_lines(
    old: pl.DataFrame,
    new: pl.DataFrame,
    parts: pl.DataFrame | None = None,
    grounds: pl.DataFrame | None = None,
) -> pl.DataFrame:
    """Compare two registers line by line.

    Args:
        old, new: rows of the table `register`, each of one edition.
        parts: factors of known causes, in order: `LINE`, `cause`, `step` (of a method), `factor`.
        grounds: per line the `ground`, which names the factor that the parts leave over. Without
            it that is `printed` where a line has no tow, `tow` where another tow counts, else
            `method`.

    Returns:
        Per line with a curve in either register the columns of the table `register_changes`.
        `causes` is a JSON list of `cause`, `factor` and, for a method, `step`; the factors multiply
        to `cw_ratio`. Added are:

        - `cw_ratio_slow`, `cw_ratio_fast`: new / old Cw at 85 and 115 % of the old declared speed;
          a line is `same` only where both curves agree over that range;
        - `old_` and `new_` tow, A, B, Cw, declared speed and rank: the place in the class at equal
          power per rower, 1 is the fastest;
        - `old_power_w`, `new_power_w` per rower at the old declared speed;
        - `gain_in_two_hours_s`: seconds that the new register gives in a race of two hours;
        - `exceeds_interval`: whether the change is larger than the 95 % intervals of both; of two
          numbers from one tow, which share its errors, than that of the old one. Null where an
          interval is not known.

        A ratio is null where the new curve does not reach that speed.
    """
    pairs = (
        _rank(old)
        .join(
            _rank(new),
            on=LINE,
            how="full",
            coalesce=True,
            suffix="_new",
            maintain_order="left_right",
        )
        .sort(LINE)
    )
    in_both = (pairs["cw_kg_m"].is_not_null() & pairs["cw_kg_m_new"].is_not_null()).to_numpy()
    speed = pairs["declared_speed_m_s"].fill_null(1.0).to_numpy()
    old_a, old_s = _find_filled_curves(pairs, "")
    new_a, new_s = _find_filled_curves(pairs, "_new")

    def ratio_at(share: float) -> FloatArray:
        ratio = cw(new_a, new_s, share * speed) / cw(old_a, old_s, share * speed)
        return np.where(in_both, ratio, np.nan)

    slow, declared, fast = ratio_at(VALID_RATIO[0]), ratio_at(1.0), ratio_at(VALID_RATIO[1])
    compared = in_both & np.isfinite(declared)
    power = np.where(compared, cw(old_a, old_s, speed), 0.0) * speed**3
    same_power_speed = speed_at_power(new_a, new_s, power)
    time_ratio = speed / np.where(compared & (same_power_speed > 0), same_power_speed, np.nan)

    largest = np.max(np.abs(np.nan_to_num(np.stack([slow, declared, fast]) - 1.0, nan=np.inf)), 0)
    change = np.select(
        [in_both & (largest <= SAME_RATIO), in_both, pairs["cw_kg_m"].is_null().to_numpy()],
        ["same", "changed", "added"],
        "removed",
    )
    old_width, new_width = _half_width(pairs, ""), _half_width(pairs, "_new")
    is_same_tow = (pairs["tow_id"] == pairs["tow_id_new"]).fill_null(False).to_numpy()
    width = np.where(is_same_tow, old_width, np.hypot(old_width, new_width))
    exceeds = np.abs(np.log(np.where(compared, declared, 1.0))) > width
    old_power = power_per_rower_w(pairs["cw_kg_m"], speed, pairs["rowers"])
    causes = _explain(pairs, np.where(compared, declared, np.nan), parts, grounds)

    def known(values: FloatArray | np.ndarray, where: np.ndarray = compared) -> pl.Expr:
        return pl.when(pl.Series(where)).then(pl.Series(values))

    return pairs.select(
        pl.lit(old["edition"].first(), pl.String).alias("from_edition"),
        pl.lit(new["edition"].first(), pl.String).alias("to_edition"),
        pl.col(LINE),
        pl.Series("change", change, pl.String),
        known(declared).alias("cw_ratio"),
        known(declared).alias("power_ratio"),
        known(time_ratio).alias("time_ratio"),
        pl.Series("causes", causes, pl.String),
        known(slow, np.isfinite(slow)).alias("cw_ratio_slow"),
        known(fast, np.isfinite(fast)).alias("cw_ratio_fast"),
        pl.col(SHOWN).name.prefix("old_"),
        pl.col([f"{name}_new" for name in SHOWN]).name.replace("^(.*)_new$", "new_$1"),
        pl.Series("old_power_w", old_power).fill_nan(None),
        known(old_power * declared).alias("new_power_w"),
        known(RACE_S * (time_ratio - 1.0)).alias("gain_in_two_hours_s"),
        known(exceeds, compared & np.isfinite(width)).alias("exceeds_interval"),
    )


def sort_largest_first(lines: pl.DataFrame) -> pl.DataFrame:
    """Sort lines by the size of their change, whatever its sign; those without a ratio on top."""
    size = pl.col("cw_ratio").log().abs().fill_null(math.inf)
    return lines.sort(-size, pl.col(LINE))


def _find_filled_curves(pairs: pl.DataFrame, suffix: str) -> tuple[FloatArray, FloatArray]:
    """Return A and s = 1/B^2; where a register has no line, those of a harmless curve."""
    a, s = find_line_curves(pairs, suffix)
    has_curve = np.isfinite(a) & np.isfinite(s)
    return np.where(has_curve, a, 1.0), np.where(has_curve, s, 0.0)


def _rank(register: pl.DataFrame) -> pl.DataFrame:
    """Return lines with a curve, and their rank by speed at equal power within the class."""
    lines = register.drop_nulls("cw_kg_m").select(pl.col(LINE), pl.col(COMPARED))
    usual_power_w = get_usual_power(STANDARD_CREWS)
    power = lines["rowers"] * lines["crew_class"].replace_strict(
        usual_power_w, default=OTHER_POWER_W, return_dtype=pl.Float64
    )
    a, s = find_line_curves(lines)
    speed = pl.Series(speed_at_power(a, s, power.to_numpy()))
    rank = pl.col("speed").rank("min", descending=True).over("crew_class").cast(pl.Int32)
    return lines.with_columns(speed=speed).with_columns(rank=rank).drop("speed")


def _half_width(pairs: pl.DataFrame, suffix: str) -> FloatArray:
    """Return half the 95 % interval of ln Cw; infinite where it is not known."""
    low = pairs[f"cw_lo_kg_m{suffix}"].to_numpy()
    high = pairs[f"cw_hi_kg_m{suffix}"].to_numpy()
    known = np.isfinite(low) & np.isfinite(high) & (low > 0)
    ratio = np.where(known, high, 1.0) / np.where(known, low, 1.0)
    return np.where(known, 0.5 * np.log(ratio), np.inf)


def _explain(
    pairs: pl.DataFrame,
    ratios: FloatArray,
    parts: pl.DataFrame | None,
    grounds: pl.DataFrame | None,
) -> list[str]:
    """Return the causes of each change as JSON: known parts, and a factor for what remains."""
    parts_of, ground_of = {}, {}
    if parts is not None:
        moved = parts.filter((pl.col("factor") - 1.0).abs() > NO_FACTOR)
        parts_of = moved.rows_by_key(LINE, named=True)
    if grounds is not None:
        ground_of = dict(zip(grounds.select(LINE).rows(), grounds["ground"], strict=True))
    explained = []
    for pair, ratio in zip(pairs.iter_rows(named=True), ratios.tolist(), strict=True):
        causes: list[Row] = []
        line = get_key(pair, LINE)
        if math.isfinite(ratio):
            for part in parts_of.get(line, ()):
                known = {name: value for name, value in part.items() if value is not None}
                causes.append(known)
            remainder = ratio / math.prod(cause["factor"] for cause in causes)
            if abs(remainder - 1.0) > NO_FACTOR or not causes:
                ground = "method" if pair["tow_id"] == pair["tow_id_new"] else "tow"
                if pair["tow_id"] is None or pair["tow_id_new"] is None:
                    ground = "printed"
                causes.append({"cause": ground_of.get(line, ground), "factor": remainder})
        explained.append(json.dumps(causes))
    return explained
