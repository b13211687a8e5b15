"""Plausibility: can the samples of a tow be true, given size, type, boat, day, season and archive?

A force in kgf under a header of newtons is a sound number of a boat that does not exist. No tow
reveals that by itself; the others do. Each tow is compared with what all the others predict. A
shift of a tow, a day, a season, a part of one, or the whole archive that they rule out is reported.
Nothing here depends on a method or changes a number: later steps leave these tows out of what tows
share.

The expectation is a Gaussian model with known variances; `mean_shift` says what it rules out.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
import polars as pl
import scipy

from pipeline.arrays import BoolArray, FloatArray, IntArray
from pipeline.assessment.mean_shift import Candidates, Observations, find_shifts
from pipeline.assessment.seen import LEAST_WATER, USUAL_BEND, Seen
from pipeline.blocks.tows import Tows
from pipeline.messages import say
from pipeline.tables.keys import LINE

LIMIT: Final = 4.5
"""Standard deviations from which a shift is not chance: one in 300,000, as thousands are tried."""

LOOK: Final = {"speed": 3.0}
"""Standard deviations from which a single tow is unusual: somebody has to look, but its numbers
stand. One sound tow in 400, if all were as Gaussian as the model. Of force and wind so little says
nothing: of 189 tows whose force was 3 standard deviations off, 24 % had a Cw that was over 3 % off;
of 152 whose speed was, 95 % (64 simulated archives)."""

FEWEST: Final = 3
"""Fewest tows for which a day, a season, either part of one, or an archive is judged as a whole."""

GROSS: Final = np.log(1.6)
"""Shift of a logarithm that no boat explains: the widest spread within a type is far less."""

_WITH_UNITS: Final = ("force", "wind")
"""Quantities that a wrong unit shifts so far."""


EXCHANGE_TOLERANCE: Final = 0.12
"""How far a logarithm that is known exactly may lie from that of an exchange."""

Cause = tuple[str, ...]
"""A text, and what goes between its braces."""


def _instead_of(unit: str, meant: str) -> Cause:
    """A number in one unit that is read as in another."""
    return say("{} instead of {}"), unit, meant


_EXCHANGES: Final[dict[str, dict[Cause, float]]] = {
    "force": {
        _instead_of("kgf", "N"): 9.80665,
        _instead_of("daN", "N"): 10.0,
        _instead_of("lbf", "N"): 4.4482216,
        _instead_of("kN", "N"): 1e3,
        (say("a gain of two"),): 2.0,
    },
    "wind": {
        _instead_of("km/h", "m/s"): 3.6,
        _instead_of(say("knots"), "m/s"): 1.9438445,
        _instead_of("mph", "m/s"): 2.2369363,
        _instead_of("ft/s", "m/s"): 3.2808399,
    },
}
"""Ratio of the two units. kgf and daN differ by 2 % and are named together."""


@dataclass(frozen=True)
class Spread:
    """Prior standard deviations of one observed quantity (inferred).

    Attributes:
        tow, day, season, archive: of a single tow, and of what those of a group share.
        boat, boat_type: of what the tows of a boat and crew, or of a type, share.
        log_alone: of what those of a season without GPS share besides.
    """

    tow: float
    day: float
    season: float
    archive: float
    boat: float = 0.0
    boat_type: float = 0.0
    log_alone: float = 0.0


LEVEL: Final = Spread(
    tow=0.045, day=0.025, season=0.05, archive=0.20, boat=0.12, boat_type=0.10, log_alone=0.12
)
"""Spread of ln Cw at the declared speed: until 2011 logs are 6 % off, which is 15 % in Cw."""
BEND: Final = Spread(tow=0.10, day=0.03, season=0.05, archive=0.30, boat=0.20, boat_type=0.10)
"""Spread of dlnCw/dlnv: B lies at 1.06 to 1.5 times the hull speed."""
WIND_AHEAD: Final = Spread(tow=0.06, day=0.03, season=0.05, archive=0.05)
WIND_ABEAM: Final = Spread(tow=0.06, day=0.03, season=0.05, archive=0.05)
GUST_SD: Final = 0.065
"""Standard deviation of the wind's mean over out and back / true wind (inferred). A steady wind
cancels between out and back; gusts do not, and grow with the wind. One and a half times what a
turbulence of a quarter leaves in six simulated runs."""
SPEED: Final = Spread(tow=0.008, day=0.004, season=0.01, archive=0.01)

LEAST: Final = {"force": 0.05, "zero": 0.0, "wind": 0.2, "vane": 0.2, "speed": 0.025}
"""Smallest sizes that matter, however clear: smaller ones change Cw by less than a tow scatters."""


@dataclass(frozen=True)
class Shift:
    """A shift that chance does not explain.

    Attributes:
        kind, key: what shifted: the `tow`, `day`, `part` (of a season, from a day on), `some` tows
            of a season, `season` or `archive`, and which.
        quantity: `force`, `zero` (of the load cell), `wind` (its speed), `vane` or `speed`.
        size: of ln force; in N for a zero; degrees for a vane that is turned; relative for the
            others.
        sd: its standard deviation; 0 where the samples themselves leave no doubt.
        tows: the tows in it, sorted.
        causes: what would do this, likeliest first; empty where nothing known does.
        clear: chance is ruled out; else the tow is only unusual.
    """

    kind: str
    key: str
    quantity: str
    size: float
    sd: float
    tows: tuple[str, ...]
    causes: tuple[Cause, ...]
    clear: bool = True

    @property
    def is_gross(self) -> bool:
        """Whether only a wrong unit, column or file can explain this."""
        if not self.clear:
            return False
        if self.quantity == "vane":
            return bool(self.causes)
        if self.quantity == "wind":
            return bool(self.causes) and abs(np.log1p(self.size)) > GROSS
        return self.quantity == "force" and abs(self.size) > GROSS


def plausibility(tows: Tows) -> tuple[Shift, ...]:
    """Judges every tow beside all others.

    Args:
        tows: all tows of the archive with their runs.

    Returns:
        Shifts of force, wind and speed that the other tows rule out, the clearest first; then
        single tows that are only unusual.
    """
    seen = Seen(tows)
    return (
        *_in_radians(seen),
        *_turned(seen),
        *_of_force(seen),
        *_of_one(seen, "wind", seen.wind_ahead, WIND_AHEAD, _GROUPS),
        *_of_one(seen, "vane", seen.wind_abeam, WIND_ABEAM, _GROUPS),
        *_of_one(seen, "speed", seen.speed, SPEED, ("tow", "part")),
    )


_RADIANS: Final = (_instead_of(say("radians"), say("degrees")),)
TURNED: Final = (("a vane that is turned",),)
_TURNED_DEG: Final = {"season": 45.0, "tow": 90.0}
"""Where the wind out and back together comes from at least, for the vane to be turned (inferred):
in a single tow the true wind may change by as much as the boat's speed, in a season not."""
_TURNED_WIND: Final = (0.6, 1.6)
"""That wind over the boat's speed: less or more is not the vane's doing alone."""
_TURNED_ALIKE: Final = 0.9
"""Length of the mean direction of tows that have one vane."""
_GROUPS: Final = ("tow", "day", "season", "archive")


