"""Are equal boats equal: statistics per boat type and of repeat tows."""

from pipeline.tables import column
from pipeline.tables.bases import PerCrewTow, PerMethod
from pipeline.tables.declare import dy


class TypeLines(PerMethod):
    """How a quantity follows weight, length or tow speed within a type."""

    tows = column.text("all, or newest (of each boat and crew)", primary_key=True)
    boat_type = column.text("type of boat; unknown: no claims", primary_key=True)
    quantity = column.text("b_m_s, a_kg_m, cw_standard_kg_m or ln_cw_standard", primary_key=True)
    explaining = column.text(
        "weight_kg, declared_speed_m_s, waterline_length_m or ln_displacement", primary_key=True
    )
    within = column.text("men or women against tow speed; else all", primary_key=True)
    standard_speed_m_s = column.speed("common speed: median declared speed of the type's tows")
    n = column.count("tows")
    n_boats = column.count("boats")
    slope = column.optional("quantity / explaining", "slope of the line")
    slope_lo = column.lower("quantity / explaining")
    slope_hi = column.upper("quantity / explaining")
    r2 = column.optional("1", "1 - squares about line / about crews' means", min=0, max=1)
    residual_sd_ratio = column.optional("1", "spread about the line / mean; of ln Cw itself", min=0)
    reason = column.text("why none: no_type, few_boats, equal_values, not_settled; else empty")


class TypeLinePoints(PerMethod):
    """A line of `type_lines` with its 95 % interval, for drawing."""

    tows = column.text("all, or newest", primary_key=True)
    boat_type = column.text("type of boat", primary_key=True)
    quantity = column.text("as in `type_lines`", primary_key=True)
    explaining = column.text("as in `type_lines`", primary_key=True)
    crew_class = column.text(
        "class that the line is of, H or D; of displacement all", primary_key=True
    )
    x = column.number("as explaining", "place on the line", primary_key=True)
    y = column.number("as quantity", "the line there")
    lo = column.number("as quantity", "lower end of its 95 % interval")
    hi = column.number("as quantity", "upper end")


class ComparedTows(PerCrewTow):
    """Every tow next to the others of its type: A, B and Cw at one speed, hull speed, outliers."""

    boat_type = column.text("type of boat, or unknown")
    season = column.season()
    newest = column.flag("the newest tow of its boat and crew")
    slow = column.flag("towed with too little power: men under 60 W, women under 34 W")
    weight_kg = column.optional("kg", "empty boat with oars")
    displacement_kg = column.optional("kg", "boat and crew")
    waterline_length_m = column.number("m", "length on the waterline that day")
    declared_speed_m_s = column.speed("speed v0 the crew declared")
    power_w = column.optional("W", "power per rower at that speed")
    hull_speed_m_s = column.speed(
        "1.25 sqrt(waterline length); also 'B from length' of the tool of 2014"
    )
    tow_hull_ratio = column.number("1", "declared speed / hull speed")
    speed_case = column.text(
        "low (under 0.67 of hull speed), middle or high (from 0.80)", regex="^(low|middle|high)$"
    )
    b_hull_ratio = column.optional("1", "B / hull speed; empty without B")
    a_kg_m = column.number("kg/m", "A")
    a_lo_kg_m = column.optional("kg/m", "lower end of its 95 % interval, by the runs")
    a_hi_kg_m = column.upper("kg/m")
    b_m_s = column.optional("m/s", "B; empty where it is not determined")
    b_lo_m_s = column.lower("m/s")
    b_hi_m_s = column.optional("m/s", "upper end; empty: no upper bound")
    standard_speed_m_s = column.speed("common speed: median declared speed of the type's tows")
    cw_standard_kg_m = column.optional("kg/m", "Cw at that speed; empty from B on", min_exclusive=0)
    cw_standard_lo_kg_m = column.lower("kg/m")
    cw_standard_hi_kg_m = column.upper("kg/m")
    beyond_curve = column.flag("that speed lies outside 85-115 % of the declared speed")
    deviation_sd = column.optional("1", "difference of ln Cw / standard deviation of a prediction")
    outside = column.flag("differs at 5 % over all tows of the type", nullable=True)
    candidates = column.texts("codes of what could explain a difference", nullable=True)


