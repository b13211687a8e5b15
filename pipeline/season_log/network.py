"""The network of boats and seasons: which tows are of one boat, and what ties seasons together.

Graph and bookkeeping; no statistics.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
import polars as pl
import scipy

from pipeline.arrays import BoolArray, FloatArray, IntArray
from pipeline.tables.keys import LINE

GROUP: Final = ("season", "part")
"""What has a log factor of its own: one log, in a season or the part of it until a replacement."""
BOAT: Final = (*LINE, "state")
"""A line as it was until a reported alteration."""


def with_state(tows: pl.DataFrame) -> pl.DataFrame:
    """Tows sorted by line and time, with `state`: how often the line was altered, as reported."""
    return tows.sort(*LINE, "season", "part", "tow_id").with_columns(
        pl.col("altered").fill_null(False).cum_sum().over(LINE).alias("state")
    )


@dataclass(frozen=True)
class Network:
    """Tows sorted by line and time, with what ties them together.

    Attributes:
        tows: the tows.
        group: index of each tow's row of `groups`, -1 for anchored tows, shape (tows,).
        boat: index of the boat as it was until a reported alteration, shape (tows,).
        cluster: index of the boat whatever its crew and alterations, shape (tows,).
        groups: season, part and log of the tows that are not anchored.
        boat_names: fsn_no by cluster.
        links: boats that tie a group to others, shape (groups,).
        component: connected part of the network, 0 with the anchor, shape (groups,).
        has_gps: groups with plain GPS, shape (groups,).
        calibrated: groups of whose log dGPS calibrated other tows that season, shape (groups,).
        refused: groups whose factor contradicts what needs no model (`guard`), shape (groups,).
    """

    tows: pl.DataFrame
    group: IntArray
    boat: IntArray
    cluster: IntArray
    groups: pl.DataFrame
    boat_names: list[str]
    links: IntArray
    component: IntArray
    has_gps: BoolArray
    calibrated: BoolArray
    refused: BoolArray

    @classmethod
    def of(cls, tows: pl.DataFrame) -> "Network":
        """The network of the tows that `estimate_season_factors` is given."""
        tows = with_state(tows)
        loose = ~tows["anchored"].to_numpy()
        groups = tows.filter(loose).select(GROUP).unique().sort(GROUP)
        key = groups.with_row_index("group")
        group = tows.join(key, on=GROUP, how="left", maintain_order="left")["group"]
        group_index = np.where(loose, group.cast(pl.Int64).fill_null(-1).to_numpy(), -1)
        boat = index_of(tows, BOAT)
        has_gps = np.zeros(groups.height, dtype=bool)
        has_gps[group_index[loose & tows["gps_ln_ratio"].is_not_null().to_numpy()]] = True
        calibrated = np.zeros(groups.height, dtype=bool)
        calibrated[group_index[loose & tows["others_calibration_ln"].is_not_null().to_numpy()]] = (
            True
        )
        names = tows["fsn_no"].unique().sort().to_list()
        links, component = _connect(group_index, boat, has_gps | calibrated)
        cluster = index_of(tows, ("fsn_no",))
        return cls(
            tows,
            group_index,
            boat,
            cluster,
            groups,
            names,
            links,
            component,
            has_gps,
            calibrated,
            np.zeros(groups.height, dtype=bool),
        )

    @property
    def determined(self) -> BoolArray:
        """Groups that are tied to the anchor and not refused, shape (groups,)."""
        return np.asarray((self.component == 0) & ~self.refused)

    @property
    def log_known(self) -> BoolArray:
        """Tows whose group is determined, and anchored ones, shape (tows,)."""
        return np.append(self.determined, [True])[self.group]  # -1, anchored, reads the last

    @cached_property
    def critical(self) -> BoolArray:
        """Whether a group is tied to the anchor no more without a boat, (boats, groups)."""
        lost = np.zeros((len(self.boat_names), len(self.has_gps)), dtype=bool)
        anchors = self.has_gps | self.calibrated
        rows = np.stack([self.cluster, self.group, self.boat])
        cluster_of, group, boat = np.unique(rows, axis=1)  # once each of a boat's groups
        for cluster in range(len(self.boat_names)):
            others = cluster_of != cluster
            if len(np.unique(group[~others])) > 1:
                component = _connect(group[others], boat[others], anchors)[1]
                lost[cluster] = self.determined & (component != 0)
        return lost

    def boat_mean(self, values: FloatArray) -> FloatArray:
        """Mean over the boat's tows, for each tow."""
        boats = int(self.boat.max(initial=-1)) + 1
        count = np.maximum(np.bincount(self.boat, minlength=boats), 1)
        return np.asarray((np.bincount(self.boat, values, boats) / count)[self.boat])

    def numbers(self, column: str) -> FloatArray:
        """A column as float64, NaN where null, shape (tows,)."""
        return self.tows[column].cast(pl.Float64).fill_null(np.nan).to_numpy()


def index_of(tows: pl.DataFrame, columns: tuple[str, ...]) -> IntArray:
    """Rank of each row's combination of values in sorted order."""
    key = tows.select(columns).unique().sort(columns).with_row_index("index")
    placed = tows.select(columns).join(key, on=columns, how="left", maintain_order="left")
    return placed["index"].to_numpy().astype(np.int64)


def _connect(group: IntArray, boat: IntArray, by_gps: BoolArray) -> tuple[IntArray, IntArray]:
    """Links and connected component of each group; GPS ties a group to the anchor."""
    groups, boats = len(by_gps), int(boat.max(initial=-1)) + 1
    nodes_of_groups = groups + 1  # node 0 is the anchor
    edges = np.divmod(np.unique(boat * nodes_of_groups + group + 1), nodes_of_groups)
    degree = np.bincount(edges[0], minlength=boats)
    linking = edges[1][degree[edges[0]] > 1]
    links = np.bincount(linking, minlength=nodes_of_groups)[1:].astype(np.int64)
    gps_nodes = np.flatnonzero(by_gps) + 1
    nodes = nodes_of_groups + boats
    start = np.concatenate([edges[1], np.zeros(len(gps_nodes), np.int64)])
    end = np.concatenate([edges[0] + nodes_of_groups, gps_nodes])
    graph = scipy.sparse.coo_array((np.ones(len(start)), (start, end)), shape=(nodes, nodes))
    label = scipy.sparse.csgraph.connected_components(graph, directed=False)[1]
    other, component = np.unique(label[1:nodes_of_groups], return_inverse=True)
    # The anchor's part is 0, the others follow in the order of their seasons.
    first = [int(np.flatnonzero(component == i)[0]) for i in range(len(other))]
    rank = np.argsort(np.argsort(np.where(other == label[0], -1, first)))
    offset = 0 if label[0] in other else 1
    return links, np.asarray(rank[component] + offset, dtype=np.int64)
