"""Does a quantity follow weight, length or tow speed within a type, and which tows lie outside?

Which tows is a choice: the newest of each boat and crew, all, or those of one season. Lines are
weighted: each tow has its own measuring error, and boats differ truly by a standard deviation that
is estimated (REML); tows of one boat, also of two crews, share that difference. Over all tows a
season and a single tow have a deviation of their own as well, so that repeats count as repeats.
Women's and men's crews differ in weight and speed, so lines against weight or length compare boats
within a crew; displacement contains the crew.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Final, NamedTuple, Self

import numpy as np
import polars as pl
import scipy
from numpy.typing import NDArray

from herijk.pipeline.arrays import BoolArray, FloatArray, IntArray
from herijk.pipeline.consistency import mixed
from herijk.pipeline.consistency.eras import Era, season_ranges
from herijk.pipeline.consistency.observed import (
    UNKNOWN_TYPE,
    Observed,
    bend_at,
    curve_anywhere,
    ln_cw_unit_variance,
    newest,
    q_at,
)
from herijk.pipeline.consistency.reml import Problem
from herijk.pipeline.consistency.tow_speed import is_slow
from herijk.tables.consistency import TypeLinePoints, TypeLines, TypeOutliers
from herijk.tables.declare import dy
from herijk.tables.frames import frame_of
from herijk.tables.keys import LINE
from herijk.tables.row import Row

LN_CW, BEND = "ln_cw_standard", "bend"
"""What tells an outlier: height and bend (v/B)^2 of the curve, both at the standard speed. Of the
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


FEWEST_BOATS: Final = 3
PLACES: Final = 7
"""Points at which a line is given for drawing."""

NO_TYPE = "no_type"
FEW_BOATS = "few_boats"
EQUAL_VALUES = "equal_values"

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
    for season in observed.table["season"].unique().sort():
        rows = np.flatnonzero((observed.table["season"] == season).to_numpy())
        yield Choice(str(season)), observed.take(rows)
    for name, ends in season_ranges(observed.table["season"]).items():
        rows = np.flatnonzero(observed.table["season"].is_between(*ends).to_numpy())
        yield Choice(name, ALL_TOWS.components), observed.take(rows)


def standard_speed_m_s(observed: Observed) -> float:
    """The common speed at which boats of a type are compared."""
    return float(observed.table["standard_speed_m_s"][0])


Measured = tuple[FloatArray, FloatArray]
"""Values and their variances for a run scatter of 1, shape (rows,); NaN where there is none."""


def quantities(observed: Observed) -> dict[str, Measured]:
    """What is compared within a type.

    Cw at the standard speed is the curve's also beyond the speeds at which it counts: a tow too
    slow for it is not left out. Its error grows with the distance.

    Errors of A and B are taken at the type's middle bend, not at each tow's own: else boats with a
    small B, whose error looks small, would weigh most.
    """
    speed = standard_speed_m_s(observed)
    a, cw = observed.column("a_kg_m"), observed.column("cw_kg_m")
    b = observed.table["b_m_s"].to_numpy().astype(np.float64)
    b = np.where(observed.table["b_capped"].to_numpy(), np.nan, b)
    q = max(float(np.median(observed.column("q"))), 0.05)
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


def type_consistency(observed: Observed) -> pl.DataFrame:
    """Straight line of each quantity on each explaining variable, per method and boat type.

    Of the newest tow of each boat and crew. The physics model is among them: the slope of ln Cw on
    ln displacement is the power with which resistance grows.

    Returns:
        Rows of the table `type_consistency`; where no line is drawn, `reason` says why.
    """
    return newest_lines(_lines([(NEWEST, newest(observed))])[0])


def newest_lines(lines: pl.DataFrame) -> pl.DataFrame:
    """The rows of `type_consistency` among those of `type_lines`."""
    return lines.filter(tows=NEWEST.tows).drop("tows")


def type_lines(
    observed: Observed,
) -> tuple[dy.DataFrame[TypeLines], dy.DataFrame[TypeLinePoints]]:
    """The lines of every choice of tows, per method and boat type.

    Of the newest tows all, of other choices those that the presentation of 2015 plots.

    Returns:
        Rows of the tables `type_lines` and `type_line_points`. Where a line compares boats within
        a crew, its points are given per class; `crew_class` is `all` elsewhere.
    """
    return _lines(chosen_tows(observed))


