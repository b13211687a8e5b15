"""Columns that more than one table has; here so that naming them imports nothing."""

from typing import Final

LINE: Final = ("fsn_no", "rowers", "crew_class")
"""What names a line of the register: a boat and one of its crews."""

SIZES: Final = ("waterline_length_m", "beam_m", "bow_height_m", "weight_kg")
"""What the register says of a boat on the day of its tow (Sleepproef 2017, "Opmetingen")."""

HAND_COLUMNS: Final = {"start_s": "hand_start_s", "end_s": "hand_end_s", "reason": "hand_reason"}
"""Columns of the windows given by hand beside the runs of a tow, by their name in `hand_windows`;
null where a run has none."""

UNKNOWN_TYPE: Final = "unknown"
"""The type of boats of which the archive names none."""

CW_STANDARD, B, A = "cw_standard_kg_m", "b_m_s", "a_kg_m"
QUANTITIES: Final = (CW_STANDARD, B, A)
"""What boats of a type are compared by, as `type_consistency` names it, the weightiest first."""

WEIGHT, TOW_SPEED = "weight_kg", "declared_speed_m_s"
TERM_NAMES: Final = {WEIGHT: "weight", TOW_SPEED: "tow_speed"}
"""What may explain a difference between boats of a type, and how the columns of `type_consistency`
about it begin."""

SEASON_LEVEL: Final = "season_level"
"""Among the instruments of `season_diagnosis`: what all tows of a season have in common."""

WOULD_NOT_SHOW: Final = "would not show"
"""Among its verdicts: a fault of the usual size would not be found."""

MAX_THWARTS: Final = 8
"""Number of thwarts of which a tow list can give the distance (inferred: 16 rowers)."""
