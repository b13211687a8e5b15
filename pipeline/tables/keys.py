"""Columns that more than one table has; here so that naming them imports nothing."""

from typing import Final

LINE: Final = ("fsn_no", "rowers", "crew_class")
"""What names a line of the register: a boat and one of its crews."""

SIZES: Final = ("waterline_length_m", "beam_m", "bow_height_m", "weight_kg")
"""What the register says of a boat on the day of its tow (Sleepproef 2017, "Opmetingen")."""

SEASON_LEVEL: Final = "season_level"
"""Among the instruments of `season_diagnosis`: what all tows of a season have in common."""

WOULD_NOT_SHOW: Final = "would not show"
"""Among its verdicts: a fault of the usual size would not be found."""