def _lines(
    chosen: Iterable[tuple[Choice, Observed]],
) -> tuple[dy.DataFrame[TypeLines], dy.DataFrame[TypeLinePoints]]:
    rows: list[Row] = []
    to_fit: dict[tuple[str, ...], list[tuple[Row, Row, _Line]]] = {}
    for choice, tows in chosen:
        for (method, boat_type), group in tows.groups("method", "boat_type"):
            boats = _Boats.of(group)
            some = cache(boats.where)  # lines have the same tows time and again
            speed = {"standard_speed_m_s": standard_speed_m_s(group)}
            for quantity, explaining, measured in _pairs(group, choice):
                names = {"method": method, "tows": choice.tows, "boat_type": boat_type}
                names |= {"quantity": quantity, "explaining": explaining}
                facts, line = _line(boats, some, choice, names, measured)
                rows.append(names | speed | facts)
                if line is not None:
                    to_fit.setdefault(choice.components, []).append((rows[-1], names, line))
    points: list[Row] = []
    for components, lines in to_fit.items():
        fits = mixed.fit_all([line.problem for *_, line in lines], components)
        for (row, names, line), fit in zip(lines, fits, strict=True):
            row.update(line.row(fit))
            if (names["quantity"], names["explaining"]) in SLIDE_PAIRS:
                points += [names | point for point in line.points(fit)]
    return frame_of(TypeLines, rows), frame_of(TypeLinePoints, points)


@dataclass(frozen=True)
class _Boats:
    """What lines need of the tows of a type, as arrays of shape (tows,): lines are many.

    Attributes:
        boat, crew: number of the boat, and of rowers and class.
        crew_class: the class.
        season: the season.
        run_sd_ratio: as in `Observed`.
        explaining: the explaining variables by name, NaN where missing.
        type_known: whether the type is.
    """

    boat: IntArray
    crew: IntArray
    crew_class: NDArray[np.object_]
    season: IntArray
    run_sd_ratio: FloatArray
    explaining: Mapping[str, FloatArray]
    type_known: bool

    @classmethod
    def of(cls, tows: Observed) -> Self:
        """The tows of one type under one method."""
        crews = tows.table.select(pl.struct("rowers", "crew_class").rank("dense")).to_series()
        return cls(
            np.unique(tows.table["fsn_no"].to_numpy(), return_inverse=True)[1],
            crews.to_numpy().astype(np.int64),
            tows.table["crew_class"].to_numpy(),
            tows.table["season"].to_numpy().astype(np.int64),
            tows.column("run_sd_ratio"),
            {name: _explaining(tows, name) for name in (*EXPLAINING, LN_DISPLACEMENT)},
            tows.table["boat_type"][0] != UNKNOWN_TYPE,
        )

    def where(self, known: bytes) -> "_Boats":
        """Some of the tows, by the bytes of a mask."""
        some = np.frombuffer(known, dtype=bool)
        return _Boats(
            self.boat[some],
            self.crew[some],
            self.crew_class[some],
            self.season[some],
            self.run_sd_ratio[some],
            {name: values[some] for name, values in self.explaining.items()},
            self.type_known,
        )

    @cached_property
    def number(self) -> int:
        """Number of different boats."""
        return len(np.unique(self.boat))

    @cached_property
    def crew_effects(self) -> FloatArray:
        """One indicator column per crew."""
        number = np.unique(self.crew, return_inverse=True)[1]
        return np.asarray(np.eye(int(number.max(initial=0)) + 1)[number])

    @cached_property
    def classes(self) -> list[tuple[str, BoolArray]]:
        """The classes, with the tows of each."""
        return [(name, self.crew_class == name) for name in np.unique(self.crew_class)]

    @cached_property
    def all(self) -> list[tuple[str, BoolArray]]:
        """The same with all tows as one."""
        return [("all", np.ones(len(self.boat), dtype=bool))]


def _pairs(boats: Observed, choice: Choice) -> Iterator[tuple[str, str, Measured]]:
    for quantity, measured in quantities(boats).items():
        if quantity == LN_CW:
            explaining = [LN_DISPLACEMENT]
        else:
            explaining = [] if quantity == BEND else list(EXPLAINING)
        for name in explaining:
            if choice == NEWEST or (quantity, name) in SLIDE_PAIRS:
                yield quantity, name, measured


