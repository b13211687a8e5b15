"""What is wrong with the instruments of each season: one row per season and possible fault.

Every season has them all, dGPS or not: dGPS anchors speed and nothing else. Where a fault cannot be
told from another, both say so.
"""

from typing import Final, TypeAlias

import numpy as np
import polars as pl

from pipeline.arrays import FloatArray
from pipeline.quantiles import NORMAL
from pipeline.season_log.effects import (
    CHANGE,
    FORCE,
    GPS_SCALE,
    LOG,
    ZERO,
    ZERO_DRIFT,
)
from pipeline.season_log.likelihood import LEVEL as LEVEL_NUMBER
from pipeline.season_log.network import GROUP, Network
from pipeline.season_log.posterior import Posterior, Problem
from pipeline.tables.frames import dtypes
from pipeline.tables.season_log import SeasonDiagnosis, SeasonSteps

FOUND: Final = 0.5
"""A fault of this probability is in the model."""
POSSIBLE: Final = 0.1
"""One of this probability cannot be told."""
ALARM_SD: Final = 4.0
USUAL_SIZES: Final = 2.0
"""Faults beyond so many standard deviations of their prior are not usual."""
FAULT: Final = "fault"
ALARM: Final = "alarm"
SOUND: Final = "sound"
CANNOT_BE_TOLD: Final = "cannot be told"
WOULD_NOT_SHOW: Final = "would not show"
NOT_DETERMINED: Final = "not determined"
NOT_SETTLED: Final = "not settled"
USUAL_CALIBRATION: Final = 0.02
"""Size of ln(dGPS / log) that logs normally keep within (Sleepproef 2017, "IJking snelheid")."""
FORCES: Final = (FORCE, ZERO, ZERO_DRIFT)
Key: TypeAlias = tuple[int, int, str]
"""Season, part of it and instrument."""

STEP_SCHEMA: Final = dtypes(SeasonSteps, without=["method"])
DIAGNOSIS_SCHEMA: Final = dtypes(SeasonDiagnosis, without=["method"])


def season_diagnosis(posterior: Posterior) -> pl.DataFrame:
    """The diagnosis of every season.

    Returns:
        Rows of `DIAGNOSIS_SCHEMA`. `estimate` with its 95 % interval is the logarithm of a factor,
        or newtons. `p_fault` is the probability that there is such a fault, null for what there
        always is. `distance_sd` is how far what is seen lies from what is assumed, in standard
        deviations. `verdict` is `sound`, `cannot be told`, `fault`, or `would not show`: a fault of
        the usual size would most likely be taken for something else. For the factor of a log it
        is `estimated` or `not determined`; a distance of 4 is an `alarm`. Where the search did not
        come to rest, all are `not settled`. `alarm`: a person should look.
    """
    parts = posterior.problem.network.groups["part"]
    keys: dict[Key, list[int]] = {}
    for place, unknown in enumerate(posterior.problem.unknowns):
        if unknown.season is not None:
            part = 0 if unknown.group is None else parts[unknown.group]
            keys.setdefault((unknown.season, part, unknown.name), []).append(place)
    rows = [_row(posterior, key, of_key) for key, of_key in sorted(keys.items())]
    return pl.DataFrame(rows, schema=DIAGNOSIS_SCHEMA, orient="row")


