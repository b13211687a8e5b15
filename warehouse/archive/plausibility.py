"""Whether the samples of a tow can be true: a fault costs what it touches.

In this order: the runs that are there and long enough; what is wrong with the tow as a whole; the
samples that cannot be; and the table of `RULES` on each channel of a run.
"""

from collections.abc import Callable, Mapping
from itertools import combinations
from typing import Final, Literal, NamedTuple

import numpy as np
import polars as pl
import scipy
from numpy.typing import NDArray

from pipeline.arrays import BoolArray
from pipeline.channels import SECOND_FILE_OFFSET
from pipeline.messages import Sentence, say
from pipeline.tables.row import Row
from warehouse.archive.faults import Fault
from warehouse.archive.judgement import (
    CHANNELS,
    COLUMN_OF,
    SPARE,
    Array,
    Cost,
    Judgement,
    Run,
    describe_value,
    find_stretches,
)
from warehouse.archive.samples import Place, RunDefect, find_run_starts

SPEEDS: Final = ("log1", "log2", "gps")
SHORTEST_RUN_RATIO: Final = 0.99
LONGEST_RUN_RATIO: Final = 1.8
"""Shares of the planned time. A rate that is wrong is usually half of the right one (inferred)."""
LEFT_OUT_S: Final = 2.0
"""Longest time in all of a run in which what the run point needs may be left out; as long again for
log 2 and the GPS each."""
DROPOUT_M_S: Final = 0.1
SPIKE_RATIO: Final = {"log1": 0.3, "log2": 0.3, "gps": 0.1}
"""Share of the speed around it: a boat and its crew weigh a ton, and change no faster. A GPS has no
noise of samples: such a jump is the receiver's (inferred)."""
AROUND_S: Final = 11
"""The speed around a sample: the median over so many seconds of each one's median."""
FORCE_SPIKE_RATIO: Final = (-3.0, 5.0)
"""Share of the usual force. A tow line cannot push: what a slack one reads is noise about zero."""
FORCE_DEAD_RATIO: Final = 0.05
FORCE_DEAD_S: Final = 0.1
"""A force that stays at one value so near zero, for so long, is not one."""
GUST_RATIO: Final = 2.5
GUST_M_S: Final = 4.0
"""Wind so many times the run's median, and this much more, is not a gust that cups follow."""
EXTREMES: Final = {"wind_speed": (0.0, 40.0), "wind_angle": (-180.0, 360.0)}
"""Between which every sample lies."""
MOVES_AS_A_LOG_HZ: Final = 5.0
FOLLOWS_PLAN: Final = (
    ("log1", "wind_speed", 1, 0.03),
    ("log2", "wind_speed", 1, 0.03),
    ("force", "wind_angle", 2, 0.2),
)
"""A channel, the wind that it can be exchanged with, the power of the speed that it follows, and
how far it stays from that at most, from run to run: 0.01 and 0.14 in simulated tows, where wind
speeds have 0.06 and more, and wind angles 0.6."""
EXCHANGED_SPREAD_RATIO: Final = 1.5
HELD_AS_A_FIX_HZ: Final = (0.1, 2.0)
"""Changes of value a second, at least of a log and of a receiver of one fix a second."""
KM_H_RATIO: Final = (3.0, 4.2)
"""Log 1 over the intended speed where it looks like km/h."""
GPS_MUST_MOVE_M_S: Final = 0.15
"""A GPS that holds one value is suspect only where the boat's speed differed more than this."""
VANE_TURNS_M_S: Final = 0.5
CLIPPED_TIMES: Final = 3.0
"""Samples at the highest value, times those at the next one, where coarse steps explain them."""


class Judged(NamedTuple):
    """What is left of a tow's samples.

    Attributes:
        samples: the given frame without the runs that are lost, NaN where a sample is left out.
        faults: what was lost: seconds and runs, in the order of the runs.
    """

    samples: pl.DataFrame
    faults: list[Fault]


