"""What changes for a boat between two registers, in terms that crews notice, and why.

Compared are lines of the same boat and crew, at the old declared speed: resistance, power at that
speed, and time over a distance at equal power. Which registers are compared, and what is known
about their inputs and code, is not decided here.
"""

import json
import math
from typing import Final

import numpy as np
import polars as pl

from pipeline.arrays import FloatArray
from pipeline.assessment.seen import POWER_W
from pipeline.choice import SAME_SHARE
from pipeline.curve import cw
from pipeline.races.power import curve_of_lines, speed_at_power
from pipeline.races.race import power_per_rower_w
from pipeline.register.register import LINE
from pipeline.tables.frames import dtypes
from pipeline.tables.register import Register, RegisterChanges
from pipeline.tables.row import Row
from pipeline.tables.studies import CorrectionSteps

SAME_RATIO: Final = 5e-4
"""A difference up to 0.05 % counts as the same (docs/method-details.md, 11; inferred)."""

NO_FACTOR: Final = SAME_SHARE
"""A factor this near to 1 is rounding and is not listed as a cause."""

RACE_S: Final = 7200.0
"""The race in which a change is expressed in seconds."""

PART_SCHEMA: Final = {
    **{name: dtypes(Register)[name] for name in LINE},
    "cause": pl.String(),
    **{name: dtypes(CorrectionSteps)[name] for name in ("step", "factor")},
}
BOTH: Final = ("a_kg_m", "b_m_s", "cw_kg_m", "declared_speed_m_s", "rank", "tow_id")
"""What is said of a line under both editions."""

NUMBERS: Final = ("tow_id", *BOTH[:4], "cw_lo_kg_m", "cw_hi_kg_m")

NO_PARTS: Final = pl.DataFrame(schema=PART_SCHEMA)
"""Parts of changes whose cause is known: per line and cause a factor on Cw; `step` where the cause
is the method."""


def register_changes(
    old: pl.DataFrame,
    new: pl.DataFrame,
    parts: pl.DataFrame = NO_PARTS,
    grounds: pl.DataFrame | None = None,
) -> pl.DataFrame:
    """Rows of the table `register_changes`: what `compare_lines` says without both numbers."""
    return compare_lines(old, new, parts, grounds).select(RegisterChanges.column_names())


def compare_lines(
    old: pl.DataFrame,
    new: pl.DataFrame,
    parts: pl.DataFrame = NO_PARTS,
    grounds: pl.DataFrame | None = None,
) -> pl.DataFrame:
    """Compares two editions line by line.

    A change is the product of its known parts and of one factor for everything else, whose name
    the caller knows too.

    Args:
        old, new: rows of the table `register`, each of one edition.
        parts: what is known of the causes, in order; `PART_SCHEMA`.
        grounds: per line the `ground` of what the parts do not explain; without it `printed` where
            a line names no tow, `tow` where another one counts, else `method`.

    Returns:
        The columns of the table `register_changes`, per line with a curve in either edition.
        `causes` is JSON: a list of `cause`, `factor` and, where the cause is `method`, the `step`;
        the factors multiply to `cw_ratio`. A ratio is null where the new curve says nothing about
        the old declared speed.

        Beside them tow, A, B, Cw, declared speed and rank in both (`old_`, `new_`); the power per
        rower at the old declared speed; the seconds that the new register gives in a two-hour race:
        more time for the same power counts as gain. `exceeds_interval`: whether the change is
        larger than the 95 % intervals of both together; of two numbers from one tow, which share
        its errors, whether it is larger than that of the old one; null where an interval is not
        known. The rank is among all boats of the class with a curve: 1 is the fastest at equal
        power per rower.
    """
    pairs = _pairs(old, new)
    both = pairs["both"].to_numpy()
    cw_ratio, time_ratio = _ratios(pairs)
    compared = both & np.isfinite(cw_ratio)
    kinds = [
        both & (np.abs(cw_ratio - 1.0) <= SAME_RATIO),
        both,
        pairs["cw_kg_m"].is_null().to_numpy(),
    ]
    change = np.select(kinds, ["same", "changed", "added"], "removed")
    power = power_per_rower_w(pairs["cw_kg_m"], pairs["declared_speed_m_s"], pairs["rowers"])
    of_one_tow = (pairs["tow_id"] == pairs["tow_id_new"]).fill_null(False).to_numpy()
    of_old = _half_width(pairs, "")
    width = np.where(of_one_tow, of_old, np.hypot(of_old, _half_width(pairs, "_new")))
    exceeds = np.abs(np.log(np.where(compared, cw_ratio, 1.0))) > width

    def known(name: str, values: np.ndarray, where: np.ndarray = compared) -> pl.Expr:
        return pl.when(pl.Series(where)).then(pl.Series(values)).alias(name)

    return pairs.select(
        pl.lit(old["edition"].first(), pl.String).alias("from_edition"),
        pl.lit(new["edition"].first(), pl.String).alias("to_edition"),
        *LINE,
        pl.Series("change", change, pl.String),
        known("cw_ratio", cw_ratio),
        known("power_ratio", cw_ratio),
        known("time_ratio", time_ratio),
        pl.Series("causes", _causes(pairs, compared, cw_ratio, parts, grounds), pl.String),
        *(
            pl.col(f"{name}{suffix}").alias(f"{side}_{name}")
            for name in BOTH
            for side, suffix in (("old", ""), ("new", "_new"))
        ),
        pl.Series("old_power_w", power).fill_nan(None),
        known("new_power_w", power * cw_ratio),
        known("gain_in_two_hours_s", RACE_S * (time_ratio - 1.0)),
        known("exceeds_interval", exceeds, compared & np.isfinite(width)),
    )


