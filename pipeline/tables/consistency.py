"""Are equal boats equal: statistics per boat type and of repeat tows."""

from pipeline.tables import column
from pipeline.tables.bases import PerCrewTow, PerMethod
from pipeline.tables.declare import dy


class TypeConsistency(PerMethod):
    """Are boats of a type equal? One model per type and quantity: class, weight, tow speed, boat.

    By the newest tow of each boat and crew; ratios are of the quantity.
    """

    boat_type = column.text("type of boat; unknown: no claims", primary_key=True)
    quantity = column.text(
        "cw_standard_kg_m, b_m_s or a_kg_m",
        primary_key=True,
        regex="^(cw_standard_kg_m|b_m_s|a_kg_m)$",
    )
    standard_speed_m_s = column.speed("common speed: median declared speed of the type's tows")
    n = column.count("tows compared: of Cw only those whose curve counts at that speed")
    n_boats = column.count("boats")
    n_men = column.count("tows of men's crews behind slopes and classes", nullable=True)
    n_women = column.count("tows of women's crews", nullable=True)
    mean = column.optional("mean of the type", unit="as quantity")
    verdict = column.text(
        "equal, differ or open; else why nothing is said: no_type, few_boats, no_scatter, no_b"
    )
    difference_that_matters = column.number(
        "spread between boats from which they are not equal; the federation sets it", min=0
    )
    spread_ratio = column.optional("true standard deviation between boats", min=0)
    spread_lo = column.optional("its 95 % lower bound", min=0)
    spread_hi = column.optional("its 95 % upper bound; empty: none", min=0)
    error_ratio = column.optional("standard deviation of the measuring error", min=0)
    repeat_pairs = column.count("pairs of repeat tows, of all types, that the error rests on")
    noise_ratio = column.number(
        "error by those pairs / by runs and intervals, where it is smaller", min=0, max=1
    )
    zero_sd_n = column.number(
        "what those pairs add to each tow, as a zero error of the load cell", min=0
    )
    season_sd = column.number("standard deviation of y that tows of a season share", min=0)
    rest_verdict = column.text("the verdict without the boats that stand out")
    outside = column.texts("boats that stand out, each against all others; slopes are without them")
    farthest = column.fsn_no(nullable=True)
    farthest_ratio = column.optional(
        "quantity of the boat farthest from what the others predict / as predicted", min=0
    )
    farthest_ratio_lo = column.lower(min=0)
    farthest_ratio_hi = column.upper(min=0)
    women_ratio = column.optional("women's crews / men's, at one weight of the boat", min=0)
    women_ratio_lo = column.lower(min=0)
    women_ratio_hi = column.upper(min=0)
    weight_n = column.count("tows behind the slope on weight", nullable=True)
    weight_n_boats = column.count("boats behind it", nullable=True)
    weight_verdict = column.text("rises, falls, none or open; else why there is no slope")
    weight_slope = column.optional("relative change for 100 kg more boat")
    weight_slope_lo = column.lower()
    weight_slope_hi = column.upper()
    weight_r2 = column.optional(
        "share of the spread within classes that a line on weight explains", min=0, max=1
    )
    tow_speed_n = column.count("tows behind the slope on tow speed", nullable=True)
    tow_speed_n_boats = column.count("boats behind it", nullable=True)
    tow_speed_verdict = column.text("as weight_verdict, for the speed of the tow within a class")
    tow_speed_slope = column.optional("relative change for a tow 0.1 m/s faster")
    tow_speed_slope_lo = column.lower()
    tow_speed_slope_hi = column.upper()
    hull_ratio = column.optional("B / hull speed, median of boats; of B alone", min=0)
    hull_ratio_lo = column.lower(min=0)
    hull_ratio_hi = column.upper(min=0)


class TypeLinePoints(PerMethod):
    """A slope of `type_consistency` as a line with its 95 % interval, for drawing."""

    boat_type = column.text("type of boat", primary_key=True)
    quantity = column.text("as in `type_consistency`", primary_key=True)
    explaining = column.text("weight_kg or declared_speed_m_s", primary_key=True)
    crew_class = column.crew_class(primary_key=True)
    x = column.number("place on the line", unit="as explaining", primary_key=True)
    y = column.number("the line there", unit="as quantity")
    lo = column.number("lower end of its 95 % interval", unit="as quantity")
    hi = column.number("upper end", unit="as quantity")


