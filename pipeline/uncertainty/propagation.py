"""The uncertainty of Cw of a tow, component by component.

Belongs here: how far run points scatter about their curves, the budget of a tow with what its
components share with other tows, and the interval that follows. Does not: the
covariance of a curve's parameters (`curve`), the season log factors (`season_log`) and drawing
from the budget (`ensemble`).

Everything is relative: standard deviations of ln Cw. Components that a season or the archive
shares are kept apart from those of a single tow, because they do not average out.
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


def residual_scatter(
    residual_ratio: FloatArray, used: BoolArray, season: FloatArray | IntArray
) -> tuple[FloatArray, FloatArray]:
    """Relative scatter of run points about their curves, pooled over each season's tows.

    Four degrees of freedom per tow are too few for its own (docs/method-details.md, 9).

    Args:
        residual_ratio: (point - curve) / curve, shape (tows, points).
        used: points that count, same shape.
        season: the same for tows of one season, shape (tows,).

    Returns:
        Standard deviation and degrees of freedom for each tow's season, shape (tows,); infinite
        and 0 where no tow of the season has a point to spare.
    """
    _, group = np.unique(season, return_inverse=True)
    spare = np.maximum(used.sum(axis=1) - CURVE_PARAMETERS, 0)
    squares = np.where(used & (spare > 0)[:, None], residual_ratio, 0.0) ** 2
    dof = np.bincount(group, spare)[group].astype(np.float64)
    total = np.bincount(group, squares.sum(axis=1))[group]
    known = dof > 0
    return np.where(known, np.sqrt(total / np.where(known, dof, 1.0)), np.inf), dof


UNRECORDED_WATER_C: Final = 4.0
"""Standard deviation of a season's water about the reference where nobody wrote it down: boats are
towed early in the year. The season log assumes the same (`season_log.assumed`)."""


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

    def beside_repeats(self, tow_sd: float, calibration_sd: float) -> "Assumed":
        """What remains assumed where repeat tows show how far tows scatter.

        Calibration, which moves speed, and recorded temperature, straightness and
        the weighing of the crew, which do not, differ from tow to tow: repeat tows show both sums.
        What repeat tows share cancels in their difference, so they never shrink it (ISO 5725-1;
        GUM, type B).

        Args:
            tow_sd: standard deviation of ln Cw of a tow beyond its random part and its log, from
                the network of repeat tows (`season_log`).
            calibration_sd: of the ln speed of tows calibrated on dGPS, from there too.
        """
        return replace(
            self,
            between_tows_ratio=tow_sd,
            force_ratio=self.force_standard_ratio,
            calibration_speed_ratio=calibration_sd,
            mass_ratio=self.mass_standard_ratio,
            temperature_known_c=0.0,
            temperature_unknown_c=UNRECORDED_WATER_C,
            straightness_ratio=0.0,
        )


class Component(NamedTuple):
    """A component of the uncertainty of Cw, in SQL over the facts of a tow and what is assumed.

    Attributes:
        effect: change of ln Cw by one standard deviation of it, signed.
        shared: what has one error in common: 'single' (tow), 'season' or 'archive'.
        dof: degrees of freedom of the standard deviation; infinite for an assumed one.
    """

    effect: str
    shared: str = "'single'"
    dof: str = "CAST('inf' AS DOUBLE)"


RULES: Final = {
    "random": Component("random_ratio", dof="random_dof"),
    "misfit": Component("misfit_ratio"),
    "calibration": Component(
        "kappa * CASE WHEN calibrated THEN calibration_speed_ratio ELSE tow_log_sd END"
    ),
    "between_tows": Component("between_tows_ratio"),
    "force": Component("COALESCE(force_sd, force_ratio)", "'season'"),
    "wind": Component(
        "CASE WHEN wind_measured THEN air_per_coefficient * wind_coefficient "
        "ELSE still_air_ratio * unmeasured_wind END",
        "CASE WHEN wind_measured THEN 'archive' ELSE 'single' END",
    ),
    "anemometer": Component("2 * COALESCE(wind_ln_sd, anemometer_ratio) * air_ratio", "'season'"),
    "mass": Component("mass_ratio"),
    "temperature": Component(
        "SQRT(POW(temperature_formula_ratio, 2) + POW(temperature_ratio_per_c * CASE "
        "WHEN temperature_known THEN GREATEST(temperature_known_c, water_off_c) "
        "ELSE temperature_unknown_c END, 2) + POW(0.5 * mass_ln_sd * water_change_ratio, 2))",
        "CASE WHEN temperature_known THEN 'single' ELSE 'season' END",
    ),
    "straightness": Component("COALESCE(askew_ratio, straightness_ratio)"),
    "season_log": Component("kappa * log_sd", "'season'", "log_dof"),
}
"""Every component by its name, in the order in which they are shown.

