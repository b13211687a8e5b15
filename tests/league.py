"""The simulated tows of the example of docs/other-registers.md: `python -m tests.league` writes it.

An invented league with boats, classes of crews, files and a tow test of its own. Lists and samples
are written here; the profile, the methods and the settings are written by hand.
"""

import csv
import datetime as dt
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np
import polars as pl

from herijk.simulate import Defects, Tow, World, WorldSettings, simulate_tow, simulate_world
from herijk.simulate.boats import Boat, BoatType, load_hull, speed_at_power_m_s
from herijk.simulate.hull import true_cw_kg_m
from tests.architecture.repository import ROOT

ARCHIVE: Final = ROOT / "docs" / "examples" / "league" / "archive"
KNOT_M_S: Final = 1852.0 / 3600.0
SIMULATED_HZ: Final = 4
KEPT_HZ: Final = 2
RUN_S: Final = 40
LEGS: Final = {1: 1, 3: 2, 4: 3, 6: 4}
"""The four runs of the league, by the run of the simulator: out and back at 90 and 110 %."""
LOG_FACTORS: Final = {2025: 1.016, 2026: 0.994}
"""True speed / log speed of the log of each season."""
USUAL_W: Final = {"M": 70.0, "W": 45.0, "X": 57.5}
ROWER_KG: Final = {"M": 85.0, "W": 68.0, "X": 76.0}
WATER_C: Final = {2025: 9.0, 2026: 12.0}
RACE_KM: Final = 9.0

SKIFF: Final = BoatType(
    "Coastal skiff", 1.0, 4, 6.10, 1.70, 0.75, 155, 2.8, 0.10, 0.070, 2.0, 0.010, 3.3
)
GIG: Final = BoatType("Pilot gig", 1.0, 6, 9.30, 1.45, 0.80, 330, 2.8, 0.08, 0.060, 2.4, 0.010, 5.5)
FLEET: Final = (
    # number, name, type, weight, roughness
    (3, "Solan", SKIFF, 152, 1.00),
    (7, "Kittiwake", SKIFF, 158, 1.02),
    (12, "Marram", SKIFF, 171, 1.01),
    (21, "Lady Jane", GIG, 322, 1.00),
    (22, "Steadfast", GIG, 341, 1.03),
    (30, "Harbour Lass", GIG, 335, 0.99),
)
TOWS: Final = (
    # tow, boat, class, power as a part of the usual
    ("2025-01", 3, "M", 1.0),
    ("2025-02", 7, "W", 1.05),
    ("2025-03", 21, "M", 0.95),
    ("2025-04", 22, "X", 1.0),
    ("2026-01", 3, "M", 1.0),
    ("2026-02", 12, "W", 1.0),
    ("2026-03", 30, "X", 1.1),
)
RESULTS: Final = ((3, "M", 1.25), (21, "M", 1.2), (7, "W", 1.2), (12, "W", 1.3), (22, "X", 1.3),
                  (30, "X", 1.2))  # fmt: skip
"""Of the race: boat, class, and power as a part of the usual."""

DEFECTS: Final = Defects(
    log_tow_sd=0.003, log_run_wander=0.002, log_noise_m_s=0.02, gps_noise_m_s=0.01, gps_hold_s=1.0,
    stream_m_s=0.15, wind_m_s=2.5, wind_turbulence=0.2, vane_jitter_deg=8.0, speed_miss=0.01,
    speed_wander_m_s=0.015, surge_force=0.03, force_noise=0.03, inertia=1.0,
)  # fmt: skip


def make_boats(template: Boat) -> dict[int, Boat]:
    """Return the fleet by the numbers of its boats."""
    boats = {}
    for index, (number, name, boat_type, weight, roughness) in enumerate(FLEET):
        boats[number] = replace(
            template,
            index=index,
            name=name,
            boat_type=boat_type,
            waterline_length_m=boat_type.waterline_length_m,
            beam_m=boat_type.beam_m,
            bow_height_m=boat_type.bow_height_m,
            weight_kg=float(weight),
            roughness=roughness,
        )
    return boats


def make_world() -> tuple[World, dict[int, Boat], list[Tow]]:
    """Return a world with the league's instruments, its fleet, and its tows."""
    settings = WorldSettings(seasons=(2018,), tows_per_season=1, rate_hz=SIMULATED_HZ, seed=65)
    drawn = simulate_world(settings)
    world = replace(drawn, settings=replace(settings, defects=lambda _: DEFECTS))
    boats = make_boats(drawn.boats[0])
    tows = [make_tow(world, boats, *row) for row in TOWS]
    return world, boats, tows


def make_tow(
    world: World, boats: dict[int, Boat], tow_id: str, number: int, crew_class: str, effort: float
) -> Tow:
    """Return one tow, with the hull of its boat and the speed that its power gives."""
    season, place = int(tow_id[:4]), int(tow_id[5:])
    boat, air = boats[number], world.settings.air
    rowers = boat.boat_type.rowers
    hull = load_hull(boat, ROWER_KG[crew_class] * (rowers + 1), boat.weight_kg, 1.0)
    power_w = effort * USUAL_W[crew_class]
    speed = round(speed_at_power_m_s(hull, power_w, rowers, WATER_C[season], air), 2)
    cw = float(true_cw_kg_m(hull, np.array(speed), 15.0, air))
    first = world.tows[0]
    return replace(
        first,
        tow_id=tow_id,
        season=season,
        number=place,
        day=dt.date(season, 4, 4 + place),
        boat=boat,
        rowers=rowers,
        crew_class=crew_class,
        declared_speed_m_s=speed,
        weight_kg=boat.weight_kg,
        water_temperature_c=WATER_C[season],
        fast_run=False,
        hull=hull,
        truth=replace(
            first.truth,
            cw_at_15c_kg_m=cw,
            log_factor=LOG_FACTORS[season],
            second_log_factor=None,
            force_zero_n=0.0,
            askew_ratio=1.0,
        ),
    )


