"""Are equal boats equal: statistics per boat type and of repeat tows."""

from pipeline.tables import column
from pipeline.tables.bases import PerCrewTow, PerMethod
from pipeline.tables.declare import dy


class TypeLines(PerMethod):
    """How a quantity follows weight, length or tow speed within a type."""

    tows = column.text("all, or newest (of each boat and crew)", primary_key=True)
    boat_type = column.text(
        "type of boat; unknown: boats without type, no claims", primary_key=True
    )
    quantity = column.text("b_m_s, a_kg_m, cw_standard_kg_m or ln_cw_standard", primary_key=True)
    explaining = column.text(
        "weight_kg, declared_speed_m_s, waterline_length_m or ln_displacement", primary_key=True
    )
    within = column.text("all, or against tow speed also men, women", primary_key=True)
    standard_speed_m_s = column.speed(
        "common speed of cw_standard: median declared speed of the type's tows"
    )
    n = dy.Int32(description="tows", min=0)
    n_boats = dy.Int32(description="boats", min=0)
    slope = column.number("quantity / explaining", "slope of the line", nullable=True)
    slope_lo = column.number(
        "quantity / explaining", "lower end of its 95 % interval", nullable=True
    )
    slope_hi = column.number("quantity / explaining", "upper end", nullable=True)
    r2 = column.number(
        "1", "1 - squares about line / about crews' means", nullable=True, min=0, max=1
    )
    residual_sd_ratio = column.number(
        "1", "spread about the line / mean; of ln Cw itself", nullable=True, min=0
    )
    reason = column.text(
        "why there is no line: no_type, few_boats, equal_values, not_settled; else empty"
    )


class TypeLinePoints(PerMethod):
    """A line of `type_lines` with its 95 % interval, for drawing."""

    tows = column.text("all, or newest", primary_key=True)
    boat_type = column.text("type of boat", primary_key=True)
    quantity = column.text("as in `type_lines`", primary_key=True)
    explaining = column.text("as in `type_lines`", primary_key=True)
    crew_class = column.text(
        "H or D where boats are compared within a crew, or all", primary_key=True
    )
    x = column.number("as explaining", "place on the line", primary_key=True)
    y = column.number("as quantity", "the line there")
    lo = column.number("as quantity", "lower end of its 95 % interval")
    hi = column.number("as quantity", "upper end")


class ComparedTows(PerCrewTow):
    """Every tow next to the others of its type: A, B and Cw at one speed, hull speed, outliers."""

    boat_type = column.text("type of boat, or unknown")
    season = column.season()
    newest = dy.Bool(description="the newest tow of its boat and crew")
    slow = dy.Bool(description="towed with too little power: men under 60 W, women under 34 W")
    weight_kg = column.number("kg", "empty boat with oars", nullable=True)
    displacement_kg = column.number("kg", "boat and crew", nullable=True)
    waterline_length_m = column.number("m", "length on the waterline that day")
    declared_speed_m_s = column.speed("speed v0 the crew declared")
    power_w = column.number("W", "power per rower at that speed", nullable=True)
    hull_speed_m_s = column.speed(
        "1.25 sqrt(waterline length); also 'B from length' of the tool of 2014"
    )
    tow_hull_ratio = column.number("1", "declared speed / hull speed")
    speed_case = column.text(
        "low (under 0.67 of hull speed), middle or high (from 0.80)", regex="^(low|middle|high)$"
    )
    b_hull_ratio = column.number("1", "B / hull speed; empty without B", nullable=True)
    a_kg_m = column.number("kg/m", "A")
    a_lo_kg_m = column.number("kg/m", "lower end of its 95 % interval, by the runs", nullable=True)
    a_hi_kg_m = column.number("kg/m", "upper end", nullable=True)
    b_m_s = column.number("m/s", "B; empty where it is not determined", nullable=True)
    b_lo_m_s = column.number("m/s", "lower end of its 95 % interval", nullable=True)
    b_hi_m_s = column.number("m/s", "upper end; empty: no upper bound", nullable=True)
    standard_speed_m_s = column.speed("common speed: median declared speed of the type's tows")
    cw_standard_kg_m = column.number(
        "kg/m", "Cw at that speed; empty from B on", nullable=True, min_exclusive=0
    )
    cw_standard_lo_kg_m = column.number("kg/m", "lower end of its 95 % interval", nullable=True)
    cw_standard_hi_kg_m = column.number("kg/m", "upper end", nullable=True)
    beyond_curve = dy.Bool(description="that speed lies outside 85-115 % of the declared speed")
    deviation_sd = column.number(
        "1", "difference of ln Cw in standard deviations of a prediction", nullable=True
    )
    outside = dy.Bool(description="differs at 5 % over all tows of the type", nullable=True)
    candidates = column.texts(description="codes of what could explain a difference", nullable=True)


