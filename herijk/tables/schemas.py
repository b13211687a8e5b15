"""The tables of the warehouse, each declared once: names, dtypes, units, ranges and meaning.

Other programs rely on these names; a column may be added, none is renamed or dropped without a
line in the changelog. Units stand in the names (SI); ratios are ratios. What a number means
physically is explained in the module that computes it; how tables are stored is in
`warehouse.store.store`.
"""

from typing import Any, Final

import dataframely as dy
import polars as pl

STATUSES: Final = ("accepted", "flagged", "rejected")


def _text(description: str, **rules: Any) -> dy.String:
    return dy.String(description=description, **rules)


def _number(unit: str, description: str, **rules: Any) -> dy.Float64:
    return dy.Float64(description=description, metadata={"unit": unit}, **rules)


def _tow_id(**rules: Any) -> dy.String:
    return _text("tow, as named in the tow list", **rules)


def _fsn_no(**rules: Any) -> dy.String:
    return _text("boat: its number with the federation", **rules)


def _method(**rules: Any) -> dy.String:
    return _text("name of the method that made the row", **rules)


def _season() -> dy.Int32:
    return dy.Int32(description="year of the tow list", min=1990, max=2100)


def _rowers(**rules: Any) -> dy.Int32:
    return dy.Int32(description="rowers the curve is valid for", min=1, max=24, **rules)


def _crew_class(**rules: Any) -> dy.String:
    return _text("H men, D women", regex="^[HD]$", **rules)


def _speed(description: str, **rules: Any) -> dy.Float64:
    return _number("m/s", description, min=0.0, max=15.0, **rules)


class Boats(dy.Schema):
    """Boats of `sloependata.csv`, one row each."""

    fsn_no = _fsn_no(primary_key=True)
    ht_no = _text("number in the HT register", nullable=True)
    name = _text("name of the boat")
    boat_type = _text("type, empty where not known", nullable=True)
    waterline_length_m = _number("m", "length on the waterline", min_exclusive=0, nullable=True)
    beam_m = _number("m", "breadth", min_exclusive=0, nullable=True)
    bow_height_m = _number("m", "height of the bow", min_exclusive=0, nullable=True)
    weight_kg = _number("kg", "empty boat with oars", min_exclusive=0, nullable=True)


class Seasons(dy.Schema):
    """What a rebuild read of each season."""

    season = dy.Int32(primary_key=True, description="year of the tow list")
    listed = dy.Int32(description="tows in the tow list that could be read", min=0)
    tows = dy.Int32(description="of which used; the others are in quarantine", min=0)


class Tows(dy.Schema):
    """Tows accepted into the warehouse, one row each."""

    tow_id = _tow_id(primary_key=True)
    season = _season()
    tow_date = dy.Date(description="day of the tow")
    fsn_no = _fsn_no()
    rowers = _rowers()
    crew_class = _crew_class()
    declared_speed_m_s = _speed("speed v0 the crew declared")
    waterline_length_m = _number("m", "length on the waterline that day", min_exclusive=0)
    beam_m = _number("m", "breadth that day", min_exclusive=0)
    bow_height_m = _number("m", "height of the bow that day", min_exclusive=0)
    weight_kg = _number("kg", "empty boat with oars, before", nullable=True, min_exclusive=0)
    weight_after_kg = _number("kg", "the same, after", nullable=True, min_exclusive=0)
    crew_weight_kg = _number("kg", "crew and ballast on board", nullable=True, min=0)
    water_temperature_c = _number("C", "water temperature", nullable=True, min=-2, max=35)
    speed_correction_ratio = _number(
        "1", "speed correction entered by hand, 0.06 for 6 %", nullable=True, min=-0.5, max=0.5
    )
    altered = dy.Bool(description="the boat was altered since its previous tow")
    sample_rate_hz = dy.Int32(
        description="samples a second", metadata={"unit": "Hz"}, min_exclusive=0
    )
    empty_thwart = _text("thwart left free", nullable=True)
    freeboard_lowest_m = _number("m", "freeboard at its lowest", nullable=True)
    freeboard_bow_m = _number("m", "freeboard at the bow", nullable=True)
    freeboard_stern_m = _number("m", "freeboard at the stern", nullable=True)
    remark = _text("remark in the tow list", nullable=True)
    log1_part = dy.Int32(description="times log 1 had been replaced that season", min=0)
    log2_part = dy.Int32(description="times log 2 had been replaced that season", min=0)
    samples_path = _text("samples file in the archive")
    samples_sha256 = _text("its content hash", regex="^[0-9a-f]{64}$")
    second_path = _text("second samples file, if two tows were combined", nullable=True)
    second_sha256 = _text("its content hash", nullable=True, regex="^[0-9a-f]{64}$")


class TowRuns(dy.Schema):
    """Runs of every tow; runs 11-16 are runs 1-6 of the second samples file."""

    tow_id = _tow_id(primary_key=True)
    run = dy.Int8(primary_key=True, description="run", min=1, max=16)
    direction = dy.Int8(description="1 out, -1 back", min=-1, max=1)
    target_speed_ratio = _number("1", "intended speed / declared speed", min_exclusive=0)
    selected = dy.Bool(description="the tow list says to use it")


