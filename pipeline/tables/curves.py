"""Resistance curves, what checks say of them, and how uncertain they are."""

from typing import Final

from pipeline.tables import column
from pipeline.tables.bases import PerTow
from pipeline.tables.declare import dy
from pipeline.tables.severity import SEVERITY_PATTERN

STATUSES: Final = ("accepted", "flagged", "rejected")


class Curves(PerTow):
    """One curve Cw = A / (1 - (v/B)^2) per method and tow."""

    fsn_no = column.fsn_no()
    season = column.season()
    rowers = column.rowers()
    crew_class = column.crew_class()
    declared_speed_m_s = column.speed("speed v0 the crew declared")
    a_kg_m = column.optional("A: coefficient at v = 0")
    b_m_s = column.optional("B; empty where it is not determined", min=0)
    b_capped = column.flag("B was brought down to its cap and A fitted again")
    cw_kg_m = column.optional("Cw at the declared speed")
    cw_lo_kg_m = column.optional(column.LOWER_END)
    cw_hi_kg_m = column.upper()
    cw_best_kg_m = column.optional("best estimate: by this tow, the boat's others and all seasons")
    cw_best_lo_kg_m = column.lower()
    cw_best_hi_kg_m = column.upper()
    cw_others_kg_m = column.optional(
        "Cw with log and load cell as all other boats show them; empty: nothing is estimated",
    )
    b_lo_m_s = column.optional(f"{column.LOWER_END}; empty: cannot be told")
    b_hi_m_s = column.optional("upper end; empty: no upper bound")
    power_w = column.optional("power per rower at the declared speed")
    residual_sd_ratio = column.optional("sd of the points about the curve / Cw")
    calibration_factor = column.optional("GPS speed / log speed")
    runs_used = dy.Int8(description="points the curve is fitted through", min=0)
    status = column.text("accepted, flagged or rejected", regex=f"^({'|'.join(STATUSES)})$")
    flags = column.texts("codes of what a person should look at")


class CurvePoints(PerTow):
    """Curves over the speeds at which they are valid, 85 to 115 % of the declared speed."""

    speed_m_s = column.speed("speed through the water", primary_key=True)
    cw_kg_m = column.number("Cw at this speed", min_exclusive=0)
    cw_lo_kg_m = column.number(column.LOWER_END, min_exclusive=0)
    cw_hi_kg_m = column.number("upper end", min_exclusive=0)


class Assessments(PerTow):
    """What each check found, one row per method, tow and check; a check not made has no row."""

    check = column.text("code of the check", primary_key=True)
    severity = column.text(
        "note: worth knowing; look: somebody must decide; refuse: nothing to register",
        regex=SEVERITY_PATTERN,
    )
    observed = column.number("what was observed", unit="as in unit")
    limit = column.number("the limit that is exceeded, or the nearest", unit="as in unit")
    unit = column.text("unit of both; 1 for a ratio, a count or yes (1) and no (0)")
    flagged = column.flag("the observed number is beyond its limit")


class UncertaintyBudget(PerTow):
    """What makes Cw at the declared speed uncertain, per method, tow and component."""

    component = column.text("what is uncertain", primary_key=True)
    shared = column.text("single, season or archive: with whom the error is shared")
    key = column.text("rows with one key share one error")
    effect_ratio = column.number("change of ln Cw by one standard deviation of it")
    u_ratio = column.number("relative standard uncertainty", min=0)
    dof = column.optional("degrees of freedom; empty: not limited")


class Ensemble(PerTow):
    """Equally likely values of Cw, with the errors that tows share drawn together.

    Kept in the lake, a file per method, and not in the database.
    """

    member = dy.Int16(
        primary_key=True, description="equal numbers of different tows belong together", min=1
    )
    cw_kg_m = column.number("Cw at the declared speed", min_exclusive=0)
