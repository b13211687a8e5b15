"""Does a quantity follow weight, length or tow speed within a type, and which tows are outliers?

The tows are a choice: the newest of each boat and crew, all, or those of one season. Lines are
weighted: each tow has its own measuring error, and boats differ truly by a standard deviation that
is estimated (REML); tows of one boat, also of two crews, share that difference. Over all tows a
season and a single tow have a deviation of their own as well, so that repeats count as repeats.
Women's and men's crews differ in weight and speed, so lines against weight or length compare boats
within a crew; displacement contains the crew. Lines against tow speed, which stands for crew mass,
are drawn within men and within women too.
"""

from collections.abc import Iterator
from typing import Final, NamedTuple

import numpy as np
import polars as pl
import scipy

from pipeline.arrays import BoolArray, FloatArray, IntArray
from pipeline.consistency import mixed
from pipeline.consistency.eras import season_ranges
from pipeline.consistency.mixed import Problem
from pipeline.consistency.observed import (
    UNKNOWN_TYPE,
    Observed,
    bend_at,
    curve_anywhere,
    ln_cw_unit_variance,
    newest,
    q_at,
)
from pipeline.consistency.tow_speed import is_slow
from pipeline.history import STEERED_STRAIGHT_FROM
from pipeline.tables.consistency import TypeLinePoints, TypeLines, TypeOutliers
from pipeline.tables.declare import dy
from pipeline.tables.frames import frame_of
from pipeline.tables.keys import LINE
from pipeline.tables.row import Row

LN_CW, BEND = "ln_cw_standard", "bend"
"""What makes an outlier: height and bend (v/B)^2 of the curve, both at the standard speed. Of the
forms of the bend this one has the most even spread: where B truly spreads 10 %, 27 % of types of 24
boats had an outlier by q, 11 % have one by this."""

LN_DISPLACEMENT: Final = "ln_displacement"
EXPLAINING: Final = ("weight_kg", "displacement_kg", "declared_speed_m_s", "waterline_length_m")
OF_THE_BOAT: Final = ("weight_kg", "waterline_length_m")
"""Explaining variables that say nothing of the crew."""

SLIDE_PAIRS: Final = tuple(
    (quantity, explaining)
    for quantity in ("b_m_s", "a_kg_m", "cw_standard_kg_m")
    for explaining in ("weight_kg", "declared_speed_m_s", "waterline_length_m")
)
"""What the presentation of 2015 plots, here for every choice of tows."""


ALL_CREWS: Final = "all"
WITHIN: Final = {"men": "H", "women": "D"}
"""Classes within which lines against tow speed are drawn too, by their codes."""

FEWEST_BOATS: Final = 3
PLACES: Final = 7
"""Points at which a line is given for drawing."""

OUTSIDE_LEVEL: Final = 0.05
"""Chance that any boat of a type of like boats is called outside (Bonferroni)."""

UNUSUAL_SD: Final = 2.0
"""A weight, length or season counts as unusual from this many standard deviations on."""

ASKEW_EXCESS: Final = 0.03
"""Pulled askew gave 5-10 % too high, once 40 % (presentation 2015); less is not worth naming."""


class Choice(NamedTuple):
    """Which tows: a name as in tables (`newest`, `all`, a season, a range), and what deviates.

    Of one season, as of the newest tows, hardly any boat has two: boat and tow are one. Of all
    tows and of a range each deviates by itself as well, by its season among other things: a chart
    of all tows shows that too.
    """

    tows: str
    components: tuple[str, ...] = (mixed.BOAT,)


NEWEST: Final = Choice("newest")
ALL_TOWS: Final = Choice("all", (mixed.BOAT, mixed.CELL))
TOW_BY_TOW: Final = Choice("all", mixed.COMPONENTS)


def chosen_tows(observed: Observed) -> Iterator[tuple[Choice, Observed]]:
    """Every choice of tows, with them."""
    yield NEWEST, newest(observed)
    yield ALL_TOWS, observed
    season = observed.table["season"]
    by_ends = {Choice(str(one)): (one, one) for one in season.unique().sort()}
    for name, ends in season_ranges(season).items():
        by_ends[Choice(name, ALL_TOWS.components)] = ends
    for choice, ends in by_ends.items():
        yield choice, observed.take(np.flatnonzero(season.is_between(*ends).to_numpy()))


