"""Archives at the level of tows, with known truth: boats, schedule, log errors, repeat tows.

Fast enough for hundreds of worlds; what a tow's samples look like is left to `herijk.simulate`.
The set-ups are clean, and hard: logs that vary, boats that are altered and age.
"""

from dataclasses import dataclass

import numpy as np
import polars as pl

SEASONS = range(2009, 2019)
ANCHORED_FROM = 2014
GPS_FROM = 2011
RETOW_YEARS = (3, 4, 4, 5)
TYPES = 8
TOWS_A_DAY = 3


@dataclass(frozen=True)
class Setup:
    """What is wrong in a world. Ratios; alterations are not reported."""

    tows_a_season: int = 24
    boats: int = 90
    tow_noise: float = 0.01
    run_noise: float = 0.01
    wander: float = 0.0
    altered_share: float = 0.0
    altered_sd: float = 0.08
    ageing_per_year: float = 0.0
    ageing_apart_per_year: float = 0.0
    """More of it for every other boat, less for the others."""
    gps_run_error: float = 0.012
    gps_season_error: float = 0.003
    kappa_error: float = 0.03
    force_step: tuple[int, float] | None = None
    log_factors: tuple[tuple[int, float], ...] = ()
    day_sd: float = 0.0
    """Of ln Cw, of what three tows of one day share."""
    log_change: tuple[int, int, float] | None = None
    """Season, number of tows until its log was replaced, and change of the ln factor."""


CLEAN = Setup()
HARD = Setup(wander=0.012, altered_share=0.12, ageing_per_year=0.004)


@dataclass(frozen=True)
class World:
    tows: pl.DataFrame
    ln_factor: dict[int, float]


def simulate(setup: Setup, seed: int) -> World:
    rng, of_days = np.random.default_rng(seed), np.random.default_rng((seed, 1))
    ln_factor = {s: _true_ln_factor(s, rng) for s in SEASONS}
    ln_factor |= {s: float(np.log(f)) for s, f in setup.log_factors}
    gps_offset = {s: setup.gps_season_error * rng.standard_normal() for s in SEASONS}
    boats = _boats(setup.boats, rng)
    state = boats["ln_cw"].copy()
    ln_weight = boats["ln_weight"].copy()
    towed = np.zeros(setup.boats, bool)
    rows = []
    for season, crews in _schedule(setup):
        of_day = setup.day_sd * np.repeat(of_days.standard_normal(len(crews)), TOWS_A_DAY)
        for place, boat in enumerate(crews):
            if towed[boat] and rng.random() < setup.altered_share:
                state[boat] += setup.altered_sd * rng.standard_normal()
            towed[boat] = True
            change = 0.01 * rng.standard_normal()
            rows.append(
                _tow(
                    setup,
                    season,
                    boat,
                    boats,
                    state[boat],
                    ln_weight[boat] + change,
                    change,
                    ln_factor[season] + _replaced(setup, season, place),
                    gps_offset[season],
                    rng,
                )
            )
            rows[-1]["ln_cw"] += of_day[place]
            rows[-1]["day"] = _day(setup, place)
    tows = pl.DataFrame(rows, infer_schema_length=None).with_columns(
        (pl.col("season").cast(pl.String) + "-" + pl.int_range(pl.len()).cast(pl.String)).alias(
            "tow_id"
        )
    )
    return World(tows, {s: x for s, x in ln_factor.items() if s < ANCHORED_FROM})


def _day(setup, place):
    if setup.day_sd:
        return float(place // TOWS_A_DAY)
    return float(place) if setup.log_change else None


def _replaced(setup, season, place):
    """Change of the log's ln factor after it was replaced."""
    if setup.log_change is None:
        return 0.0
    when, first, change = setup.log_change
    return change if season == when and place >= first else 0.0


def _true_ln_factor(season, rng):
    if season <= 2011:
        return float(np.log1p(rng.uniform(0.0, 0.06)))
    return 0.015 * float(rng.standard_normal()) if season < ANCHORED_FROM else 0.0


def _boats(n, rng):
    kind = rng.integers(TYPES, size=n)
    ln_weight = np.log(900) + 0.05 * kind + 0.06 * rng.standard_normal(n)
    ln_length = np.log(8) + 0.02 * kind + 0.02 * rng.standard_normal(n)
    r = rng.uniform(0.18, 0.42, n)
    ln_cw = np.log(35) + 0.5 * (ln_weight - np.log(1000)) + 0.3 * (ln_length - np.log(8))
    ln_cw = ln_cw + 0.03 * np.cos(kind) + 0.05 * rng.standard_normal(n)
    return {"kind": kind, "ln_weight": ln_weight, "ln_length": ln_length, "r": r, "ln_cw": ln_cw}


def _schedule(setup):
    """Boats that are due, longest waiting first, then new ones, as long as there are."""
    due, newcomers = {}, list(range(setup.boats))
    for season in SEASONS:
        waiting = [b for _, b in sorted((when, b) for b, when in due.items() if when <= season)]
        crews = waiting[: setup.tows_a_season]
        while len(crews) < setup.tows_a_season and newcomers:
            crews.append(newcomers.pop(0))
        for place, boat in enumerate(crews):
            due[boat] = season + RETOW_YEARS[place % len(RETOW_YEARS)]
        yield season, crews


def _tow(setup, season, boat, boats, ln_cw, ln_weight, change, ln_factor, gps_offset, rng):
    anchored = season >= ANCHORED_FROM
    r, q = boats["r"][boat], boats["r"][boat] / (1 - boats["r"][boat])
    wander = 0.0 if anchored else setup.wander * rng.standard_normal()
    y2 = np.exp(2 * (0.0 if anchored else ln_factor + wander))
    ageing = setup.ageing_per_year + (-1) ** boat * setup.ageing_apart_per_year
    level = ln_cw + 0.4 * change + ageing * (season - 2009)
    truth = level
    q_log = r * y2 / (1 - r * y2)
    level += np.log(y2) - np.log((1 - r * y2) / (1 - r))
    if setup.force_step and setup.force_step[0] == season:
        level += np.log1p(setup.force_step[1])
    level += (
        setup.tow_noise * rng.standard_normal() + 0.41 * setup.run_noise * rng.standard_normal()
    )
    gps = None
    if GPS_FROM <= season < ANCHORED_FROM:
        gps = ln_factor + wander + gps_offset + setup.gps_run_error * rng.standard_normal()
    q_guess = q * (1 + setup.kappa_error * rng.standard_normal())
    return {
        "season": season,
        "part": 0,
        "fsn_no": f"FSN{100 + boat}",
        "rowers": 8,
        "crew_class": "H",
        "ln_cw": level,
        "reference_ln": 0.0,
        "true_ln_cw": truth,
        "true_ln_factor": ln_factor + wander,
        "kappa": 2 * (1 + q_guess),
        "ln_cw_sd": 0.41 * setup.run_noise,
        "weight_kg": float(np.exp(ln_weight)),
        "waterline_length_m": float(np.exp(boats["ln_length"][boat])),
        "boat_type": f"type {boats['kind'][boat]}",
        "altered": False,
        "declared_speed_m_s": 2.5,
        "gps_ln_ratio": gps,
        "gps_sd": 0.01,
        "anchored": anchored,
        "temperature_known": True,
        "water_off_c": 0.0,
        "own_calibration_ln": None,
        "others_calibration_ln": None,
        "others_calibration_sd": None,
        "force_sd": None,
        "q": q_log + 2.5 * setup.run_noise * rng.standard_normal(),
        "q_sd": 2.5 * setup.run_noise,
        "ln_cw_q_cov": 0.0,
    }