class HandWindows(dy.Schema):
    """Windows that a person gave, one row a run; a method may use them (`by_hand`)."""

    tow_id = _tow_id(primary_key=True)
    run = dy.Int8(primary_key=True, description="run", min=1, max=16)
    start_s = dy.Int16(description="start of the window", metadata={"unit": "s"}, min=0)
    end_s = dy.Int16(description="end of the window", metadata={"unit": "s"}, min=1)
    reason = _text("why, in the person's words")


class RunPoints(dy.Schema):
    """One point per method, tow and run."""

    method = _method(primary_key=True)
    tow_id = _tow_id(primary_key=True)
    run = dy.Int8(primary_key=True, description="run", min=1, max=16)
    direction = dy.Int8(description="1 out, -1 back", min=-1, max=1)
    target_speed_ratio = _number("1", "intended speed / declared speed", min_exclusive=0)
    window_start_s = _number("s", "start of the window that counts", min=0, nullable=True)
    window_end_s = _number("s", "end of the window that counts", min=0, nullable=True)
    cut_reason = _text("why the rest was cut: codes, comma separated, or by_hand and the reason")
    speed_factor = _number("1", "true speed / log speed", min_exclusive=0, nullable=True)
    speed_m_s = _speed("mean true speed", nullable=True)
    gross_cw_kg_m = _number("kg/m", "mean F/v^2 before the wind", nullable=True)
    inertia_cw_kg_m = _number("kg/m", "part that accelerated the boat, off", nullable=True)
    air_cw_kg_m = _number("kg/m", "air part taken off", nullable=True)
    still_air_cw_kg_m = _number("kg/m", "still-air part put back", nullable=True)
    temperature_cw_kg_m = _number("kg/m", "change to the reference water", nullable=True)
    wind_coefficient_ahead = _number("1", "drag coefficient, wind from ahead", nullable=True)
    wind_coefficient_behind = _number("1", "the same from behind", nullable=True)
    cw_kg_m = _number("kg/m", "resistance coefficient in still air", nullable=True)
    cw_sd = _number("kg/m", "standard deviation of the samples", nullable=True, min=0)
    u_ratio = _number(
        "1", "uncertainty / Cw from within the season's runs, if pooled", nullable=True
    )
    fitted_cw_kg_m = _number("kg/m", "coefficient of the curve at this speed", nullable=True)
    wind_m_s = _number("m/s", "mean apparent wind speed", nullable=True)
    wind_angle_deg = _number("deg", "circular mean of the apparent wind", nullable=True)
    log2_ratio = _number("1", "log 2 / log 1", nullable=True)
    gps_ratio = _number("1", "GPS / log 1; empty without GPS", nullable=True)
    used = dy.Bool(description="the curve is fitted through it")
    reason = _text("why it is not used; empty when it is")


class Curves(dy.Schema):
    """One curve Cw = A / (1 - (v/B)^2) per method and tow."""

    method = _method(primary_key=True)
    tow_id = _tow_id(primary_key=True)
    fsn_no = _fsn_no()
    season = _season()
    rowers = _rowers()
    crew_class = _crew_class()
    declared_speed_m_s = _speed("speed v0 the crew declared")
    a_kg_m = _number("kg/m", "A: coefficient at v = 0", nullable=True)
    b_m_s = _number("m/s", "B; empty where it is not determined", nullable=True, min=0)
    b_capped = dy.Bool(description="B was brought down to its cap and A fitted again")
    cw_kg_m = _number("kg/m", "Cw at the declared speed", nullable=True)
    cw_lo_kg_m = _number("kg/m", "lower end of its 95 % interval", nullable=True)
    cw_hi_kg_m = _number("kg/m", "upper end", nullable=True)
    b_lo_m_s = _number("m/s", "lower end of the 95 % interval of B; empty: cannot be told", nullable=True)
    b_hi_m_s = _number("m/s", "upper end; empty: no upper bound", nullable=True)
    power_w = _number("W", "power a rower at the declared speed", nullable=True)
    residual_sd_ratio = _number("1", "sd of the points about the curve / Cw", nullable=True)
    calibration_factor = _number("1", "GPS speed / log speed", nullable=True)
    runs_used = dy.Int8(description="points the curve is fitted through", min=0)
    status = _text("accepted, flagged or rejected", regex=f"^({'|'.join(STATUSES)})$")
    flags = dy.List(dy.String(), description="codes of what a person should look at")


class CurvePoints(dy.Schema):
    """Curves over the speeds at which they are valid, 85 to 115 % of the declared speed."""

    method = _method(primary_key=True)
    tow_id = _tow_id(primary_key=True)
    speed_m_s = _speed("speed through the water", primary_key=True)
    cw_kg_m = _number("kg/m", "Cw at this speed", min_exclusive=0)
    cw_lo_kg_m = _number("kg/m", "lower end of its 95 % interval", min_exclusive=0)
    cw_hi_kg_m = _number("kg/m", "upper end", min_exclusive=0)