def judge_samples(
    samples: pl.DataFrame,
    place: Place,
    tow: Row,
    runs: pl.DataFrame,
    defects: Mapping[int, RunDefect] | None = None,
) -> Judged:
    """Judge the selected runs of a tow; other runs stay as they are.

    Args:
        samples: frame of `SAMPLE_SCHEMA`, as `read_tow_samples` returns it.
        place: where its rows stand.
        tow: a row of `ArchiveIndex.tows`.
        runs: `ArchiveIndex.runs`; rows of other tows are ignored.
        defects: what costs a run, as `read_tow_samples` returns it.

    Raises:
        DefectiveFileError: the tow is lost: the most specific cause comes first.
    """
    judgement = Judgement(tow, place)
    _select_runs(judgement, samples, runs)
    for run in judgement.runs:
        if defects and run.number in defects:
            code, what, row = defects[run.number]
            judgement.lose(run, code, what, "run", row - run.start)
    _check_length(judgement)
    _leave_out_copies(judgement)
    judgement.check_left()
    _leave_out_no_wind(judgement)
    _check_whole_tow(judgement)
    # The median over runs, which one faulty run does not move.
    each_kg_m = [run.medians["force"] / run.intended_m_s**2 for run in judgement.runs]
    usual_kg_m = abs(float(np.nanmedian(each_kg_m))) if np.isfinite(each_kg_m).any() else np.nan
    for run in judgement.runs:
        leave_out(judgement, run, usual_kg_m)
        if run in judgement.runs:
            apply_rules(judgement, run)
    leave_out_stuck_gps(judgement)
    judgement.check_left()
    return Judged(_drop_lost(samples, judgement), judgement.faults)


# Runs


def _select_runs(judgement: Judgement, samples: pl.DataFrame, runs: pl.DataFrame) -> None:
    """Find the selected runs; each that is not there leaves a fault."""
    tow, number = judgement.tow, samples["run"].to_numpy()
    starts = find_run_starts(number)
    ends = np.append(starts[1:], len(number))
    rows = {}
    for start, end in zip(starts.tolist(), ends.tolist(), strict=True):
        rows[int(number[start])] = slice(start, end)
    selected = runs.filter((pl.col("tow_id") == tow["tow_id"]) & pl.col("selected")).sort("run")
    judgement.wanted = selected.height
    for run, planned_s, ratio in selected["run", "planned_s", "target_speed_ratio"].iter_rows():
        if run not in rows:
            judgement.faults.append(_describe_missing_run(run, tow, sorted(rows)))
            continue
        channels = {}
        for key, name in CHANNELS.items():
            if samples[name].null_count() == 0:
                channels[key] = samples[name][rows[run]].to_numpy()
        judgement.runs.append(
            Run(
                number=run,
                start=rows[run].start,
                rate_hz=tow["sample_rate_hz"],
                intended_m_s=tow["declared_speed_m_s"] * ratio,
                planned_s=planned_s,
                channels=channels,
            )
        )


def _describe_missing_run(run: int, tow: Row, present: list[int]) -> Fault:
    """Return the fault of a run that is not in its file, with the runs that are."""
    in_second = run > SECOND_FILE_OFFSET
    offset = SECOND_FILE_OFFSET if in_second else 0
    there = [str(n - offset) for n in present if (n > SECOND_FILE_OFFSET) == in_second]
    text = say("Run {} is to be used but is not in the file; it holds runs {}.")
    return Fault(
        path=tow["second_path" if in_second else "samples_path"],
        tow_id=tow["tow_id"],
        reason_code="missing_run",
        message=say(text, run - offset, ", ".join(there)),
        lost="run",
        run=run,
    )


