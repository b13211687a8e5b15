"""Numbers that every method has alike: nobody votes about them.

Sources: P2015 is the presentation of R. Pot, 24 January 2015; S2017 is his "Sleepproef" of 2017.
"""

from typing import Any, Final

SHORTEST_WINDOW_S: Final = 30
"""Length of the shortest window that counts (S2017: "minimaal 30 seconden stabiele meting")."""

SPEED_ENDS_M_S: Final = 0.1
"""Allowed difference of the speed between the ends of a window (S2017, "Knippen")."""

FORCE_ENDS_RATIO: Final = 0.1
"""The same of the force, as a share of its median (inferred; S2017: "equal force")."""

REFERENCE_WATER_C: Final = 15.0
"""Water to which tows are brought (inferred; usual in towing tanks)."""

FEWEST_RUNS: Final = 4
"""Runs from which a curve is fitted (inferred)."""

CAP_HULL_SPEEDS: Final = 3.0
"""Largest B, in hull speeds, where it is capped (P2015: "B-waarden maximeren aan 3x")."""

FORMER_OPTIONS: Final[dict[str, dict[str, Any]]] = {
    "window": {
        "minimum_s": float(SHORTEST_WINDOW_S),
        "speed_drift_m_s": SPEED_ENDS_M_S,
        "force_ends_ratio": FORCE_ENDS_RATIO,
    },
    "wind": {"reading": "as_felt"},
    "temperature": {"reference_c": REFERENCE_WATER_C},
    "runs": {"minimum": FEWEST_RUNS},
    "curve": {"cap_hull_speeds": CAP_HULL_SPEEDS},
}
"""The constants by the names they had as options; the hash of a method is made with them."""