class ComparedTows(PerCrewTow):
    """Every tow next to the others of its type: A, B and Cw at one speed, hull speed, races."""

    boat_type = column.text("type of boat, or unknown")
    season = column.season()
    newest = column.flag("the newest tow of its boat and crew")
    slow = column.flag("towed with too little power: men under 60 W, women under 34 W")
    weight_kg = column.optional("empty boat with oars")
    displacement_kg = column.optional("boat and crew")
    waterline_length_m = column.number("length on the waterline that day")
    declared_speed_m_s = column.speed("speed v0 the crew declared")
    power_w = column.optional("power per rower at that speed")
    hull_speed_m_s = column.speed(
        "1.25 sqrt(waterline length); also 'B from length' of the tool of 2014"
    )
    tow_hull_ratio = column.number("declared speed / hull speed")
    speed_case = column.text(
        "low (under 0.67 of hull speed), middle or high (from 0.80)", regex="^(low|middle|high)$"
    )
    b_hull_ratio = column.optional("B / hull speed; empty without B")
    a_kg_m = column.number("A")
    a_lo_kg_m = column.optional("lower end of its 95 % interval, by the runs")
    a_hi_kg_m = column.upper()
    b_m_s = column.optional("B; empty where it is not determined")
    b_lo_m_s = column.lower()
    b_hi_m_s = column.optional("upper end; empty: no upper bound")
    standard_speed_m_s = column.speed("common speed: median declared speed of the type's tows")
    cw_standard_kg_m = column.optional("Cw at that speed; empty from B on", min_exclusive=0)
    cw_standard_lo_kg_m = column.lower()
    cw_standard_hi_kg_m = column.upper()
    beyond_curve = column.flag("that speed lies outside 85-115 % of the declared speed")
    cw_expected_kg_m = column.optional(
        "that Cw as the type's other boats predict it; of newest tows", min_exclusive=0
    )
    cw_deviation_sd = column.optional("difference of ln Cw in sd of the prediction")
    cw_outside = column.flag("stands out in Cw: 5 % over all boats of the type", nullable=True)
    b_expected_m_s = column.optional("B as the type's other boats predict it")
    b_deviation_sd = column.optional("difference in sd of the prediction, above 0: larger B")
    b_outside = column.flag("stands out in B", nullable=True)
    candidates = column.texts("codes of what could explain a difference", nullable=True)
    races = dy.Int32(description="races until its next tow; empty: none", nullable=True)
    raced_speed_m_s = column.speed("fastest of them, through the water", nullable=True)
    raced_beyond_curve = column.flag(
        "that speed lies outside 85-115 % of the declared speed", nullable=True
    )
    raced_power_w = column.optional("power per rower there by its own curve")
    raced_high = column.flag("over 100 W (women 57 W)", nullable=True)
    power_ratio_raced = column.optional(
        "power there by its own curve / by the same runs with the bend of its type"
    )


class RepeatPairs(PerMethod):
    """Consecutive tows of one boat and crew without an alteration between them."""

    fsn_no = column.fsn_no()
    rowers = column.rowers()
    crew_class = column.crew_class()
    tow_id = column.tow_id(primary_key=True)
    tow_id_before = column.tow_id()
    season = column.season()
    season_before = column.season()
    cw_ratio = column.number("new / old Cw, at the old declared speed")
    ln_ratio = column.number("ln of that")
    e_n = column.optional("difference / both intervals (ISO 13528)")


class EraShifts(PerMethod):
    """Do seasons with other instruments stand apart? Next tow of the same boat, in a later era."""

    boat_type = column.text("type of boat, or all", primary_key=True)
    era = column.text("seasons of the older tow", primary_key=True)
    n = column.count("pairs of tows")
    shift_ratio = column.optional("new / old Cw without ageing, median", min=0)
    lo = column.lower(min=0)
    hi = column.upper(min=0)
    apart = column.flag("the interval leaves out 1", nullable=True)
    ageing_per_year = column.optional("change of ln Cw a year taken out; empty: none")
    reason = column.text("why there is no shift: few_pairs; else empty")


class Reproducibility(PerMethod):
    """How well repeat tows of unaltered boats agree."""

    scope = column.text("all pairs, or an era", primary_key=True)
    n_pairs = column.count("pairs of consecutive tows of one boat and crew")
    n_tows = column.count("tows behind within_sd_ratio")
    sd_ratio = column.optional("standard deviation of one tow, s_R", min=0)
    lo = column.lower(min=0)
    hi = column.upper(min=0)
    share_within_1pct = column.optional("share of pairs that differ under 1 %")
    share_within_2pct = column.optional("the same for 2 %")
    within_sd_ratio = column.optional("s_r: by the scatter of a tow's runs alone", min=0)


class PredictedCw(PerCrewTow):
    """A second opinion without towing: Cw from weight, length, beam and type."""

    boat_type = column.text("type of boat, or unknown")
    standard_speed_m_s = column.speed("median declared speed of type and crew class")
    cw_kg_m = column.number("Cw of the tow at that speed")
    cw_sd_ratio = column.number(
        "its standard uncertainty: of the runs, or of its interval if wider", min=0
    )
    predicted_cw_kg_m = column.optional("Cw as the other boats predict it")
    predicted_lo_kg_m = column.lower()
    predicted_hi_kg_m = column.upper()
    ln_ratio = column.optional("ln of the tow's Cw / the predicted")
    disagrees = column.flag("differs by more than both uncertainties", nullable=True)
    reason = column.text("why there is no prediction: few_boats; else empty")