Measured = tuple[FloatArray, FloatArray]
"""Values and their variances for a run scatter of 1, shape (rows,); NaN where there is none."""


def quantities(observed: Observed) -> dict[str, Measured]:
    """What is compared within a type.

    Cw at the standard speed is the curve's also beyond the speeds at which it counts: a tow too
    slow for it is not left out. Its error grows with the distance.

    Errors of A and B are taken at the type's middle bend, not at each tow's own: else boats with a
    small B, whose error looks small, would weigh most.
    """
    speed = observed.column("standard_speed_m_s")
    a, cw = observed.column("a_kg_m"), observed.column("cw_kg_m")
    b = observed.table["b_m_s"].to_numpy().astype(np.float64)
    b = np.where(observed.table["b_capped"].to_numpy(), np.nan, b)
    middle = pl.col("q").median().over("method", "boat_type")
    q = np.maximum(observed.table.select(middle).to_series().to_numpy(), 0.05)
    var_c, var_q = observed.column("c0_unit_variance"), observed.column("q_unit_variance")
    cov = observed.column("c0_q_unit_covariance")
    standard = curve_anywhere(observed, speed)
    standard_unit = ln_cw_unit_variance(observed, speed)
    with np.errstate(invalid="ignore"):
        ln_standard = np.log(standard)
    return {
        "b_m_s": (b, b * b * var_q / (2.0 * q * (1.0 + q)) ** 2),
        "a_kg_m": (a, a * a * (var_c - 2.0 * cov / (1.0 + q) + var_q / (1.0 + q) ** 2)),
        "q": q_at(observed, speed),
        BEND: bend_at(observed, speed),
        "cw_kg_m": (cw, cw * cw * var_c),
        "cw_standard_kg_m": (standard, standard * standard * standard_unit),
        LN_CW: (ln_standard, standard_unit),
    }


def newest_lines(lines: pl.DataFrame) -> pl.DataFrame:
    """Rows of the table `type_consistency`: those of `type_lines` by the newest tows.

    The physics model is among them: the slope of ln Cw on ln displacement is the power with which
    resistance grows.
    """
    return lines.filter(tows=NEWEST.tows).drop("tows")


def type_lines(
    observed: Observed,
) -> tuple[dy.DataFrame[TypeLines], dy.DataFrame[TypeLinePoints]]:
    """Straight lines of each quantity on each explaining variable, per method and boat type.

    All lines over the newest tow of each boat and crew; over other choices of tows, those that
    the presentation of 2015 plots.

    Returns:
        Rows of the tables `type_lines` and `type_line_points`. Where no line is drawn, `reason`
        says why. Points are those of lines over all crews. Where such a line compares boats within
        a crew, they are given per class; `crew_class` is `all` elsewhere.
    """
    rows: list[Row] = []
    lines: dict[tuple[str, ...], list[_Line]] = {}
    for choice, tows in chosen_tows(observed):
        measured, designs = quantities(tows), _Designs(tows)
        run_variance = tows.column("run_sd_ratio") ** 2
        speeds = tows.column("standard_speed_m_s")
        for (method, boat_type), own in tows.rows_by("method", "boat_type"):
            for quantity, explaining, within in _kinds(choice):
                y, unit = measured[quantity]
                mine = own[np.isfinite(y[own])]
                mine, facts, design = designs.of(mine, boat_type, explaining, within)
                row: Row = {
                    "method": method,
                    "tows": choice.tows,
                    "boat_type": boat_type,
                    "quantity": quantity,
                    "explaining": explaining,
                    "within": within,
                    "standard_speed_m_s": float(speeds[own[0]]),
                    **facts,
                }
                rows.append(row)
                if design is not None:
                    variance = unit[mine] * run_variance[mine]
                    problem = Problem.of(y[mine], variance, design.x, design.boat)
                    noise = float(np.sqrt(variance.mean()))
                    lines.setdefault(choice.components, []).append(
                        _Line(row, design, problem, noise)
                    )
    points: dict[str, list[object]] = {name: [] for name in TypeLinePoints.column_names()}
    for components, of_choice in lines.items():
        fits = mixed.fit_all([line.problem for line in of_choice], components)
        for line, fit in zip(of_choice, fits, strict=True):
            if fit is None:
                line.row["reason"] = "not_settled"
                continue
            ends = fit.line_at(line.design.at)
            line.row.update(_numbers(line, fit, ends))
            if line.is_drawn:
                for column, values in _points(line, ends).items():
                    points[column] += values
    return frame_of(TypeLines, rows), TypeLinePoints.cast(pl.DataFrame(points))


