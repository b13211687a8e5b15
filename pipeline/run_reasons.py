"""Why a run does not count: the codes of `run_points.reason`."""

from typing import Final

NOT_SELECTED: Final = "not_selected"
NO_STEADY_WINDOW: Final = "no_steady_window"
ABOVE_TARGET: Final = "above_target_speed"
NOT_CALIBRATED: Final = "not_calibrated"