class HullSpeed(PerMethod):
    """Is B hull speed, and at what part of hull speed are boats towed? Medians over boats."""

    boat_type = column.text("type of boat, or all", primary_key=True)
    n = dy.Int32(description="tows", min=0)
    n_boats = dy.Int32(description="boats", min=0)
    tow_ratio = column.number("1", "declared speed / hull speed, median of tows")
    tow_share_60_70 = column.number("1", "share of tows at 60-70 % of hull speed")
    b_ratio = column.number("1", "B / hull speed, median of boats", nullable=True)
    b_ratio_lo = column.number("1", "lower end of its 95 % interval", nullable=True)
    b_ratio_hi = column.number("1", "upper end", nullable=True)
    b_share_within_5pct = column.number("1", "share of B within 5 % of hull speed", nullable=True)
    b_is_hull_speed = dy.Bool(description="the interval of the median holds 1", nullable=True)


class TypeOutliers(PerCrewTow):
    """Every boat and crew against the other boats of its type."""

    boat_type = column.text("type of boat")
    season = column.season()
    quantity = column.text("ln_cw_standard, or bend: (v/B)^2 there", primary_key=True)
    standard_speed_m_s = column.speed("common speed: median declared speed of the type")
    value = column.number("1", "quantity of this tow, at the standard speed")
    expected = column.number("1", "the same as the type's other boats predict it")
    deviation_sd = column.number("1", "difference in standard deviations of a prediction")
    outside = dy.Bool(description="differs at 5 % over all boats of the type together")
    candidates = column.texts(description="codes of what could explain a difference")


class TypeHomogeneity(PerMethod):
    """Equal boats, equal B? An F test per method and type, and what noise alone gives."""

    boat_type = column.text(
        "type of boat; unknown: boats without type, no claims", primary_key=True
    )
    n = dy.Int32(description="tows: the newest of each boat and crew", min=0)
    n_boats = dy.Int32(description="boats", min=0)
    p_value = column.number("1", "chance of such an F with one bend", nullable=True, min=0, max=1)
    power_at_10pct = column.number("1", "chance to see a true spread of B of 10 %", nullable=True)
    noise_share = column.number("1", "share of the bends' spread that noise gives", nullable=True)
    equal_possible = dy.Bool(
        nullable=True, description="all may have one bend; empty where the test is too weak to say"
    )
    shared_b_m_s = column.number("m/s", "B of the one bend; empty without", nullable=True)
    reason = column.text("why there is no test: no_type, few_boats, no_scatter; else empty")


class SpeedTrend(PerMethod):
    """Does the bend follow the speed of the tow? If the hyperbola is true, it does not."""

    boat_type = column.text(
        "type of boat, or all: all types, each about its level", primary_key=True
    )
    n = dy.Int32(description="tows: the newest of each boat and crew", min=0)
    n_boats = dy.Int32(description="boats", min=0)
    slope = column.number(
        "1", "change of q at the standard speed per ln of tow speed", nullable=True
    )
    slope_lo = column.number("1", "lower end of its 95 % interval", nullable=True)
    slope_hi = column.number("1", "upper end", nullable=True)
    reason = column.text("why there is no trend: few_boats, equal_values, not_settled; else empty")


class SlowTows(PerCrewTow):
    """Tows made with little power or raced beyond their curve, and race power by their curve.

    Each power ratio is that by the tow's own curve / by the same runs with the bend of its type.
    """

    boat_type = column.text("type of boat, or unknown")
    declared_speed_m_s = column.speed("speed v0 the crew declared")
    season = column.season()
    power_w = column.number("W", "power per rower at the declared speed", nullable=True)
    slow = dy.Bool(description="under 60 W (women 34 W); else under 70 W, or raced off its curve")
    tow_hull_ratio = column.number("1", "declared speed / hull speed")
    speed_case = column.text("low (under 0.67 of hull speed), middle or high (from 0.80)")
    races = dy.Int32(description="races until its next tow; empty: none", nullable=True)
    raced_speed_m_s = column.speed("fastest of them, through the water", nullable=True)
    raced_power_w = column.number("W", "power per rower there by its own curve", nullable=True)
    raced_high = dy.Bool(description="over 100 W (women 57 W)", nullable=True)
    power_ratio_raced = column.number("1", "power ratio at the raced speed", nullable=True)


