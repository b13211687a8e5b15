"""What is wrong with the instruments of each season: one row per season and possible fault.

Every season has them all, dGPS or not: dGPS anchors speed and nothing else. Where a fault cannot be
told from another, both say so.
"""

from typing import Final

import numpy as np
import polars as pl

from pipeline.arrays import FloatArray, IntArray
from pipeline.quantiles import NORMAL
from pipeline.season_log.archive_tows import LOG, ArchiveTows
from pipeline.season_log.boats import LEVEL
from pipeline.season_log.effects import FORCE, LOG_SCALE, OF_BOATS, ZERO, ZERO_DRIFT
from pipeline.season_log.factors import ESTIMATED, NOT_DETERMINED, NOT_SETTLED
from pipeline.season_log.faults import Posterior
from pipeline.season_log.fit import Fit
from pipeline.tables.frames import dtypes
from pipeline.tables.season_log import SeasonDiagnosis, SeasonSteps

FOUND: Final = 0.5
"""A fault of this probability is in the model."""
POSSIBLE: Final = 0.1
"""One of this probability cannot be told."""
ALARM_SD: Final = 4.0
MIN_INFORMED_SHARE: Final = 0.05
"""Least share of a prior's variance that counts as learned from the archive. Where the archive says
nearly nothing of an effect, prior and posterior variance are equal but for rounding and for the
approximation of the posterior, and a quotient by their difference is no distance (inferred)."""
USUAL_SIZES: Final = 2.0
"""Faults beyond so many standard deviations of their prior are not usual."""
FAULT: Final = "fault"
ALARM: Final = "alarm"
SOUND: Final = "sound"
CANNOT_BE_TOLD: Final = "cannot be told"
WOULD_NOT_SHOW: Final = "would not show"
FORCES: Final = (FORCE, ZERO, ZERO_DRIFT)
ALTERED_BOAT: Final = "altered_boat"
"""What a fault that one boat alone shows may be instead."""

STEP_SCHEMA: Final = dtypes(SeasonSteps, without=["method"])
DIAGNOSIS_SCHEMA: Final = dtypes(SeasonDiagnosis, without=["method"])


def season_diagnosis(posterior: Posterior) -> pl.DataFrame:
    """The diagnosis of every season.

    Returns:
        Rows of `DIAGNOSIS_SCHEMA`. `estimate` with its 95 % interval is the logarithm of a factor,
        or newtons. `p_fault` is the probability that there is such a fault, null for what there
        always is. `distance_sd` is how far what is seen lies from what is assumed, in standard
        deviations. `verdict` is `sound`, `cannot be told`, `fault`, or `would not show`: a fault of
        the usual size would most likely be taken for something else. A fault that one boat alone
        shows cannot be told either: `shown_by` names the boat, which may have been altered, and
        the interval ends where all of it is the instrument's. For the factor of a log it
        is `estimated` or `not determined`; a distance of 4 is an `alarm`. Where the search did not
        come to rest, all are `not settled`. `alarm`: a person should look.
    """
    tows = posterior.fit.problem.tows
    effects = posterior.fit.problem.effects.frame.with_row_index("place").drop_nulls("season")
    rests_on = dict(_rests_on(tows).select("season", "rests_on").rows())
    rows = [
        {"season": season, "part": part, "instrument": name, "rests_on": rests_on[season]}
        | _judged(posterior, of_one)
        for (season, part, name), of_one in effects.sort(
            "season", "part", "name", "place"
        ).group_by("season", "part", "name", maintain_order=True)
    ]
    return pl.DataFrame(rows, schema=DIAGNOSIS_SCHEMA)