A speed error acts through the elasticity kappa of the boat. A tow without dGPS has the wander of
its log in place of calibration: a log feels the water, not the current."""

COMPONENTS: Final = tuple(RULES)


def budget(tows: pl.DataFrame) -> pl.DataFrame:
    """Every component of the uncertainty of Cw at one speed, per tow.

    Args:
        tows: one row per tow and speed: `tow_id`, `speed_ratio` (that speed / the declared one),
            `season, part`; `kappa`; `random_ratio` (of C0, from the scatter of the run
            points) with `random_dof`; `misfit_ratio`, of the hull about its hyperbola;
            `calibrated` (on dGPS); `log_sd` and `log_dof` of the season's ln factor (0 and any
            where calibrated), `tow_log_sd` of the log (0 where calibrated); `air_ratio`, net
            wind correction / Cw, and `air_per_coefficient`, change of ln Cw per unit of drag
            coefficient (both signed); `wind_ln_sd`, of the anemometer's ln scale, null where it is
            taken as it reads; `wind_measured`, and where it was not `still_air_ratio`, still-air
            part / Cw;
            `temperature_known`; `water_off_c`, of the water from its day's; `mass_ln_sd`, of ln
            mass, 0 where it was weighed, and `water_change_ratio`, the correction for temperature /
            Cw, which goes with the root of the mass; `askew_ratio`, by being pulled askew, null
            where repeat tows do not tell; `force_sd`, of the load cell by its record, null without
            one; and every number of `Assumed`, with for `wind_coefficient` what the archive-wide
            search came to where that was used.

    Returns:
        One row per tow, speed and component: `tow_id, speed_ratio, component, shared`, `key` (rows
        with one key share one error), `effect_ratio`, `u_ratio` (its size) and `dof`.
    """
    return pl.concat(
        tows.select(
            "tow_id",
            "speed_ratio",
            component=pl.lit(name),
            shared=pl.sql_expr(rule.shared),
            key=_key(name, pl.sql_expr(rule.shared)),
            effect_ratio=pl.sql_expr(rule.effect).cast(pl.Float64),
            u_ratio=pl.sql_expr(rule.effect).cast(pl.Float64).abs(),
            dof=pl.sql_expr(rule.dof).cast(pl.Float64),
        )
        for name, rule in RULES.items()
    )


def _key(component: str, shared: pl.Expr) -> pl.Expr:
    """What has this error in common: the tow alone, its season (and log), or all."""
    if component == "season_log":
        return log_key(pl.col("season"), pl.col("part"))
    season = pl.when(shared == "season").then(pl.col("season").cast(pl.String))
    whose = pl.when(shared == "single").then("tow_id").otherwise(season).fill_null("")
    return pl.concat_str(pl.lit(component), whose, separator="/")


def log_key(season: pl.Expr, part: pl.Expr) -> pl.Expr:
    """Key of the error of one log factor."""
    named = (pl.lit("season_log"), season.cast(pl.String), part.cast(pl.String), pl.lit(LOG))
    return pl.concat_str(named, separator="/")


def combine(components: pl.DataFrame) -> pl.DataFrame:
    """Adds a budget up per tow and speed.

    Args:
        components: rows of `budget`.

    Returns:
        One row per tow and speed, in the order of `components`: `tow_id, speed_ratio, u_ratio`,
        `dof` (Welch-Satterthwaite), and `lo_ratio, hi_ratio`: the 95 % bounds of Cw / its value, a
        t interval on the logarithm.
    """
    square = pl.col("u_ratio") ** 2
    rows = (
        components.group_by("tow_id", "speed_ratio", maintain_order=True)
        .agg(
            square.sum().sqrt().alias("u_ratio"),
            (square**2 / pl.col("dof").clip(lower_bound=1.0)).sum().alias("spread"),
        )
        .with_columns((pl.col("u_ratio") ** 4 / pl.col("spread")).alias("dof"))
        .with_columns(pl.col("dof").fill_nan(np.inf))
    )
    quantile = t_quantile(rows["dof"].clip(1.0).to_numpy())
    half = rows["u_ratio"] * pl.Series(quantile, dtype=pl.Float64)
    return rows.drop("spread").with_columns(
        (-half).exp().alias("lo_ratio"), half.exp().alias("hi_ratio")
    )