def _check_length(judgement: Judgement) -> None:
    """Leave out the runs that are too short; note where all last far longer than planned.

    That costs nothing: by a wrong rate, windows, averages and what accelerated the boat are taken
    over another time than is meant.
    """
    for run in judgement.runs:
        missing_s = run.planned_s - run.seconds
        if run.seconds < SHORTEST_RUN_RATIO * run.planned_s:
            text = say("it lasts {:.2f} s at {:g} samples per second, {:.2f} s too short")
            cost: Cost = "run" if missing_s > LEFT_OUT_S else "seconds"
            what = say(text, run.seconds, run.rate_hz, missing_s)
            judgement.lose(run, "short_run", what, cost, 0, missing_s)
    runs = judgement.runs
    if runs and all(run.seconds >= LONGEST_RUN_RATIO * run.planned_s for run in runs):
        text = say(
            "All runs last {:.0f} s or longer at {:g} samples per second, and {:.0f} s is planned: "
            "is the rate {:.0f}? Nothing is left out."
        )
        shortest, first = min(run.seconds for run in runs), runs[0]
        rate_hz = first.rate_hz * first.seconds / first.planned_s
        message = say(text, shortest, first.rate_hz, first.planned_s, rate_hz)
        judgement.lose_of_all("long_run", message)


def _leave_out_copies(judgement: Judgement) -> None:
    """Set aside runs with the samples of another; the one nearest to its intended speed stays."""

    def off_target(run: Run) -> tuple[float, int]:
        ratio = run.medians["log1"] / run.intended_m_s
        return float(np.nan_to_num(abs(ratio - 1.0), nan=np.inf)), run.number

    first: dict[bytes, Run] = {}
    for run in sorted(judgement.runs, key=off_target):
        content = run.channels["log1"].tobytes() + run.channels["force"].tobytes()
        is_unread = np.isnan([run.medians["log1"], run.medians["force"]]).all()
        other = first.setdefault(bytes([run.number]) if is_unread else content, run)
        if other is not run:
            what = say("it has exactly the samples of {}", other.name.lower())
            judgement.lose(run, "samples_listed_twice", what, "run")


def _drop_lost(samples: pl.DataFrame, judgement: Judgement) -> pl.DataFrame:
    """Return the samples without lost runs: NaN where left out, null in channels of no run."""
    if not judgement.faults:
        return samples
    changed = []
    for key, name in CHANNELS.items():
        values = samples[name].to_numpy().copy()
        for run in judgement.runs:
            if key in run.channels:
                values[run.start : run.start + len(run.channels[key])] = run.channels[key]
        is_there = key in judgement.runs[0].channels
        changed.append(pl.Series(name, values if is_there else [None] * len(samples), pl.Float32))
    lost = [fault.run for fault in judgement.faults if fault.lost == "run"]
    return samples.with_columns(changed).filter(~pl.col("run").is_in(lost))


# The tow as a whole


def _leave_out_no_wind(judgement: Judgement) -> None:
    """Leave out a wind speed that in all runs is empty, or one value that cannot be.

    So people write that there was no anemometer: 999 everywhere. The tow goes on as one without.
    """
    least, most = EXTREMES["wind_speed"]
    for run in judgement.runs:
        wind = run.channels.get("wind_speed")
        is_held = wind is not None and (wind == wind[0]).all() and not least <= wind[0] <= most
        if wind is None or not (is_held or np.isnan(wind).all()):
            return
    text = say("column '{column}' {} in all runs, which is not wind; the tow goes on without wind.")
    first = describe_value(judgement.runs[0].channels["wind_speed"][0])
    message = say(text, first, column=COLUMN_OF["wind_speed"])
    judgement.lose_of_all("implausible_value", message, "wind_speed", "wind_angle")


def _check_whole_tow(judgement: Judgement) -> None:
    """Raise where the force is turned, columns are exchanged, or the speeds are in km/h.

    Seen by what a typical run looks like: medians over the runs, which a fault in one does not
    move.
    """
    runs = judgement.runs
    force_n = judgement.typical_median("force")
    intended_m_s = float(np.median([run.intended_m_s for run in runs]))
    low, high = USUAL["force"].times(intended_m_s, np.nan)
    if low <= -force_n <= high:
        said = say("The force is {:.0f} N in a typical run; it must be positive.", force_n)
        raise judgement.make_lost_error("negative_force", said, runs[0].start)
    _check_exchanged(judgement, intended_m_s)
    _check_held_as_a_fix(judgement)
    _check_against_plan(judgement)
    ratio = judgement.typical_median("log1") / intended_m_s
    least, most = KM_H_RATIO
    if least <= ratio <= most:
        text = say(
            "The speed by log1 is {:.2f} times the intended one; between {:g} and {:g} times it "
            "looks like km/h under another header."
        )
        raise judgement.make_lost_error("speed_unit", say(text, ratio, least, most))


