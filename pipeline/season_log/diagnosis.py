"""What is wrong with the instruments of each season: one row per season and possible fault.

Every season has them all, dGPS or not: dGPS anchors speed and nothing else. Where a fault cannot be
told from another, both rows say so.
"""

from typing import Final

import numpy as np
import polars as pl
import scipy

from pipeline.arrays import IntArray
from pipeline.quantiles import LEVEL as INTERVAL_LEVEL
from pipeline.quantiles import NORMAL
from pipeline.season_log.archive import Archive
from pipeline.season_log.factors import ESTIMATED, NOT_DETERMINED, NOT_SETTLED
from pipeline.season_log.faults import Posterior
from pipeline.season_log.fit import Fit
from pipeline.season_log.observation_model import (
    BOAT_EFFECTS,
    FORCE,
    LOG_SCALE,
    ZERO,
    ZERO_DRIFT,
)
from pipeline.season_log.season_levels import SeasonLevel, compare_season_levels
from pipeline.tables.frames import get_dtypes
from pipeline.tables.keys import SEASON_LEVEL, WOULD_NOT_SHOW
from pipeline.tables.season_log import SeasonDiagnosis

FAULT_PROBABILITY: Final = 0.5
"""Probability from which a fault is in the model."""
DOUBT_PROBABILITY: Final = 0.1
"""Probability from which a fault cannot be excluded."""
ALARM_SD: Final = 4.0
"""Distance of a permanent effect from its prior, in standard deviations, that is an alarm."""
MIN_INFORMED_SHARE: Final = 0.05
"""Least share of a prior's variance that counts as learned from the archive. Where the archive says
nearly nothing of an effect, prior and posterior variance are equal but for rounding and for the
approximation of the posterior, and a quotient by their difference is no distance (inferred)."""
FAULT: Final = "fault"
ALARM: Final = "alarm"
SOUND: Final = "sound"
CANNOT_BE_TOLD: Final = "cannot be told"
ALTERED_BOAT: Final = "altered_boat"
"""What a fault that one boat alone shows may be instead."""
LEVEL_CAUSES: Final = ("mass_on_board", "water_depth", "waves", "force_not_linear")
"""What a level of a season may be that is no fault of the model."""
CAUSES_BESIDE_FAULT: Final = {FORCE: LEVEL_CAUSES, ZERO: ("force_not_linear",)}
"""What a fault of the load cell may be instead that is no fault of the model."""
MAX_LEVEL: Final = np.log(1.02)
"""Level in ln Cw from which a person should look: two tows agree within 2 % (P2015)."""
MAX_LEVEL_HALF_WIDTH: Final = 2.0 * MAX_LEVEL
"""Half width of the interval of a level beyond which it would not show. It is passed where nothing
but the bend tells the level from the log."""

DIAGNOSIS_SCHEMA: Final = get_dtypes(SeasonDiagnosis, without=["method"])


def diagnose_seasons(posterior: Posterior) -> pl.DataFrame:
    """Return the diagnosis of every season.

    Returns:
        Rows of `DIAGNOSIS_SCHEMA`. `estimate` with its 95 % interval is the logarithm of a factor,
        or newtons. `p_fault` is the probability that there is such a fault, null for an effect that
        there always is. `distance_sd` is how far the estimate lies from its prior, in standard
        deviations. `verdict` is `sound`, `fault`, `cannot be told`, or `would not show`: a fault of
        the usual size would most likely be taken for something else; `alarm` for a distance of 4;
        of the factor of a log `estimated` or `not determined`; `not settled` of everything where
        the search did not converge. A fault that one boat alone shows cannot be told either:
        `shown_by` names the boat, which may have been altered, and the interval ends where all of
        it is the instrument's. `alarm`: a person should look; not at what is less probable than
        its absence.
    """
    instruments: dict[tuple[int, int, str], list[int]] = {}
    for place, effect in enumerate(posterior.fit.model.effects.listed):
        if effect.season is not None:
            instruments.setdefault((effect.season, effect.part, effect.name), []).append(place)
    evidence = _describe_evidence(posterior.fit.model.archive)
    rows = []
    for season, part, name in sorted(instruments):
        places = np.array(instruments[season, part, name])
        row = {"season": season, "part": part, "instrument": name, "rests_on": evidence[season]}
        rows.append(row | _diagnose_instrument(posterior, name, places))
    levels = compare_season_levels(posterior.fit)
    for season, level in levels.items():
        row = {"season": season, "part": 0, "rests_on": evidence[season]}
        rows.append(row | _diagnose_level(level, len(levels), posterior.fit.has_converged))
    return pl.DataFrame(rows, schema=DIAGNOSIS_SCHEMA).sort("season", "part", "instrument")


