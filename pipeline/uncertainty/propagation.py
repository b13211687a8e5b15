"""The uncertainty budget of Cw, component by component, and the interval that follows.

Every component is a standard deviation of ln Cw. What a season or the archive shares is kept apart
from what is a single tow's, because it does not average out.
"""

import math
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

import numpy as np
import polars as pl

from pipeline.arrays import BoolArray, FloatArray, IntArray
from pipeline.quantiles import t_quantile
from pipeline.steps.speed import LOG

CURVE_PARAMETERS: Final = 2

UNRECORDED_WATER_C: Final = 4.0
"""Standard deviation of a season's water about the reference where nobody wrote it down: boats are
towed early in the year. The season log assumes the same (`season_log.priors`)."""


@dataclass(frozen=True)
class Assumed:
    """Standard uncertainties that the archive itself cannot show (docs/method-details.md, 9)."""

    calibration_speed_ratio: float = math.hypot(0.002, 0.003)  # by dGPS, by current out and back
    force_ratio: float = 0.003  # calibration of the load cell, as daily with a known weight
    force_standard_ratio: float = 0.002  # of that what all seasons share: the rest is estimated
    wind_coefficient: float = 0.115  # prescribed: 0.2 either way, all equally likely
    # Without an anemometer, net wind correction / still-air part: wind as fast as the boat, from
    # ahead out and from behind back, makes it 1.
    unmeasured_wind: float = 1.0
    anemometer_ratio: float = 0.05  # wind speed by one that is taken as it reads
    mass_ratio: float = 0.006  # crew and gear, on Cw
    mass_standard_ratio: float = 0.002  # the part that all tows of a boat share
    temperature_known_c: float = 0.3
    temperature_unknown_c: float = 2.0  # without a record, where no logs are estimated
    temperature_ratio_per_c: float = 0.003
    temperature_formula_ratio: float = 0.002  # wetted surface and friction formula
    straightness_ratio: float = 0.002  # tows that are pulled slightly askew
    between_tows_ratio: float = 0.0  # what repeat tows show of all that differs from tow to tow
    between_tows_n: float = 0.0  # and of what adds to the force: the zero of the load cell

    def replace_by_repeats(
        self, tow_sd: float, tow_zero_n: float, calibration_sd: float
    ) -> "Assumed":
        """Return what remains assumed where repeat tows show how far tows scatter.

        Calibration, recorded temperature, straightness and the weighing of the crew differ from tow
        to tow: repeat tows show their sum. What repeat tows share cancels in their difference, so
        they never shrink it (ISO 5725-1; GUM, type B).

        Args:
            tow_sd: standard deviation of ln Cw of a tow beyond its random part, its log and its
                zero.
            tow_zero_n: of the load cell's zero from tow to tow, N.
            calibration_sd: of the ln speed of tows calibrated on dGPS.
        """
        return replace(
            self,
            between_tows_ratio=tow_sd,
            between_tows_n=tow_zero_n,
            force_ratio=self.force_standard_ratio,
            calibration_speed_ratio=calibration_sd,
            mass_ratio=self.mass_standard_ratio,
            temperature_known_c=0.0,
            temperature_unknown_c=UNRECORDED_WATER_C,
            straightness_ratio=0.0,
        )


class Component(NamedTuple):
    """A component of the uncertainty of Cw, as expressions over the inputs of a tow.

    Attributes:
        effect: change of ln Cw by one standard deviation of it, signed.
        shared: what has one error in common: 'single' (tow), 'season' or 'archive'.
        dof: degrees of freedom of the standard deviation; infinite for an assumed one.
    """

    effect: pl.Expr
    shared: pl.Expr = pl.lit("single")
    dof: pl.Expr = pl.lit(math.inf)


def list_components(assumed: Assumed) -> dict[str, Component]:
    """Return every component by name, in the order in which they are shown.

    A speed error acts through the elasticity kappa of the boat. A tow without dGPS has the scatter
    of its log in place of calibration: a log feels the water, not the current.
    """
    col, season = pl.col, pl.lit("season")
    has_wind, has_temperature = pl.col("wind_measured"), pl.col("temperature_known")
    speed_sd = pl.when("calibrated").then(assumed.calibration_speed_ratio).otherwise("tow_log_sd")
    wind_scale_sd = col("wind_ln_sd").fill_null(assumed.anemometer_ratio)
    wind = (
        pl.when(has_wind)
        .then(col("air_per_coefficient") * assumed.wind_coefficient)
        .otherwise(col("still_air_ratio") * col("unmeasured_wind"))
    )
    temperature_sd_c = (
        pl.when(has_temperature)
        .then(col("water_off_c").clip(lower_bound=assumed.temperature_known_c))
        .otherwise(assumed.temperature_unknown_c)
    )
    by_zero = assumed.between_tows_n / col("force_n")
    between_tows = (assumed.between_tows_ratio**2 + by_zero**2).sqrt()
    by_temperature = assumed.temperature_ratio_per_c * temperature_sd_c
    by_mass = 0.5 * col("mass_ln_sd") * col("water_change_ratio")
    temperature = (assumed.temperature_formula_ratio**2 + by_temperature**2 + by_mass**2).sqrt()
    return {
        "random": Component(col("random_ratio"), dof=col("random_dof")),
        "misfit": Component(col("misfit_ratio")),
        "calibration": Component(col("kappa") * speed_sd),
        "between_tows": Component(between_tows),
        "force": Component(col("force_sd").fill_null(assumed.force_ratio), season),
        "wind": Component(
            wind, pl.when(has_wind).then(pl.lit("archive")).otherwise(pl.lit("single"))
        ),
        "anemometer": Component(2.0 * wind_scale_sd * col("air_ratio"), season),
        "mass": Component(pl.lit(assumed.mass_ratio)),
        "temperature": Component(
            temperature,
            pl.when(has_temperature).then(pl.lit("single")).otherwise(season),
        ),
        "straightness": Component(col("askew_ratio").fill_null(assumed.straightness_ratio)),
        "season_log": Component(col("kappa") * col("log_sd"), season),
    }