def _kinds(choice: Choice) -> Iterator[tuple[str, str, str]]:
    """Each quantity with what may explain it, and within which crews, for a choice of tows."""
    for quantity, explaining in _pairs(choice):
        yield quantity, explaining, ALL_CREWS
        if explaining == "declared_speed_m_s":
            yield from ((quantity, explaining, name) for name in WITHIN)


def _pairs(choice: Choice) -> Iterator[tuple[str, str]]:
    """Each quantity with what may explain it, as far as the choice of tows has a line of it."""
    if choice != NEWEST:
        yield from SLIDE_PAIRS
        return
    for quantity in ("b_m_s", "a_kg_m", "q", "cw_kg_m", "cw_standard_kg_m"):
        for explaining in EXPLAINING:
            yield quantity, explaining
    yield LN_CW, LN_DISPLACEMENT


class _Design(NamedTuple):
    """What lines through the same tows on the same explaining variable have in common.

    Attributes:
        x: the crews and the variable, which is scaled to one so that no power of a unit gets lost
            in rounding.
        boat: of each row.
        width: what the variable is divided by.
        names, places: class and place of each point that is drawn.
        at: the same as rows of x; the last row is the slope's.
    """

    x: FloatArray
    boat: IntArray
    width: float
    names: list[str]
    places: list[float]
    at: FloatArray


class _Line(NamedTuple):
    """A line to be fitted: its row of `type_lines`, and root mean square of measuring errors."""

    row: Row
    design: _Design
    problem: Problem
    noise: float

    @property
    def is_drawn(self) -> bool:
        """Whether its points are in `type_line_points`."""
        kind = self.row["quantity"], self.row["explaining"]
        return self.row["within"] == ALL_CREWS and kind in SLIDE_PAIRS


class _Designs:
    """Designs of lines: one serves all methods and quantities with its tows."""

    def __init__(self, tows: Observed) -> None:
        self._explaining = {n: _explaining(tows, n) for n in (*EXPLAINING, LN_DISPLACEMENT)}
        self._tow, self._boat, self._hull, self._crew = (
            tows.table.select(pl.struct(by).rank("dense")).to_series().to_numpy()
            for by in (("tow_id",), ("fsn_no",), ("hull",), ("rowers", "crew_class"))
        )
        self._class = tows.table["crew_class"].to_numpy()
        self._made: dict[tuple[str, str, bytes], tuple[Row, _Design | None]] = {}

    def of(
        self, rows: IntArray, boat_type: str, explaining: str, within: str
    ) -> tuple[IntArray, Row, _Design | None]:
        """Which of some rows a line is through, how many they are, and the design or why none."""
        known = np.isfinite(self._explaining[explaining][rows])
        if within != ALL_CREWS:
            known &= self._class[rows] == WITHIN[within]
        rows = rows[known]
        key = boat_type, explaining, self._tow[rows].tobytes()
        if key not in self._made:
            self._made[key] = self._design(rows, boat_type, explaining)
        return rows, *self._made[key]

    def _design(
        self, rows: IntArray, boat_type: str, explaining: str
    ) -> tuple[Row, _Design | None]:
        of_boat = explaining in OF_THE_BOAT
        crew = self._crew[rows] if of_boat else np.zeros(len(rows))
        crews = np.asarray(crew[:, None] == np.unique(crew), dtype=np.float64)
        n_boats = len(np.unique(self._boat[rows]))
        counts: Row = {"n": len(rows), "n_boats": n_boats}
        if boat_type == UNKNOWN_TYPE:
            return counts | {"reason": "no_type"}, None
        if n_boats < max(FEWEST_BOATS, crews.shape[1] + 2):
            return counts | {"reason": "few_boats"}, None
        x = self._explaining[explaining][rows]
        centre = np.linalg.lstsq(crews, x)[0]
        centred = x - crews @ centre
        width = float(np.abs(centred).max())
        if width <= 1e-9 * np.abs(x).max():
            return counts | {"reason": "equal_values"}, None
        names, places, at = [], [], []
        whose = self._class[rows] if of_boat else np.full(len(rows), ALL_CREWS)
        for name in np.unique(whose):
            mine = whose == name
            some = np.unique(np.linspace(x[mine].min(), x[mine].max(), PLACES))
            mean = crews[mine].mean(axis=0)
            at += [[*mean, (place - mean @ centre) / width] for place in some]
            names += [str(name)] * len(some)
            places += some.tolist()
        at.append([*np.zeros(crews.shape[1]), 1.0])
        columns = np.column_stack([crews, centred / width])
        design = _Design(columns, self._hull[rows], width, names, places, np.array(at))
        return counts | {"reason": ""}, design