class Assessments(dy.Schema):
    """What each check found, one row per method, tow and check; a check not made has no row."""

    method = _method(primary_key=True)
    tow_id = _tow_id(primary_key=True)
    check = _text("code of the check", primary_key=True)
    severity = _text("flag: a person should look; note: worth knowing", regex="^(flag|note)$")
    observed = _number("as in unit", "what was observed")
    limit = _number("as in unit", "the limit that is exceeded, or the nearest")
    unit = _text("unit of both; 1 for a ratio, a count or yes (1) and no (0)")
    flagged = dy.Bool(description="the observed number is beyond its limit")


class LogFactors(dy.Schema):
    """True speed = log speed x factor, per method and season."""

    method = _method(primary_key=True)
    season = dy.Int32(primary_key=True, description="year of the tow list")
    factor = _number("1", "true speed / log speed", min_exclusive=0)
    lo = _number("1", "lower end of the 95 % interval; empty where unknown", nullable=True)
    hi = _number("1", "upper end", nullable=True)
    source = _text("none, prescribed, estimated or gps", regex="^(none|prescribed|estimated|gps)$")


class SeasonLinks(dy.Schema):
    """What each estimated log factor rests on, per method, season, part of it and log."""

    method = _method(primary_key=True)
    season = dy.Int32(primary_key=True, description="year of the tow list")
    part = dy.Int32(primary_key=True, description="part of the season, until a log was replaced")
    log = _text("speed source", primary_key=True)
    source = _text("estimated, gps, other log (by the ratio of both), or not determined")
    n_tows = dy.Int32(description="tows of the season", min=0)
    n_links = dy.Int32(description="boats also towed in other seasons", min=0)
    component = dy.Int32(description="connected part of the network; 0 has the dGPS anchor", min=0)
    critical_boats = dy.Int32(
        description="boats without any of which the season is undetermined", nullable=True, min=0
    )
    factor = _number("1", "true speed / log speed; empty: not determined", nullable=True)
    lo = _number("1", "lower end of its 95 % interval", nullable=True)
    hi = _number("1", "upper end", nullable=True)
    ln_sd = _number("1", "standard deviation of ln factor", nullable=True)
    dof = _number("1", "its degrees of freedom", nullable=True)
    influence = _number("1", "largest change when one boat is left out", nullable=True)
    influence_boat = _text("that boat", nullable=True)
    weakest_mode = _number("1", "share in what is known worst", nullable=True)
    factor_no_boats = _number("1", "the same without boat identity, a check", nullable=True)
    lo_no_boats = _number("1", "lower end of its 95 % interval", nullable=True)
    hi_no_boats = _number("1", "upper end", nullable=True)
    agreement = _number("1", "difference of the two in standard deviations", nullable=True)


class RetowChoice(dy.Schema):
    """Which few boats to tow again, with dGPS, so that the season factors are surest."""

    method = _method(primary_key=True)
    position = dy.Int32(primary_key=True, description="1 tells most, given none of the others")
    fsn_no = _fsn_no()
    rowers = _rowers()
    crew_class = _crew_class()
    seasons = _text("seasons without dGPS in which it was towed as it is now")
    factor_sd_before_ratio = _number("1", "typical uncertainty of a season's factor before", min=0)
    factor_sd_after_ratio = _number("1", "the same when this boat is towed too", min=0)


class SeasonSteps(dy.Schema):
    """Whether a season's step against the boats' other tows is the log's or the load cell's."""

    method = _method(primary_key=True)
    season = dy.Int32(primary_key=True, description="year of the tow list")
    part = dy.Int32(primary_key=True, description="part of the season, until a log was replaced")
    log = _text("speed source", primary_key=True)
    n_boats = dy.Int32(description="boats also towed in other seasons", min=0)
    level_step = _number("1", "step of ln Cw, by the log as it reads", nullable=True)
    level_step_sd = _number("1", "its standard deviation", nullable=True)
    force_step = _number("1", "the part of it in ln force, as the bend shows", nullable=True)
    force_step_sd = _number("1", "its standard deviation", nullable=True)
    cause = _text(
        "log, force (a log error may have come with it), none (no step), or not told",
        regex="^(log|force|none|not told)$",
    )


class UncertaintyBudget(dy.Schema):
    """What makes Cw at the declared speed uncertain, per method, tow and component."""

    method = _method(primary_key=True)
    tow_id = _tow_id(primary_key=True)
    component = _text("what is uncertain", primary_key=True)
    shared = _text("single, season or archive: with whom the error is shared")
    key = _text("rows with one key share one error")
    effect_ratio = _number("1", "change of ln Cw by one standard deviation of it")
    u_ratio = _number("1", "relative standard uncertainty", min=0)
    dof = _number("1", "degrees of freedom; empty: not limited", nullable=True)


class Ensemble(dy.Schema):
    """Equally likely values of Cw, with the errors that tows share drawn together.

    Kept in the lake, a file per method, and not in the database.
    """

    method = _method(primary_key=True)
    tow_id = _tow_id(primary_key=True)
    member = dy.Int16(
        primary_key=True, description="equal numbers of different tows belong together", min=1
    )
    cw_kg_m = _number("kg/m", "Cw at the declared speed", min_exclusive=0)