def largest_first(lines: pl.DataFrame) -> pl.DataFrame:
    """Lines by the size of their change, whatever its sign; those without a ratio on top."""
    size = pl.col("cw_ratio").log().abs().fill_null(math.inf)
    return lines.sort(size, *LINE, descending=[True, *(False for _ in LINE)])


def steps_of_lines(register: pl.DataFrame, ladder: pl.DataFrame) -> pl.DataFrame:
    """The steps of a ladder as parts of the changes of the lines whose tow they are of.

    Args:
        register: lines with their `tow_id`.
        ladder: `tow_id`, `position`, `step`, `factor`.
    """
    steps = (
        register.select(*LINE, "tow_id")
        .join(ladder, on="tow_id", maintain_order="left")
        .sort(*LINE, "position")
    )
    return steps.select(
        *LINE, pl.lit("method").alias("cause"), "step", pl.col("factor").cast(pl.Float64)
    )


def _pairs(old: pl.DataFrame, new: pl.DataFrame) -> pl.DataFrame:
    """Lines with a curve in either edition, sorted; `both` where there is one in each."""
    pairs = _ranked(old).join(
        _ranked(new),
        on=LINE,
        how="full",
        coalesce=True,
        suffix="_new",
        maintain_order="left_right",
    )
    both = pl.col("cw_kg_m").is_not_null() & pl.col("cw_kg_m_new").is_not_null()
    return pairs.with_columns(both=both).sort(LINE)


def _ratios(pairs: pl.DataFrame) -> tuple[FloatArray, FloatArray]:
    """New / old Cw at the old declared speed, and new / old time at the power of that speed.

    NaN where either has no curve, or a curve says nothing about that speed.
    """
    cw_ratio, time_ratio = (np.full(pairs.height, np.nan) for _ in range(2))
    both = pairs["both"].to_numpy()
    lines = pairs.filter("both")
    speed = lines["declared_speed_m_s"].to_numpy()
    old, new = curve_of_lines(lines), curve_of_lines(lines, "_new")
    before, after = cw(*old, speed), cw(*new, speed)
    sound = np.isfinite(before) & np.isfinite(after)
    power = np.where(sound, before, 0.0) * speed**3
    same_power_speed = np.where(sound, speed_at_power(*new, power), 1.0)
    cw_ratio[both] = np.where(sound, after, np.nan) / np.where(sound, before, 1.0)
    time_ratio[both] = np.where(sound, speed / same_power_speed, np.nan)
    return cw_ratio, time_ratio


def _ranked(register: pl.DataFrame) -> pl.DataFrame:
    """Lines with a curve, and their rank by speed at equal power."""
    lines = register.drop_nulls("cw_kg_m").select(*LINE, *NUMBERS)
    power = lines["crew_class"].replace_strict(POWER_W, return_dtype=pl.Float64)
    speed = speed_at_power(*curve_of_lines(lines), (power * lines["rowers"]).to_numpy())
    rank = pl.col("speed").rank("min", descending=True).over("crew_class").cast(pl.Int32)
    return lines.with_columns(speed=pl.Series(speed)).with_columns(rank=rank)


def _half_width(pairs: pl.DataFrame, suffix: str) -> FloatArray:
    """Half the 95 % interval of ln Cw; infinite where it is not known."""
    low, high = (pairs[f"cw_{end}_kg_m{suffix}"].to_numpy() for end in ("lo", "hi"))
    known = np.isfinite(low) & np.isfinite(high) & (low > 0)
    ratio = np.where(known, high, 1.0) / np.where(known, low, 1.0)
    return np.where(known, 0.5 * np.log(ratio), np.inf)


def _causes(
    pairs: pl.DataFrame,
    compared: np.ndarray,
    ratio: FloatArray,
    parts: pl.DataFrame,
    grounds: pl.DataFrame | None,
) -> list[str]:
    """The causes of each change with their factors on Cw, as JSON."""
    moved = parts.filter((pl.col("factor") - 1.0).abs() > NO_FACTOR)
    of_line = moved.group_by(LINE, maintain_order=True).agg(
        pl.struct("cause", "step", "factor").alias("parts")
    )
    known = pairs.select(LINE).join(of_line, on=LINE, how="left", maintain_order="left")["parts"]
    rests = _grounds(pairs, grounds)
    return [
        json.dumps(_factors(parts_of_line or [], float(factor), rest) if both else [])
        for parts_of_line, both, factor, rest in zip(
            known.to_list(), compared, ratio, rests, strict=True
        )
    ]


def _grounds(pairs: pl.DataFrame, grounds: pl.DataFrame | None) -> list[str]:
    if grounds is None:
        grounds_by_tow = {None: "printed", True: "method", False: "tow"}
        return [grounds_by_tow[same] for same in pairs["tow_id"] == pairs["tow_id_new"]]
    named = pairs.select(LINE).join(grounds, on=LINE, how="left", maintain_order="left")
    return named["ground"].to_list()


def _factors(parts: list[Row], total: float, rest: str) -> list[Row]:
    """The known parts, and one factor for the rest, which multiply to the total."""
    causes = [{k: v for k, v in part.items() if v is not None} for part in parts]
    left = total / math.prod(part["factor"] for part in parts)
    if abs(left - 1.0) > NO_FACTOR or not parts:
        causes.append({"cause": rest, "factor": left})
    return causes