class RepeatPairs(PerMethod):
    """Consecutive tows of one boat and crew without an alteration between them."""

    fsn_no = column.fsn_no()
    rowers = column.rowers()
    crew_class = column.crew_class()
    tow_id = column.tow_id(primary_key=True)
    tow_id_before = column.tow_id()
    season = column.season()
    season_before = column.season()
    cw_ratio = column.number("1", "new / old Cw, at the old declared speed")
    ln_ratio = column.number("1", "ln of that")
    e_n = column.number("1", "difference / both intervals (ISO 13528)", nullable=True)


class EraShifts(PerMethod):
    """Do seasons with other instruments stand apart? Next tow of the same boat, in a later era."""

    boat_type = column.text("type of boat, or all", primary_key=True)
    era = column.text("seasons of the older tow", primary_key=True)
    n = dy.Int32(description="pairs of tows", min=0)
    shift_ratio = column.number("1", "new / old Cw without ageing, median", nullable=True, min=0)
    lo = column.number("1", "lower end of its 95 % interval", nullable=True, min=0)
    hi = column.number("1", "upper end", nullable=True, min=0)
    apart = dy.Bool(description="the interval leaves out 1", nullable=True)
    ageing_per_year = column.number(
        "1", "change of ln Cw a year taken out; empty: none", nullable=True
    )
    reason = column.text("why there is no shift: few_pairs; else empty")


class Reproducibility(PerMethod):
    """How well repeat tows of unaltered boats agree."""

    scope = column.text("all pairs, or an era", primary_key=True)
    n_pairs = dy.Int32(description="pairs of consecutive tows of one boat and crew", min=0)
    n_tows = dy.Int32(description="tows behind within_sd_ratio", min=0)
    sd_ratio = column.number("1", "standard deviation of one tow, s_R", nullable=True, min=0)
    lo = column.number("1", "lower end of its 95 % interval", nullable=True, min=0)
    hi = column.number("1", "upper end", nullable=True, min=0)
    share_within_1pct = column.number("1", "share of pairs that differ under 1 %", nullable=True)
    share_within_2pct = column.number("1", "the same for 2 %", nullable=True)
    within_sd_ratio = column.number(
        "1", "s_r: what the scatter of its runs does to a tow's Cw", nullable=True, min=0
    )


class VarianceComponents(PerMethod):
    """Spread of Cw by cause, from a mixed model over all tows (REML)."""

    scope = column.text("fleet, or within_type", primary_key=True)
    component = column.text("boat, season, boat_season or run", primary_key=True)
    n = dy.Int32(description="tows", min=0)
    n_boats = dy.Int32(description="boats and crews between two alterations", min=0)
    sd_ratio = column.number("1", "standard deviation of Cw by this cause", nullable=True, min=0)
    lo = column.number("1", "lower end of its 95 % interval", nullable=True, min=0)
    hi = column.number("1", "upper end; empty: no bound", nullable=True, min=0)
    share = column.number("1", "share of the variance of a tow's Cw", nullable=True, min=0, max=1)
    reason = column.text("why there are no numbers: too_few_repeats, not_settled; else empty")


class PredictedCw(PerCrewTow):
    """A second opinion without towing: Cw from weight, length, beam and type."""

    boat_type = column.text("type of boat, or unknown")
    standard_speed_m_s = column.speed("median declared speed of type and crew class")
    cw_kg_m = column.number("kg/m", "Cw of the tow at that speed")
    cw_sd_ratio = column.number(
        "1", "its standard uncertainty: of the runs, or of its interval if wider", min=0
    )
    predicted_cw_kg_m = column.number("kg/m", "Cw as the other boats predict it", nullable=True)
    predicted_lo_kg_m = column.number("kg/m", "lower end of its 95 % interval", nullable=True)
    predicted_hi_kg_m = column.number("kg/m", "upper end", nullable=True)
    ln_ratio = column.number("1", "ln of the tow's Cw / the predicted", nullable=True)
    disagrees = dy.Bool(description="differs by more than both uncertainties", nullable=True)
    reason = column.text("why there is no prediction: few_boats, not_settled; else empty")