def _check_held_as_a_fix(judgement: Judgement) -> None:
    """Raise where another channel holds a fix a second, and the GPS moves as a log does."""

    def typical_hz(channel: str) -> float:
        return float(np.median([run.changes_hz(channel) for run in judgement.runs]))

    for key in ("log1", "log2", "wind_speed"):
        if not judgement.has_channels(key, "gps"):
            continue
        other_hz, gps_hz = typical_hz(key), typical_hz("gps")
        least, most = HELD_AS_A_FIX_HZ
        if gps_hz > MOVES_AS_A_LOG_HZ and least < other_hz < most:
            text = say(
                "Columns '{}' and 'gps' seem to be exchanged: the first changes {:.1f} times a "
                "second, the second {:.0f} times."
            )
            raise judgement.make_lost_error(
                "swapped_columns", say(text, COLUMN_OF[key], other_hz, gps_hz)
            )


def _check_against_plan(judgement: Judgement) -> None:
    """Raise where a channel does not follow the planned speeds, and the wind under its name does.

    A log follows the intended speeds of the runs, a force their square; wind follows neither.
    """
    for key, wind, power, most in FOLLOWS_PLAN:
        if not judgement.has_channels(key, wind):
            continue
        own = _measure_spread(judgement.runs, key, power)
        other = _measure_spread(judgement.runs, wind, power)
        if own > EXCHANGED_SPREAD_RATIO * most and other < most:
            text = say(
                "Columns '{}' and '{}' seem to be exchanged: from run to run the second follows "
                "the planned speeds, and the first does not."
            )
            said = say(text, COLUMN_OF[key], COLUMN_OF[wind])
            raise judgement.make_lost_error("swapped_columns", said)


def _measure_spread(runs: list[Run], key: str, power: int) -> float:
    """Return the spread from run to run of ln(median / intended speed ** power)."""
    ratios = [run.medians[key] / run.intended_m_s**power for run in runs]
    return float(np.std(np.log(ratios))) if min(ratios) > 0 else np.inf


def _check_exchanged(judgement: Judgement, intended_m_s: float) -> None:
    """Raise where two channels can be right only the other way round."""
    runs = judgement.runs
    typical = {}
    for key in runs[0].channels:
        typical[key] = np.median([run.typical(key) for run in runs], axis=0)
    wrong = _find_implausible(typical, intended_m_s)
    for one, other in combinations(typical, 2):
        exchanged = typical | {one: typical[other], other: typical[one]}
        if {one, other} & wrong and not _find_implausible(exchanged, intended_m_s):
            text = say("Columns '{}' and '{}' seem to be exchanged: {seen}.")
            seen = say("typically they hold {:.4g} and {:.4g}", typical[one][0], typical[other][0])
            said = say(text, COLUMN_OF[one], COLUMN_OF[other], seen=seen)
            raise judgement.make_lost_error("swapped_columns", said)


def _find_implausible(typical: Mapping[str, NDArray[np.floating]], intended_m_s: float) -> set[str]:
    """Return the channels of which median, lowest and highest cannot be what their header says."""
    wrong = set()
    for key, (median, lowest, highest) in typical.items():
        usual = USUAL.get(key, Limits(-np.inf, np.inf))
        low, high = usual.times(intended_m_s, float(typical["log1"][0]))
        least, most = EXTREMES.get(key, (-np.inf, np.inf))
        if not (low <= median <= high and least <= lowest and highest <= most):
            wrong.add(key)
    return wrong


# Samples