def make_budget(inputs: pl.DataFrame, assumed: Assumed) -> pl.DataFrame:
    """Return every component of the uncertainty of Cw, per tow and speed.

    Args:
        inputs: one row per tow and speed: `tow_id`, `speed_ratio` (that speed / the declared one),
            `season, part`; `kappa`, elasticity of Cw by a speed error; `random_ratio`, of the
            scatter of the run points, with `random_dof`; `force_n`, tow force; `misfit_ratio`, of
            the hull about its hyperbola; `calibrated` (on dGPS); `log_sd` of the season's ln
            factor (0 where calibrated), `tow_log_sd` of the log (0 where
            calibrated); `air_ratio`, net wind correction / Cw, and `air_per_coefficient`, change of
            ln Cw per unit of drag coefficient (both signed); `wind_ln_sd`, standard deviation of
            the anemometer's ln scale, null where it is taken as it reads; `wind_measured`, and
            where it was not `still_air_ratio`, still-air part / Cw, and `unmeasured_wind`, standard
            deviation of the net correction over that;
            `temperature_known`; `water_off_c`, of the water from its day's; `mass_ln_sd`, of ln
            mass, 0 where it was weighed, and `water_change_ratio`, the correction for temperature /
            Cw, which goes with the root of the mass; `askew_ratio`, by being pulled askew, null
            where repeat tows do not tell; `force_sd`, of the load cell by its record, null without
            one.
        assumed: what the archive does not show.

    Returns:
        One row per tow, speed and component: `tow_id, speed_ratio, component, shared`, `key` (rows
        with one key share one error), `effect_ratio`, `u_ratio` (its size) and `dof`.
    """
    parts = []
    for name, component in list_components(assumed).items():
        season = pl.when(component.shared == "season").then(pl.col("season").cast(pl.String))
        group = pl.when(component.shared == "single").then("tow_id").otherwise(season)
        key = pl.concat_str(pl.lit(name), group.fill_null(""), separator="/")
        if name == "season_log":
            key = make_log_key(pl.col("season"), pl.col("part"))
        effect = component.effect.cast(pl.Float64)
        parts.append(
            inputs.select(
                "tow_id",
                "speed_ratio",
                component=pl.lit(name),
                shared=component.shared,
                key=key,
                effect_ratio=effect,
                u_ratio=effect.abs(),
                dof=component.dof.cast(pl.Float64),
            )
        )
    return pl.concat(parts)


def make_log_key(season: pl.Expr, part: pl.Expr) -> pl.Expr:
    """Return the key of the error of one log factor."""
    named = (pl.lit("season_log"), season.cast(pl.String), part.cast(pl.String), pl.lit(LOG))
    return pl.concat_str(named, separator="/")


def combine(inputs: pl.DataFrame, assumed: Assumed) -> pl.DataFrame:
    """Return the combined uncertainty of Cw, per tow and speed, and the interval that follows.

    Args:
        inputs: as of `make_budget`.
        assumed: what the archive does not show.

    Returns:
        One row per row of `inputs`: `tow_id, speed_ratio, u_ratio`, `dof` (Welch-Satterthwaite),
        and `lo_ratio, hi_ratio`: the 95 % bounds of Cw / its value, a t interval on the logarithm.
    """
    components = list_components(assumed).values()
    variances = [component.effect.cast(pl.Float64) ** 2 for component in components]
    spreads = [
        variance**2 / component.dof.clip(lower_bound=1.0)
        for variance, component in zip(variances, components, strict=True)
    ]
    variance = pl.sum_horizontal(variances)
    total = inputs.select(
        "tow_id",
        "speed_ratio",
        u_ratio=variance.sqrt(),
        dof=(variance**2 / pl.sum_horizontal(spreads)).fill_nan(np.inf),
    )
    quantile = t_quantile(total["dof"].clip(1.0).to_numpy())
    half_width = total["u_ratio"] * pl.Series(quantile, dtype=pl.Float64)
    return total.with_columns(lo_ratio=(-half_width).exp(), hi_ratio=half_width.exp())


def pool_scatter(
    residual_ratio: FloatArray,
    is_used: BoolArray,
    group: FloatArray | IntArray,
    parameters: int = CURVE_PARAMETERS,
) -> tuple[FloatArray, FloatArray]:
    """Return the relative scatter of run points about their curves, pooled over groups of tows.

    Four degrees of freedom per tow are too few for its own (docs/method-details.md, 9).

    Args:
        residual_ratio: (tows, points) (point - curve) / curve.
        is_used: (tows, points) whether a point counts.
        group: (tows,) the same for tows whose scatter is pooled.
        parameters: number of parameters that were fitted to the points of each tow.

    Returns:
        Standard deviation and degrees of freedom of each tow's group, (tows,); infinite and 0 where
        no tow of the group has a point to spare.
    """
    _, place = np.unique(group, return_inverse=True)
    spare_points = np.maximum(is_used.sum(axis=1) - parameters, 0)
    counts = is_used & (spare_points > 0)[:, None]
    square = np.where(counts, residual_ratio**2, 0.0).sum(axis=1)
    dof = np.bincount(place, spare_points)[place].astype(np.float64)
    total = np.bincount(place, square)[place]
    sd = np.where(dof > 0, np.sqrt(total / np.maximum(dof, 1.0)), np.inf)
    return sd, dof