def _line(
    boats: _Boats,
    some: Callable[[bytes], _Boats],
    choice: Choice,
    names: Mapping[str, str],
    measured: Measured,
) -> tuple[Row, "_Line | None"]:
    """How many tows a line is of, and the line; without one, why."""
    y, unit = measured
    x = boats.explaining[names["explaining"]]
    known = np.isfinite(x) & np.isfinite(y)
    boats, x, y = some(known.tobytes()), x[known], y[known]
    within_crew = names["explaining"] in OF_THE_BOAT
    crews = boats.crew_effects if within_crew else np.ones((len(y), 1))
    centre = np.asarray(np.linalg.lstsq(crews, x)[0], dtype=np.float64)
    centred = x - crews @ centre
    width = float(np.abs(centred).max(initial=0.0))
    reason = _no_line(boats, crews, width <= 1e-9 * np.abs(x).max(initial=0.0))
    counts = {"n": len(y), "n_boats": boats.number, "reason": reason}
    if reason:
        return counts, None
    variance = unit[known] * boats.run_sd_ratio**2
    problem = Problem.of(
        y,
        np.column_stack([crews, centred / width]),
        variance,
        boats.boat,
        _seasons(boats.season, choice),
    )
    noise = float(np.sqrt(variance.mean()))
    level = 1.0 if names["quantity"] == LN_CW else abs(y.mean())
    groups = boats.classes if within_crew else boats.all
    return counts, _Line(problem, crews, x, (centre, width), noise, level, groups)


def _no_line(boats: _Boats, crews: FloatArray, equal_values: bool) -> str:
    """Why no line is drawn; empty where there is one."""
    if not boats.type_known:
        return NO_TYPE
    if boats.number < max(FEWEST_BOATS, crews.shape[1] + 2):
        return FEW_BOATS
    return EQUAL_VALUES if equal_values else ""


@dataclass(frozen=True)
class _Line:
    """A line of a quantity on an explaining variable, to be fitted.

    Attributes:
        problem: the quantity, the crews and x; x is scaled to one so that no power of a unit gets
            lost in rounding.
        crews: (tows, crews) which crew each tow is of.
        x: (tows,) the explaining variable.
        scale: the crews' means of x, and what it is divided by.
        noise: root mean square of the measuring errors.
        level: what the spread is a share of.
        groups: those that get points of their own: name, and which tows.
    """

    problem: Problem
    crews: FloatArray
    x: FloatArray
    scale: tuple[FloatArray, float]
    noise: float
    level: float
    groups: Sequence[tuple[str, BoolArray]]

    def row(self, fit: mixed.Fit) -> Row:
        """The line itself and its spread, as in `type_lines`."""
        problem = self.problem
        slope, lo, hi = (float(end[-1]) / self.scale[1] for end in fit.coefficients())
        residual = problem.y - problem.x @ fit.beta
        spread = np.sqrt((residual**2).sum() / (len(problem.y) - problem.x.shape[1]))
        total = fit.total_misfit
        return {
            "slope": slope,
            "slope_lo": lo,
            "slope_hi": hi,
            "r2": min(max(1.0 - fit.misfit / total, 0.0), 1.0) if total > 0 else None,
            "residual_sd_ratio": float(spread) / self.level,
            "between_sd_ratio": fit.sd[0] / self.level,
            "noise_sd_ratio": self.noise / self.level,
        }

    def points(self, fit: mixed.Fit) -> Iterator[Row]:
        """The line with its interval at some places; for each class at the mean of its crews."""
        centre, width = self.scale
        names, places, designs = [], [], []
        for name, rows in self.groups:
            at = np.unique(np.linspace(self.x[rows].min(), self.x[rows].max(), PLACES))
            crew = self.crews[rows].mean(axis=0)
            designs.append(
                np.column_stack([np.tile(crew, (len(at), 1)), (at - crew @ centre) / width])
            )
            names += [name] * len(at)
            places += at.tolist()
        line = fit.line_at(np.concatenate(designs))
        for name, at, mean, lo, hi in zip(
            names, places, *map(np.ndarray.tolist, line), strict=True
        ):
            yield {"crew_class": name, "x": at, "y": mean, "lo": lo, "hi": hi}


def _seasons(season: IntArray, choice: Choice) -> IntArray | None:
    """The season of each tow, where seasons may deviate."""
    return season if mixed.OTHER in choice.components else None


def _explaining(boats: Observed, name: str) -> FloatArray:
    """An explaining variable, NaN where missing."""
    if name == LN_DISPLACEMENT:
        return np.log(_explaining(boats, "displacement_kg"))
    return np.asarray(boats.table[name].to_numpy(), dtype=np.float64)


def type_outliers(observed: Observed, eras: tuple[Era, ...]) -> pl.DataFrame:
    """The newest tow of every boat against its type, with what could explain a difference.

    Compared are ln Cw at the standard speed, after the line on ln displacement where that is known,
    and the bend. A boat's expectation comes from the other boats alone; the deviation is in
    standard deviations of a prediction (externally Studentised).

    Returns:
        Rows of the table `type_outliers`: one per method, tow and quantity, `outside` or not.
    """
    return _outliers(newest(observed), NEWEST, (LN_CW, BEND), eras)