class Register(dy.Schema):
    """One line per edition, boat and crew."""

    edition = _text("edition; a draft is called concept-<method>", primary_key=True)
    method = _method()
    fsn_no = _fsn_no(primary_key=True)
    rowers = _rowers(primary_key=True)
    crew_class = _crew_class(primary_key=True)
    tow_id = _tow_id(nullable=True)
    tow_date = dy.Date(description="day of the tow", nullable=True)
    valid_until = dy.Date(description="last day the line counts", nullable=True)
    declared_speed_m_s = _speed("speed v0 the crew declared", nullable=True)
    a_kg_m = _number("kg/m", "A", nullable=True)
    b_m_s = _number("m/s", "B; empty where it is not determined", nullable=True)
    cw_kg_m = _number("kg/m", "Cw at the declared speed", nullable=True)
    cw_lo_kg_m = _number("kg/m", "lower end of its 95 % interval", nullable=True)
    cw_hi_kg_m = _number("kg/m", "upper end", nullable=True)
    status = _text("valid, or why there is no valid curve")
    verification_code = _text(
        "ten letters and digits that follow from all that made the line; drafts have none",
        nullable=True,
    )


class DueList(dy.Schema):
    """Until when each boat and crew's tow counts, and the speed of its next tow."""

    method = _method(primary_key=True)
    fsn_no = _fsn_no(primary_key=True)
    rowers = _rowers(primary_key=True)
    crew_class = _crew_class(primary_key=True)
    as_of = dy.Date(description="day on which it was judged: that of the last tow or race")
    status = _text("valid, or why there is no valid curve")
    tow_id = _tow_id(nullable=True)
    tow_date = dy.Date(description="day of the tow", nullable=True)
    valid_until = dy.Date(description="last day it counts", nullable=True)
    declared_speed_m_s = _speed("speed that was declared for it", nullable=True)
    power_w = _number("W", "power a rower at that speed", nullable=True)
    raced_speed_m_s = _speed("fastest race of the past year, through the water", nullable=True)
    lowest_speed_m_s = _speed("speed at 70 W a rower (men) or 40 W (women)", nullable=True)
    highest_speed_m_s = _speed("speed at 90 W or 55 W", nullable=True)
    tow_speed_m_s = _speed("speed proposed for the next tow", nullable=True)
    speed_reason = _text("why that speed")
    beyond_curve = dy.Bool(
        description="it lies outside 85-115 % of the last declared speed", nullable=True
    )


class Editions(dy.Schema):
    """The published editions: what each is and by whose decision."""

    edition = _text("edition", primary_key=True)
    kind = _text("recomputed, or as_printed", regex="^(recomputed|as_printed)$")
    method = _text("name of the method; empty as printed", nullable=True)
    method_hash = _text("its content hash", nullable=True, regex="^[0-9a-f]{64}$")
    valid_from = dy.Date(description="day from which it counts")
    published_on = dy.Date(description="day of publication")
    decision = _text("by whom and where it was decided")
    previous = _text("edition that it was compared with", nullable=True)
    code_version = _text("version of the code that made it")
    seal = _text("SHA-256 over all that the edition says of itself", regex="^[0-9a-f]{64}$")


class RegisterChanges(dy.Schema):
    """What differs between two editions, per boat and crew."""

    from_edition = _text("old edition", primary_key=True)
    to_edition = _text("new edition", primary_key=True)
    fsn_no = _fsn_no(primary_key=True)
    rowers = _rowers(primary_key=True)
    crew_class = _crew_class(primary_key=True)
    change = _text("added, removed, changed or same", regex="^(added|removed|changed|same)$")
    cw_ratio = _number("1", "new / old Cw at the old declared speed", nullable=True)
    power_ratio = _number("1", "new / old power at that speed", nullable=True)
    time_ratio = _number("1", "new / old time at equal power", nullable=True)
    causes = _text("what made the change, with its factor on Cw, as JSON")


class RaceChanges(dy.Schema):
    """Races replayed under two editions: power, rank and podium of every result."""

    from_edition = _text("old edition", primary_key=True)
    to_edition = _text("new edition", primary_key=True)
    race = _text("name of the race", primary_key=True)
    race_date = dy.Date(primary_key=True, description="day of the race")
    fsn_no = _fsn_no(primary_key=True)
    rowers = _rowers(primary_key=True)
    crew_class = _crew_class(primary_key=True)
    rowing_time_s = _number("s", "time rowed", min_exclusive=0)
    old_power_w = _number("W", "power a rower by the old edition", nullable=True)
    new_power_w = _number("W", "the same by the new one", nullable=True)
    old_rank = dy.Int32(description="place in race and class by the old edition", nullable=True)
    new_rank = dy.Int32(description="the same by the new one", nullable=True)
    podium_changed = dy.Bool(description="among the first three in one of the two only")