def _numbers(line: _Line, fit: mixed.Fit, ends: mixed.Coefficients) -> Row:
    """The line and its spread, as in `type_lines`; `ends` are at `_Design.at`.

    Tows weigh on the line as they were measured. About the line as it is drawn they count alike in
    its spread, and so in R2: beside that about the means of the crews.
    """
    problem, level = line.problem, 1.0
    if line.row["quantity"] != LN_CW:
        level = float(abs(problem.y.mean()))
    slope, lo, hi = (float(end[-1]) / line.design.width for end in ends)
    about_line = float(((problem.y - problem.x @ fit.beta) ** 2).sum())
    # The last column of x has no mean within a crew.
    about_means = float(((problem.residual + problem.x[:, -1] * problem.plain[-1]) ** 2).sum())
    return {
        "slope": slope,
        "slope_lo": lo,
        "slope_hi": hi,
        "r2": max(1.0 - about_line / about_means, 0.0) if about_means > 0 else None,
        "residual_sd_ratio": float(np.sqrt(about_line / problem.rows_beyond)) / level,
        "between_sd_ratio": fit.sd[0] / level,
        "noise_sd_ratio": line.noise / level,
    }


def _points(line: _Line, ends: mixed.Coefficients) -> dict[str, list[object]]:
    """The line with its interval at some places; for each class at the mean of its crews."""
    names = ("method", "tows", "boat_type", "quantity", "explaining")
    columns = {name: [line.row[name]] * len(line.design.places) for name in names}
    columns |= {"crew_class": list(line.design.names), "x": list(line.design.places)}
    value, lo, hi = (end[:-1].tolist() for end in ends)
    return columns | {"y": value, "lo": lo, "hi": hi}


def _explaining(boats: Observed, name: str) -> FloatArray:
    """An explaining variable, NaN where missing."""
    if name == LN_DISPLACEMENT:
        return np.log(_explaining(boats, "displacement_kg"))
    return np.asarray(boats.table[name].to_numpy(), dtype=np.float64)


def type_outliers(observed: Observed) -> pl.DataFrame:
    """The newest tow of every boat against its type, with what could explain a difference.

    ln Cw at the standard speed is compared, after the line on ln displacement where that is known,
    and so is the bend. A boat's expectation comes from the other boats alone; the deviation is in
    standard deviations of a prediction (externally Studentised).

    Returns:
        Rows of the table `type_outliers`: one per method, tow and quantity, `outside` or not;
        none of a type where the search for its variances did not come to rest.
    """
    return _outliers(newest(observed), NEWEST, (LN_CW, BEND))


def tow_outliers(observed: Observed) -> pl.DataFrame:
    """Every tow against the tows of the other boats of its type, by Cw at the standard speed.

    A season's own deviation is taken out, so that a tow stands out by itself and not because its
    log was worn like those of all tows that year.

    Returns:
        As `type_outliers`, for all tows.
    """
    return _outliers(observed, TOW_BY_TOW, (LN_CW,))


def _outliers(tows: Observed, choice: Choice, names: tuple[str, ...]) -> pl.DataFrame:
    compared = [
        (boats, quantity, problem)
        for (_, boat_type), group in tows.groups("method", "boat_type")
        if boat_type != UNKNOWN_TYPE
        for quantity in names
        for boats, problem in _compared(group, choice, quantity)
    ]
    fits = mixed.fit_all([problem for *_, problem in compared], choice.components)
    parts = [
        _deviations(boats, quantity, fit)
        for (boats, quantity, _), fit in zip(compared, fits, strict=True)
        if fit is not None
    ]
    return _with_season(pl.concat([TypeOutliers.create_empty(), *parts]))