def _judged(posterior: Posterior, effects: pl.DataFrame) -> dict[str, object]:
    """What all effects of one season and instrument add up to.

    Args:
        effects: their rows of `Effects.frame`, with `place`.
    """
    fitted = posterior.fit
    name, places = effects["name"][0], effects["place"].to_numpy()
    columns = np.flatnonzero(np.isin(fitted.active, places))
    faults = np.flatnonzero(np.isin(fitted.problem.effects.faults, places))
    estimate = float(fitted.value[columns].sum())
    variance = float(fitted.covariance[np.ix_(columns, columns)].sum())
    half = NORMAL * np.sqrt(max(variance, 0.0))
    ends = [estimate - half, estimate + half]
    chance = min(float(posterior.chance[faults].sum()), 1.0) if len(faults) else None
    unresolved = next((one for one in posterior.unresolved if one.place in places), None)
    if unresolved is not None:
        ends.append(estimate + unresolved.size)
        chance = max(chance or 0.0, _chance_beside_alteration(fitted))
    distance = None if name == LOG_SCALE else _distance(posterior, columns)
    shows = bool(posterior.shows[faults].any())
    if not fitted.settled:
        verdict = NOT_SETTLED
    elif name == LOG_SCALE:
        verdict = _of_log(posterior, columns)
    elif unresolved is not None:
        verdict = CANNOT_BE_TOLD
    else:
        verdict = _verdict(chance, distance, shows)
    begins = None
    if chance is not None and chance >= POSSIBLE:
        begins = effects["first_tow"][
            int(len(effects) - len(faults) + posterior.chance[faults].argmax())
        ]
    return {
        "unit": "N" if name in (ZERO, ZERO_DRIFT) else "1",
        "estimate": estimate,
        "lo": min(ends),
        "hi": max(ends),
        "p_fault": chance,
        "distance_sd": distance,
        "verdict": verdict,
        "alarm": verdict in (FAULT, ALARM, CANNOT_BE_TOLD, NOT_SETTLED),
        "first_tow": begins,
        "shown_by": None if unresolved is None else ", ".join(unresolved.boats),
        "confused_with": _confused_with(
            posterior,
            columns,
            faults,
            of_one_boat=unresolved is not None or not posterior.has_boats[faults].all(),
        ),
    }


def _chance_beside_alteration(fitted: Fit) -> float:
    """Return the probability that an instrument failed and not that the one boat was altered.

    Both explain the boat's tows equally well, so their chances beforehand decide.
    """
    fault = fitted.problem.settings.fault_chance
    return float(fault / (fault + fitted.shares[0]))


def _distance(posterior: Posterior, columns: IntArray) -> float | None:
    """Return how far the archive moves an effect that is always there, in standard deviations."""
    fitted = posterior.fit
    always = columns[~fitted.is_fault[columns]]
    if not len(always):
        return None
    prior = fitted.problem.effects.column("variance", fitted.active[always[0]])
    learned = prior - fitted.covariance[always[0], always[0]]
    variance = max(learned, MIN_INFORMED_SHARE * prior)
    return float(fitted.value[always[0]] / np.sqrt(variance))


def _verdict(chance: float | None, distance: float | None, shows: bool) -> str:
    if chance is not None and chance >= FOUND:
        return FAULT
    if distance is not None and abs(distance) >= ALARM_SD:
        return ALARM
    if chance is None:
        return SOUND
    if chance >= POSSIBLE:
        return CANNOT_BE_TOLD
    return SOUND if shows else WOULD_NOT_SHOW


def _of_log(posterior: Posterior, columns: IntArray) -> str:
    """Whether the factor of a log is estimated; it has a column of the fit."""
    fitted = posterior.fit
    log = int(fitted.problem.tows.log[fitted.share[:, columns[0]] > 0][0])
    if posterior.refused[log]:
        return NOT_SETTLED
    return ESTIMATED if posterior.determined[log] else NOT_DETERMINED


def _confused_with(
    posterior: Posterior, columns: IntArray, faults: IntArray, of_one_boat: bool
) -> str | None:
    """Return what one of these faults would pass for if it does not show, and what for it.

    Args:
        of_one_boat: too few boats tell, so that an alteration of one would pass for the fault.
    """
    effects, active = posterior.fit.problem.effects, posterior.fit.active
    label, hidden = effects.frame["label"].to_numpy(), ~posterior.shows
    passes = active[posterior.hidden_by[faults[hidden[faults]]]]
    pass_for_it = effects.faults[hidden & np.isin(posterior.hidden_by, columns)]
    own = {*label[effects.faults[faults]], *label[active[columns]]}
    others = np.concatenate([passes, pass_for_it])
    names = [ALTERED_BOAT] if of_one_boat else []
    if of_one_boat:
        others = others[~np.isin(effects.column("name", others), OF_BOATS)]
    names += [name for name in dict.fromkeys(label[others]) if name not in own]
    return ", ".join(names) or None


