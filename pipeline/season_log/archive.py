"""What is observed of every tow, and which logs and boats the tows have in common.

A tow gives up to three numbers: ln Cw at one speed (`LEVEL`), the bend q of its own curve (`BEND`),
and ln(GPS / log) (`GPS`). This module sorts the tows, numbers boats and logs, and finds out which
logs are connected. It estimates nothing.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
import polars as pl
import scipy

from pipeline.arrays import BoolArray, FloatArray, IntArray, StrArray
from pipeline.errors import BrokenPromiseError
from pipeline.season_log.priors import Priors
from pipeline.tables.keys import LINE

LEVEL, BEND, GPS = range(3)
"""The observed numbers of a tow, in this order in every array."""

LOG: Final = ("season", "part")
"""Key of a log: one log in a season, or in the part of it until a reported replacement."""
ANCHORED: Final = -1
"""Log number of a tow that is calibrated on dGPS, which leaves no error of its log."""
MIN_SD: Final = 0.001
"""Standard deviation added to every number: keeps the search finite where all tows agree."""
UNOBSERVED_SD: Final = 100.0
"""Standard deviation of a number that a tow does not have, or that is not to be relied on."""


@dataclass(frozen=True)
class Archive:
    """The observations of n tows, sorted by boat, crew and time.

    Attributes:
        frame: the rows given to `estimate_season_factors`, sorted, with `state`.
        logs: a row per log without dGPS: `season, part, n_tows`; `n_links`, number of boats that
            connect it with other logs; `component` of the network, 0 with the anchor; `has_gps`,
            whether a tow has plain GPS; `calibrated`, whether dGPS calibrated other tows of the
            same log, with `prior_ln` and `prior_sd` of its ln factor.
        y: (n, 3) ln Cw less the boat's mean, bend, ln(GPS / log).
        y_covariance: (n, 3, 3) of their known random errors.
        mean_level: (n,) the boat's mean ln Cw, taken off `y`.
        usual_bend: (n,) the boat's q at the reference speed.
        force_n: (n,) tow force at the reference speed, N.
        reference_ln: (n,) ln factor of the log at whose true speed the numbers hold.
        season: (n,) year.
        day: (n,) day in the season; 0 where unknown.
        boat: (n,) number of the boat and crew, as it was between two reported alterations.
        hull: (n,) number of the boat, whatever its crew and alterations.
        log: (n,) row of `logs`, or `ANCHORED`.
        is_observed: (n,) whether the tow's numbers are relied on; others are only estimated.
        log_variance: (n,) which variance between tows the log has: the era, or the last one for
            anchored tows.
    """

    frame: pl.DataFrame
    logs: pl.DataFrame
    y: FloatArray
    y_covariance: FloatArray
    mean_level: FloatArray
    usual_bend: FloatArray
    force_n: FloatArray
    reference_ln: FloatArray
    season: FloatArray
    day: FloatArray
    boat: IntArray
    hull: IntArray
    log: IntArray
    is_observed: BoolArray
    log_variance: IntArray

    @property
    def is_connected(self) -> BoolArray:
        """Logs that boats or GPS connect with the anchor, (logs,)."""
        return np.asarray(self.logs["component"].to_numpy() == 0)

    @property
    def hull_names(self) -> StrArray:
        """FSN number of each boat, by its number `hull`, (hulls,)."""
        return self.frame["fsn_no"].unique().sort().to_numpy()

    def column(self, name: str) -> FloatArray:
        """Return a column of `frame` as float64, NaN where null, (n,)."""
        return to_numpy(self.frame, name)


def to_numpy(frame: pl.DataFrame, name: str) -> FloatArray:
    """Return a column as float64, NaN where null."""
    return frame[name].cast(pl.Float64).fill_null(np.nan).to_numpy()


def average_over_boat(
    values: FloatArray, boat: IntArray, is_counted: BoolArray | None = None
) -> FloatArray:
    """Return for each tow the mean of `values` over the tows of its boat, (n,).

    Args:
        is_counted: (n,) tows over which the mean is taken; all, when left out.
    """
    weight = np.ones(len(boat)) if is_counted is None else is_counted.astype(np.float64)
    count = np.maximum(np.bincount(boat, weight), 1.0)
    return np.asarray((np.bincount(boat, values * weight) / count)[boat])


def sort_tows(tows: pl.DataFrame) -> pl.DataFrame:
    """Sort tows by boat, crew and time; add `state`, the number of reported alterations so far."""
    return tows.sort(LINE + LOG + ("tow_id",)).with_columns(
        pl.col("altered").fill_null(False).cum_sum().over(LINE).alias("state")
    )


def build_archive(tows: pl.DataFrame, priors: Priors) -> Archive:
    """Return the observations of the tows that `estimate_season_factors` is given.

    Raises:
        BrokenPromiseError: a number that every tow must have is missing or not positive.
    """
    _check_numbers(tows)
    frame = sort_tows(tows)
    boat = frame.select(pl.struct(LINE + ("state",)).rank("dense") - 1).to_series().to_numpy()
    boat = boat.astype(np.int64)
    hull = (frame["fsn_no"].rank("dense") - 1).to_numpy().astype(np.int64)
    is_observed = (to_numpy(frame, "ln_cw_sd") < UNOBSERVED_SD).astype(np.bool_)
    logs, log = _list_logs(frame, boat, is_observed)

    ln_cw = to_numpy(frame, "ln_cw")
    speed = to_numpy(frame, "declared_speed_m_s")
    season = to_numpy(frame, "season")
    reference_ln = to_numpy(frame, "reference_ln")
    gps = to_numpy(frame, "gps_ln_ratio")
    has_gps = np.isfinite(gps) & (log != ANCHORED)
    gps_bias = 0.25 * (priors.gps_noise_m_s / speed) ** 2
    mean_level = average_over_boat(ln_cw, boat, is_observed)

    y = np.stack(
        [ln_cw - mean_level, to_numpy(frame, "q"), np.where(has_gps, gps - gps_bias, 0.0)], axis=1
    )
    y_covariance = np.zeros((len(y), 3, 3))
    y_covariance[:, LEVEL, LEVEL] = to_numpy(frame, "ln_cw_sd") ** 2
    y_covariance[:, BEND, BEND] = to_numpy(frame, "q_sd") ** 2
    y_covariance[:, LEVEL, BEND] = to_numpy(frame, "ln_cw_q_cov")
    y_covariance[:, BEND, LEVEL] = to_numpy(frame, "ln_cw_q_cov")
    gps_variance = to_numpy(frame, "gps_sd") ** 2
    y_covariance[:, GPS, GPS] = np.where(has_gps, gps_variance, UNOBSERVED_SD**2)
    y_covariance += MIN_SD**2 * np.eye(3)

    era = np.searchsorted(priors.era_starts, season, side="right") - 1
    return Archive(
        frame=frame,
        logs=logs,
        y=y,
        y_covariance=y_covariance,
        mean_level=mean_level,
        usual_bend=average_over_boat(0.5 * to_numpy(frame, "kappa") - 1.0, boat),
        force_n=np.exp(ln_cw) * (speed * np.exp(-reference_ln)) ** 2,
        reference_ln=reference_ln,
        season=season,
        day=np.nan_to_num(to_numpy(frame, "day")),
        boat=boat,
        hull=hull,
        log=log,
        is_observed=is_observed,
        log_variance=np.where(log == ANCHORED, len(priors.era_starts), np.maximum(era, 0)),
    )


def _check_numbers(tows: pl.DataFrame) -> None:
    for name in ("ln_cw", "kappa", "ln_cw_sd", "declared_speed_m_s"):
        minimum = -np.inf if name == "ln_cw" else 0.0
        is_sound = pl.col(name).is_finite() & (pl.col(name) > minimum)
        faulty = tows.filter(~is_sound.fill_null(False))
        if faulty.height:
            raise BrokenPromiseError(
                "season factors: {} of tow {} is {}, and {} more; give only tows "
                "with a sound curve",
                name,
                faulty["tow_id"][0],
                faulty[name][0],
                faulty.height - 1,
            )


def _list_logs(
    frame: pl.DataFrame, boat: IntArray, is_observed: BoolArray
) -> tuple[pl.DataFrame, IntArray]:
    """Return `Archive.logs`, and the log of each tow, (n,)."""
    logs = (
        frame.filter(~pl.col("anchored"))
        .group_by(LOG, maintain_order=True)
        .agg(
            n_tows=pl.len().cast(pl.Int64),
            has_gps=pl.col("gps_ln_ratio").is_not_null().any(),
            calibrated=pl.col("others_calibration_ln").is_not_null().any(),
            prior_ln=pl.col("others_calibration_ln").first(),
            prior_sd=pl.col("others_calibration_sd").first(),
        )
        .sort(LOG)
        .with_row_index("row")
    )
    rows_of_logs = logs.select("row", pl.col(LOG))
    row = frame.join(rows_of_logs, on=LOG, how="left", maintain_order="left")["row"]
    log = np.where(frame["anchored"], ANCHORED, row.cast(pl.Int64).fill_null(ANCHORED).to_numpy())

    # The network: nodes are the anchor, the logs and the boats; a tow is an edge from its boat to
    # its log. GPS connects a log with the anchor.
    edges = np.unique(np.stack([log, boat], axis=1)[is_observed], axis=0)
    boats_with_links = np.flatnonzero(np.bincount(edges[:, 1]) > 1)
    linking = edges[np.isin(edges[:, 1], boats_with_links), 0]
    n_links = np.bincount(linking + 1, minlength=logs.height + 1)[1:]
    by_gps = np.flatnonzero((logs["has_gps"] | logs["calibrated"]).to_numpy())
    start = np.concatenate([edges[:, 0] + 1, by_gps + 1])
    end = np.concatenate([edges[:, 1] + logs.height + 1, np.zeros_like(by_gps)])
    size = logs.height + 1 + int(boat.max(initial=-1)) + 1
    graph = scipy.sparse.coo_array((np.ones(len(start)), (start, end)), shape=(size, size))
    label = scipy.sparse.csgraph.connected_components(graph, directed=False)[1]
    # SciPy numbers components by their first node: 0 has the anchor, others come by season.
    component = label[1 : logs.height + 1]
    logs = logs.drop("row").with_columns(n_links=pl.Series(n_links), component=pl.Series(component))
    return logs, log