def season_steps(posterior: Posterior, diagnosis: pl.DataFrame) -> pl.DataFrame:
    """Whether the step of a season against the others comes from the log or from the load cell.

    Returns:
        Rows of `STEP_SCHEMA`: `level_step`, what log and load cell together do to ln Cw, and
        `force_step`, the part of the load cell, with standard deviations. `cause` is

        - `force` where a fault of the load cell is likelier than not;
        - `not told` where one cannot be told, or looks like a current that runs with the boat both
          ways; where the season is not determined, or the search did not settle; and where a fault
          of the load cell would not show, and one no larger than usual could be the whole step;
        - `log` where the level differs by more than twice its standard deviation;
        - else `none`.
    """
    network, settings = posterior.problem.network, posterior.problem.settings
    instruments = np.where(posterior.of_boats, 0.0, posterior.design[:, LEVEL_NUMBER])
    forces = np.where(np.isin(posterior.names, FORCES), instruments, 0.0)
    verdicts = {
        tuple(key): verdict
        for *key, verdict in diagnosis.select("season", "part", "instrument", "verdict").rows()
    }
    rows = []
    placed = network.tows.select(GROUP).with_row_index("row")
    for key, part in placed.group_by(GROUP, maintain_order=True):
        mine = part["row"].to_numpy()
        step, step_sd = _mean_effect(posterior, instruments[mine])
        force, force_sd = _mean_effect(posterior, forces[mine])
        season = int(str(key[0]))
        of_force = {verdicts.get((season, 0, name)) for name in FORCES}
        of_log = verdicts.get((season, int(str(key[1])), LOG))
        lost = of_log in (NOT_DETERMINED, NOT_SETTLED) or not posterior.fit.settled
        hidden = verdicts.get((season, 0, FORCE)) == WOULD_NOT_SHOW
        streams = _may_be_a_stream(network, season, force)
        lost |= hidden and 2.0 * step_sd < abs(step) < USUAL_SIZES * settings.force_fault_sd
        rows.append(
            dict(zip(GROUP, key, strict=True))
            | {
                "n_boats": _boats_elsewhere(network, season),
                "level_step": step,
                "level_step_sd": step_sd,
                "force_step": force,
                "force_step_sd": force_sd,
                "cause": _cause(of_force, lost, abs(step) > 2.0 * step_sd, streams),
            }
        )
    return pl.DataFrame(rows, schema=STEP_SCHEMA).sort(GROUP)


def _mean_effect(posterior: Posterior, effects: FloatArray) -> tuple[float, float]:
    """Mean over tows of what unknowns do to ln Cw, and its standard deviation."""
    along = effects.mean(axis=0)
    variance = max(float(along @ posterior.covariance @ along), 0.0)
    return float(along @ posterior.mean), float(np.sqrt(variance))


def _may_be_a_stream(network: Network, season: int, force: float) -> bool:
    """Whether dGPS that is off in a whole season would look like this error of the load cell.

    A current that runs with the boat both ways, or against it, does that: it makes dGPS over log
    unusual, and Cw err the other way.
    """
    own = network.tows.filter(season=season)["own_calibration_ln"].drop_nulls()
    ln_y = 0.0 if own.is_empty() else float(own.to_numpy().mean())
    return abs(ln_y) > USUAL_CALIBRATION and force * ln_y < 0.0


def _cause(of_force: set[str | None], lost: bool, steps: bool, may_be_a_stream: bool) -> str:
    if of_force & {FAULT, ALARM}:
        return "not told" if may_be_a_stream else "force"
    if lost or CANNOT_BE_TOLD in of_force:
        return "not told"
    return "log" if steps else "none"


def _row(posterior: Posterior, key: Key, unknowns: list[int]) -> dict[str, object]:
    """One season and instrument: what all its unknowns add up to."""
    season, part, name = key
    fit, network = posterior.fit, posterior.problem.network
    columns = np.flatnonzero(np.isin(posterior.places, unknowns)).tolist()
    faults = np.flatnonzero(np.isin(posterior.problem.faults, unknowns)).tolist()
    mean = float(posterior.mean[columns].sum())
    variance = float(posterior.covariance[np.ix_(columns, columns)].sum())
    half = NORMAL * np.sqrt(max(variance, 0.0))
    chance = min(float(posterior.chance[faults].sum()), 1.0) if faults else None
    distance = _distance(posterior, columns)
    shows = bool(posterior.shows[faults].any())
    verdict = _verdict(network, key, chance, distance, shows) if fit.settled else NOT_SETTLED
    confused = _confused_with(posterior, columns, faults)
    if name == FORCE and verdict == FAULT and _may_be_a_stream(network, season, mean):
        confused = ", ".join(filter(None, (f"{GPS_SCALE} {season}", confused)))
    return {
        "season": season,
        "part": part,
        "instrument": name,
        "unit": "N" if name in (ZERO, ZERO_DRIFT) else "1",
        "estimate": mean,
        "lo": mean - half,
        "hi": mean + half,
        "p_fault": chance,
        "distance_sd": distance,
        "verdict": verdict,
        "alarm": verdict in (FAULT, ALARM, CANNOT_BE_TOLD, NOT_SETTLED),
        "first_tow": _first_tow(posterior, faults, chance),
        "rests_on": _rests_on(network, season),
        "confused_with": confused,
    }