def _in_radians(seen: Seen) -> Iterator[Shift]:
    """Tows whose wind angles are radians; a season, where most of its tows are."""
    tows, whose = (seen.tows.frame[name].to_numpy() for name in ("tow_id", "season"))
    for season in np.unique(whose).tolist():
        mine = whose == season
        written_so = mine & seen.in_radians
        if written_so.sum() >= FEWEST and written_so.sum() > 0.5 * mine.sum():
            yield Shift("season", str(season), "vane", 1.0, 0.0, tuple(tows[mine]), _RADIANS)
        else:
            for tow in tows[written_so]:
                yield Shift("tow", str(tow), "vane", 1.0, 0.0, (str(tow),), _RADIANS)


def _turned(seen: Seen) -> Iterator[Shift]:
    """Tows, or seasons, whose vane is turned.

    Out and back together leave the wind of the boat's own speed, which comes from straight ahead.
    """
    felt = (1.0 + seen.wind_ahead) + 1j * seen.wind_abeam
    low, high = _TURNED_WIND
    known = (np.abs(felt) > low) & (np.abs(felt) < high)  # NaN is not
    tows = seen.tows.frame
    turned: set[str] = set()
    for kind, key, places in _groups(tows, ("season", "tow")):
        mine = places[known[places]]
        if kind == "season" and len(mine) < FEWEST:
            continue
        mean = (felt[mine] / np.abs(felt[mine])).sum() / max(len(mine), 1)
        angle = float(np.degrees(np.angle(mean)))
        if abs(mean) < _TURNED_ALIKE or abs(angle) < _TURNED_DEG[kind]:
            continue
        ids = tuple(tows["tow_id"].gather(np.sort(places)))
        if not turned & {*ids}:
            turned |= {*ids}
            yield Shift(kind, key, "vane", round(angle) % 360, 0.0, ids, TURNED)


