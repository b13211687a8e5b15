"""Are boats of one type equal? B, A and Cw per type, against weight and against tow speed.

One model serves every quantity of every type, fitted to the newest tow of each boat and crew:

    y = class + weight + tow speed within the class + boat + season + measuring error

with y = ln Cw at the type's standard speed, ln A, or the bend (v*/B)^2. Men and women are never
compared with each other: their crews differ in mass, and so in Cw and in the speed of the tow. Rows
of men and of women of one hull share its boat. How large the measuring error is, and what tows of a
season share, repeat tows of the archive tell (`pipeline.consistency.noise`). Every verdict is about
a parameter of this model with its interval, held against a difference that matters, so that the
verdicts on one type agree.

With few boats, slopes that are estimated along with the spread would use it up. So they have a
prior (`Quantity.slopes`): heavier boats have more Cw, and tow speed should not matter, give or take
what hulls that are no hyperbolas do. The slopes that are told are estimated without that prior.

Spread between boats beyond their measuring errors, after what weight and tow speed explain:

- `equal`: its 95 % upper bound is under the difference that matters;
- `differ`: not equal, and its 95 % lower bound is above 0;
- `open`: the tows are too few or too rough to say.

A slope on weight or tow speed `rises` or `falls` if its 95 % interval leaves out 0; there is `none`
if that interval leaves out all slopes that matter between a light and a heavy boat; else `open`.
Slopes are those of the boats that do not stand out: one boat pulled askew would turn them.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, NamedTuple

import numpy as np
import polars as pl
import scipy

from pipeline.arrays import BoolArray, FloatArray
from pipeline.consistency.boat_model import BoatModel, Interval
from pipeline.consistency.noise import Noise, estimate_noise
from pipeline.consistency.repeats import estimate_median
from pipeline.quantiles import t_quantile
from pipeline.tables import keys
from pipeline.tables.consistency import TypeConsistency, TypeLinePoints
from pipeline.tables.frames import make_frame
from pipeline.tables.keys import TERM_NAMES, TOW_SPEED, UNKNOWN_TYPE, WEIGHT
from pipeline.tables.row import Row

MIN_BOATS: Final = 5
"""Boats of a type below which nothing is said of it, and of a class below which it has no slope."""

MIN_SLOPE_DOF: Final = 3
"""Boats beyond the columns of the model that a slope needs."""

MIN_BEND: Final = 0.02
"""Mean bend of a type below which its boats have no B: (v*/B)^2 at B of seven times the speed."""

OUTSIDE_CHANCE: Final = 0.05
"""Chance that any boat of a type of like boats is said to stand out (Bonferroni)."""

SDS_LIGHT_TO_HEAVY: Final = 2.0
"""A light and a heavy boat, a slow and a fast tow: so many standard deviations apart."""

TERMS: Final = {WEIGHT: 100.0, TOW_SPEED: 0.1}
"""What may explain a quantity, in order of importance, with the step that a slope is given for."""

VERDICTS: Final = ("verdict", "rest_verdict", "weight_verdict", "tow_speed_verdict")
"""Columns that say why, where nothing can be said of a type."""

LINE_PLACES: Final = 7
"""Points at which a line is given for drawing."""


class SlopePrior(NamedTuple):
    """What is known of a slope beforehand, as a ratio of the quantity per step of `TERMS`."""

    mean: float
    sd: float


class Quantity(NamedTuple):
    """A quantity of the register that boats of a type are compared by.

    Attributes:
        name: as in the tables.
        y, variance, zero_effect: columns of `observe` that the model is fitted to.
        slopes: prior of the slope on weight and on tow speed.
        only_valid: leave out tows whose curve does not count at the standard speed.
    """

    name: str
    y: str
    variance: str
    zero_effect: str
    slopes: Mapping[str, SlopePrior]
    only_valid: bool = False


MORE_WITH_WEIGHT: Final = SlopePrior(0.045, 0.03)
"""A, and Cw, grow about as displacement to the power 0.8; a boat with its crew weighs 1.8 t."""

CW: Final = Quantity(
    name=keys.CW_STANDARD,
    y="ln_cw_standard",
    variance="ln_cw_variance",
    zero_effect="ln_cw_zero_effect",
    slopes={WEIGHT: MORE_WITH_WEIGHT, TOW_SPEED: SlopePrior(0.0, 0.02)},
    only_valid=True,
)
B: Final = Quantity(
    name=keys.B,
    y="bend",
    variance="bend_variance",
    zero_effect="bend_zero_effect",
    slopes={WEIGHT: SlopePrior(0.0, 0.03), TOW_SPEED: SlopePrior(0.0, 0.05)},
)
A: Final = Quantity(
    name=keys.A,
    y="ln_a",
    variance="ln_a_variance",
    zero_effect="ln_a_zero_effect",
    slopes={WEIGHT: MORE_WITH_WEIGHT, TOW_SPEED: SlopePrior(0.0, 0.05)},
)
QUANTITIES: Final = (CW, B, A)

DIFFERENCES_THAT_MATTER: Final[Mapping[str, float]] = MappingProxyType(
    {CW.name: 0.03, B.name: 0.10, A.name: 0.10}
)
"""Standard deviation between boats, as a ratio of the quantity, if the federation sets no other.
3 % of Cw is 1 % of speed, a minute in a race of two hours; 10 % of B or A moves Cw by 2 to 3 % at
115 % of the declared speed."""


@dataclass(frozen=True)
class Design:
    """What explains the tows of a type; n tows, c classes, k terms.

    Attributes:
        classes: (n, c) 1 in the column of the tow's class.
        terms: the explaining variables that vary.
        slopes: (n, k) those about their mean, in steps of `TERMS`.
        reasons: why nothing is said of a slope, by explaining variable.
        values: (n,) of each explaining variable, missing ones at the mean.
        within: (n,) of each explaining variable about the mean of the class.
        sd: standard deviation of each within the classes.
    """

    classes: FloatArray
    terms: list[str]
    slopes: FloatArray
    reasons: dict[str, str]
    values: dict[str, FloatArray]
    within: dict[str, FloatArray]
    sd: dict[str, float]

    @property
    def is_told(self) -> BoolArray:
        """Whether something is said of the slope of each of `terms`, (k,)."""
        return np.array([term not in self.reasons for term in self.terms], dtype=bool)


def design_type(tows: pl.DataFrame) -> Design:
    """Describe what explains the tows of a type.

    Tow speed is taken about the mean of the class, weight about that of the type.

    Args:
        tows: rows of `observe` of one type, one per boat and crew.
    """
    class_of_tow = tows["crew_class"].to_numpy()
    classes = np.asarray(class_of_tow[:, None] == np.unique(class_of_tow), dtype=np.float64)
    n_boats = tows["fsn_no"].n_unique()
    boats_per_class = tows.group_by("crew_class", maintain_order=True).agg(
        pl.col("fsn_no").n_unique()
    )
    has_large_class = int(boats_per_class["fsn_no"].to_numpy().max()) >= MIN_BOATS
    columns = classes
    terms: list[str] = []
    reasons: dict[str, str] = {}
    values: dict[str, FloatArray] = {}
    within: dict[str, FloatArray] = {}
    sd: dict[str, float] = {}
    for name, step in TERMS.items():
        known = tows[name].cast(pl.Float64)
        values[name] = known.fill_null(known.mean() or 0.0).to_numpy()
        class_mean = classes @ (classes.T @ values[name] / classes.sum(axis=0))
        within[name] = values[name] - class_mean
        squares = float((within[name] ** 2).sum())
        sd[name] = float(np.sqrt(squares / max(tows.height - classes.shape[1], 1)))
        about = within[name] if name == TOW_SPEED else values[name] - values[name].mean()
        candidate = np.column_stack([columns, about / step])
        varies = sd[name] > 1e-9 * np.abs(values[name]).max()
        if not varies or np.linalg.matrix_rank(candidate) < candidate.shape[1]:
            reasons[name] = "equal_values"
            continue
        if not has_large_class or n_boats - candidate.shape[1] < MIN_SLOPE_DOF:
            reasons[name] = "few_boats"
        columns = candidate
        terms.append(name)
    return Design(
        classes=classes,
        terms=terms,
        slopes=columns[:, classes.shape[1] :],
        reasons=reasons,
        values=values,
        within=within,
        sd=sd,
    )


@dataclass(frozen=True)
class TypeModel:
    """The model of one quantity of one type under one method.

    Attributes:
        quantity: what is compared.
        difference_that_matters: as in `DIFFERENCES_THAT_MATTER`.
        tows: (n rows) the tows compared.
        design: what explains them.
        error_variance: (n,) of the measuring errors, with what a season's tows share.
        by_prior: (n,) y as the mean of the slopes' priors explains it.
        model: of y without `by_prior`, with the classes as columns and the slopes as the prior has
            them: for the spread between boats.
        slope_model: with the slopes that are told as columns.
    """

    quantity: Quantity
    difference_that_matters: float
    tows: pl.DataFrame
    design: Design
    error_variance: FloatArray
    by_prior: FloatArray
    model: BoatModel
    slope_model: BoatModel

    @property
    def mean(self) -> float:
        """Mean of y as the classes explain it."""
        return float((self.design.classes @ self.model.beta).mean())

    @property
    def ratio_per_y(self) -> float:
        """Relative change of the quantity for a change of y; 1 for logarithms."""
        return -0.5 / self.mean if self.quantity is B else 1.0

    def to_quantity(self, y: FloatArray | float) -> FloatArray:
        """Return the quantity in its unit; NaN for a B that does not exist."""
        values = np.asarray(y, dtype=np.float64)
        if self.quantity is not B:
            return np.exp(values)
        standard_speed = self.tows["standard_speed_m_s"][0]
        positive = np.where(values > 0.0, values, np.nan)
        return np.asarray(standard_speed / np.sqrt(positive))

    def unit_row(self, term: str) -> FloatArray:
        """Return the row that picks the slope of a term in `slope_model`, (1, p)."""
        n_columns = self.slope_model.x.shape[1]
        told = [name for name in self.design.terms if name not in self.design.reasons]
        return np.eye(n_columns)[[n_columns - len(told) + told.index(term)]]


def fit_type(
    tows: pl.DataFrame, quantity: Quantity, noise: Noise, difference_that_matters: float
) -> TypeModel | str:
    """Fit the model of a quantity to the newest tows of one type under one method.

    Args:
        tows: rows of `observe`, one per boat and crew.
        quantity: what is compared.
        noise: measuring errors of that quantity under that method.
        difference_that_matters: as in `DIFFERENCES_THAT_MATTER`.

    Returns:
        The model, or the code of the reason why nothing is said.
    """
    if tows["boat_type"][0] == UNKNOWN_TYPE:
        return "no_type"
    known = tows.drop_nulls([quantity.y, quantity.variance])
    if quantity.only_valid:
        known = known.filter(~pl.col("beyond_curve"))
    if known["fsn_no"].n_unique() < MIN_BOATS:
        return "few_boats"
    variance = known[quantity.variance].to_numpy()
    if not (variance > 0.0).all():
        return "no_scatter"
    design = design_type(known)
    y = known[quantity.y].to_numpy()
    errors = noise.covariance(
        variance, known[quantity.zero_effect].to_numpy(), known["season"].to_numpy()
    )
    # A prior is a ratio of the quantity; dB/B = -dr/2r turns one of B into one of the bend r.
    y_per_ratio = -2.0 * max(float(np.median(y)), MIN_BEND) if quantity is B else 1.0
    priors = [quantity.slopes[term] for term in design.terms]
    prior_mean = y_per_ratio * np.array([prior.mean for prior in priors])
    prior_sd = abs(y_per_ratio) * np.array([prior.sd for prior in priors])
    of_slopes = design.slopes * prior_sd
    boat = known["fsn_no"].rank("dense").cast(pl.Int64).to_numpy()
    by_prior = design.slopes @ prior_mean
    model = BoatModel(
        y=y - by_prior,
        covariance=errors + of_slopes @ of_slopes.T,
        x=design.classes,
        boat=boat,
        error_dof=noise.dof,
        aimed_sd=abs(y_per_ratio) * difference_that_matters,
    )
    untold = np.flatnonzero(~design.is_told)
    slope_model = BoatModel(
        y=y - design.slopes[:, untold] @ prior_mean[untold],
        covariance=errors + of_slopes[:, untold] @ of_slopes[:, untold].T,
        x=np.column_stack([design.classes, design.slopes[:, design.is_told]]),
        boat=boat,
        error_dof=noise.dof,
    )
    fitted = TypeModel(
        quantity=quantity,
        difference_that_matters=difference_that_matters,
        tows=known,
        design=design,
        error_variance=np.diag(errors),
        by_prior=by_prior,
        model=model,
        slope_model=slope_model,
    )
    if quantity is B and fitted.mean < MIN_BEND:
        return "no_b"
    return fitted


def measure_noise(observed: pl.DataFrame, repeat_pairs: pl.DataFrame, quantity: Quantity) -> Noise:
    """Estimate the measuring errors of a quantity from the repeat tows of all types.

    The difference in ln Cw is that of `repeat_pairs`, in which a boat has no part in the correction
    of its own log.

    Args:
        observed: rows of `observe` under one method, with logarithms.
        repeat_pairs: rows of the table of that name under that method.
        quantity: what is compared.
    """
    known = observed.drop_nulls([quantity.y, quantity.variance])
    if quantity.only_valid:
        known = known.filter(~pl.col("beyond_curve"))
    values = known.select(
        "tow_id", y=quantity.y, variance=quantity.variance, zero_effect=quantity.zero_effect
    )
    values = values.filter(pl.col("variance") > 0.0)
    before = values.rename({name: f"{name}_before" for name in values.columns})
    pairs = repeat_pairs.join(values, on="tow_id", maintain_order="left").join(
        before, on="tow_id_before", maintain_order="left"
    )
    difference = pl.col("ln_ratio") if quantity is CW else pl.col("y") - pl.col("y_before")
    return estimate_noise(pairs.with_columns(difference=difference).sort("tow_id"))


def add_logarithms(tows: pl.DataFrame) -> pl.DataFrame:
    """Add ln Cw at the standard speed and ln A."""
    return tows.with_columns(
        ln_cw_standard=pl.col("cw_standard_kg_m").log(),
        ln_a=pl.when(pl.col("a_kg_m") > 0.0).then(pl.col("a_kg_m").log()),
    )


# Verdicts


def judge_spread(fitted: TypeModel) -> Row:
    """Return the spread between boats with its bounds, and whether they are equal."""
    ratio = abs(fitted.ratio_per_y)
    lower = ratio * fitted.model.lower_bound()
    upper = ratio * fitted.model.upper_bound()
    return {
        "spread_ratio": ratio * fitted.model.boat_sd,
        "spread_lo": lower,
        "spread_hi": upper if np.isfinite(upper) else None,
        "error_ratio": ratio * float(np.sqrt(fitted.error_variance.mean())),
        "verdict": name_spread(lower, upper, fitted.difference_that_matters),
    }


def name_spread(lower: float, upper: float, difference_that_matters: float) -> str:
    """Return `equal`, `differ` or `open` from the bounds of the spread between boats."""
    if upper < difference_that_matters:
        return "equal"
    return "differ" if lower > 0.0 else "open"


def judge_slope(slope: Interval, light_to_heavy: float, difference_that_matters: float) -> str:
    """Return `rises`, `falls`, `none` or `open`.

    Args:
        slope: relative change of the quantity per step, with its 95 % interval.
        light_to_heavy: steps between a light and a heavy boat, or a slow and a fast tow.
    """
    if slope.lo > 0.0:
        return "rises"
    if slope.hi < 0.0:
        return "falls"
    steepest = max(-slope.lo, slope.hi) * light_to_heavy
    return "none" if steepest < difference_that_matters else "open"


def describe_slopes(fitted: TypeModel) -> Row:
    """Return slope, interval and verdict for weight and tow speed; empty with a reason."""
    row: Row = {}
    for term, name in TERM_NAMES.items():
        design = fitted.design
        row[f"{name}_n"] = fitted.tows.height
        row[f"{name}_n_boats"] = fitted.tows["fsn_no"].n_unique()
        if term in design.reasons:
            row[f"{name}_verdict"] = design.reasons[term]
            continue
        (in_y,) = fitted.slope_model.predict(fitted.unit_row(term))
        lo, hi = sorted([fitted.ratio_per_y * in_y.lo, fitted.ratio_per_y * in_y.hi])
        slope = Interval(fitted.ratio_per_y * in_y.value, lo, hi)
        apart = SDS_LIGHT_TO_HEAVY * design.sd[term] / TERMS[term]
        row |= {
            f"{name}_slope": slope.value,
            f"{name}_slope_lo": slope.lo,
            f"{name}_slope_hi": slope.hi,
            f"{name}_verdict": judge_slope(slope, apart, fitted.difference_that_matters),
        }
    if WEIGHT not in fitted.design.reasons:
        row["weight_r2"] = explain_by_weight(fitted)
    return row


def explain_by_weight(fitted: TypeModel) -> float | None:
    """Return R2 of the straight line on weight within the classes, every tow counting alike.

    It is what the presentation of 2015 showed. No verdict rests on it: a line through few points
    can explain much of their spread by chance.
    """
    classes = fitted.tows["crew_class"].to_numpy()
    y = fitted.tows[fitted.quantity.y].to_numpy().copy()
    for crew_class in np.unique(classes):
        y[classes == crew_class] -= y[classes == crew_class].mean()
    weight = fitted.design.within[WEIGHT]
    squares = float(y @ y) * float(weight @ weight)
    return float(y @ weight) ** 2 / squares if squares > 0.0 else None


def compare_classes(fitted: TypeModel) -> Row:
    """Return the quantity of women's crews (D) / that of men's (H), at one weight of the boat."""
    men = (fitted.tows["crew_class"] == "H").to_numpy()
    women = (fitted.tows["crew_class"] == "D").to_numpy()
    counts: Row = {"n_men": int(men.sum()), "n_women": int(women.sum())}
    if not men.any() or not women.any():
        return counts
    classes = fitted.design.classes
    contrast = classes[women].mean(axis=0) - classes[men].mean(axis=0)
    (in_y,) = fitted.model.predict(contrast[None, :])
    ln_lo, ln_hi = sorted([fitted.ratio_per_y * in_y.lo, fitted.ratio_per_y * in_y.hi])
    women_ratio, lo, hi = np.exp([fitted.ratio_per_y * in_y.value, ln_lo, ln_hi]).tolist()
    return counts | {"women_ratio": women_ratio, "women_ratio_lo": lo, "women_ratio_hi": hi}


def compare_with_hull_speed(tows: pl.DataFrame) -> Row:
    """Return B / hull speed: the median of the boats, with its 95 % interval.

    Args:
        tows: rows of `observe` of one type, one per boat and crew.
    """
    with_b = tows.select("fsn_no", ratio=pl.col("b_m_s") / pl.col("hull_speed_m_s")).drop_nulls()
    boats = with_b.group_by("fsn_no", maintain_order=True).agg(pl.col("ratio").median())
    median = estimate_median(boats["ratio"].to_numpy())
    if median is None:
        return {}
    return {"hull_ratio": median.value, "hull_ratio_lo": median.lo, "hull_ratio_hi": median.hi}


def find_deviations(fitted: TypeModel) -> pl.DataFrame:
    """Compare each tow with what the other boats predict for its class, weight and tow speed.

    A boat stands out if its deviation is beyond Student's t at `OUTSIDE_CHANCE` over all tows.

    Returns:
        `method`, `tow_id`, `fsn_no`, `quantity`, `expected`, `ratio` (quantity / expected) with
        `ratio_lo` and `ratio_hi` (95 %), `deviation_sd` and `outside`; no rows of boats that the
        others do not determine.
    """
    outside_quantile = 1.0 - 0.5 * OUTSIDE_CHANCE / fitted.tows.height
    rows = []
    for left_out in fitted.model.leave_boats_out():
        limit = float(scipy.special.stdtrit(left_out.dof, outside_quantile))
        half = float(t_quantile(left_out.dof)) * left_out.sd * abs(fitted.ratio_per_y)
        expected = fitted.to_quantity(left_out.expected + fitted.by_prior[left_out.rows])
        ln_ratio = fitted.ratio_per_y * (fitted.model.y[left_out.rows] - left_out.expected)
        # A boat whose bend is larger than expected has a smaller B.
        deviation = left_out.deviation_sd * np.sign(fitted.ratio_per_y)
        for i, place in enumerate(left_out.rows.tolist()):
            tow = fitted.tows.row(place, named=True)
            rows.append(
                {
                    "method": tow["method"],
                    "tow_id": tow["tow_id"],
                    "fsn_no": tow["fsn_no"],
                    "quantity": fitted.quantity.name,
                    "expected": float(expected[i]) if np.isfinite(expected[i]) else None,
                    "ratio": float(np.exp(ln_ratio[i])),
                    "ratio_lo": float(np.exp(ln_ratio[i] - half[i])),
                    "ratio_hi": float(np.exp(ln_ratio[i] + half[i])),
                    "deviation_sd": float(deviation[i]),
                    "outside": bool(abs(deviation[i]) > limit),
                }
            )
    return pl.DataFrame(rows, schema=DEVIATIONS)


DEVIATIONS: Final = {
    "method": pl.String,
    "tow_id": pl.String,
    "fsn_no": pl.String,
    "quantity": pl.String,
    "expected": pl.Float64,
    "ratio": pl.Float64,
    "ratio_lo": pl.Float64,
    "ratio_hi": pl.Float64,
    "deviation_sd": pl.Float64,
    "outside": pl.Boolean,
}


def find_farthest(deviations: pl.DataFrame) -> Row:
    """Return the boat farthest from what the others predict, in standard deviations."""
    # Two boats that only have each other to compare with deviate alike to the last bit.
    size = pl.col("deviation_sd").abs().round(6)
    farthest = deviations.sort(size, "tow_id").tail(1)
    if farthest.is_empty():
        return {}
    row = farthest.row(0, named=True)
    return {
        "farthest": row["fsn_no"],
        "farthest_ratio": row["ratio"],
        "farthest_ratio_lo": row["ratio_lo"],
        "farthest_ratio_hi": row["ratio_hi"],
    }


def draw_lines(fitted: TypeModel) -> Iterator[Row]:
    """Yield the lines on weight and tow speed, per class, the other term at the class's mean.

    A class of under `MIN_BOATS` boats has no line.
    """
    design = fitted.design
    classes = fitted.tows["crew_class"].to_numpy()
    columns = fitted.slope_model.x
    by_untold = fitted.tows[fitted.quantity.y].to_numpy() - fitted.slope_model.y
    for term in design.terms:
        if term in design.reasons:
            continue
        for crew_class in np.unique(classes):
            own: BoolArray = classes == crew_class
            if fitted.tows.filter(crew_class=str(crew_class))["fsn_no"].n_unique() < MIN_BOATS:
                continue
            x = design.values[term][own]
            places = np.unique(np.linspace(x.min(), x.max(), LINE_PLACES))
            steps = (places - x.mean()) / TERMS[term]
            rows = columns[own].mean(axis=0) + steps[:, None] * fitted.unit_row(term)
            for place, in_y in zip(places, fitted.slope_model.predict(rows), strict=True):
                y_there = np.array(in_y) + by_untold[own].mean()
                y, one, other = fitted.to_quantity(y_there).tolist()
                if not np.isfinite([y, one, other]).all():
                    continue  # no B there
                yield {
                    "method": fitted.tows["method"][0],
                    "boat_type": fitted.tows["boat_type"][0],
                    "quantity": fitted.quantity.name,
                    "explaining": term,
                    "crew_class": str(crew_class),
                    "x": float(place),
                    "y": y,
                    "lo": min(one, other),
                    "hi": max(one, other),
                }


class TypeResults(NamedTuple):
    """What the models of all types say.

    Attributes:
        consistency: rows of the table `type_consistency`.
        lines: rows of the table `type_line_points`.
        deviations: rows of `find_deviations`.
    """

    consistency: pl.DataFrame
    lines: pl.DataFrame
    deviations: pl.DataFrame


def compare_types(
    observed: pl.DataFrame,
    repeat_pairs: pl.DataFrame,
    differences_that_matter: Mapping[str, float] = DIFFERENCES_THAT_MATTER,
) -> TypeResults:
    """Fit and judge every quantity of every type under every method.

    Args:
        observed: rows of `observe`; of each boat and crew only the newest tow is compared.
        repeat_pairs: rows of the table of that name.
        differences_that_matter: as in `DIFFERENCES_THAT_MATTER`, by quantity.
    """
    verdicts: list[Row] = []
    lines: list[Row] = []
    deviations = [pl.DataFrame(schema=DEVIATIONS)]
    known = add_logarithms(observed).sort("method", "boat_type", "tow_id")
    for (method,), of_method in known.group_by("method", maintain_order=True):
        pairs = repeat_pairs.filter(method=method)
        for quantity in QUANTITIES:
            noise = measure_noise(of_method, pairs, quantity)
            matters = differences_that_matter[quantity.name]
            newest = of_method.filter("newest")
            for (boat_type,), tows in newest.group_by("boat_type", maintain_order=True):
                row: Row = {
                    "method": method,
                    "boat_type": boat_type,
                    "quantity": quantity.name,
                    "standard_speed_m_s": tows["standard_speed_m_s"][0],
                    "n": tows.height,
                    "n_boats": tows["fsn_no"].n_unique(),
                    "difference_that_matters": matters,
                    "repeat_pairs": noise.n_pairs,
                    "noise_ratio": float(np.sqrt(noise.variance_ratio)),
                    "zero_sd_n": noise.zero_sd_n,
                    "season_sd": noise.season_sd,
                    "outside": [],
                }
                fitted = fit_type(tows, quantity, noise, matters)
                if isinstance(fitted, str):
                    verdicts.append(row | dict.fromkeys(VERDICTS, fitted))
                    continue
                own_deviations = find_deviations(fitted)
                outside = own_deviations.filter("outside")["fsn_no"].unique().sort()
                explained = fitted
                if len(outside):
                    rest = tows.filter(~pl.col("fsn_no").is_in(outside.implode()))
                    refitted = fit_type(rest, quantity, noise, matters)
                    explained = fitted if isinstance(refitted, str) else refitted
                row |= {
                    "n": fitted.tows.height,
                    "n_boats": fitted.tows["fsn_no"].n_unique(),
                    "mean": float(fitted.to_quantity(fitted.mean)),
                    "outside": outside.to_list(),
                    "rest_verdict": judge_spread(explained)["verdict"],
                }
                row |= judge_spread(fitted) | find_farthest(own_deviations)
                row |= compare_classes(explained) | describe_slopes(explained)
                if quantity is B:
                    row |= compare_with_hull_speed(fitted.tows)
                verdicts.append(row)
                lines.extend(draw_lines(explained))
                deviations.append(own_deviations)
    return TypeResults(
        consistency=make_frame(TypeConsistency, verdicts),
        lines=make_frame(TypeLinePoints, lines),
        deviations=pl.concat(deviations),
    )