def _diagnose_level(level: SeasonLevel, n_seasons: int, has_converged: bool) -> dict[str, object]:
    """Return the diagnosis of what all tows of a season have in common.

    It is an alarm where it is 2 % or more and its interval excludes none. The interval holds for
    all seasons together with 95 % (Bonferroni): of ten seasons one would else be an alarm by chance
    in every other archive with plain GPS.
    """
    error_rate = (1.0 - INTERVAL_LEVEL) / n_seasons
    half_width = float(scipy.special.ndtri(1.0 - 0.5 * error_rate)) * level.sd
    is_alarm = abs(level.ln_ratio) >= max(MAX_LEVEL, half_width)
    if not has_converged:
        verdict = NOT_SETTLED
    elif half_width > MAX_LEVEL_HALF_WIDTH:
        verdict = WOULD_NOT_SHOW
    else:
        verdict = ALARM if is_alarm else SOUND
    return {
        "instrument": SEASON_LEVEL,
        "unit": "1",
        "estimate": level.ln_ratio,
        "lo": level.ln_ratio - half_width,
        "hi": level.ln_ratio + half_width,
        "distance_sd": level.ln_ratio / level.sd,
        "verdict": verdict,
        "alarm": verdict in (ALARM, NOT_SETTLED),
        "confused_with": ", ".join(LEVEL_CAUSES) if verdict == ALARM else None,
    }


def _diagnose_instrument(posterior: Posterior, name: str, places: IntArray) -> dict[str, object]:
    """Return the diagnosis of one instrument in one season.

    Args:
        places: its effects: one that there always is, candidate faults, or both.
    """
    fit, effects = posterior.fit, posterior.fit.model.effects
    columns = np.flatnonzero(np.isin(fit.active, places))
    candidates = np.flatnonzero(np.isin(effects.faults, places))
    estimate = float(fit.value[columns].sum())
    variance = float(fit.covariance[np.ix_(columns, columns)].sum())
    half_width = NORMAL * np.sqrt(max(variance, 0.0))
    bounds = [estimate - half_width, estimate + half_width]

    probability = None
    first_tow = None
    if len(candidates):
        probability = min(float(posterior.probability[candidates].sum()), 1.0)
    unresolved = next((one for one in posterior.unresolved if one.place in places), None)
    if unresolved is not None:
        bounds.append(estimate + unresolved.size)
        # An alteration explains the boat's tows equally well, so prior probabilities decide.
        fault_probability = fit.model.priors.fault_probability
        of_instrument = float(fault_probability / (fault_probability + fit.share[0]))
        probability = max(probability or 0.0, of_instrument)
    if probability is not None and probability >= DOUBT_PROBABILITY:
        likeliest = effects.faults[candidates[posterior.probability[candidates].argmax()]]
        first_tow = effects.listed[likeliest].first_tow

    distance = None if name == LOG_SCALE else _measure_distance_from_prior(fit, columns)
    if not fit.has_converged:
        verdict = NOT_SETTLED
    elif name == LOG_SCALE:
        verdict = _judge_log(posterior, columns[0])
    elif unresolved is not None:
        verdict = CANNOT_BE_TOLD
    else:
        would_show = bool(posterior.would_show[candidates].any())
        verdict = _judge_fault(probability, distance, would_show)
    has_too_few_boats = unresolved is not None or not posterior.has_boats[candidates].all()
    confusions = _list_confusions(posterior, columns, candidates, has_too_few_boats)
    if verdict == FAULT:
        confusions += CAUSES_BESIDE_FAULT.get(name, ())
    return {
        "unit": "N" if name in (ZERO, ZERO_DRIFT) else "1",
        "estimate": estimate,
        "lo": min(bounds),
        "hi": max(bounds),
        "p_fault": probability,
        "distance_sd": distance,
        "verdict": verdict,
        "alarm": verdict in (FAULT, ALARM, NOT_SETTLED) or unresolved is not None,
        "first_tow": first_tow,
        "shown_by": None if unresolved is None else ", ".join(unresolved.boats),
        "confused_with": ", ".join(confusions) or None,
    }


