"""One point per run, as a method computes it."""

from pipeline.tables import column
from pipeline.tables.bases import PerTow
from pipeline.tables.declare import dy


class RunPoints(PerTow):
    """One point per method, tow and run."""

    run = column.run(primary_key=True)
    direction = dy.Int8(description="1 out, -1 back", min=-1, max=1)
    target_speed_ratio = column.number("intended speed / declared speed", min_exclusive=0)
    window_start_s = column.optional("start of the window that counts", min=0)
    window_end_s = column.optional("end of the window that counts", min=0)
    cut_reason = column.text(
        "why the rest was cut: codes, comma separated, or by_hand and the reason"
    )
    lost_s = column.number("most that is left out of a channel", min=0)
    ends_ratio = column.optional(
        "largest change of speed, force or wind from its start to its end / its limit; empty "
        "where the method has none",
    )
    speed_factor = column.optional("true speed / log speed", min_exclusive=0)
    speed_m_s = column.speed("mean true speed", nullable=True)
    gross_cw_kg_m = column.optional("mean F/v^2 before the wind")
    inertia_cw_kg_m = column.optional("part that accelerated the boat, off")
    air_cw_kg_m = column.optional("air part taken off")
    still_air_cw_kg_m = column.optional("still-air part put back")
    temperature_cw_kg_m = column.optional("change to the reference water")
    wind_coefficient_ahead = column.optional("drag coefficient, wind from ahead")
    wind_coefficient_behind = column.optional("the same from behind")
    cw_kg_m = column.optional("resistance coefficient in still air")
    cw_sd = column.optional("standard deviation of the samples", min=0)
    cw_seconds_sd_kg_m = column.optional("standard deviation of the means per second", min=0)
    fitted_cw_kg_m = column.optional("coefficient of the curve at this speed")
    wind_m_s = column.optional("mean apparent wind speed")
    wind_angle_deg = column.optional("circular mean of the apparent wind")
    log2_ratio = column.optional("log 2 / log 1")
    gps_ratio = column.optional("GPS / log 1; empty without GPS")
    used = column.flag("the curve is fitted through it")
    reason = column.text("why it is not used; empty when it is")
    choice = column.text(
        "of more runs at one target and direction: most_reliable, or why it is less so",
        nullable=True,
    )


class TowCurrents(PerTow):
    """The current of each tow with GPS both ways, along the course of the runs out."""

    current_m_s = column.number("speed of the current; positive where it ran with the boat out")
    current_lo_m_s = column.number("lower end of its 95 % interval")
    current_hi_m_s = column.number("upper end of its 95 % interval")
    current_change_m_s = column.optional(
        "current of the runs back less that of the runs out; empty where too few other tows tell "
        "the factor of the log"
    )
    current_change_lo_m_s = column.optional("lower end of its 95 % interval")
    current_change_hi_m_s = column.optional("upper end of its 95 % interval")
    current_verdict = column.text(
        "changed (by more than 0.1 m/s and 3 standard deviations), no_change, or cannot be told",
        regex="^(changed|no_change|cannot be told)$",
    )
