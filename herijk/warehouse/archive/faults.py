"""What can be wrong with the archive: one table of reason codes, and the record of one fault.

A reason code is stable: it is in the quarantine table and in `docs/archive.md`. Detecting a
fault belongs to the module that reads the thing; this one only says what the codes mean.
"""

from dataclasses import dataclass, field
from typing import Final, Literal

from herijk.pipeline.errors import DefectiveInputError
from herijk.words import cause_of, spoken

Lost = Literal["seconds", "run", "tow", "file", "row", "cell"]
"""What a fault costs: seconds of one channel of a run, a run, a tow, or a file; or a row of a list
that costs no tow, as one of a race, or one of its cells."""


OF_A_HEADER: Final = ("missing_column", "unknown_column", "duplicate_column", "unknown_unit")
"""Reason codes of a header: of a list, they cost all of it."""


@dataclass(frozen=True)
class Reason:
    """What a reason code means and what a volunteer can do about it."""

    description: str
    way_out: str


@dataclass(frozen=True)
class Fault:
    """Something that is set aside: seconds, a run, a tow, a file or a row of a list.

    Attributes:
        path: posix path relative to the archive.
        tow_id: the tow it costs, None where the fault belongs to a file or a boat.
        line: line in `path` (the header is line 1), where there is one.
        reason_code: a key of `REASONS`.
        message: a sentence a volunteer understands.
        lost: what it costs; None for a tow, a row or a file, as it has a tow, a line or neither.
        run: the run that it costs, or seconds of which.
        lost_s: how many seconds.
        cause: what faults of one cause share.
        message_nl: the message in Dutch.
    """

    path: str
    tow_id: str | None
    line: int | None
    reason_code: str
    message: str
    lost: Lost | None = None
    run: int | None = None
    lost_s: float | None = None
    cause: str = field(init=False)
    message_nl: str = field(init=False)

    def __post_init__(self) -> None:
        """Say the message in Dutch too, and what it shares with others."""
        object.__setattr__(self, "cause", cause_of(self.message))
        object.__setattr__(self, "message_nl", spoken(self.message, "nl"))


class DefectiveFileError(DefectiveInputError):
    """A `DefectiveInputError` that knows which of a tow's files it is about.

    Args:
        reason_code: a key of `REASONS`.
        message: a sentence that a volunteer understands.
        line: line in the file, where there is one.
        path: posix path relative to the archive.
    """

    def __init__(self, reason_code: str, message: str, line: int | None, path: str) -> None:
        super().__init__(reason_code, message, line)
        self.path = path


def fault_from(error: DefectiveInputError, path: str, tow_id: str | None = None) -> Fault:
    """Return the fault an error stands for; `path` serves where the error knows none itself."""
    where = error.path if isinstance(error, DefectiveFileError) else path
    return Fault(where, tow_id, error.line, error.reason_code, error.message)


