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
from typing import Final, NamedTuple

import numpy as np
import polars as pl
import scipy

from pipeline.arrays import BoolArray, FloatArray, IntArray
from pipeline.assessment.mean_shift import Candidates, Observations, find_mean_shifts
from pipeline.assessment.tow_summary import (
    MIN_WATER_SHARE,
    USUAL_BEND,
    TowSummary,
    summarize_tows,
)
from pipeline.blocks.tows import Tows
from pipeline.crews import STANDARD_CREWS
from pipeline.messages import say
from pipeline.tables.keys import LINE

REJECT_AT_SD: Final = 4.5
"""Standard deviations from which a shift is not chance: one in 300,000, as thousands are tried."""

FLAG_AT_SD: Final = {"speed": 3.0}
"""Standard deviations from which a single tow is unusual: somebody has to look, but its numbers
stand. One sound tow in 400, if all were as Gaussian as the model. Of force and wind so little says
nothing: of 189 tows whose force was 3 standard deviations off, 24 % had a Cw that was over 3 % off;
of 152 whose speed was, 95 % (64 simulated archives)."""

MIN_TOWS: Final = 3
"""Fewest tows for which a day, a season, either part of one, or an archive is judged as a whole."""

GROSS: Final = np.log(1.6)
"""Shift of a logarithm that no boat explains: the widest spread within a type is far less."""

_HAS_UNITS: Final = ("force", "wind")
"""Quantities that a wrong unit shifts so far."""


UNIT_TOLERANCE: Final = 0.12
"""How far a logarithm that is known exactly may lie from that of a ratio of units."""

Cause = tuple[str, ...]
"""A text, and what goes between its braces."""


def _name_wrong_unit(unit: str, meant: str) -> Cause:
    """Return the cause that a number in one unit is read as in another."""
    return say("{} instead of {}"), unit, meant


