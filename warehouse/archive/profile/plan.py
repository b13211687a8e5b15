"""The runs that a tow is meant to have."""

from dataclasses import dataclass
from typing import Final

from pipeline.channels import BACK, OUT, RUN_SECONDS, TARGET_SPEED_RATIOS


@dataclass(frozen=True)
class Plan:
    """The runs that a tow is meant to have.

    Attributes:
        targets: intended speed / declared speed of each run.
        directions: `OUT` or `BACK`, of each run.
        seconds: how long a run is meant to last.
        second_directions: of the runs of a second file, where these belong to the tow; empty where
            a second file is another tow, of which the list names the runs to use.
    """

    targets: tuple[float, ...] = TARGET_SPEED_RATIOS * 2
    directions: tuple[int, ...] = (OUT, OUT, OUT, BACK, BACK, BACK)
    seconds: float = RUN_SECONDS
    second_directions: tuple[int, ...] = ()

    @property
    def runs(self) -> range:
        """Numbers of the runs."""
        return range(1, len(self.targets) + 1)


STANDARD: Final = Plan()