def _compared(boats: Observed, choice: Choice, quantity: str) -> Iterator[tuple[Observed, Problem]]:
    """The boats of a type that have a quantity, with what is fitted; nothing where too few have."""
    y, unit = quantities(boats)[quantity]
    displacement = _explaining(boats, LN_DISPLACEMENT)
    weighed = quantity == LN_CW and bool(np.isfinite(displacement).all())
    known = np.flatnonzero(np.isfinite(y))
    boats, y, displacement = boats.take(known), y[known], displacement[known]
    x = np.ones((len(y), 1))
    if weighed and len(y) and np.ptp(displacement) > 1e-9:
        x = np.column_stack([x, displacement - displacement.mean()])
    if boats.table["fsn_no"].n_unique() >= x.shape[1] + FEWEST_BOATS:
        variance = unit[known] * boats.column("run_sd_ratio") ** 2
        season = boats.table["season"].to_numpy() if mixed.OTHER in choice.components else None
        yield boats, Problem.of(y, variance, x, boats.table["hull"].to_numpy(), season)


def _deviations(boats: Observed, quantity: str, fit: mixed.Fit) -> pl.DataFrame:
    """Rows of the table `type_outliers`, without the candidate `season`."""
    y = fit.problem.y
    error, variance, scale = fit.leave_boats_out()
    deviation = error / np.sqrt(variance * scale)
    chance = 1.0 - OUTSIDE_LEVEL / (2.0 * len(y))
    limit = float(scipy.special.stdtrit(max(fit.dof - 1, 1), chance))
    return boats.table.select(
        "method",
        "tow_id",
        *LINE,
        "boat_type",
        "season",
        pl.lit(quantity).alias("quantity"),
        "standard_speed_m_s",
        pl.Series("value", y),
        pl.Series("expected", y - error),
        pl.Series("deviation_sd", deviation),
        pl.Series("outside", np.abs(deviation) > limit),
        pl.Series("candidates", _candidates(boats, quantity, error)),
    )


def _candidates(boats: Observed, quantity: str, error: FloatArray) -> list[list[str]]:
    """What could explain a boat's place, as codes; the season is judged afterwards."""
    table = boats.table
    unchecked = (table["season"] < STEERED_STRAIGHT_FROM).to_numpy()
    high = (error > ASKEW_EXCESS) & (quantity == LN_CW)
    differ = table["flags"].list.contains("out_and_back_differ").to_numpy()
    checks = {
        "weight": _unusual(_explaining(boats, "weight_kg")),
        "length": _unusual(_explaining(boats, "waterline_length_m")),
        "log": table["flags"].list.contains("unusual_calibration").to_numpy(),
        "altered": table["altered"].to_numpy(),
        "slow_tow": is_slow(table),
        "askew": differ | (high & unchecked),
        "b_at_cap": table["b_capped"].to_numpy(),
        "b_not_determined": table["b_m_s"].is_null().to_numpy(),
    }
    return [[code for code, applies in checks.items() if applies[i]] for i in range(table.height)]


def _unusual(values: FloatArray) -> BoolArray:
    """Whether a value lies far from the other boats', each judged by the others."""
    known = np.isfinite(values)
    others = int(known.sum()) - 1
    if others < FEWEST_BOATS:
        return np.zeros(len(values), bool)
    # About the mean of the others: with the value itself mean and squares are known.
    from_all = values - values[known].mean()
    squares = from_all**2 * (others + 1) / others
    variance = ((from_all[known] ** 2).sum() - squares) / (others - 1)
    from_others = np.abs(from_all) * (others + 1) / others
    return np.asarray(known & (from_others > UNUSUAL_SD * np.sqrt(np.fmax(variance, 1e-18))))


def _with_season(outliers: pl.DataFrame) -> pl.DataFrame:
    """Adds the candidate `season` where the season's other boats lie on the same side."""
    group = ["method", "quantity", "season"]
    others = pl.len().over(group) - 1
    mean = (pl.col("deviation_sd").sum().over(group) - pl.col("deviation_sd")) / others
    along = mean * pl.col("deviation_sd").sign() * others.sqrt() > UNUSUAL_SD
    return outliers.with_columns(
        pl.when((others > 0) & along)
        .then(pl.col("candidates").list.concat(pl.lit(["season"])))
        .otherwise("candidates")
        .alias("candidates")
    ).sort("method", "boat_type", "tow_id", "quantity")