class CorrectionSteps(dy.Schema):
    """The ladder: what each step from one method to another does to a tow's Cw."""

    from_method = _text("method the ladder begins with", primary_key=True)
    to_method = _text("method it ends with", primary_key=True)
    tow_id = _tow_id(primary_key=True)
    position = dy.Int8(primary_key=True, description="place of the step; 0 is the start", min=0)
    step = _text("step of the method that was exchanged")
    factor = _number("1", "Cw after / before the step; they multiply to the total", min_exclusive=0)
    cw_kg_m = _number("kg/m", "Cw at the declared speed after the step")


class OptionEffects(dy.Schema):
    """How much choices of judgement matter, on top of a method."""

    method = _method(primary_key=True)
    tow_id = _tow_id(primary_key=True)
    option = _text("option of a step, or all", primary_key=True)
    cw_effect_ratio = _number("1", "Cw with the second value / with the first", nullable=True)
    b_effect_ratio = _number("1", "the same for B", nullable=True)
    cw_sd_ratio = _number("1", "spread of Cw over all combinations", nullable=True, min=0)
    b_sd_ratio = _number("1", "the same for B", nullable=True, min=0)
    cw_interval_ratio = _number("1", "half the 95 % interval of ln Cw", nullable=True, min=0)
    b_interval_ratio = _number("1", "the same for B; empty: no bound", nullable=True, min=0)


class SeasonChanges(dy.Schema):
    """Cw of each method / Cw of the first method, of the same tows, per season."""

    method = _method(primary_key=True)
    from_method = _text("first method, held against")
    season = dy.Int32(primary_key=True, description="year of the tow list")
    tows = dy.Int32(description="tows with a curve under both", min=1)
    median_ratio = _number("1", "median of the ratio", min_exclusive=0)
    lowest_ratio = _number("1", "lowest ratio of a tow", min_exclusive=0)
    highest_ratio = _number("1", "highest ratio of a tow", min_exclusive=0)


class SeasonLadder(dy.Schema):
    """The ladder per season: what each step does to Cw on average."""

    from_method = _text("method the ladder begins with", primary_key=True)
    to_method = _text("method it ends with", primary_key=True)
    season = dy.Int32(primary_key=True, description="year of the tow list")
    position = dy.Int8(primary_key=True, description="place of the step", min=1)
    step = _text("step of the method that was exchanged")
    tows = dy.Int32(description="tows", min=1)
    factor = _number("1", "geometric mean of the factor on Cw; they multiply", min_exclusive=0)


class OptionSummary(dy.Schema):
    """How much each option of judgement moves Cw over all tows."""

    method = _method(primary_key=True)
    option = _text("option of a step", primary_key=True)
    tows = dy.Int32(description="tows", min=1)
    median_ratio = _number("1", "median of Cw with the second value / with the first")
    lo_ratio = _number("1", "5 % of the tows lie below")
    hi_ratio = _number("1", "5 % of the tows lie above")


class TypeConsistency(dy.Schema):
    """How a quantity follows weight or tow speed within a boat type: a straight line."""

    method = _method(primary_key=True)
    boat_type = _text("type of boat; unknown: boats without type, no claims", primary_key=True)
    quantity = _text(
        "b_m_s, a_kg_m, q, cw_kg_m, cw_standard_kg_m or ln_cw_standard", primary_key=True
    )
    explaining = _text(
        "weight_kg, displacement_kg, declared_speed_m_s or ln_displacement", primary_key=True
    )
    standard_speed_m_s = _speed("common speed of q and cw_standard: median declared speed")
    n = dy.Int32(description="tows: the newest of each boat and crew", min=0)
    n_boats = dy.Int32(description="boats", min=0)
    slope = _number("quantity / explaining", "slope of the line", nullable=True)
    slope_lo = _number("quantity / explaining", "lower end of its 95 % interval", nullable=True)
    slope_hi = _number("quantity / explaining", "upper end", nullable=True)
    r2 = _number("1", "share of the spread that is explained", nullable=True, min=0, max=1)
    residual_sd_ratio = _number(
        "1", "spread about the line / mean; of ln Cw itself", nullable=True, min=0
    )
    between_sd_ratio = _number("1", "true spread about the line / mean", nullable=True, min=0)
    noise_sd_ratio = _number("1", "spread by run noise alone / mean", nullable=True, min=0)
    reason = _text("why there is no line: no_type, few_boats, equal_values; else empty")


class TypeOutliers(dy.Schema):
    """Every boat and crew against the other boats of its type."""

    method = _method(primary_key=True)
    tow_id = _tow_id(primary_key=True)
    fsn_no = _fsn_no()
    rowers = _rowers()
    crew_class = _crew_class()
    boat_type = _text("type of boat")
    season = _season()
    quantity = _text("ln_cw_standard, or bend: (v/B)^2 there", primary_key=True)
    standard_speed_m_s = _speed("common speed: median declared speed of the type")
    value = _number("1", "quantity of this tow, at the standard speed")
    expected = _number("1", "the same as the type's other boats predict it")
    deviation_sd = _number("1", "difference in standard deviations of a prediction")
    outside = dy.Bool(description="differs at 5 % over all boats of the type together")
    candidates = dy.List(dy.String(), description="codes of what could explain a difference")


