"""Does a quantity follow weight, length or tow speed within a type?

The tows are the newest of each boat and crew, or all. Lines are weighted: each tow has its own
measuring error, and boats differ truly by a standard deviation that is estimated (REML); tows of
one boat, also of two crews, share that difference. Over all tows each has a deviation of its own as
well, so that repeats count as repeats. Women's and men's crews differ in weight and speed, so lines
against weight or length compare boats within a crew; displacement contains the crew. A line against
tow speed is one of men or of women: over both, tow speed stands for the mass of the crew.
"""

from collections.abc import Iterator
from itertools import product
from typing import Final, NamedTuple

import numpy as np
import polars as pl

from pipeline.arrays import FloatArray, IntArray
from pipeline.consistency import mixed
from pipeline.consistency.mixed import Problem
from pipeline.consistency.observed import (
    UNKNOWN_TYPE,
    Observed,
    a_unit_variance,
    bend_at,
    curve_anywhere,
    ln_cw_unit_variance,
    newest,
)
from pipeline.tables.consistency import TypeLinePoints, TypeLines
from pipeline.tables.declare import dy
from pipeline.tables.frames import frame_of
from pipeline.tables.row import Row

LN_CW, BEND = "ln_cw_standard", "bend"
LN_DISPLACEMENT: Final = "ln_displacement"
OF_THE_BOAT: Final = ("weight_kg", "waterline_length_m")
"""Explaining variables that say nothing of the crew."""

TOW_SPEED: Final = "declared_speed_m_s"
PAIRS: Final = (
    *product(("b_m_s", "a_kg_m", "cw_standard_kg_m"), (*OF_THE_BOAT, TOW_SPEED)),
    (LN_CW, LN_DISPLACEMENT),
)
"""Quantities with what may explain them: what the presentation of 2015 plots, and its power law."""

ALL_CREWS: Final = "all"
WITHIN: Final = {"men": "H", "women": "D"}
"""Classes within which lines against tow speed are drawn, with their codes."""

FEWEST_BOATS: Final = 5
"""Fewest boats through which a line is drawn."""
PLACES: Final = 7
"""Points at which a line is given for drawing."""

COMPONENTS: Final = {"newest": (mixed.BOAT,), "all": (mixed.BOAT, mixed.CELL)}
"""What deviates besides the measuring error, by the tows. Of the newest tows hardly any boat has
two: boat and tow are one. Of all tows each deviates by itself as well, by its season among other
things: a chart of all tows shows that too."""


def quantities(observed: Observed) -> dict[str, tuple[FloatArray, FloatArray]]:
    """What is compared within a type: values, and variances for a run scatter of 1, (rows,).

    NaN where there is none. Cw at the standard speed is the curve's also beyond the speeds at which
    it counts: a tow too slow for it is not left out. Its error grows with the distance.

    Errors of A and B are taken at the type's middle bend, not at each tow's own: else boats with a
    small B, whose error looks small, would weigh most.
    """
    speed = observed.column("standard_speed_m_s")
    a = observed.column("a_kg_m")
    b = observed.table["b_m_s"].to_numpy().astype(np.float64)
    b = np.where(observed.table["b_capped"].to_numpy(), np.nan, b)
    middle = pl.col("q").median().over("method", "boat_type")
    q = np.maximum(observed.table.select(middle).to_series().to_numpy(), 0.05)
    standard, unit = curve_anywhere(observed, speed), ln_cw_unit_variance(observed, speed)
    b_unit = observed.column("q_unit_variance") / (2.0 * q * (1.0 + q)) ** 2
    with np.errstate(invalid="ignore"):
        ln_standard = np.log(standard)
    return {
        "b_m_s": (b, b * b * b_unit),
        "a_kg_m": (a, a * a * a_unit_variance(observed, q)),
        BEND: bend_at(observed, speed),
        "cw_standard_kg_m": (standard, standard * standard * unit),
        LN_CW: (ln_standard, unit),
    }


def explaining_variable(observed: Observed, name: str) -> FloatArray:
    """An explaining variable, (rows,), NaN where missing."""
    if name == LN_DISPLACEMENT:
        return np.log(explaining_variable(observed, "displacement_kg"))
    return np.asarray(observed.table[name].to_numpy(), dtype=np.float64)


class _Line(NamedTuple):
    """A line to be fitted; n tows.

    Attributes:
        row: what `type_lines` says of it so far.
        problem: with a column for every crew and the explaining variable about their means, scaled
            to one so that no power of a unit gets lost in rounding.
        centre: (crews,) those means; width: what the variable is divided by.
        x: (n,) the variable as it is; whose: (n,) the class that a tow is drawn with.
    """

    row: Row
    problem: Problem
    centre: FloatArray
    width: float
    x: FloatArray
    whose: np.ndarray


def type_lines(observed: Observed) -> tuple[dy.DataFrame[TypeLines], dy.DataFrame[TypeLinePoints]]:
    """Lines through the newest tows and through all tows of every type.

    Returns:
        Rows of the tables `type_lines` and `type_line_points`. Where no line is drawn, `reason`
        says why. Points are given per class, with the line of that class; of lines on displacement,
        which is the same for all crews, `crew_class` is `all`.
    """
    rows: list[Row] = []
    points: list[Row] = []
    for tows, components in COMPONENTS.items():
        of = newest(observed) if tows == "newest" else observed
        for row, line in _described(tows, of):
            rows.append(row)
            if line is None:
                continue
            if (fit := mixed.fit(line.problem, *components)) is None:
                row["reason"] = "not_settled"
                continue
            row.update(_numbers(line, fit))
            points += _points(line, fit)
    return frame_of(TypeLines, rows), frame_of(TypeLinePoints, points)


