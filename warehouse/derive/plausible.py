"""Tows that the rest of the archive rules out: set aside, or doubted.

What is judged, and how, is in `pipeline.assessment.plausibility`. A wrong unit costs the tow,
or the season, as any fault of a file does. A tow with a smaller shift is kept and needs a look.
Where single tows or a day are shifted, they take no part in what tows share. A shift that a whole
season or archive has in common is left to the joint model (`pipeline.season_log`), which knows such
faults and needs these tows for it.
"""

import math
from collections.abc import Sequence
from typing import Final

import polars as pl

from pipeline.assessment.plausibility import TURNED, Shift, plausibility
from pipeline.blocks.run_blocks import RunBlocks
from pipeline.blocks.tows import Tows
from pipeline.messages import say
from pipeline.tables.declare import dy
from pipeline.tables.lake import Faults
from warehouse.archive.faults import Fault, make_fault_frame

_SINGLED_OUT: Final = ("tow", "day")
"""Kinds of shifts that exclude their tows from what tows share."""

_SENSOR: Final = {
    "force": "force",
    "zero": "force",
    "wind": "wind",
    "vane": "wind",
    "speed": "speed",
}
"""Per quantity that can be shifted, what its reason code and its checks are named after."""


def judge(tows: pl.DataFrame, blocks: RunBlocks, crew_classes: pl.DataFrame) -> tuple[Shift, ...]:
    """Judge each tow by all others of the archive.

    Args:
        tows: rows of `tows` with `boat_type`.
        blocks: their runs, and perhaps others.
        crew_classes: the table of that name.
    """
    if tows.is_empty():
        return ()
    return plausibility(Tows.from_frames(tows, blocks), crew_classes)


def list_gross_faults(shifts: Sequence[Shift], tows: pl.DataFrame) -> dy.DataFrame[Faults]:
    """Return a fault for each tow that a wrong unit, column or file costs."""
    gross = {}
    for shift in reversed(shifts):  # the first shift of a tow is the one that is told
        if shift.is_gross:
            gross.update(dict.fromkeys(shift.tows, shift))
    faults = []
    for path, tow_id in tows.select("samples_path", "tow_id").iter_rows():
        if tow_id in gross:
            shift = gross[tow_id]
            code = f"{_SENSOR[shift.quantity]}_not_plausible"
            fault = Fault(
                path=path,
                tow_id=tow_id,
                reason_code=code,
                message=_describe_fault(shift),
                lost="tow",
            )
            faults.append(fault)
    return make_fault_frame(faults)


def add_doubts(tows: pl.DataFrame, judged: Sequence[Shift]) -> pl.DataFrame:
    """Add to tows the columns `doubts` and `unusual`: what all others say of them."""

    def checks(verdict: str, doubted: bool) -> pl.Series:
        shifts = [s for s in judged if (s.clear and s.kind in _SINGLED_OUT) is doubted]
        codes = []
        for tow_id in tows["tow_id"]:
            sensors = {_SENSOR[shift.quantity] for shift in shifts if tow_id in shift.tows}
            codes.append([f"{sensor}_{verdict}" for sensor in sorted(sensors)])
        return pl.Series(codes, dtype=pl.List(pl.String))

    return tows.with_columns(
        checks("not_plausible", doubted=True).alias("doubts"),
        checks("unusual", doubted=False).alias("unusual"),
    )


def _describe_fault(shift: Shift) -> str:
    """Say to a volunteer what is seen, what it may be, and what to do."""
    whose = {
        "tow": say("This tow"),
        "day": say("All {} tows of {}", len(shift.tows), shift.key),
        "some": say("{} tows of season {}", len(shift.tows), shift.key),
        "season": say("All {} tows of season {}", len(shift.tows), shift.key),
        "archive": say("All tows of the archive"),
    }[shift.kind]
    return say("{}: {}. {}", whose, _describe_shift(shift), _propose_remedy(shift))


def _describe_shift(shift: Shift) -> str:
    if shift.quantity == "force":
        return say(
            "the force is {:.2g} times what the size of the boat and the other tows give",
            math.exp(shift.size),
        )
    if shift.quantity == "wind":
        return say(
            "the wind is {:.2g} times what out and back together give, which is the "
            "boat's own speed",
            1.0 + shift.size,
        )
    if shift.causes == TURNED:
        return say(
            "the wind out and back together comes from {:.0f} degrees; it is the wind of the "
            "boat's own speed, from straight ahead",
            shift.size,
        )
    return say("all wind angles lie between -3.14 and 6.28, as angles in radians do")


def _propose_remedy(shift: Shift) -> str:
    if not shift.causes:
        return say(
            "Check whether these are this boat's samples, and what the load cell was set to."
        )
    if shift.causes == TURNED:
        return say(
            "If the vane is turned, or counts from another 0, declare wind_zero_deg = {:.0f} under "
            "[[profile]] in archief.toml.",
            shift.size,
        )
    causes = [say(text, *values) for text, *values in shift.causes]
    cause = causes[0]
    for other in causes[1:]:
        cause = say("{} or {}", cause, other)
    likely = say("It looks like {}: correct the unit in the header, or the scale.", cause)
    if (shift.kind, shift.quantity) != ("tow", "force"):
        return likely
    return say("{} Or are weight and length in its row of the list not this boat's?", likely)