def _rests_on(tows: ArchiveTows) -> pl.DataFrame:
    """What tells of each season: `season`, `n_boats` towed in others too, and `rests_on`."""
    elsewhere = pl.col("season").n_unique().over("boat") > 1
    plain = ~pl.col("anchored") & pl.col("gps_ln_ratio").is_not_null()
    named = {"plain GPS": plain, "dGPS": pl.col("anchored")}
    seasons = tows.frame.with_columns(elsewhere=elsewhere).group_by("season", maintain_order=True)
    told = seasons.agg(
        pl.col("boat").filter("elsewhere").n_unique().alias("n_boats"),
        *(pl.when(there.any()).then(pl.lit(name)).alias(name) for name, there in named.items()),
    )
    boats = pl.format("{} boats towed in other seasons too", "n_boats")
    rests_on = pl.concat_str(boats, *named, separator=", ", ignore_nulls=True)
    return told.select("season", "n_boats", rests_on=rests_on)


def season_steps(posterior: Posterior, diagnosis: pl.DataFrame) -> pl.DataFrame:
    """Whether the step of a season against the others comes from the log or from the load cell.

    Returns:
        Rows of `STEP_SCHEMA`: `level_step`, what log and load cell together do to ln Cw, and
        `force_step`, the part of the load cell, with standard deviations. `cause` is

        - `force` where a fault of the load cell is likelier than not;
        - `not told` where one cannot be told; where the season is not determined, or the search did
          not settle; and where a fault of the load cell would not show, and one no larger than
          usual could be the whole step;
        - `log` where the level differs by more than twice its standard deviation;
        - else `none`.
    """
    fitted, tows = posterior.fit, posterior.fit.problem.tows
    instruments = np.where(fitted.of_boats, 0.0, fitted.design[:, LEVEL])
    forces = np.where(np.isin(fitted.name, FORCES), instruments, 0.0)
    verdicts = {tuple(k): v for *k, v in diagnosis.select(*LOG, "instrument", "verdict").rows()}
    boats, rows = dict(_rests_on(tows).select("season", "n_boats").rows()), []
    for (season, part), mine in tows.frame.with_row_index().group_by(LOG, maintain_order=True):
        step, step_sd = _mean_effect(posterior, instruments[mine["index"]])
        force, force_sd = _mean_effect(posterior, forces[mine["index"]])
        of_force = {verdicts.get((season, 0, name)) for name in FORCES}
        of_log = verdicts.get((season, part, LOG_SCALE))
        steps = abs(step) > 2.0 * step_sd
        usual = abs(step) < USUAL_SIZES * fitted.problem.settings.force_fault_sd
        hidden = verdicts.get((season, 0, FORCE)) == WOULD_NOT_SHOW
        lost = of_log in (NOT_DETERMINED, NOT_SETTLED) or not fitted.settled
        if of_force & {FAULT, ALARM}:
            cause = "force"
        elif lost or CANNOT_BE_TOLD in of_force or (hidden and steps and usual):
            cause = "not told"
        else:
            cause = "log" if steps else "none"
        rows.append((season, part, boats[season], step, step_sd, force, force_sd, cause))
    return pl.DataFrame(rows, schema=STEP_SCHEMA, orient="row").sort(LOG)


def _mean_effect(posterior: Posterior, effects: FloatArray) -> tuple[float, float]:
    """Mean over tows of what effects do to ln Cw, and its standard deviation."""
    along = effects.mean(axis=0)
    variance = max(float(along @ posterior.fit.covariance @ along), 0.0)
    return float(along @ posterior.fit.value), float(np.sqrt(variance))
