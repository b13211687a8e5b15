"""A mock instrument: tow tests whose truth is known, with every defect switchable by name.

`simulate_world` decides boats, schedule and truth; `simulate_tow` delivers the samples of one
tow. Arrays and frames only: writing an archive is `simulate.archive_writer`. What is assumed,
and where it comes from, is on the page `docs/simulator.md`.
"""

from herijk.simulate.defects import Defects
from herijk.simulate.hull import AirCoefficients, true_cw_kg_m
from herijk.simulate.motion import Disturbance, RunTruth
from herijk.simulate.tow import simulate_tow
from herijk.simulate.world import Tow, TowTruth, World, WorldSettings, simulate_world
from herijk.simulate.worlds import WORLDS, NamedWorld, world_settings

__all__ = [
    "WORLDS",
    "AirCoefficients",
    "Defects",
    "Disturbance",
    "NamedWorld",
    "RunTruth",
    "Tow",
    "TowTruth",
    "World",
    "WorldSettings",
    "simulate_tow",
    "simulate_world",
    "true_cw_kg_m",
    "world_settings",
]
