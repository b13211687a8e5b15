"""Whether a season's step against the others comes from the log or from the load cell."""

from typing import Final

import numpy as np
import polars as pl

from herijk.pipeline.arrays import BoolArray, FloatArray, IntArray
from herijk.pipeline.season_log.estimate import SeasonFactors
from herijk.pipeline.season_log.network import BOAT, GROUP, index_of, with_state
from herijk.pipeline.season_log.scale import LEAST_MARGIN, scale_effect

LOG: Final = "log"
NOT_TOLD: Final = "not told"

FEWEST_BOATS: Final = 3
SMALLEST_STEP: Final = 0.03
"""A smaller step of ln Cw is one per cent of speed: no cause is looked for."""
TELLING: Final = 3.0
"""A level step of this many sd of the slope's can be told: half way to the other cause is 1.5."""
SURE: Final = 4.0
"""A force step of this many sd is one, however large the log's own part of the level."""


def log_or_force(tows: pl.DataFrame, found: SeasonFactors) -> pl.DataFrame:
    """Whether the step of a season against the others comes from the log or from the load cell.

    A scale error of the log leaves A B^2 as it is, that of the load cell multiplies it; both move
    the level (research, method.md 8.2). So the slope q / Cw of 1/Cw on (v/v0)^2, which is
    v0^2 / (A B^2), is compared with that of the same boats' other tows.

    Args:
        tows: as for `estimate_season_factors`, with `q` and its standard deviation `q_sd` of the
            free curve at the reference speed, by the log as it reads.
        found: the season factors.

    Returns:
        One row per season, part and log (anchored ones too): `level_step` (ln Cw against the
        boats' other tows, those corrected by their factors), `force_step` (the part in ln force
        that the slope shows), both with `_sd`, `n_boats`, and `cause`: `log`, `force` (a log error
        may have come with it), `none` (no level step of 3 % and twice its sd), or `not told`: the
        slope is too uncertain, there are fewer than three boats, or a log would be blamed that
        dGPS has calibrated: then the boats' other tows may be what is wrong.
    """
    placed = (
        with_state(tows)
        .join(
            found.factors.select(*GROUP, pl.col("factor").log().alias("ln_factor")),
            on=GROUP,
            how="left",
            maintain_order="left",
        )
        .filter(pl.col("anchored") | pl.col("ln_factor").is_not_null())
    )
    boat = index_of(placed, BOAT)
    ln_factor = np.where(placed["anchored"], 0.0, placed["ln_factor"].fill_null(0.0))
    kappa, ln_cw, q, q_sd = (placed[c].to_numpy() for c in ("kappa", "ln_cw", "q", "q_sd"))
    corrected = ln_cw - scale_effect(ln_factor, 1.0 - 2.0 / kappa)[0]
    pooled_q = 0.5 * kappa - 1.0
    rows = []
    for key, part in placed.with_row_index("row").group_by(GROUP, maintain_order=True):
        inside = np.zeros(placed.height, dtype=bool)
        inside[part["row"].to_numpy()] = True
        step = _step(boat, inside, ln_cw, corrected, q / pooled_q, q_sd / pooled_q)
        if step["cause"] == LOG and part["anchored"].all():
            step["cause"] = NOT_TOLD
        rows.append(dict(zip(GROUP, key, strict=True)) | step)
    numbers = ("level_step", "level_step_sd", "force_step", "force_step_sd")
    schema = {name: tows.schema[name] for name in GROUP} | dict.fromkeys(numbers, pl.Float64())
    return pl.DataFrame(rows, schema=schema | {"n_boats": pl.Int64(), "cause": pl.String()}).sort(
        GROUP
    )


def _step(
    boat: IntArray,
    inside: BoolArray,
    ln_cw: FloatArray,
    corrected: FloatArray,
    q_ratio: FloatArray,
    q_ratio_sd: FloatArray,
) -> dict[str, float | int | str | None]:
    """Level and slope of a group's tows against those of the same boats elsewhere."""
    size = int(boat.max()) + 1
    counts = np.stack([np.bincount(boat, side, size) for side in (inside, ~inside)])
    both = (counts > 0).all(axis=0)
    if both.sum() < FEWEST_BOATS:
        return {"n_boats": int(both.sum()), "cause": NOT_TOLD}

    def mean(values: FloatArray, side: BoolArray, count: FloatArray) -> FloatArray:
        return np.asarray(np.bincount(boat, values * side, size)[both] / count[both])

    usual = np.zeros(size)
    usual[both] = mean(corrected, ~inside, counts[1])
    level = mean(ln_cw, inside, counts[0]) - usual[both]
    slope = q_ratio * np.exp(usual[boat] - ln_cw)
    slope_sd = q_ratio_sd * np.exp(usual[boat] - ln_cw)
    change = mean(slope, inside, counts[0]) - mean(slope, ~inside, counts[1])
    change_variance = (
        mean(slope_sd**2, inside, counts[0]) / counts[0, both]
        + mean(slope_sd**2, ~inside, counts[1]) / counts[1, both]
    )
    level_step, level_sd = _weighted_mean(level, 1.0 / (1.0 / counts[:, both]).sum(axis=0))
    change_step, change_sd = _weighted_mean(change, 1.0 / change_variance)
    share = max(1.0 + change_step, LEAST_MARGIN)
    force_step, force_sd = -float(np.log(share)), change_sd / share
    return {
        "level_step": level_step,
        "level_step_sd": level_sd,
        "force_step": force_step,
        "force_step_sd": force_sd,
        "n_boats": int(both.sum()),
        "cause": _cause(level_step, level_sd, force_step, force_sd),
    }


def _weighted_mean(values: FloatArray, weight: FloatArray) -> tuple[float, float]:
    """Weighted mean and its standard error from the scatter about it."""
    mean = float(np.average(values, weights=weight))
    scatter = float((weight * (values - mean) ** 2).sum() / (len(values) - 1))
    return mean, float(np.sqrt(scatter / weight.sum()))


def _cause(level: float, level_sd: float, force: float, force_sd: float) -> str:
    if abs(level) < max(SMALLEST_STEP, 2.0 * level_sd):
        return "none"
    if abs(force) > SURE * force_sd:
        return "force"
    if abs(level) < TELLING * force_sd:
        return NOT_TOLD
    return LOG if abs(force) < abs(force - level) else "force"
