"""The options of a method's steps as arrays: what each tow, or each run, is computed with.

A method names its options as words, per season. Here they become one typed array per option, so
that a step asks `options.wind.ahead` and a misspelt name is an error before anything runs.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from typing import Any, Self

import numpy as np

from pipeline.arrays import BoolArray, FloatArray, IntArray, StrArray
from pipeline.method.options import Steps


@dataclass(frozen=True)
class _Group:
    """Options that belong together, an array of one length each."""

    def take(self, rows: IntArray) -> Self:
        """Return the options of some rows: of tows by run, for example."""
        return type(self)(**{one.name: getattr(self, one.name)[rows] for one in fields(self)})


@dataclass(frozen=True)
class SpeedOptions(_Group):
    """What is known to be wrong with the log, and how it is brought to ground speed.

    Attributes:
        correction: `none`, `prescribed` or `estimated`.
        factor: the prescribed factor.
        is_calibrated: the log is calibrated on dGPS, tow by tow.
    """

    correction: StrArray
    factor: FloatArray
    is_calibrated: BoolArray


@dataclass(frozen=True)
class RunOptions(_Group):
    """Which part of a run counts, which runs, and how a window becomes a point.

    Attributes:
        is_trimmed: only the steady window counts.
        highest_target_ratio: fastest run / declared speed.
        uses_mean_of_ratios: mean of F / v^2, else mean F / mean v squared.
        is_robust: seconds that lie far from the others count less in those means.
        corrects_inertia: force that accelerated the boat is taken out.
        force_ratio: load cell reading / true force.
    """

    is_trimmed: BoolArray
    highest_target_ratio: FloatArray
    uses_mean_of_ratios: BoolArray
    is_robust: BoolArray
    corrects_inertia: BoolArray
    force_ratio: FloatArray


@dataclass(frozen=True)
class WindOptions(_Group):
    """How the resistance in air is taken off.

    Attributes:
        is_oblique: the oblique wind model, else head wind.
        coefficients: `fixed` or `per_run`.
        ahead, behind, side: drag coefficients.
        averaging_s: seconds over which the wind vector is averaged.
        estimates_anemometer: the scale of the anemometer is estimated, else taken as it reads.
    """

    is_oblique: BoolArray
    coefficients: StrArray
    ahead: FloatArray
    behind: FloatArray
    side: FloatArray
    averaging_s: IntArray
    estimates_anemometer: BoolArray


@dataclass(frozen=True)
class StepOptions:
    """All options of the steps, of tows or of runs.

    Attributes:
        corrects_temperature: resistance is brought to one water temperature.
        expects_unrecorded: other tows say what nobody recorded.
        caps_b: B is at most `constants.CAP_HULL_SPEEDS`.
    """

    speed: SpeedOptions
    run: RunOptions
    wind: WindOptions
    corrects_temperature: BoolArray
    expects_unrecorded: BoolArray
    caps_b: BoolArray

    @classmethod
    def from_steps(cls, steps: Sequence[Steps], which: IntArray) -> Self:
        """Return the options of each tow.

        Args:
            steps: those that some tow follows.
            which: (tows,) place of each tow's steps.
        """

        def words(option: Callable[[Steps], str]) -> StrArray:
            return np.array([option(one) for one in steps], dtype=np.str_)[which]

        def numbers(option: Callable[[Steps], float]) -> FloatArray:
            return np.array([option(one) for one in steps], dtype=np.float64)[which]

        def flags(option: Callable[[Steps], bool]) -> BoolArray:
            return np.array([option(one) for one in steps], dtype=np.bool_)[which]

        return cls(
            speed=SpeedOptions(
                correction=words(lambda s: s.speed.correction),
                factor=numbers(lambda s: s.speed.factor),
                is_calibrated=flags(lambda s: s.calibration.rule == "gps_per_tow"),
            ),
            run=RunOptions(
                is_trimmed=flags(lambda s: s.window.rule == "steady"),
                highest_target_ratio=numbers(lambda s: s.runs.highest_target_ratio),
                uses_mean_of_ratios=flags(lambda s: s.run_point.estimator == "mean_of_ratios"),
                is_robust=flags(lambda s: s.run_point.estimator == "ratio_of_robust_means"),
                corrects_inertia=flags(lambda s: s.run_point.inertia == "end_speeds"),
                force_ratio=numbers(lambda s: s.force.ratio),
            ),
            wind=WindOptions(
                is_oblique=flags(lambda s: s.wind.model == "oblique"),
                coefficients=words(lambda s: s.wind.coefficients),
                ahead=numbers(lambda s: s.wind.ahead),
                behind=numbers(lambda s: s.wind.behind),
                side=numbers(lambda s: s.wind.side),
                averaging_s=numbers(lambda s: s.wind.averaging_s).astype(np.int64),
                estimates_anemometer=flags(lambda s: s.wind.anemometer == "estimated"),
            ),
            corrects_temperature=flags(lambda s: s.temperature.rule == "ittc57"),
            expects_unrecorded=flags(lambda s: s.unrecorded.rule == "expected"),
            caps_b=flags(lambda s: s.curve.b == "capped"),
        )

    def take(self, rows: IntArray) -> "StepOptions":
        """Return the options of some rows: of tows by run, for example."""
        taken: dict[str, Any] = {}
        for one in fields(self):
            value = getattr(self, one.name)
            taken[one.name] = value.take(rows) if isinstance(value, _Group) else value[rows]
        return StepOptions(**taken)
