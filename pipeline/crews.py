"""Classes of crews: what people call each, and the limits that its power and weight are held to.

The classes of the Dutch federation are the default; an archive declares others under `[[crew]]` in
`archief.toml`. They travel as a frame, the table `crew_classes`, to whatever compares with them.
"""

from typing import Final

import polars as pl

POWER_PER_ROWER: Final = "power_per_rower"
"""Handicap by which the crew with the highest power per rower wins."""

TIME_ON_TIME: Final = "time_on_time"
"""Handicap by which a race time is multiplied by how fast the boat is at one power per rower."""

CREW_SCHEMA: Final = {
    "crew_class": pl.String(),
    "name": pl.String(),
    "lowest_power_w": pl.Float64(),
    "highest_power_w": pl.Float64(),
    "slow_power_w": pl.Float64(),
    "raced_power_w": pl.Float64(),
    "lightest_rower_kg": pl.Float64(),
    "heaviest_rower_kg": pl.Float64(),
    "handicap": pl.String(),
}

STANDARD_CREWS: Final = pl.DataFrame(
    [
        ("H", "men", 70.0, 90.0, 60.0, 100.0, 81.0, 114.0, POWER_PER_ROWER),
        ("D", "women", 40.0, 55.0, 34.0, 57.0, 64.0, 90.0, POWER_PER_ROWER),
    ],
    CREW_SCHEMA,
    orient="row",
)
"""Men and women of the Dutch federation. Power per rower at a realistic tow speed is 70-90 W and
40-55 W (Sleepproef, R. Pot 2017, "Sleepsnelheid"). A tow is too slow under "60-70 Watt", and in a
race men give "meer dan 100 Watt" (Cw-kromme, R. Pot 2015); of women the same shares of their range
(inferred). A rower weighs, in clothes, within a fifth of 95 and 75 kg (inferred from the same)."""


def get_limits(crews: pl.DataFrame, column: str) -> dict[str, float | None]:
    """Return a limit of each class, by its code; None where a class has no such limit.

    Args:
        crews: rows of `crew_classes`.
        column: the limit, by its name in `CREW_SCHEMA`.
    """
    return dict(crews.select("crew_class", column).rows())


def get_usual_power(crews: pl.DataFrame) -> dict[str, float]:
    """Return the middle of the realistic power per rower [W] of each class, by its code."""
    middle = pl.mean_horizontal("lowest_power_w", "highest_power_w")
    return dict(crews.select("crew_class", middle.alias("power_w")).rows())