# What may have shifted, and how much it scatters

Group = tuple[str, str, IntArray]
"""Kind, key, and the places of its tows."""

Candidate = tuple[str, Group, IntArray, FloatArray]
"""Quantity, group, and what a shift of it does to which observations."""


def _groups(tows: pl.DataFrame, kinds: tuple[str, ...]) -> list[Group]:
    """The groups that are judged."""
    keys = {
        "tow": tows["tow_id"],
        "day": tows["tow_date"].cast(pl.String),
        "season": tows["season"].cast(pl.String),
        "archive": pl.repeat("", tows.height, eager=True),
    }
    whole = [
        (kind, str(name), places)
        for kind in kinds
        if kind in keys
        for name, places in _places(keys[kind])
        if kind == "tow" or len(places) >= FEWEST
    ]
    return [*whole, *_parts(tows)] if "part" in kinds else whole


def _parts(tows: pl.DataFrame) -> Iterator[Group]:
    """Seasons from each of their days on: a log may be replaced between two days."""
    day = tows["tow_date"].cast(pl.String).to_numpy()
    for _, places in _places(tows["season"].cast(pl.String)):
        for first in np.unique(day[places])[1:]:
            after = places[day[places] >= first]
            if FEWEST <= len(after) <= len(places) - FEWEST:
                yield ("part", str(first), after)


def _grossly_off(tows: pl.DataFrame, level: FloatArray) -> Iterator[Group]:
    """Tows of a season that lie grossly above, or below, the archive: half of a season in kgf.

    Without these a season of which only some are wrong looks wrong as a whole, by half as much.
    """
    off = level - np.median(level)
    for season, places in _places(tows["season"].cast(pl.String)):
        for side in (-1.0, 1.0):
            some = places[side * off[places] > GROSS]
            if 1 < len(some) < len(places):
                yield ("some", str(season), some)


def _places(key: pl.Series) -> Iterator[tuple[str, IntArray]]:
    names, rank = np.unique(key.to_numpy(), return_inverse=True)
    order, ends = np.argsort(rank, kind="stable"), np.cumsum(np.bincount(rank))
    yield from zip(names, np.split(order, ends[:-1]), strict=True)


def _observed(
    tows: pl.DataFrame, values: FloatArray, spread: Spread, more_variance: FloatArray | float = 0.0
) -> Observations:
    """A quantity of tows, with what those of a boat, season, day or type share."""
    state = pl.col("altered").cast(pl.Int32).cum_sum().over(LINE, order_by=["tow_date", "tow_id"])
    keyed = tows.with_columns(archive=pl.lit(0), state=state)
    kinds = (
        ((*LINE, "state"), spread.boat),
        (("archive",), spread.archive),
        (("season",), spread.season),
        (("log_alone",), spread.log_alone),
        (("tow_date",), spread.day),
        (("boat_type",), spread.boat_type),
    )
    of, variance = [], []
    for by, sd in kinds:
        if sd > 0.0 and set(by) <= set(keyed.columns):
            rank = keyed.select(pl.struct(by).rank("dense")).to_series().to_numpy() - 1
            each = np.ones(tows.height), (np.arange(tows.height), rank)
            of.append(scipy.sparse.csr_array(each))
            variance.append(np.full(of[-1].shape[1], sd**2))
    noise = np.full(tows.height, spread.tow**2) + more_variance
    return Observations(
        values, noise, scipy.sparse.hstack(of, format="csr"), np.concatenate(variance)
    )


def _of_one(
    seen: Seen, quantity: str, values: FloatArray, spread: Spread, kinds: tuple[str, ...]
) -> list[Shift]:
    """Shifts of one observed quantity."""
    there = np.isfinite(values)
    tows = seen.tows.frame.filter(pl.Series(there))
    if tows.is_empty():
        return []
    groups = _groups(tows, kinds)
    if quantity in _WITH_UNITS:
        ratio = np.maximum(1.0 + values[there], 0.01)
        groups += _grossly_off(tows, np.log(ratio))
    may = [(quantity, group, group[2], np.ones(len(group[2]))) for group in groups]
    gusts = np.zeros(tows.height)
    if quantity in ("wind", "vane"):
        gusts = (GUST_SD * seen.true_wind[there]) ** 2
    return _shifts(seen, there, _observed(tows, values[there], spread, gusts), may)