class TypeHomogeneity(dy.Schema):
    """Equal boats, equal B? An F test per method and type, and what noise alone gives."""

    method = _method(primary_key=True)
    boat_type = _text("type of boat; unknown: boats without type, no claims", primary_key=True)
    n = dy.Int32(description="tows: the newest of each boat and crew", min=0)
    n_boats = dy.Int32(description="boats", min=0)
    dof_between = dy.Int32(description="degrees of freedom between", nullable=True, min=1)
    dof_within = dy.Int32(description="degrees of freedom within", nullable=True, min=1)
    standard_speed_m_s = _speed("common speed of shared_q", nullable=True)
    run_sd_ratio = _number("1", "scatter of a run about its curve", nullable=True, min=0)
    f_value = _number("1", "spread of the bends / what noise gives", nullable=True, min=0)
    p_value = _number("1", "chance of such an F with one bend", nullable=True, min=0, max=1)
    power_at_5pct = _number("1", "chance to see a true spread of B of 5 %", nullable=True)
    power_at_10pct = _number("1", "the same for 10 %", nullable=True)
    noise_share = _number("1", "share of the bends' spread that noise gives", nullable=True)
    between_b_sd_ratio = _number("1", "estimated true spread of B", nullable=True, min=0)
    b_sd_ratio = _number("1", "seen spread of B where determined", nullable=True, min=0)
    b_noise_sd_ratio = _number("1", "spread of B by noise alone", nullable=True, min=0)
    cw_noise_sd_ratio = _number("1", "spread of Cw by noise alone", nullable=True, min=0)
    ab_correlation = _number("1", "correlation of ln A and ln B", nullable=True)
    ab_noise_correlation = _number("1", "the same by noise alone", nullable=True)
    shared_q = _number("1", "q of the one bend, at the standard speed", nullable=True)
    shared_b_m_s = _number("m/s", "B of the one bend; empty without", nullable=True)
    reason = _text("why there is no test: no_type, few_boats, no_scatter; else empty")


class PooledCurves(dy.Schema):
    """The register if boats of a type kept their bend (own), shared it in part, or wholly."""

    method = _method(primary_key=True)
    tow_id = _tow_id(primary_key=True)
    fsn_no = _fsn_no()
    rowers = _rowers()
    crew_class = _crew_class()
    boat_type = _text("type of boat, or unknown")
    pooling = _text("own, partial or shared", primary_key=True, regex="^(own|partial|shared)$")
    standard_speed_m_s = _speed("common speed of q")
    q = _number("1", "bend at the standard speed", nullable=True)
    a_kg_m = _number("kg/m", "A", nullable=True)
    b_m_s = _number("m/s", "B; empty where it is not determined", nullable=True)
    cw_085_kg_m = _number("kg/m", "Cw at 85 % of the declared speed", nullable=True)
    cw_kg_m = _number("kg/m", "Cw at the declared speed", nullable=True)
    cw_115_kg_m = _number("kg/m", "Cw at 115 % of the declared speed", nullable=True)


class SpeedTrend(dy.Schema):
    """Does the bend follow the speed of the tow? If the hyperbola is true, it does not."""

    method = _method(primary_key=True)
    boat_type = _text("type of boat, or all: all types, each about its level", primary_key=True)
    n = dy.Int32(description="tows: the newest of each boat and crew", min=0)
    n_boats = dy.Int32(description="boats", min=0)
    slope = _number("1", "change of q at the standard speed per ln of tow speed", nullable=True)
    slope_lo = _number("1", "lower end of its 95 % interval", nullable=True)
    slope_hi = _number("1", "upper end", nullable=True)
    reason = _text("why there is no trend: few_boats, equal_values; else empty")


class SlowTows(dy.Schema):
    """Tows with too little power, and race power by their curve / with their type's bend."""

    method = _method(primary_key=True)
    tow_id = _tow_id(primary_key=True)
    fsn_no = _fsn_no()
    rowers = _rowers()
    crew_class = _crew_class()
    boat_type = _text("type of boat, or unknown")
    declared_speed_m_s = _speed("speed v0 the crew declared")
    power_w = _number("W", "power a rower at the declared speed")
    power_ratio_110 = _number("1", "power ratio at 110 % of that speed", nullable=True)
    power_ratio_110_lo = _number("1", "lower end of its 95 % interval", nullable=True)
    power_ratio_110_hi = _number("1", "upper end", nullable=True)
    power_ratio_120 = _number("1", "power ratio at 120 % of that speed", nullable=True)
    power_ratio_120_lo = _number("1", "lower end of its 95 % interval", nullable=True)
    power_ratio_120_hi = _number("1", "upper end", nullable=True)
    rowed_speed_m_s = _speed("median declared speed of like crews", nullable=True)
    power_ratio_rowed = _number("1", "power ratio at that speed", nullable=True)
    power_ratio_rowed_lo = _number("1", "lower end of its 95 % interval", nullable=True)
    power_ratio_rowed_hi = _number("1", "upper end", nullable=True)


