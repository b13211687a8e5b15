"""One point per run, as a method computes it."""

from pipeline.tables import column
from pipeline.tables.bases import PerTow
from pipeline.tables.declare import dy


class RunPoints(PerTow):
    """One point per method, tow and run."""

    run = column.run(primary_key=True)
    direction = dy.Int8(description="1 out, -1 back", min=-1, max=1)
    target_speed_ratio = column.number("1", "intended speed / declared speed", min_exclusive=0)
    window_start_s = column.number("s", "start of the window that counts", min=0, nullable=True)
    window_end_s = column.number("s", "end of the window that counts", min=0, nullable=True)
    cut_reason = column.text(
        "why the rest was cut: codes, comma separated, or by_hand and the reason"
    )
    lost_s = column.number("s", "most that is left out of a channel", min=0)
    ends_ratio = column.number(
        "1",
        "largest change of speed, force or wind from its start to its end / its limit; empty "
        "where the method has none",
        nullable=True,
    )
    speed_factor = column.number("1", "true speed / log speed", min_exclusive=0, nullable=True)
    speed_m_s = column.speed("mean true speed", nullable=True)
    gross_cw_kg_m = column.number("kg/m", "mean F/v^2 before the wind", nullable=True)
    inertia_cw_kg_m = column.number("kg/m", "part that accelerated the boat, off", nullable=True)
    air_cw_kg_m = column.number("kg/m", "air part taken off", nullable=True)
    still_air_cw_kg_m = column.number("kg/m", "still-air part put back", nullable=True)
    temperature_cw_kg_m = column.number("kg/m", "change to the reference water", nullable=True)
    wind_coefficient_ahead = column.number("1", "drag coefficient, wind from ahead", nullable=True)
    wind_coefficient_behind = column.number("1", "the same from behind", nullable=True)
    cw_kg_m = column.number("kg/m", "resistance coefficient in still air", nullable=True)
    cw_sd = column.number("kg/m", "standard deviation of the samples", nullable=True, min=0)
    u_ratio = column.number(
        "1", "uncertainty / Cw from within the season's runs, if pooled", nullable=True
    )
    fitted_cw_kg_m = column.number("kg/m", "coefficient of the curve at this speed", nullable=True)
    wind_m_s = column.number("m/s", "mean apparent wind speed", nullable=True)
    wind_angle_deg = column.number("deg", "circular mean of the apparent wind", nullable=True)
    log2_ratio = column.number("1", "log 2 / log 1", nullable=True)
    gps_ratio = column.number("1", "GPS / log 1; empty without GPS", nullable=True)
    used = dy.Bool(description="the curve is fitted through it")
    reason = column.text("why it is not used; empty when it is")
    choice = column.text(
        "of more runs at one target and direction: most_reliable, or why it is less so",
        nullable=True,
    )