class HullSpeed(PerMethod):
    """Is B hull speed, and at what part of hull speed are boats towed? Medians over boats."""

    boat_type = column.text("type of boat, or all", primary_key=True)
    n = column.count("tows")
    n_boats = column.count("boats")
    tow_ratio = column.number("1", "declared speed / hull speed, median of tows")
    tow_share_60_70 = column.number("1", "share of tows at 60-70 % of hull speed")
    b_ratio = column.optional("1", "B / hull speed, median of boats")
    b_ratio_lo = column.lower("1")
    b_ratio_hi = column.upper("1")
    b_share_within_5pct = column.optional("1", "share of B within 5 % of hull speed")
    b_is_hull_speed = column.flag("the interval of the median holds 1", nullable=True)


class TypeOutliers(PerCrewTow):
    """Every boat and crew against the other boats of its type."""

    boat_type = column.text("type of boat")
    season = column.season()
    quantity = column.text("ln_cw_standard, or bend: (v/B)^2 there", primary_key=True)
    standard_speed_m_s = column.speed("common speed: median declared speed of the type")
    value = column.number("1", "quantity of this tow, at the standard speed")
    expected = column.number("1", "the same as the type's other boats predict it")
    deviation_sd = column.number("1", "difference in standard deviations of a prediction")
    outside = column.flag("differs at 5 % over all boats of the type together")
    candidates = column.texts("codes of what could explain a difference")


class TypeHomogeneity(PerMethod):
    """Equal boats, equal B? An F test per method and type, and what noise alone gives."""

    boat_type = column.text("type of boat; unknown: no claims", primary_key=True)
    n = column.count("tows: the newest of each boat and crew")
    n_boats = column.count("boats")
    p_value = column.optional("1", "chance of such an F with one bend", min=0, max=1)
    power_at_10pct = column.optional("1", "chance to see a true spread of B of 10 %")
    noise_share = column.optional("1", "share of the bends' spread that noise gives")
    equal_possible = column.flag(
        "all may have one bend; empty where the test is too weak to say", nullable=True
    )
    shared_b_m_s = column.optional("m/s", "B of the one bend; empty without")
    reason = column.text("why there is no test: no_type, few_boats, no_scatter; else empty")


class PooledCurves(PerCrewTow):
    """The register if boats of a type kept their bend (own), shared it in part, or wholly."""

    boat_type = column.text("type of boat, or unknown")
    pooling = column.text(
        "own, partial or shared", primary_key=True, regex="^(own|partial|shared)$"
    )
    standard_speed_m_s = column.speed("common speed of q")
    q = column.optional("1", "bend at the standard speed")
    a_kg_m = column.optional("kg/m", "A")
    b_m_s = column.optional("m/s", "B; empty where it is not determined")
    cw_085_kg_m = column.optional("kg/m", "Cw at 85 % of the declared speed")
    cw_kg_m = column.optional("kg/m", "Cw at the declared speed")
    cw_115_kg_m = column.optional("kg/m", "Cw at 115 % of the declared speed")


class SpeedTrend(PerMethod):
    """Does the bend follow the speed of the tow? If the hyperbola is true, it does not."""

    boat_type = column.text(
        "type of boat, or all types; each class of a type about its own level", primary_key=True
    )
    n = column.count("tows: the newest of each boat and crew")
    n_boats = column.count("boats")
    slope = column.optional("1", "change of q at the standard speed per ln of tow speed")
    slope_lo = column.lower("1")
    slope_hi = column.upper("1")
    reason = column.text("why there is no trend: few_boats, equal_values, not_settled; else empty")