def _distance(posterior: Posterior, columns: list[int]) -> float | None:
    """How far what the archive shows of an unknown that there always is lies from its prior."""
    fit, problem = posterior.fit, posterior.problem
    always = [c for c in columns if fit.active[c] in problem.always]
    if not always or problem.unknowns[fit.active[always[0]]].name == LOG:
        return None
    prior = problem.unknowns[fit.active[always[0]]].sd ** 2
    shown = prior - fit.covariance[always[0], always[0]]
    return float(fit.value[always[0]] / np.sqrt(max(shown, 1e-6 * prior)))


def _verdict(
    network: Network, key: Key, chance: float | None, distance: float | None, shows: bool
) -> str:
    season, part, name = key
    if name == LOG:
        return _of_log(network, season, part)
    if chance is not None and chance >= FOUND:
        return FAULT
    if distance is not None and abs(distance) >= ALARM_SD:
        return ALARM
    if chance is None:
        return SOUND
    if chance >= POSSIBLE:
        return CANNOT_BE_TOLD
    return SOUND if shows else WOULD_NOT_SHOW


def _of_log(network: Network, season: int, part: int) -> str:
    groups = network.groups
    mine = ((groups["season"] == season) & (groups["part"] == part)).to_numpy()
    if network.refused[mine].any():
        return NOT_SETTLED
    return "estimated" if network.determined[mine].all() else NOT_DETERMINED


def _first_tow(posterior: Posterior, faults: list[int], chance: float | None) -> str | None:
    """First tow after the likeliest change of a log, if there seems to be one."""
    problem = posterior.problem
    changes = [f for f in faults if problem.unknowns[problem.faults[f]].name == CHANGE]
    if not changes or chance is None or chance < POSSIBLE:
        return None
    likeliest = max(changes, key=lambda f: float(posterior.chance[f]))
    change = problem.unknowns[problem.faults[likeliest]]
    after = problem.network.tows.filter(pl.Series(change.share > 0), season=change.season)
    return str(after.sort("day", "tow_id")["tow_id"][0])


def _boats_elsewhere(network: Network, season: int) -> int:
    """Boats of a season that were towed in other seasons too."""
    mine = network.numbers("season") == season
    return len(set(network.boat[mine].tolist()) & set(network.boat[~mine].tolist()))


def _rests_on(network: Network, season: int) -> str:
    """What tells: repeat boats, plain GPS, dGPS."""
    mine = network.numbers("season") == season
    rests_on = [f"{_boats_elsewhere(network, season)} boats towed in other seasons too"]
    if np.isfinite(network.numbers("gps_ln_ratio")[mine & (network.group >= 0)]).any():
        rests_on.append("plain GPS")
    if (network.group[mine] < 0).any():
        rests_on.append("dGPS")
    return ", ".join(rests_on)


def _confused_with(posterior: Posterior, mine: list[int], faults: list[int]) -> str | None:
    """Other faults that would explain as much, likeliest first; then what would pass for them."""
    problem = posterior.problem
    confusion = posterior.confusion
    chance: FloatArray = confusion[faults].sum(axis=0) + confusion[:, faults].sum(axis=1)
    named: dict[str, float] = {}
    for fault, p in zip(problem.faults.tolist(), chance.tolist(), strict=True):
        named[_name(problem, fault)] = named.get(_name(problem, fault), 0.0) + p
    likely = [name for _, name in sorted((-p, n) for n, p in named.items() if p >= POSSIBLE)]
    hidden = ~posterior.shows
    passes = [posterior.fit.active[posterior.hidden_by[f]] for f in faults if hidden[f]]
    passes += problem.faults[hidden & np.isin(posterior.hidden_by, mine)].tolist()
    names = dict.fromkeys([*likely, *(_name(problem, unknown) for unknown in passes)])
    own = {_name(problem, problem.faults[f]) for f in faults}
    own |= {_name(problem, posterior.fit.active[c]) for c in mine}
    return ", ".join(name for name in names if name not in own) or None


def _name(problem: Problem, unknown: int) -> str:
    """An unknown with its season, if it is of one."""
    season = problem.unknowns[unknown].season
    return problem.unknowns[unknown].name + ("" if season is None else f" {season}")