def name_file(tow: Tow) -> str:
    """Return the name of the samples file of a tow, without suffix."""
    return f"{tow.boat.name.lower()} {tow.crew_class.lower()}"


def tabulate_samples(world: World, tow: Tow) -> pl.DataFrame:
    """Return the samples of a tow as the league writes them: four legs, speeds in knots."""
    samples, _ = simulate_tow(world, tow)
    leg = pl.col("run").cast(pl.Int64).replace_strict(LEGS, default=None, return_dtype=pl.Int64)
    numbered = samples.with_columns(leg=leg, place=pl.int_range(pl.len()).over("run"))
    kept = numbered.filter(
        pl.col("leg").is_not_null(),
        pl.col("place") < RUN_S * SIMULATED_HZ,
        pl.col("place") % (SIMULATED_HZ // KEPT_HZ) == 0,
    )
    return kept.select(
        "leg",
        (pl.col("log1_m_s") / KNOT_M_S).round(2).alias("log [kn]"),
        (pl.col("gps_m_s") / KNOT_M_S).round(2).alias("gps [kn]"),
        pl.col("force_n").round(0).cast(pl.Int64).alias("pull [N]"),
        (pl.col("wind_speed_m_s") / KNOT_M_S).round(1).alias("wind [kn]"),
        pl.col("wind_angle_deg").round(0).cast(pl.Int64).alias("wind from [deg]"),
    )


def list_boats(boats: dict[int, Boat]) -> list[dict[str, Any]]:
    """Return the rows of the list of boats: each with every class that was towed or raced."""
    classes = {number: crew_class for number, crew_class, _ in RESULTS}
    return [
        {
            "Boat no": number,
            "Boat": boat.name,
            "Class": boat.boat_type.name,
            "Length [m]": boat.waterline_length_m,
            "Beam [m]": boat.beam_m,
            "Bow [m]": boat.bow_height_m,
            "Weight [kg]": f"{boat.weight_kg:g}",
            "Rowers": boat.boat_type.rowers,
            "Crew": classes[number],
        }
        for number, boat in boats.items()
    ]


def list_tows(tows: Sequence[Tow]) -> list[dict[str, Any]]:
    """Return the rows of a list of tows."""
    numbers = {name: number for number, name, *_ in FLEET}
    return [
        {
            "Tow": tow.tow_id,
            "Date": tow.day.isoformat(),
            "Boat no": numbers[tow.boat.name],
            "File": name_file(tow),
            "Rowers": tow.rowers,
            "Crew": tow.crew_class,
            "Declared speed [kn]": f"{tow.declared_speed_m_s / KNOT_M_S:.2f}",
            "Length [m]": tow.boat.waterline_length_m,
            "Beam [m]": tow.boat.beam_m,
            "Bow [m]": tow.boat.bow_height_m,
            "Weight [kg]": f"{tow.weight_kg:g}",
            "Crew weight [kg]": f"{ROWER_KG[tow.crew_class] * (tow.rowers + 1):g}",
            "Water [C]": tow.water_temperature_c,
            "Altered": "no",
        }
        for tow in tows
    ]


def list_results(world: World, tows: Sequence[Tow]) -> list[dict[str, Any]]:
    """Return the rows of the race, rowed by the true curves."""
    rows = []
    newest = {(tow.boat.name, tow.crew_class): tow for tow in tows}
    names = {number: name for number, name, *_ in FLEET}
    for number, crew_class, effort in RESULTS:
        tow = newest[names[number], crew_class]
        power_w = effort * USUAL_W[crew_class]
        speed = speed_at_power_m_s(tow.hull, power_w, tow.rowers, 14.0, world.settings.air)
        seconds = round(1000.0 * RACE_KM / speed)
        rows.append(
            {
                "Race": "Autumn Head",
                "Date": "2026-09-12",
                "Distance [km]": RACE_KM,
                "Boat no": number,
                "Rowers": tow.rowers,
                "Crew": crew_class,
                "Time": str(dt.timedelta(seconds=seconds)),
            }
        )
    return rows


def write_list(name: str, rows: Sequence[dict[str, Any]]) -> None:
    """Write rows as a list of the archive."""
    path = ARCHIVE / name
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def main() -> None:
    """Write lists and samples of the example."""
    world, boats, tows = make_world()
    write_list("boats/boats.csv", list_boats(boats))
    for season in WATER_C:
        own = [tow for tow in tows if tow.season == season]
        write_list(f"tows/tows_{season}.csv", list_tows(own))
        folder = ARCHIVE / f"samples_{season}"
        folder.mkdir(exist_ok=True)
        for tow in own:
            tabulate_samples(world, tow).write_csv(folder / f"{name_file(tow)}.csv")
    write_list("races/autumn_head_2026.csv", list_results(world, tows))


if __name__ == "__main__":
    main()
