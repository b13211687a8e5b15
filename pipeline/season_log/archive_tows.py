"""The tows that season factors are estimated from: one frame, and what ties their logs together.

Graph and bookkeeping; no statistics.
"""

from dataclasses import dataclass
from typing import Final, Self

import numpy as np
import polars as pl
import scipy

from pipeline.arrays import BoolArray, FloatArray, IntArray, StrArray
from pipeline.errors import BrokenPromiseError
from pipeline.tables.keys import LINE

LOG: Final = ("season", "part")
"""What has a factor of its own: one log, in a season or the part of it until a replacement."""
ANCHORED: Final = -1
"""Place among the logs of a tow that is calibrated on dGPS: no error of its log is left."""


def with_state(tows: pl.DataFrame) -> pl.DataFrame:
    """Tows sorted by line and time, with `state`: how often the line was altered, as reported."""
    return tows.sort(*LINE, *LOG, "tow_id").with_columns(
        pl.col("altered").fill_null(False).cum_sum().over(LINE).alias("state")
    )


@dataclass(frozen=True)
class ArchiveTows:
    """The tows of an archive and their logs; n tows.

    Attributes:
        frame: the tows, sorted by line and time, with places: `boat`, of the line as it was until a
            reported alteration; `hull`, of the boat whatever its crew and alterations; `log_place`,
            a row of `logs`, or `ANCHORED`.
        logs: logs without dGPS: `season, part, n_tows`; `n_links`, boats that tie it to others;
            `component` of the network, 0 with the anchor; `has_gps`, plain GPS in any tow;
            `calibrated`, whether dGPS calibrated other tows of it, with `prior_ln` and `prior_sd`.
    """

    frame: pl.DataFrame
    logs: pl.DataFrame

    @classmethod
    def of(cls, tows: pl.DataFrame) -> Self:
        """The tows that `estimate_season_factors` is given.

        Raises:
            BrokenPromiseError: a number that every tow must have is missing or not positive.
        """
        _refuse_unknown(tows)
        frame = with_state(tows).with_columns(
            boat=_place(*LINE, "state"), hull=_place("fsn_no"), is_loose=~pl.col("anchored")
        )
        logs = (
            frame.filter("is_loose")
            .group_by(LOG, maintain_order=True)
            .agg(
                n_tows=pl.len().cast(pl.Int64),
                has_gps=pl.col("gps_ln_ratio").is_not_null().any(),
                calibrated=pl.col("others_calibration_ln").is_not_null().any(),
                prior_ln=pl.col("others_calibration_ln").first(),
                prior_sd=pl.col("others_calibration_sd").first(),
            )
            .sort(LOG)
            .with_row_index("log_place")
        )
        frame = frame.join(
            logs.select("log_place", *LOG), on=LOG, how="left", maintain_order="left"
        ).with_columns(pl.when("is_loose").then("log_place").otherwise(ANCHORED).cast(pl.Int64))
        edges = frame.select("boat", "log_place").unique(maintain_order=True)
        linking = edges.filter(pl.len().over("boat") > 1)["log_place"].to_numpy()
        tied = logs.select(pl.col("has_gps") | pl.col("calibrated")).to_series().to_numpy()
        return cls(
            frame.drop("is_loose"),
            logs.with_columns(
                n_links=pl.Series(np.bincount(linking + 1, minlength=len(tied) + 1)[1:]),
                component=pl.Series(_components(edges, tied)),
            ),
        )

    @property
    def log(self) -> IntArray:
        """Place of each tow's log, (n,)."""
        return self.frame["log_place"].to_numpy()

    @property
    def boat(self) -> IntArray:
        """Place of each tow's boat as it was between alterations, (n,)."""
        return self.frame["boat"].to_numpy()

    @property
    def hull_names(self) -> StrArray:
        """Number of each boat, by its place `hull`, (hulls,)."""
        return self.frame["fsn_no"].unique().sort().to_numpy()

    def numbers(self, column: str) -> FloatArray:
        """A column as float64, NaN where null, (n,)."""
        return self.frame[column].cast(pl.Float64).fill_null(np.nan).to_numpy()

    def boat_mean(self, values: FloatArray) -> FloatArray:
        """Mean over the boat's tows, for each tow."""
        count = np.bincount(self.boat)
        return np.asarray((np.bincount(self.boat, values) / np.maximum(count, 1))[self.boat])


def _refuse_unknown(tows: pl.DataFrame) -> None:
    for name in ("ln_cw", "kappa", "ln_cw_sd", "declared_speed_m_s"):
        least = -np.inf if name == "ln_cw" else 0.0
        sound = pl.col(name).is_finite() & (pl.col(name) > least)
        faulty = tows.filter(~sound.fill_null(False))
        if faulty.height:
            raise BrokenPromiseError(
                "season factors: {} of tow {} is {}, and {} more; give only tows "
                "with a sound curve",
                name,
                faulty["tow_id"][0],
                faulty[name][0],
                faulty.height - 1,
            )


def _place(*columns: str) -> pl.Expr:
    """Rank of each row's combination of values."""
    return pl.struct(columns).rank("dense").cast(pl.Int64) - 1


def _components(edges: pl.DataFrame, tied: BoolArray) -> IntArray:
    """Connected part of the network of each log: 0 with the anchor, others by season.

    Args:
        edges: which `boat` was towed by which `log_place`.
        tied: logs that GPS ties to the anchor.
    """
    nodes = len(tied) + 1  # the first is the anchor
    by_gps = np.flatnonzero(tied) + 1
    start = np.concatenate([edges["log_place"].to_numpy() + 1, by_gps])
    end = np.concatenate([edges["boat"].to_numpy() + nodes, np.zeros_like(by_gps)])
    size = nodes + edges["boat"].n_unique()
    graph = scipy.sparse.coo_array((np.ones(len(start)), (start, end)), shape=(size, size))
    label = scipy.sparse.csgraph.connected_components(graph, directed=False)[1][:nodes]
    _, first, part = np.unique(label, return_index=True, return_inverse=True)
    return np.asarray(np.argsort(np.argsort(first))[part][1:], dtype=np.int64)