_UNIT_RATIOS: Final[dict[str, dict[Cause, float]]] = {
    "force": {
        _name_wrong_unit("kgf", "N"): 9.80665,
        _name_wrong_unit("daN", "N"): 10.0,
        _name_wrong_unit("lbf", "N"): 4.4482216,
        _name_wrong_unit("kN", "N"): 1e3,
        (say("a gain of two"),): 2.0,
    },
    "wind": {
        _name_wrong_unit("km/h", "m/s"): 3.6,
        _name_wrong_unit(say("knots"), "m/s"): 1.9438445,
        _name_wrong_unit("mph", "m/s"): 2.2369363,
        _name_wrong_unit("ft/s", "m/s"): 3.2808399,
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

MIN_SIZE: Final = {"force": 0.05, "zero": 0.0, "wind": 0.2, "vane": 0.2, "speed": 0.025}
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


def plausibility(tows: Tows, crew_classes: pl.DataFrame = STANDARD_CREWS) -> tuple[Shift, ...]:
    """Judge every tow beside all others.

    Args:
        tows: all tows of the archive with their runs.
        crew_classes: the table of that name.

    Returns:
        Shifts of force, wind and speed that the other tows rule out, the clearest first; then
        single tows that are only unusual.
    """
    summary = summarize_tows(tows, crew_classes)
    shifts = list(_find_radians(summary))
    shifts += _find_turned_vanes(summary)
    shifts += _judge_force(summary)
    shifts += _judge_quantity(summary, "wind", summary.wind_ahead, WIND_AHEAD, _GROUPS)
    shifts += _judge_quantity(summary, "vane", summary.wind_abeam, WIND_ABEAM, _GROUPS)
    shifts += _judge_quantity(summary, "speed", summary.speed, SPEED, ("tow", "part"))
    return tuple(shifts)


_RADIANS: Final = (_name_wrong_unit(say("radians"), say("degrees")),)
TURNED: Final = (("a vane that is turned",),)
_MIN_TURN_DEG: Final = {"season": 45.0, "tow": 90.0}
"""Where the wind out and back together comes from at least, for the vane to be turned (inferred):
in a single tow the true wind may change by as much as the boat's speed, in a season not."""
_TURNED_WIND: Final = (0.6, 1.6)
"""That wind over the boat's speed: less or more is not the vane's doing alone."""
_MIN_ALIGNMENT: Final = 0.9
"""Length of the mean direction of tows that have one vane."""
_GROUPS: Final = ("tow", "day", "season", "archive")


def _find_radians(summary: TowSummary) -> Iterator[Shift]:
    """List tows whose wind angles are radians; a season, where most of its tows are."""
    tow_id = summary.tows.frame["tow_id"].to_numpy()
    season = summary.tows.frame["season"].to_numpy()
    for year in np.unique(season).tolist():
        is_own = season == year
        is_odd = is_own & summary.is_in_radians
        if is_odd.sum() >= MIN_TOWS and is_odd.sum() > 0.5 * is_own.sum():
            groups = [("season", str(year), tuple(tow_id[is_own]))]
        else:
            groups = [("tow", str(name), (str(name),)) for name in tow_id[is_odd]]
        for kind, key, ids in groups:
            yield Shift(
                kind=kind,
                key=key,
                quantity="vane",
                size=1.0,
                sd=0.0,
                tows=ids,
                causes=_RADIANS,
            )


def _find_turned_vanes(summary: TowSummary) -> Iterator[Shift]:
    """List tows, or seasons, whose vane is turned.

    Out and back together leave the wind of the boat's own speed, which comes from straight ahead.
    """
    felt = (1.0 + summary.wind_ahead) + 1j * summary.wind_abeam
    low, high = _TURNED_WIND
    is_known = (np.abs(felt) > low) & (np.abs(felt) < high)  # NaN is not
    tows = summary.tows.frame
    turned: set[str] = set()
    for kind, key, places in _list_groups(tows, ("season", "tow")):
        own = places[is_known[places]]
        if kind == "season" and len(own) < MIN_TOWS:
            continue
        mean = (felt[own] / np.abs(felt[own])).sum() / max(len(own), 1)
        angle = float(np.degrees(np.angle(mean)))
        if abs(mean) < _MIN_ALIGNMENT or abs(angle) < _MIN_TURN_DEG[kind]:
            continue
        ids = tuple(tows["tow_id"].gather(np.sort(places)))
        if turned.isdisjoint(ids):
            turned.update(ids)
            yield Shift(
                kind=kind,
                key=key,
                quantity="vane",
                size=round(angle) % 360,
                sd=0.0,
                tows=ids,
                causes=TURNED,
            )


# What may have shifted, and how much it scatters


class Group(NamedTuple):
    """Tows that may have shifted together: their kind and key, and their places."""

    kind: str
    key: str
    places: IntArray


class Candidate(NamedTuple):
    """A quantity of a group that may have shifted, and its effect on the observations at places."""

    quantity: str
    group: Group
    places: IntArray
    effect: FloatArray


def _list_groups(tows: pl.DataFrame, kinds: tuple[str, ...]) -> list[Group]:
    """Return the groups of tows that are judged as a whole."""
    keys = {
        "tow": tows["tow_id"],
        "day": tows["tow_date"].cast(pl.String),
        "season": tows["season"].cast(pl.String),
        "archive": pl.repeat("", tows.height, eager=True),
    }
    groups: list[Group] = []
    for kind in kinds:
        if kind == "part":
            groups += _list_parts(tows)
            continue
        for name, places in _split_by_key(keys[kind]):
            group = Group(kind, str(name), places)
            if kind == "tow" or len(places) >= MIN_TOWS:
                groups.append(group)
    return groups


def _list_parts(tows: pl.DataFrame) -> Iterator[Group]:
    """List seasons from each of their days on: a log may be replaced between two days."""
    day = tows["tow_date"].cast(pl.String).to_numpy()
    for _, places in _split_by_key(tows["season"].cast(pl.String)):
        for first in np.unique(day[places])[1:]:
            after = places[day[places] >= first]
            if MIN_TOWS <= len(after) <= len(places) - MIN_TOWS:
                yield Group("part", str(first), after)


def _list_gross_tows(tows: pl.DataFrame, level: FloatArray) -> Iterator[Group]:
    """List the tows of a season that lie grossly above, or below, the archive.

    Half of a season may be in kgf. Without these groups it looks wrong as a whole, by half as much.
    """
    off = level - np.median(level)
    for season, places in _split_by_key(tows["season"].cast(pl.String)):
        for side in (-1.0, 1.0):
            some = places[side * off[places] > GROSS]
            if 1 < len(some) < len(places):
                yield Group("some", str(season), some)


def _split_by_key(key: pl.Series) -> Iterator[tuple[str, IntArray]]:
    """List each key with the places where it stands."""
    names, rank = np.unique(key.to_numpy(), return_inverse=True)
    order, ends = np.argsort(rank, kind="stable"), np.cumsum(np.bincount(rank))
    yield from zip(names, np.split(order, ends[:-1]), strict=True)


def _observe(
    tows: pl.DataFrame, values: FloatArray, spread: Spread, more_variance: FloatArray | float = 0.0
) -> Observations:
    """Return a quantity of tows, with what those of a boat, season, day or type share."""
    state = pl.col("altered").cast(pl.Int32).cum_sum().over(LINE, order_by=["tow_date", "tow_id"])
    keyed = tows.with_columns(archive=pl.lit(0), state=state)
    kinds = (
        (LINE + ("state",), spread.boat),
        (("archive",), spread.archive),
        (("season",), spread.season),
        (("log_alone",), spread.log_alone),
        (("tow_date",), spread.day),
        (("boat_type",), spread.boat_type),
    )
    effects, variance = [], []
    for by, sd in kinds:
        if sd > 0.0 and set(by) <= set(keyed.columns):
            rank = keyed.select(pl.struct(by).rank("dense")).to_series().to_numpy() - 1
            each = np.ones(tows.height), (np.arange(tows.height), rank)
            effects.append(scipy.sparse.csr_array(each))
            variance.append(np.full(effects[-1].shape[1], sd**2))
    noise = np.full(tows.height, spread.tow**2) + more_variance
    return Observations(
        values=values,
        variance=noise,
        shared=scipy.sparse.hstack(effects, format="csr"),
        shared_variance=np.concatenate(variance),
    )


def _judge_quantity(
    summary: TowSummary, quantity: str, values: FloatArray, spread: Spread, kinds: tuple[str, ...]
) -> list[Shift]:
    """Return the shifts of one observed quantity."""
    is_known = np.isfinite(values)
    tows = summary.tows.frame.filter(pl.Series(is_known))
    if tows.is_empty():
        return []
    groups = _list_groups(tows, kinds)
    if quantity in _HAS_UNITS:
        ratio = np.maximum(1.0 + values[is_known], 0.01)
        groups += _list_gross_tows(tows, np.log(ratio))
    candidates = []
    for group in groups:
        effect = np.ones(len(group.places))
        candidates.append(Candidate(quantity, group, group.places, effect))
    gusts = np.zeros(tows.height)
    if quantity in ("wind", "vane"):
        gusts = (GUST_SD * summary.true_wind[is_known]) ** 2
    observations = _observe(tows, values[is_known], spread, gusts)
    return _find_shifts(summary, is_known, observations, candidates)


def _judge_force(summary: TowSummary) -> list[Shift]:
    """Return shifts of the force's gain, and of its zero, which changes the bend in its own way."""
    is_known = np.isfinite(summary.level) & np.isfinite(summary.bend) & (summary.force_n > 0)
    alone = pl.when(pl.Series(summary.has_gps)).then(0).otherwise("season").alias("log_alone")
    tows = summary.tows.frame.with_columns(alone).filter(pl.Series(is_known))
    ln_level = summary.level[is_known]
    if tows.is_empty():
        return []
    level = _observe(tows, ln_level, LEVEL)
    bend = _observe(tows, summary.bend[is_known], BEND, summary.bend_sd[is_known] ** 2)
    # Of the force that the size lets expect: a force in kgf is a tenth of it.
    per_newton = np.exp(ln_level) / summary.force_n[is_known]
    groups = _list_groups(tows, _GROUPS)
    groups += _list_gross_tows(tows, ln_level)
    candidates: list[Candidate] = []
    for group in groups:
        own = group.places
        candidates.append(Candidate("force", group, own, np.ones(len(own))))
        if group.kind == "archive":  # a shape of hulls looks so; load cells are not off for ever
            continue
        zero = per_newton[own]
        both = np.concatenate([own, tows.height + own])
        effect = np.concatenate([zero, -(2.0 + USUAL_BEND) * zero])
        candidates.append(Candidate("zero", group, both, effect))
    observations = Observations.concatenate([level, bend])
    return _find_shifts(summary, is_known, observations, candidates)


def _find_shifts(
    summary: TowSummary,
    is_known: BoolArray,
    observations: Observations,
    listed: list[Candidate],
) -> list[Shift]:
    """Return the candidates that have shifted, and what may have done it.

    Args:
        is_known: (tows,) tows that are observed.
        observations: of these tows.
        listed: what may have shifted among them.
    """
    quantities = [one.quantity for one in listed]
    places = [one.places for one in listed]
    lengths = list(map(len, places))
    columns = (
        np.concatenate([one.effect for one in listed]),
        np.concatenate(places),
        np.concatenate(([0], np.cumsum(lengths))),
    )
    shape = (len(observations.values), len(listed))
    candidates = Candidates(
        directions=scipy.sparse.csc_array(columns, shape=shape),
        is_single=np.array([one.group.kind == "tow" for one in listed]),
        min_size=np.array(list(map(MIN_SIZE.__getitem__, quantities))),
        gross_size=np.array([GROSS if q in _HAS_UNITS else np.inf for q in quantities]),
    )
    flag_at = min(FLAG_AT_SD.get(quantity, np.inf) for quantity in quantities)
    tow_ids = summary.tows.frame["tow_id"].filter(pl.Series(is_known))
    air_share = summary.air_share[is_known]
    stands_still = summary.wind_stands_still[is_known]
    shifts = []
    for found in find_mean_shifts(observations, candidates, REJECT_AT_SD, flag_at):
        quantity, group = listed[found.place].quantity, listed[found.place].group
        own = group.places
        size = found.size
        if quantity == "force":
            size = _convert_to_whole_force(size, air_share[own])
        ln_size = float(np.log(max(1.0 + size, 0.01))) if quantity == "wind" else size
        causes = _list_likely_causes(quantity, ln_size, found.sd)
        if quantity == "wind" and stands_still[own].any():
            causes = ()  # an anemometer that died on the way is in no other unit
        shift = Shift(
            kind=group.kind,
            key=group.key,
            quantity=quantity,
            size=size,
            sd=found.sd,
            tows=tuple(tow_ids.gather(np.sort(own))),
            causes=causes,
            clear=found.clear,
        )
        shifts.append(shift)
    return shifts


def _convert_to_whole_force(ln_size: float, air_share: FloatArray) -> float:
    """Return the shift of ln force that gives a shift of its water part.

    No unit changes what the air took.
    """
    water = np.maximum(1.0 - air_share, MIN_WATER_SHARE)
    return float(-np.log(np.median(water * np.exp(-ln_size) + air_share)))


def _list_likely_causes(quantity: str, ln_size: float, sd: float) -> tuple[Cause, ...]:
    """Return the wrong units that explain a shift, likeliest first.

    Several are returned where they are too alike.

    Args:
        quantity: `force` or `wind`; nothing is known of others.
        ln_size: logarithm of the number in the file / the number expected.
        sd: its standard deviation.
    """
    known = _UNIT_RATIOS.get(quantity, {})
    far = {cause: abs(abs(ln_size) - np.log(ratio)) for cause, ratio in known.items()}
    near = sorted((d, cause) for cause, d in far.items() if d <= UNIT_TOLERANCE + 2.0 * sd)
    return tuple(cause for d, cause in near if d <= near[0][0] + UNIT_TOLERANCE)