REASONS: Final[dict[str, Reason]] = {
    # Files and text
    "unreadable_file": Reason(
        "The file is empty, damaged or not text.",
        "Export it again; save as CSV in UTF-8 or Windows-1252.",
    ),
    "too_large": Reason(
        "The file is larger than a samples file can be, or unpacks to more than that.",
        "Look whether it is the right file; split it when it holds more than one tow.",
    ),
    "path_outside_archive": Reason(
        "A name or a link points to a place outside the archive.",
        "Put the file itself into `meetdata_<jaar>/` and only its name into the list.",
    ),
    "unrecognised_file": Reason(
        "A file in a folder of lists has a name that is not one of the lists.",
        "Rename it, e.g. `sleeplijst_2014.csv`, or move it out of the folder.",
    ),
    "idle_setting": Reason(
        "`archief.toml` says something of a day, a season or a tow that no tow list has.",
        "Look whether it is mistyped: what it was meant for is read as if it were not there.",
    ),
    "missing_list": Reason(
        "The list of boats, or every list of tows, is not there.",
        "Put it into its folder, or name it under `[files]` in `archief.toml`.",
    ),
    "missing_column": Reason(
        "A column that is needed is not in the header.",
        "Correct the header, or name the column in `archief.toml`.",
    ),
    "unknown_column": Reason(
        "A list has a column that nobody knows. It can be a misspelt one, so the list is not read: "
        "left out in silence it would change numbers.",
        "Correct the header, or name it in `archief.toml` under `[headers]` or `ignore`.",
    ),
    "duplicate_column": Reason(
        "A column is in the header twice.",
        "Remove or rename one of the two.",
    ),
    "unknown_unit": Reason(
        "The unit in square brackets behind a column is not one this column can have.",
        "Write one of the units that `docs/archive.md` lists.",
    ),
    # Lists
    "bad_boat_row": Reason(
        "A boat's row cannot be read, so its tows cannot be used.",
        "Mend the row in `sloependata.csv`.",
    ),
    "duplicate_boat": Reason(
        "One `fsn_nr` is in the boat list twice, with different content.",
        "Keep one row of the two.",
    ),
    "bad_list_row": Reason(
        "A row of a tow list lacks a value that is needed, or holds one that cannot be right.",
        "Mend the value in the row.",
    ),
    "ambiguous_date": Reason(
        "Day and month of a date can be exchanged: 1/3/2015.",
        "Say under `[dates]` in `archief.toml` how this list means it, `dmy` or `mdy`.",
    ),
    "ambiguous_number": Reason(
        "A number can be read in two ways: 1.140 where other decimals of the list have a comma.",
        "Write 1140 or 1,140, or say under `[decimals]` in `archief.toml` what the mark before "
        "decimals is in this list.",
    ),
    "date_outside_season": Reason(
        "The date of a tow is not in the year of its list.",
        "Correct the date, or move the row to the list of that year.",
    ),
    "day_set_aside": Reason(
        "The whole day is set aside in `archief.toml`.",
        "Nothing, or remove the date there if the day was good after all.",
    ),
    "unknown_boat": Reason(
        "The boat of the tow is not in `sloependata.csv`.",
        "Add the boat, or correct the `fsn_nr`.",
    ),
    "duplicate_tow_id": Reason(
        "One `sleep_id` is in the lists twice. Equal rows: the first counts. "
        "Different rows: neither counts, as nobody can know which is right.",
        "Remove one row, or give it its own `sleep_id`.",
    ),
    "bad_instrument_row": Reason(
        "A row of readings of the load cell, or of warning lamps, cannot be read.",
        "Mend the row in `krachtijkingen_<jaar>.csv` or `lampjes_<jaar>.csv`.",
    ),
    "bad_window_row": Reason(
        "A row of windows given by hand lacks a value, holds one that cannot be right, or ends "
        "before it begins; the rule chooses the window of that run.",
        "Mend the row in `vensters_<jaar>.csv`.",
    ),
    "window_unknown_tow": Reason(
        "A window is given for a tow that is not in the list of that year.",
        "Correct the `sleep_id`, or move the row to the list of the tow's year.",
    ),
    "window_unknown_run": Reason(
        "A window is given for a run that the tow does not have.",
        "Correct `run`; `b1` to `b6` need a `meetfile2` in the tow list.",
    ),
    "window_outside_run": Reason(
        "A window given by hand ends after its run; the rule chooses the window of that run.",
        "Correct `tot`.",
    ),
    "window_given_twice": Reason(
        "Two windows are given for one run; none of them counts.",
        "Keep one row of the two.",
    ),
    "bad_register_row": Reason(
        "A row of a published register cannot be read.",
        "Mend the row.",
    ),
    "bad_race_row": Reason(
        "A row of race results cannot be read.",
        "Mend the row.",
    ),
    # Lists against files
    "samples_missing": Reason(
        "The samples file that a row names is not there.",
        "Put the file into `meetdata_<jaar>/`, or correct the name.",
    ),
    "samples_not_listed": Reason(
        "A samples file is named by no row of a tow list.",
        "Add the row to the list of that year, or remove the file.",
    ),
    "ambiguous_file": Reason(
        "More than one file answers to the name in the list.",
        "Remove or rename the wrong one, or write the extension in the list too.",
    ),
    "duplicate_tow": Reason(
        "The samples were used by an earlier row for the same boat and crew already.",
        "Remove the row, or name the file that belongs to it.",
    ),
    "samples_listed_twice": Reason(
        "The same samples are used for different boats or crews, or twice in one tow; "
        "nobody can know whose they are.",
        "Give every row the file that belongs to it.",
    ),
    # Samples: form
    "broken_row": Reason(
        "A row of samples has too few or too many fields, or the file was cut off in mid-row.",
        "Export or copy the file again.",
    ),
    "bad_number": Reason(
        "A field of the samples is empty or not an ordinary number.",
        "Export the file again; when the instrument failed, leave that run out in `gebruik runs` "
        "and remove its rows.",
    ),
    "unknown_run": Reason(
        "A run has a number other than 1 to 20.",
        "Correct the `run` column.",
    ),
    "run_not_planned": Reason(
        "A samples file has a run that the plan of its season does not know; it is not used.",
        "Give the targets and directions of all runs under `[[plan]]` in `archief.toml`.",
    ),
    "split_run": Reason(
        "The rows of a run do not stand together.",
        "Put the rows of each run together, in the order measured.",
    ),
    "bad_time": Reason(
        "The time column does not rise steadily at the sampling rate.",
        "Correct `meetfrequentie`, or remove the time column if it is wrong.",
    ),
    # Samples: content
    "missing_run": Reason(
        "A run that is to be used is not in the file.",
        "Name the runs that are there in `gebruik runs`, or mend the file.",
    ),
    "short_run": Reason(
        "A run that is to be used is shorter than planned, by default 50 s.",
        "Leave the run out in `gebruik runs`, or correct `meetfrequentie`.",
    ),
    "swapped_columns": Reason(
        "Two columns seem to be exchanged: each is implausible, but plausible as the other.",
        "Correct the header.",
    ),
    "speed_unit": Reason(
        "The speeds look like km/h under another header.",
        "Correct the unit in the header.",
    ),
    "log_dropout": Reason(
        "A log drops to zero during a run that is to be used.",
        "Leave the run out in `gebruik runs`.",
    ),
    "gps_dropout": Reason(
        "The GPS drops to zero during a run that is to be used.",
        "Leave the run out in `gebruik runs`; if there was no GPS at all, remove the column.",
    ),
    "stuck_channel": Reason(
        "A channel holds one value for so long that the instrument must have been stuck.",
        "Leave the run out in `gebruik runs`.",
    ),
    "saturated_force": Reason(
        "The force stays at its highest value: the load cell or its amplifier was at the end of "
        "its range, and what is above it is lost.",
        "Leave the run out in `gebruik runs`.",
    ),
    "implausible_speed": Reason(
        "The speeds do not fit the declared speed of the tow.",
        "Correct `roeisnelheid`, or look whether this is the right file.",
    ),
    "negative_force": Reason(
        "The tow force is negative.",
        "Look whether the sign or the zero of the load cell is wrong; leave out a run of which "
        "only part is negative.",
    ),
    "force_not_plausible": Reason(
        "The force is not that of such a boat: the size of the boat, its other tows, its day and "
        "its season all rule it out.",
        "Correct the unit in the header, or look whether these are this boat's samples.",
    ),
    "wind_not_plausible": Reason(
        "The wind out and back together does not leave the boat's own speed, or its angles are "
        "radians.",
        "Correct the unit in the header.",
    ),
    "implausible_value": Reason(
        "A value is far outside what can happen in a tow.",
        "Leave the run out in `gebruik runs`, or correct the unit or the column.",
    ),
}
"""Every reason code, in the order in which a file is read."""