def leave_out(judgement: Judgement, run: Run, usual_kg_m: float) -> None:
    """Leave out the samples of a run that cannot be, and the run where these are too many.

    Args:
        judgement: what is left of the tow.
        run: as measured.
        usual_kg_m: usual force over speed squared.
    """
    usual_n = usual_kg_m * run.intended_m_s**2
    wrong = {key: _find_wrong(run, key, usual_n) for key in run.channels}
    needed = np.zeros(len(run.channels["log1"]), dtype=bool)
    no_row = ~needed
    for key, values in run.channels.items():
        no_row &= np.isnan(values)
        if key not in SPARE:
            needed |= wrong[key]
    most = LEFT_OUT_S * run.rate_hz
    cost: Cost = "run" if needed.sum() > most else "seconds"
    if no_row.any():
        seconds = float(no_row.sum()) / run.rate_hz
        what = say("rows lack fields, or their time cannot be read, for {:.3g} s in all", seconds)
        judgement.lose(run, "broken_row", what, cost, int(no_row.argmax()), seconds)
    for key, mask in wrong.items():
        own = mask & ~no_row
        count = float(own.sum())
        if not count or (cost == "run" and key in SPARE):
            continue
        row, values, seconds = int(own.argmax()), run.channels[key], count / run.rate_hz
        text = say("column '{column}' {} and is wrong for {:.3g} s in all")
        what = say(text, describe_value(values[row]), seconds, column=COLUMN_OF[key])
        is_gone = key in SPARE and count > most
        of_channel: Cost = "column" if is_gone else cost
        reason_code = _find_reason_code(run, key, row)
        judgement.lose(run, reason_code, what, of_channel, row, seconds)
        run.channels[key] = np.where(own | is_gone, np.float32(np.nan), values)


def _find_reason_code(run: Run, key: str, row: int) -> str:
    """Return the reason code of a channel, by the first of its wrong samples."""
    value = run.channels[key][row]
    if not np.isfinite(value):
        return "bad_number"
    if key in SPEEDS and value <= DROPOUT_M_S:
        return "gps_dropout" if key == "gps" else "log_dropout"
    pushes = FORCE_SPIKE_RATIO[0] * abs(run.medians["force"])
    return "negative_force" if key == "force" and pushes <= value < 0 else "implausible_value"


def _find_wrong(run: Run, key: str, usual_n: float) -> BoolArray:
    """Return which samples of a channel are no number, have dropped out or cannot be."""
    values = run.channels[key]
    if key in SPEEDS:
        return _find_wrong_speeds(values, run.medians[key], run.rate_hz, SPIKE_RATIO[key])
    if key == "force":
        return _find_wrong_forces(run, values, usual_n)
    least, most = EXTREMES[key]
    if key == "wind_speed":
        most = min(most, GUST_RATIO * abs(run.medians[key]) + GUST_M_S)
    return ~_is_between(values, least, most)


def _is_between(values: Array, lowest: float, highest: float) -> BoolArray:
    """Return which samples are between two limits; one that is no number is not."""
    return np.asarray((values >= lowest) & (values <= highest))


def _find_wrong_speeds(
    values: Array, median: float, rate_hz: float, spike_ratio: float
) -> BoolArray:
    """Return which samples of a speed have dropped out, or jump away from the speed around them."""
    is_there = values > DROPOUT_M_S
    is_near_median = is_there & (np.abs(values - median) <= spike_ratio * abs(median))
    if is_near_median.all():
        return np.zeros(len(values), dtype=bool)
    around = _smooth_speed(values, round(rate_hz))
    return np.asarray(~(is_there & (np.abs(values - around) <= spike_ratio * around)))