class RepeatPairs(dy.Schema):
    """Consecutive tows of one boat and crew without an alteration between them."""

    method = _method(primary_key=True)
    fsn_no = _fsn_no()
    rowers = _rowers()
    crew_class = _crew_class()
    tow_id = _tow_id(primary_key=True)
    tow_id_before = _tow_id()
    season = _season()
    season_before = _season()
    ln_ratio = _number("1", "ln of new / old Cw, at the old declared speed")
    e_n = _number("1", "difference / both 95 % intervals (ISO 13528)", nullable=True)


class EraShifts(dy.Schema):
    """Do seasons with other instruments stand apart? Next tow of the same boat, in a later era."""

    method = _method(primary_key=True)
    boat_type = _text("type of boat, or all", primary_key=True)
    era = _text("seasons of the older tow", primary_key=True)
    n = dy.Int32(description="pairs of tows", min=0)
    shift_ratio = _number("1", "new / old Cw without ageing, median", nullable=True, min=0)
    lo = _number("1", "lower end of its 95 % interval", nullable=True, min=0)
    hi = _number("1", "upper end", nullable=True, min=0)
    apart = dy.Bool(description="the interval leaves out 1", nullable=True)
    n_ageing = dy.Int32(description="pairs of all types within the last era", min=0)
    ageing_per_year = _number("1", "change of ln Cw a year taken out; empty: none", nullable=True)
    ageing_lo = _number("1", "lower end of its 95 % interval", nullable=True)
    ageing_hi = _number("1", "upper end", nullable=True)
    reason = _text("why there is no shift: few_pairs; else empty")


class Reproducibility(dy.Schema):
    """How well repeat tows of unaltered boats agree."""

    method = _method(primary_key=True)
    scope = _text("all pairs, or an era", primary_key=True)
    n_pairs = dy.Int32(description="pairs of consecutive tows of one boat and crew", min=0)
    n_tows = dy.Int32(description="tows behind run_sd_ratio", min=0)
    sd_ratio = _number("1", "standard deviation of one tow, s_R", nullable=True, min=0)
    lo = _number("1", "lower end of its 95 % interval", nullable=True, min=0)
    hi = _number("1", "upper end", nullable=True, min=0)
    share_within_1pct = _number("1", "share of pairs that differ under 1 %", nullable=True)
    share_within_2pct = _number("1", "the same for 2 %", nullable=True)
    share_e_n_above_1 = _number("1", "share of pairs that disagree; 5 % expected", nullable=True)
    run_sd_ratio = _number("1", "scatter of a run about its curve", nullable=True, min=0)
    within_sd_ratio = _number("1", "s_r: what that does to a tow's Cw", nullable=True, min=0)
    distinct_categories = _number("1", "classes told apart: 1.41 s_boat / s_R", nullable=True)


class VarianceComponents(dy.Schema):
    """Spread of Cw by cause, from a mixed model over all tows (REML)."""

    method = _method(primary_key=True)
    scope = _text("fleet, or within_type", primary_key=True)
    component = _text("boat, season, boat_season or run", primary_key=True)
    n = dy.Int32(description="tows", min=0)
    n_boats = dy.Int32(description="boats and crews between two alterations", min=0)
    n_seasons = dy.Int32(description="seasons", min=0)
    n_repeated = dy.Int32(description="tows beyond a boat's first", min=0)
    sd_ratio = _number("1", "standard deviation of Cw by this cause", nullable=True, min=0)
    lo = _number("1", "lower end of its 95 % interval", nullable=True, min=0)
    hi = _number("1", "upper end; empty: no bound", nullable=True, min=0)
    share = _number("1", "share of the variance of a tow's Cw", nullable=True, min=0, max=1)
    distinct_categories = _number("1", "boats told apart: 1.41 s_boat / s_R", nullable=True)
    reason = _text("why there are no numbers: too_few_repeats; else empty")


class PredictedCw(dy.Schema):
    """A second opinion without towing: Cw from weight, length, beam and type."""

    method = _method(primary_key=True)
    tow_id = _tow_id(primary_key=True)
    fsn_no = _fsn_no()
    rowers = _rowers()
    crew_class = _crew_class()
    boat_type = _text("type of boat, or unknown")
    standard_speed_m_s = _speed("median declared speed of type and crew class")
    cw_kg_m = _number("kg/m", "Cw of the tow at that speed")
    cw_sd_ratio = _number(
        "1", "its standard uncertainty: of the runs, or of its interval if wider", min=0
    )
    predicted_cw_kg_m = _number("kg/m", "Cw as the other boats predict it", nullable=True)
    predicted_lo_kg_m = _number("kg/m", "lower end of its 95 % interval", nullable=True)
    predicted_hi_kg_m = _number("kg/m", "upper end", nullable=True)
    predicted_sd_ratio = _number("1", "its standard uncertainty", nullable=True, min=0)
    ln_ratio = _number("1", "ln of the tow's Cw / the predicted", nullable=True)
    disagrees = dy.Bool(description="differs by more than both uncertainties", nullable=True)
    reason = _text("why there is no prediction: few_boats; else empty")