def tow_outliers(observed: Observed, eras: tuple[Era, ...]) -> pl.DataFrame:
    """Every tow against the tows of the other boats of its type, by Cw at the standard speed.

    A season's own deviation is taken out, so that a tow stands out by itself and not because its
    log was worn like those of all tows that year.

    Returns:
        As `type_outliers`, for all tows.
    """
    return _outliers(observed, TOW_BY_TOW, (LN_CW,), eras)


def _outliers(
    tows: Observed, choice: Choice, names: tuple[str, ...], eras: tuple[Era, ...]
) -> pl.DataFrame:
    compared = [
        one
        for (_, boat_type), group in tows.groups("method", "boat_type")
        if boat_type != UNKNOWN_TYPE
        for one in (_Compared.of(group, choice, quantity) for quantity in names)
        if one is not None
    ]
    fits = mixed.fit_all([one.problem for one in compared], choice.components)
    parts = [one.frame(fit, eras) for one, fit in zip(compared, fits, strict=True)]
    return _with_season(pl.concat([TypeOutliers.create_empty(), *parts]))


@dataclass(frozen=True)
class _Compared:
    """A quantity of the boats of a type, to be compared with the others' of the type.

    Attributes:
        boats: those that have it.
        quantity: its name.
        problem: what is fitted; `problem.y` is the quantity.
    """

    boats: Observed
    quantity: str
    problem: Problem

    @classmethod
    def of(cls, boats: Observed, choice: Choice, quantity: str) -> Self | None:
        """What is compared; None where too few boats have it."""
        y, unit = quantities(boats)[quantity]
        displacement = _explaining(boats, LN_DISPLACEMENT)
        weighed = quantity == LN_CW and bool(np.isfinite(displacement).all())
        known = np.flatnonzero(np.isfinite(y))
        boats, y, displacement = boats.take(known), y[known], displacement[known]
        if len(y) == 0:
            return None
        x = np.ones((len(y), 1))
        if weighed and np.ptp(displacement) > 1e-9:
            x = np.column_stack([x, displacement - displacement.mean()])
        n_boats = boats.table["fsn_no"].n_unique()
        if n_boats < x.shape[1] + FEWEST_BOATS:
            return None
        variance = unit[known] * boats.column("run_sd_ratio") ** 2
        fsn_no = boats.table["fsn_no"].to_numpy()
        season = boats.table["season"].to_numpy().astype(np.int64)
        problem = Problem.of(y, x, variance, fsn_no, _seasons(season, choice))
        return cls(boats, quantity, problem)

    def frame(self, fit: mixed.Fit, eras: tuple[Era, ...]) -> pl.DataFrame:
        """Rows of the table `type_outliers`, without the candidate `season`."""
        y, left_out = self.problem.y, fit.leave_boats_out()
        deviation = _studentised(left_out.error / np.sqrt(left_out.variance * fit.scale), fit)
        chance = 1.0 - OUTSIDE_LEVEL / (2.0 * len(y))
        limit = float(scipy.special.stdtrit(max(fit.dof - 1, 1), chance))
        return self.boats.table.select(
            "method",
            "tow_id",
            *LINE,
            "boat_type",
            "season",
            pl.lit(self.quantity).alias("quantity"),
            "standard_speed_m_s",
            pl.Series("value", y),
            pl.Series("expected", y - left_out.error),
            pl.Series("deviation_sd", deviation),
            pl.Series("outside", np.abs(deviation) > limit),
            pl.Series("candidates", _candidates(self.boats, self.quantity, left_out.error, eras)),
        )


def _studentised(internal: FloatArray, fit: mixed.Fit) -> FloatArray:
    """Deviation with the boat itself taken out of the spread (Cook & Weisberg 1982, 2.2.1)."""
    dof = max(fit.dof, 2)
    return np.asarray(internal * np.sqrt((dof - 1) / np.maximum(dof - internal**2, 0.05)))


def _candidates(
    boats: Observed, quantity: str, error: FloatArray, eras: tuple[Era, ...]
) -> list[list[str]]:
    """What could explain a boat's place, as codes; the season is judged afterwards."""
    table = boats.table
    unchecked = np.array([not _steering_checked(season, eras) for season in table["season"]])
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


def _steering_checked(season: int, eras: tuple[Era, ...]) -> bool:
    return any(era.steering_checked and era.first <= season <= era.last for era in eras)


def _unusual(values: FloatArray) -> BoolArray:
    """Whether a value lies far from the other boats', each judged by the others."""
    unusual = np.zeros(len(values), bool)
    for i, value in enumerate(values):
        others = np.delete(values, i)
        others = others[np.isfinite(others)]
        if np.isfinite(value) and len(others) >= FEWEST_BOATS:
            unusual[i] = abs(value - others.mean()) > UNUSUAL_SD * max(others.std(ddof=1), 1e-9)
    return unusual


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
