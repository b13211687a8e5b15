"""What to do about each fault, by its reason code.

A reason code is stable: it is in the table `quarantine`. The sentence of a fault says what is wrong
and where; the remedy is the same wherever the fault is.
"""

from collections.abc import Mapping
from typing import Final

from pipeline.messages import Sentence, say

_IN_FILE: Final = say("Correct the file, or export it again.")
_IN_ROW: Final = say("Correct the row.")
_IN_HEADER: Final = say("Correct the header, or answer the questions below.")
_LEAVE_OUT: Final = say("If the instrument failed, leave the run out in 'gebruik runs'.")
_UNIT_OR_FILE: Final = say(
    "Check the unit in the header, the declared speed, and whether these are this boat's samples."
)
_WINDOW: Final = say("Correct the row; until then the method chooses the window of that run.")

REMEDIES: Final[Mapping[str, Sentence]] = {
    "unforeseen": say(
        "Report it, with the traceback in unforeseen/ of the data folder. It is tried again by "
        "another version, or when its files or row change."
    ),
    "unreadable_file": _IN_FILE,
    "labview_text": say("Convert it once, or export the recording as .tdms or CSV."),
    "too_large": say("Check whether it is the right file; split it if it holds several tows."),
    "path_outside_archive": say(
        "Put the file itself into meetdata_<jaar>/, and only its name into the list."
    ),
    "hidden": say("Show what is hidden, or remove it."),
    "unrecognised_file": say("Rename it, or name it under ignore in archief.toml."),
    "idle_setting": say("Correct the season, day or tow in archief.toml."),
    "missing_column": _IN_HEADER,
    "unknown_column": _IN_HEADER,
    "duplicate_column": say("Remove or rename one of the two columns."),
    "unknown_unit": _IN_HEADER,
    "bad_boat_row": _IN_ROW,
    "duplicate_boat": say("Keep one row of the two, or make them agree."),
    "bad_list_row": _IN_ROW,
    "ambiguous_number": _IN_ROW,
    "date_outside_season": say("Correct the date, or move the row to the list of that year."),
    "day_set_aside": say("Nothing; remove the date from archief.toml if the day was good."),
    "unknown_boat": say("Add the boat to the boat list, or correct its number."),
    "duplicate_tow_id": say("Remove one of the rows, or give it its own sleep_id."),
    "bad_instrument_row": _IN_ROW,
    "bad_window_row": _WINDOW,
    "window_unknown_tow": _WINDOW,
    "window_unknown_run": _WINDOW,
    "window_outside_run": _WINDOW,
    "window_given_twice": _WINDOW,
    "bad_acceptance_row": say("Correct the row; until then the tow counts as not accepted."),
    "bad_register_row": _IN_ROW,
    "bad_race_row": _IN_ROW,
    "samples_missing": say("Put the file into meetdata_<jaar>/, or correct its name in the list."),
    "samples_not_listed": say("Add a row to the tow list of that year, or remove the file."),
    "ambiguous_file": say("Remove or rename the wrong file."),
    "duplicate_tow": say("Remove the row, or name the file that belongs to it."),
    "samples_listed_twice": say("Give every row the file that belongs to it."),
    "broken_row": _IN_FILE,
    "bad_number": say(
        "Export the file again, without marks between thousands. If the instrument failed, leave "
        "the run out in 'gebruik runs'."
    ),
    "unknown_run": say("Number the runs from 1 in the column of the run."),
    "run_not_planned": say("Give targets and directions of all runs under [[plan]]."),
    "split_run": say("Put the rows of each run together, in the order measured."),
    "bad_time": say(
        "Correct the rate or the unit of the times. If a clock was set during a sound run, say "
        'that times do not count: absent = ["time"] under [[profile]] in archief.toml.'
    ),
    "missing_run": say("Name the runs that are there in 'gebruik runs', or add what is missing."),
    "long_run": say("Correct the rate, or say under [[plan]] how long runs last."),
    "short_run": say(
        "Correct 'meetfrequentie' (without it the rate is 1000) or, under [[plan]], how long runs "
        "last; or leave the run out in 'gebruik runs'."
    ),
    "slow_channel": say("Declare it under hold, or under absent."),
    "swapped_columns": say("Correct the header, or the names of the columns in archief.toml."),
    "speed_unit": say("Correct the unit in the header."),
    "log_dropout": _LEAVE_OUT,
    "gps_dropout": say("If there was no GPS, remove the column or declare it absent."),
    "stuck_channel": _LEAVE_OUT,
    "saturated_force": _LEAVE_OUT,
    "implausible_speed": _UNIT_OR_FILE,
    "negative_force": say(
        'Correct the sign, with reversed = ["force"] for a season; leave out a run of which only '
        "part is negative."
    ),
    "force_not_plausible": _UNIT_OR_FILE,
    "wind_not_plausible": say("Correct the unit in the header."),
    "implausible_value": _UNIT_OR_FILE,
}  # fmt: skip