def _measure_distance_from_prior(fit: Fit, columns: IntArray) -> float | None:
    """Return how far the archive moves an effect that is always there, in standard deviations.

    Args:
        columns: effects of the fit of one instrument in one season.
    """
    permanent = columns[~fit.is_fault[columns]]
    if not len(permanent):
        return None
    place = permanent[0]
    prior = fit.prior_variance[place]
    learned = prior - fit.covariance[place, place]
    return float(fit.value[place] / np.sqrt(max(learned, MIN_INFORMED_SHARE * prior)))


def _judge_fault(probability: float | None, distance: float | None, would_show: bool) -> str:
    if probability is not None and probability >= FAULT_PROBABILITY:
        return FAULT
    if distance is not None and abs(distance) >= ALARM_SD:
        return ALARM
    if probability is None:
        return SOUND
    if probability >= DOUBT_PROBABILITY:
        return CANNOT_BE_TOLD
    return SOUND if would_show else WOULD_NOT_SHOW


def _judge_log(posterior: Posterior, column: int) -> str:
    """Return whether the factor of the log with this effect is estimated."""
    fit = posterior.fit
    log = fit.model.archive.log[fit.covariate[:, column] > 0][0]
    if posterior.is_refused[log]:
        return NOT_SETTLED
    return ESTIMATED if posterior.is_determined[log] else NOT_DETERMINED


def _list_confusions(
    posterior: Posterior, columns: IntArray, candidates: IntArray, has_too_few_boats: bool
) -> list[str]:
    """Return what these faults pass for while they do not show, and what would pass for them.

    Args:
        has_too_few_boats: an alteration of one boat would pass for the fault.
    """
    fit, effects, test = posterior.fit, posterior.fit.model.effects, posterior.test
    is_hidden = ~posterior.would_show
    pass_for = fit.active[test.displaced[candidates[is_hidden[candidates]]]]
    taken_for_this = effects.faults[is_hidden & np.isin(test.displaced, columns)]
    others = [effects.listed[place] for place in np.concatenate([pass_for, taken_for_this])]
    own_places = np.concatenate([effects.faults[candidates], fit.active[columns]])
    own_labels = {effects.listed[place].label for place in own_places}
    labels = []
    if has_too_few_boats:
        labels.append(ALTERED_BOAT)
        others = [effect for effect in others if effect.name not in BOAT_EFFECTS]
    other_labels = dict.fromkeys(effect.label for effect in others)
    labels += [label for label in other_labels if label not in own_labels]
    return labels


def _describe_evidence(archive: Archive) -> dict[int, str]:
    """Return what each season rests on, in words."""
    frame = archive.frame.with_columns(boat=archive.boat)
    described = {}
    observed = frame.filter(archive.is_observed)
    linked = observed.filter(pl.col("season").n_unique().over("boat") > 1)
    for season in frame["season"].unique().sort():
        tows = observed.filter(season=season)
        boats = linked.filter(season=season)["boat"].n_unique()
        words = [f"{boats} boats towed in other seasons too"]
        if tows.filter(~pl.col("anchored") & pl.col("gps_ln_ratio").is_not_null()).height:
            words.append("plain GPS")
        if tows["anchored"].any():
            words.append("dGPS")
        described[season] = ", ".join(words)
    return described