def _kinds() -> Iterator[tuple[str, str, str]]:
    """Each quantity with what may explain it, and within which crews."""
    for quantity, explaining in PAIRS:
        crews = WITHIN if explaining == TOW_SPEED else (ALL_CREWS,)
        yield from ((quantity, explaining, within) for within in crews)


def _described(choice: str, tows: Observed) -> Iterator[tuple[Row, _Line | None]]:
    """The row of every line through some tows, and the line; none where the row says why."""
    measured = quantities(tows)
    names = {explaining for _, explaining in PAIRS}
    variables = {name: explaining_variable(tows, name) for name in names}
    crew_class = tows.table["crew_class"].to_numpy()
    boat, hull, crew = (
        tows.table.select(pl.struct(by).rank("dense")).to_series().to_numpy()
        for by in (("fsn_no",), ("hull",), ("rowers", "crew_class"))
    )
    run_variance = tows.column("run_sd_ratio") ** 2
    speeds = tows.column("standard_speed_m_s")
    for (method, boat_type), own in tows.rows_by("method", "boat_type"):
        for quantity, explaining, within in _kinds():
            (y, unit), x = measured[quantity], variables[explaining]
            known = np.isfinite(y[own]) & np.isfinite(x[own])
            if within != ALL_CREWS:
                known &= crew_class[own] == WITHIN[within]
            mine = own[known]
            row: Row = {
                "method": method,
                "tows": choice,
                "boat_type": boat_type,
                "quantity": quantity,
                "explaining": explaining,
                "within": within,
                "standard_speed_m_s": float(speeds[own[0]]),
                "n": len(mine),
                "n_boats": len(np.unique(boat[mine])),
            }
            is_of_boat = explaining in OF_THE_BOAT
            crews = _levels(crew[mine] if is_of_boat else np.zeros(len(mine)))
            centre = x[mine] @ crews / np.maximum(crews.sum(axis=0), 1.0)
            centred = x[mine] - crews @ centre
            row["reason"] = _reason(row, x[mine], crews.shape[1], centred)
            if row["reason"]:
                yield row, None
                continue
            width, variance = float(np.abs(centred).max()), unit[mine] * run_variance[mine]
            columns = np.column_stack([crews, centred / width])
            is_of_all = explaining == LN_DISPLACEMENT
            whose = np.full(len(mine), ALL_CREWS) if is_of_all else crew_class[mine]
            problem = Problem(y[mine], variance, columns, hull[mine])
            yield row, _Line(row, problem, centre, width, x[mine], whose)


def _levels(group: FloatArray | IntArray) -> FloatArray:
    """A column of 0 and 1 for each group."""
    return np.asarray(group[:, None] == np.unique(group), dtype=np.float64)


def _reason(row: Row, x: FloatArray, n_crews: int, centred: FloatArray) -> str:
    """Why there is no line, or nothing."""
    if row["boat_type"] == UNKNOWN_TYPE:
        return "no_type"
    if row["n_boats"] < max(FEWEST_BOATS, n_crews + 2):
        return "few_boats"
    return "equal_values" if np.abs(centred).max() <= 1e-9 * np.abs(x).max() else ""


def _numbers(line: _Line, fit: mixed.Fit) -> Row:
    """The line and its spread, as in `type_lines`.

    Tows weigh on the line as they were measured. About the line as it is drawn they count alike in
    its spread, and so in R2: beside that about the means of the crews.
    """
    problem, level = line.problem, 1.0
    if line.row["quantity"] != LN_CW:
        level = float(abs(problem.y.mean()))
    slope, lo, hi = (float(end[-1]) / line.width for end in fit.coefficients())
    about_line = float(((problem.y - problem.x @ fit.beta) ** 2).sum())
    # The last column of x has no mean within a crew.
    about_means = float(((problem.residual + problem.x[:, -1] * problem.plain[-1]) ** 2).sum())
    return {
        "slope": slope,
        "slope_lo": lo,
        "slope_hi": hi,
        "r2": max(1.0 - about_line / about_means, 0.0) if about_means > 0 else None,
        "residual_sd_ratio": float(np.sqrt(about_line / problem.rows_beyond)) / level,
    }


def _points(line: _Line, fit: mixed.Fit) -> Iterator[Row]:
    """The line with its interval at some places; for each class at the mean of its crews."""
    names = {
        name: line.row[name] for name in ("method", "tows", "boat_type", "quantity", "explaining")
    }
    for crew_class in np.unique(line.whose):
        mine = line.whose == crew_class
        mean = line.problem.x[mine, :-1].mean(axis=0)
        places = np.unique(np.linspace(line.x[mine].min(), line.x[mine].max(), PLACES))
        along = (places - mean @ line.centre) / line.width
        ends = fit.line_at(np.column_stack([np.tile(mean, (len(places), 1)), along]))
        for x, y, lo, hi in zip(places, *ends, strict=True):
            where = {"crew_class": str(crew_class), "x": float(x)}
            yield names | where | {"y": float(y), "lo": float(lo), "hi": float(hi)}