def _of_force(seen: Seen) -> list[Shift]:
    """Shifts of the force's gain, and of its zero, which changes the bend in its own way."""
    known = np.isfinite(seen.level) & np.isfinite(seen.bend) & (seen.force_n > 0)
    alone = pl.when(pl.Series(seen.has_gps)).then(0).otherwise("season").alias("log_alone")
    tows = seen.tows.frame.with_columns(alone).filter(pl.Series(known))
    if tows.is_empty():
        return []
    level = _observed(tows, seen.level[known], LEVEL)
    bend = _observed(tows, seen.bend[known], BEND, seen.bend_sd[known] ** 2)
    # Of the force that the size lets expect: a force in kgf is a tenth of it.
    per_newton = np.exp(seen.level[known]) / seen.force_n[known]
    may: list[Candidate] = []
    for group in (*_groups(tows, _GROUPS), *_grossly_off(tows, seen.level[known])):
        mine = group[2]
        may.append(("force", group, mine, np.ones(len(mine))))
        if group[0] == "archive":  # a shape of hulls looks so; load cells are not off for ever
            continue
        zero = per_newton[mine]
        both = np.concatenate([mine, tows.height + mine])
        may.append(("zero", group, both, np.concatenate([zero, -(2.0 + USUAL_BEND) * zero])))
    return _shifts(seen, known, Observations.joined([level, bend]), may)


def _shifts(
    seen: Seen, there: BoolArray, observed: Observations, may: list[Candidate]
) -> list[Shift]:
    """The candidates that have shifted among the tows that are there, and what may have done it."""
    quantities = [quantity for quantity, *_ in may]
    ends = np.cumsum([0, *(len(places) for *_, places, _ in may)])
    places, sizes = (np.concatenate([one[k] for one in may]) for k in (2, 3))
    candidates = Candidates(
        scipy.sparse.csc_array((sizes, places, ends), shape=(len(observed.values), len(may))),
        np.array([kind == "tow" for _, (kind, *_), *_ in may]),
        np.array([LEAST[quantity] for quantity in quantities]),
        np.array([GROSS if quantity in _WITH_UNITS else np.inf for quantity in quantities]),
    )
    look = min(LOOK.get(quantity, np.inf) for quantity in quantities)
    tow_ids = seen.tows.frame["tow_id"].filter(pl.Series(there))
    air_share, stands_still = seen.air_share[there], seen.wind_stands_still[there]
    shifts = []
    for found in find_shifts(observed, candidates, LIMIT, look):
        quantity, (kind, key, mine), *_ = may[found.place]
        size, ln_size = found.size, found.size
        if quantity == "force":
            size = ln_size = _of_whole_force(size, air_share[mine])
        if quantity == "wind":
            ln_size = float(np.log(max(1.0 + size, 0.01)))
        causes = _likely_causes(quantity, ln_size, found.sd)
        if quantity == "wind" and stands_still[mine].any():
            causes = ()  # an anemometer that died on the way is in no other unit
        ids = tuple(tow_ids.gather(np.sort(mine)))
        shifts.append(Shift(kind, key, quantity, size, found.sd, ids, causes, found.clear))
    return shifts


def _of_whole_force(ln_size: float, air_share: FloatArray) -> float:
    """Shift of ln force that gives a shift of its water part: no unit changes what the air took."""
    water = np.maximum(1.0 - air_share, LEAST_WATER)
    return float(-np.log(np.median(water * np.exp(-ln_size) + air_share)))


def _likely_causes(quantity: str, ln_size: float, sd: float) -> tuple[Cause, ...]:
    """The exchanges that explain a shift, likeliest first; several where they are too alike.

    Args:
        quantity: `force` or `wind`; nothing is known of others.
        ln_size: logarithm of the number in the file / the number expected.
        sd: its standard deviation.
    """
    known = _EXCHANGES.get(quantity, {})
    far = {cause: abs(abs(ln_size) - np.log(ratio)) for cause, ratio in known.items()}
    near = sorted((d, cause) for cause, d in far.items() if d <= EXCHANGE_TOLERANCE + 2.0 * sd)
    return tuple(cause for d, cause in near if d <= near[0][0] + EXCHANGE_TOLERANCE)