def _smooth_speed(values: Array, rate_hz: int) -> NDArray[np.float64]:
    """Return the speed around each sample, which short faults do not move; 0 without numbers."""
    length = max(len(values) // rate_hz, 1)
    second = np.minimum(np.arange(len(values)) // rate_hz, length - 1)
    padded = np.full((length, int(np.bincount(second).max())), np.nan)
    padded[second, np.arange(len(values)) - second * rate_hz] = values
    known = np.isfinite(padded).any(axis=1)
    if not known.any():
        return np.zeros(len(values))
    medians = np.nanmedian(padded[known], axis=1)
    filtered = scipy.ndimage.median_filter(medians, AROUND_S, mode="nearest")
    each = np.interp(np.arange(length), np.flatnonzero(known), filtered)
    return np.asarray(each[second], dtype=np.float64)


def _find_wrong_forces(run: Run, values: Array, usual_n: float) -> BoolArray:
    """Return which samples of the force are spikes, dead or of a second with a negative mean."""
    least, most = FORCE_SPIKE_RATIO
    wrong = ~_is_between(values, least * usual_n, most * usual_n)
    near_zero = FORCE_DEAD_RATIO * usual_n
    if (np.abs(values) <= near_zero).any():
        starts, lengths = find_stretches(values[1:] != values[:-1])
        least = max(int(FORCE_DEAD_S * run.rate_hz), 3)
        wrong |= np.repeat((lengths >= least) & (np.abs(values[starts]) <= near_zero), lengths)
    means = run.second_means(np.where(wrong, np.float32(np.nan), values))
    if (means < 0).any():  # single negative samples are the surge of the tow line
        second = np.minimum(np.arange(len(values)) // round(run.rate_hz), len(means) - 1)
        wrong |= (means < 0)[second]
    return wrong


# Rules on the channels of a run


class Limits(NamedTuple):
    """From `low` up to `high`, times 1, the intended speed in m/s or its square, or log 1."""

    low: float
    high: float
    unit: Literal["", "intended", "intended squared", "log1"] = ""

    def times(self, intended_m_s: float, log1_m_s: float) -> tuple[float, float]:
        """Return the limits for this speed."""
        units = {"intended": intended_m_s, "intended squared": intended_m_s**2, "log1": log1_m_s}
        return self.low * units.get(self.unit, 1.0), self.high * units.get(self.unit, 1.0)


USUAL: Final = {
    "log1": Limits(0.5, 1.6, "intended"),
    "log2": Limits(0.6, 1.4, "log1"),
    "gps": Limits(0.6, 1.4, "log1"),
    "force": Limits(2.0, 500.0, "intended squared"),  # sloops lie between 15 and 60 kg/m
    "wind_speed": Limits(0.0, 20.0),
}
"""Where the mean of a run lies."""

Found = tuple[float, int]
"""What was measured, and the row of the run where it begins."""


def mean(run: Run, channel: str) -> Found:
    """Return the mean of the samples that are numbers."""
    return float(np.nanmean(run.channels[channel], dtype=np.float64)), 0


def held_s(run: Run, channel: str) -> Found:
    """Return the longest stretch of one value [s]; cups may stand still, and a vane needs wind."""
    values = run.channels[channel]
    changes = values[1:] != values[:-1]
    least_wind_m_s = {"wind_speed": 0.0, "wind_angle": VANE_TURNS_M_S}.get(channel)
    if least_wind_m_s is None or "wind_speed" not in run.channels:
        starts, lengths = find_stretches(changes)
    else:
        moves = run.channels["wind_speed"] > least_wind_m_s
        starts, lengths = find_stretches(changes | np.diff(moves))
        lengths = lengths * moves[starts]
    longest = int(lengths.argmax())
    return float(lengths[longest]) / run.rate_hz, int(starts[longest])


def clipped_percent(run: Run, channel: str) -> Found:
    """Return the samples at the highest value in per cent; 0 where coarse steps explain them."""
    values = run.channels[channel]
    at_end = values == np.fmax.reduce(values)
    below = np.nanmax(values, where=~at_end & np.isfinite(values), initial=-np.inf)
    is_coarse = at_end.sum() <= CLIPPED_TIMES * (values == below).sum()
    return (0.0 if is_coarse else 100.0 * float(at_end.mean())), int(at_end.argmax())


class Rule(NamedTuple):
    """What can be true of a channel in a run.

    Attributes:
        measure: what is measured, and in which row of the run it begins.
        what: said where that is outside the limits: `{found}` is the measure, `{low}` and `{high}`
            are the limits, `{value}` is the sample with which it begins.
    """

    reason_code: str
    channel: str
    measure: Callable[[Run, str], Found]
    limits: Limits
    what: Sentence


_STUCK: Final = say(
    "column '{column}' holds {value:.6g} for {found:.3g} s; less than {high:g} s is normal"
)
_MEAN: Final = say(
    "the mean of column '{column}' is {found:.4g}; {low:.3g} to {high:.3g} can be right"
)
_NEGATIVE: Final = say("the mean of column '{column}' is {found:.4g}; it must be positive")
_CLIPPED: Final = say(
    "column '{column}' is at its highest value, {value:.6g}, in {found:.0f} % of the samples, as a "
    "load cell at the end of its range"
)
RULES: Final = (
    Rule("stuck_channel", "log1", held_s, Limits(0, 5), _STUCK),
    Rule("stuck_channel", "log2", held_s, Limits(0, 5), _STUCK),
    Rule("stuck_channel", "force", held_s, Limits(0, 5), _STUCK),
    Rule("stuck_channel", "wind_speed", held_s, Limits(0, 10), _STUCK),
    Rule("stuck_channel", "wind_angle", held_s, Limits(0, 20), _STUCK),
    Rule("implausible_speed", "log1", mean, USUAL["log1"], _MEAN),
    Rule("implausible_value", "log2", mean, USUAL["log2"], _MEAN),
    Rule("implausible_value", "gps", mean, USUAL["gps"], _MEAN),
    Rule("negative_force", "force", mean, Limits(0, np.inf), _NEGATIVE),
    Rule("implausible_value", "force", mean, USUAL["force"], _MEAN),
    Rule("implausible_value", "wind_speed", mean, USUAL["wind_speed"], _MEAN),
    Rule("saturated_force", "force", clipped_percent, Limits(0, 2), _CLIPPED),
)


def apply_rules(judgement: Judgement, run: Run) -> None:
    """Leave out what breaks a rule: the run, or a spare channel; one without numbers is sound."""
    log1_m_s, _ = mean(run, "log1")
    known = {key for key, values in run.channels.items() if np.isfinite(values).any()}
    for rule in RULES:
        if rule.channel not in known:
            continue
        found, row = rule.measure(run, rule.channel)
        low, high = rule.limits.times(run.intended_m_s, log1_m_s)
        if low <= found < high:
            continue
        value, column = run.channels[rule.channel][row], COLUMN_OF[rule.channel]
        what = say(rule.what, column=column, value=value, found=found, low=low, high=high)
        if rule.channel not in SPARE:
            judgement.lose(run, rule.reason_code, what, "run", row)
            return
        judgement.lose(run, rule.reason_code, what, "column", row)
        run.channels[rule.channel] = np.full_like(run.channels[rule.channel], np.nan)
        known.remove(rule.channel)


def leave_out_stuck_gps(judgement: Judgement) -> None:
    """Leave out a GPS that holds one value while the speed changed, or at another speed.

    It has a fix a second in steps of 0.01 m/s, so of a steady boat it may well hold one value.
    """
    alike: dict[float, list[Run]] = {}
    for run in judgement.runs:
        gps = run.channels.get("gps")
        if gps is not None and (gps == gps[0]).all():
            alike.setdefault(float(gps[0]), []).append(run)
    for held, runs in alike.items():
        speeds = [run.second_means(run.channels["log1"]) for run in runs]
        moved_m_s = max(np.nanmax(means) - np.nanmin(means) for means in speeds)
        n_intended = len({run.intended_m_s for run in runs})
        if n_intended == 1 and not moved_m_s > GPS_MUST_MOVE_M_S:
            continue
        for run in runs:
            what = say("gps holds {:.6g} throughout, at other speeds too", held)
            judgement.lose(run, "stuck_channel", what, "column")
            run.channels["gps"] = np.full_like(run.channels["gps"], np.nan)