class SlowTows(PerCrewTow):
    """Tows made with little power or raced beyond their curve, and race power by their curve.

    Each power ratio is that by the tow's own curve / by the same runs with the bend of its type.
    """

    boat_type = column.text("type of boat, or unknown")
    declared_speed_m_s = column.speed("speed v0 the crew declared")
    season = column.season()
    power_w = column.optional("W", "power per rower at the declared speed")
    slow = column.flag("under 60 W (women 34 W); else under 70 W, or raced off its curve")
    tow_hull_ratio = column.number("1", "declared speed / hull speed")
    speed_case = column.text("low (under 0.67 of hull speed), middle or high (from 0.80)")
    races = dy.Int32(description="races until its next tow; empty: none", nullable=True)
    raced_speed_m_s = column.speed("fastest of them, through the water", nullable=True)
    raced_power_w = column.optional("W", "power per rower there by its own curve")
    raced_high = column.flag("over 100 W (women 57 W)", nullable=True)
    power_ratio_raced = column.optional("1", "power ratio at the raced speed")


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
    e_n = column.optional("1", "difference / both intervals (ISO 13528)")


class EraShifts(PerMethod):
    """Do seasons with other instruments stand apart? Next tow of the same boat, in a later era."""

    boat_type = column.text("type of boat, or all", primary_key=True)
    era = column.text("seasons of the older tow", primary_key=True)
    n = column.count("pairs of tows")
    shift_ratio = column.optional("1", "new / old Cw without ageing, median", min=0)
    lo = column.lower("1", min=0)
    hi = column.upper("1", min=0)
    apart = column.flag("the interval leaves out 1", nullable=True)
    ageing_per_year = column.optional("1", "change of ln Cw a year taken out; empty: none")
    reason = column.text("why there is no shift: few_pairs; else empty")


class Reproducibility(PerMethod):
    """How well repeat tows of unaltered boats agree."""

    scope = column.text("all pairs, or an era", primary_key=True)
    n_pairs = column.count("pairs of consecutive tows of one boat and crew")
    n_tows = column.count("tows behind within_sd_ratio")
    sd_ratio = column.optional("1", "standard deviation of one tow, s_R", min=0)
    lo = column.lower("1", min=0)
    hi = column.upper("1", min=0)
    share_within_1pct = column.optional("1", "share of pairs that differ under 1 %")
    share_within_2pct = column.optional("1", "the same for 2 %")
    within_sd_ratio = column.optional("1", "s_r: by the scatter of a tow's runs alone", min=0)


class VarianceComponents(PerMethod):
    """Spread of Cw by cause, from a mixed model over all tows (REML)."""

    scope = column.text("fleet, or within_type", primary_key=True)
    component = column.text("boat, season, boat_season or run", primary_key=True)
    n = column.count("tows")
    n_boats = column.count("boats and crews between two alterations")
    sd_ratio = column.optional("1", "standard deviation of Cw by this cause", min=0)
    lo = column.lower("1", min=0)
    hi = column.optional("1", "upper end; empty: no bound", min=0)
    share = column.optional("1", "share of the variance of a tow's Cw", min=0, max=1)
    reason = column.text("why there are no numbers: too_few_repeats, not_settled; else empty")


class PredictedCw(PerCrewTow):
    """A second opinion without towing: Cw from weight, length, beam and type."""

    boat_type = column.text("type of boat, or unknown")
    standard_speed_m_s = column.speed("median declared speed of type and crew class")
    cw_kg_m = column.number("kg/m", "Cw of the tow at that speed")
    cw_sd_ratio = column.number(
        "1", "its standard uncertainty: of the runs, or of its interval if wider", min=0
    )
    predicted_cw_kg_m = column.optional("kg/m", "Cw as the other boats predict it")
    predicted_lo_kg_m = column.lower("kg/m")
    predicted_hi_kg_m = column.upper("kg/m")
    ln_ratio = column.optional("1", "ln of the tow's Cw / the predicted")
    disagrees = column.flag("differs by more than both uncertainties", nullable=True)
    reason = column.text("why there is no prediction: few_boats, not_settled; else empty")


class PredictionError(PerMethod):
    """Cross-validated error of the prediction, boats left out one by one."""

    n = column.count("boats and crews predicted")
    n_boats = column.count("boats")
    rmse_ratio = column.number("1", "root mean square of ln tow / predicted", min=0)
    tow_sd_ratio = column.number("1", "of which uncertainty of the tow itself", min=0)