class PredictionError(dy.Schema):
    """Cross-validated error of the prediction, boats left out one by one."""

    method = _method(primary_key=True)
    n = dy.Int32(description="boats and crews predicted", min=0)
    n_boats = dy.Int32(description="boats", min=0)
    rmse_ratio = _number("1", "root mean square of ln tow / predicted", min=0)
    tow_sd_ratio = _number("1", "of which uncertainty of the tow itself", min=0)
    share_disagreeing = _number("1", "share beyond both uncertainties", min=0, max=1)


class QualityCounts(dy.Schema):
    """How many curves have each status and flag, and how many runs do not count, and why."""

    method = _method(primary_key=True)
    kind = _text("status, flag or run", primary_key=True, regex="^(status|flag|run)$")
    code = _text("the status, flag or reason", primary_key=True)
    scope = _text("a season, or all", primary_key=True)
    number = dy.Int32(description="how many", min=1)


class CheckCounts(dy.Schema):
    """How often each check was made, and found something beyond its limit."""

    method = _method(primary_key=True)
    check = _text("code of the check", primary_key=True)
    severity = _text("flag or note", regex="^(flag|note)$")
    tows = dy.Int32(description="tows on which it was made", min=1)
    beyond = dy.Int32(description="of which beyond the limit", min=0)


class TraceSeconds(dy.Schema):
    """Means over every second of every run: what the instruments said."""

    tow_id = _tow_id(primary_key=True)
    run = dy.Int8(primary_key=True, description="run", min=1, max=16)
    second = dy.Int16(primary_key=True, description="second of the run, from 0", min=0)
    speed_m_s = _speed("log 1: speed through the water as the log said")
    gps_m_s = _speed("speed over ground; empty without GPS", nullable=True)
    force_n = _number("N", "tow force")
    wind_m_s = _number("m/s", "apparent wind speed")
    wind_angle_deg = _number("deg", "circular mean of the apparent wind", min=0, max=360)


class Quarantine(dy.Schema):
    """Files and tows set aside, each with the reason in a plain sentence."""

    path = _text("file, relative to the archive")
    tow_id = _tow_id(nullable=True)
    line = dy.Int64(description="line in the file", nullable=True, min=1)
    reason_code = _text("short stable code")
    message = _text("what is wrong and what to do, in a sentence")
    first_seen = dy.Date(description="day on which this fault was first found")


class Methods(dy.Schema):
    """The methods that made the tables."""

    method = _method(primary_key=True)
    title = _text("title for people")
    title_en = _text("title in English; the same where the method has one title")
    content_hash = _text("SHA-256 of the definition", regex="^[0-9a-f]{64}$")
    definition = _text("the options of every season, as canonical JSON")


class Lineage(dy.Schema):
    """What a register line was made from: one row per line and samples file."""

    edition = _text("edition", primary_key=True)
    fsn_no = _fsn_no(primary_key=True)
    rowers = _rowers(primary_key=True)
    crew_class = _crew_class(primary_key=True)
    tow_id = _tow_id()
    path = _text("file in the archive", primary_key=True)
    sha256 = _text("its content hash", regex="^[0-9a-f]{64}$")
    method = _method()
    method_hash = _text("content hash of the method", regex="^[0-9a-f]{64}$")
    code_version = _text("version of the code that made the line")


TABLES: Final[dict[str, type[dy.Schema]]] = {
    "boats": Boats,
    "seasons": Seasons,
    "tows": Tows,
    "tow_runs": TowRuns,
    "hand_windows": HandWindows,
    "run_points": RunPoints,
    "curves": Curves,
    "curve_points": CurvePoints,
    "assessments": Assessments,
    "log_factors": LogFactors,
    "season_links": SeasonLinks,
    "retow_choice": RetowChoice,
    "season_steps": SeasonSteps,
    "uncertainty_budget": UncertaintyBudget,
    "ensemble": Ensemble,
    "register": Register,
    "due_list": DueList,
    "editions": Editions,
    "register_changes": RegisterChanges,
    "race_changes": RaceChanges,
    "correction_steps": CorrectionSteps,
    "option_effects": OptionEffects,
    "season_changes": SeasonChanges,
    "season_ladder": SeasonLadder,
    "option_summary": OptionSummary,
    "quality_counts": QualityCounts,
    "check_counts": CheckCounts,
    "trace_seconds": TraceSeconds,
    "type_consistency": TypeConsistency,
    "type_outliers": TypeOutliers,
    "type_homogeneity": TypeHomogeneity,
    "pooled_curves": PooledCurves,
    "speed_trend": SpeedTrend,
    "slow_tows": SlowTows,
    "repeat_pairs": RepeatPairs,
    "era_shifts": EraShifts,
    "reproducibility": Reproducibility,
    "variance_components": VarianceComponents,
    "predicted_cw": PredictedCw,
    "prediction_error": PredictionError,
    "quarantine": Quarantine,
    "methods": Methods,
    "lineage": Lineage,
}


def conform(name: str, frame: pl.DataFrame) -> pl.DataFrame:
    """The declared columns of a table, in order, sorted by its key and checked.

    Raises:
        dataframely.exc.ValidationError, SchemaError: the frame is not what was declared.
    """
    schema = TABLES[name]
    key = schema.primary_key() or schema.column_names()
    chosen = frame.select(schema.column_names()).sort(key)
    return schema.validate(chosen)
