"""How far each season's speed log was off, and what that rests on."""

from pipeline.tables import column
from pipeline.tables.bases import PerMethod, PerPart, PerTow


class LogFactors(PerMethod):
    """True speed = log speed x factor, per method and season."""

    season = column.season(primary_key=True)
    factor = column.number("true speed / log speed", min_exclusive=0)
    lo = column.optional("lower end of the 95 % interval; empty where unknown")
    hi = column.upper()
    source = column.text(
        "none, prescribed, estimated, gps, or not settled (the search did not come to rest, or the "
        "factor contradicts the season's repeat tows and is not used)",
        regex="^(none|prescribed|estimated|gps|not settled)$",
    )


class SeasonLinks(PerPart):
    """What each estimated log factor rests on, per method, season, part of it and log."""

    source = column.text("estimated, gps, not determined, or not settled")
    n_tows = column.count("tows of the season")
    n_links = column.count("boats also towed in other seasons")
    component = column.count("connected part of the network; 0 has the dGPS anchor")
    factor = column.optional("true speed / log speed; empty: not determined")
    lo = column.lower()
    hi = column.upper()
    ln_sd = column.optional("standard deviation of ln factor")
    repeat_tows_sd = column.optional("part of ln_sd by scatter of repeat tows")
    gps_sd = column.optional("part of ln_sd by plain GPS")
    assumed_sd = column.optional("part of ln_sd by what is assumed of log, load cell and boats")


class SeasonDiagnosis(PerPart):
    """What is wrong with the instruments of each season: each possible fault with its odds."""

    instrument = column.text(
        "log_scale, log_trend (end of the season against its middle), log_change (from a tow on), "
        "gps_scale (plain GPS), force_scale, force_zero, force_zero_drift (end against middle), "
        "anemometer_scale (wind read / wind), season_bend (the bend of all boats as this season's "
        "logs show it), water_temperature (not recorded), fleet_step (all boats changed with "
        "this season), or season_level (all tows of the season against the other tows of their "
        "boats, with instruments corrected for what was found of them)",
        primary_key=True,
    )
    unit = column.text("1 for the logarithm of a factor, N for a force")
    estimate = column.number("expected size; 0 where surely nothing is wrong", unit="as in unit")
    lo = column.number("lower end of its 95 % interval", unit="as in unit")
    hi = column.number("upper end", unit="as in unit")
    p_fault = column.optional("probability of such a fault; empty for what there always is", min=0)
    distance_sd = column.optional("what is seen against what is assumed, in standard deviations")
    verdict = column.text(
        "sound, would not show (one of the usual size would not be found), fault (likelier than "
        "not), cannot be told (10 to 50 %, or one boat alone shows it), alarm (4 standard "
        "deviations apart; of a level 2 % and beyond its interval); of a log's factor estimated or "
        "not determined; not settled (the search did not come to rest: no estimate of the method "
        "can be relied on)",
        regex="^(sound|would not show|fault|cannot be told|alarm|estimated|not determined"
        "|not settled)$",
    )
    alarm = column.flag(
        "a person should look: fault, alarm, not settled, or shown by one boat alone"
    )
    first_tow = column.text("likeliest first tow after a log changed", nullable=True)
    rests_on = column.text("what tells")
    shown_by = column.text(
        "the one boat that shows it, or two that disagree: it may have been altered instead, and "
        "nothing is corrected; empty where more boats tell, or nothing is shown",
        nullable=True,
    )
    confused_with = column.text("what it would pass for, and what for it", nullable=True)


class TowInstruments(PerTow):
    """What was found of the instruments of each tow, and is corrected in its curve."""

    factor = column.optional("true speed / log speed; 1 with dGPS; empty: not determined")
    force_factor = column.number("force read / true force; 1 where no fault was found")
    force_zero_n = column.number("force read without any; 0 where no fault was found")
    bend = column.number("q = r / (1 - r) of the boat, r = (v/B)^2 at its usual speed")
    askew_ratio = column.number(
        "of Cw, by being pulled askew: root mean square; 0 where that is unlikely", min=0
    )
    ln_sd = column.number("their standard deviation in ln Cw / the elasticity 2 + 2 q", min=0)


class BestEstimateWeights(PerTow):
    """What the best estimate of a tow rests on: shares of the boat's tows, 1 together."""

    rests_on = column.text("the tow that it rests on", primary_key=True)
    weight = column.number("its share")
