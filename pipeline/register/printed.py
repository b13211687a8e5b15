"""Printed registers: lines re-based in closed form, and lines that count because nothing else does.

A printed register says nothing about its method; its A, B and speed are all there is. The formula
of the closed form is in `pipeline.curve.rebase`.
"""

from typing import Final

import numpy as np
import polars as pl

from pipeline.curve import cw, rebase, s_of_b
from pipeline.errors import MissingKnowledgeError
from pipeline.method.definition import Method
from pipeline.register.register import TOW_DAY, list_tow_days, valid_until

AS_PRINTED: Final = "printed"
REBASED: Final = "printed_rebased"
NOT_REBASED: Final = "printed_not_rebased"
"""The basis of a printed line: as it was printed, re-based in closed form, or left as printed
because the method changes nothing in its season or says nothing of it."""


def rebase_printed(
    printed: pl.DataFrame, log_factors: pl.DataFrame, method: Method
) -> pl.DataFrame:
    """Re-base printed lines in closed form: A / y^2 and B y with the log factor y of the season.

    Args:
        printed: lines of a printed register; those without day, speed, A or B are left out.
        log_factors: what the method found, for seasons with tows in the warehouse.
        method: prescribes the factor of other seasons, and how long a tow counts.

    Returns:
        The lines with new A, B and Cw at the declared speed, `basis` and `valid_until`.
    """
    lines = printed.drop_nulls(("tow_date", "declared_speed_m_s", "a_kg_m", "b_m_s"))
    known = dict(log_factors.select("season", "factor").rows())
    factor = np.array([_find_factor(day.year, known, method) for day in lines["tow_date"]])
    a, b = rebase(lines["a_kg_m"], lines["b_m_s"], factor)
    return lines.with_columns(
        valid_until(pl.col("tow_date"), method.validity).alias("valid_until"),
        pl.Series("a_kg_m", a, pl.Float64),
        pl.Series("b_m_s", b, pl.Float64),
        pl.Series("cw_kg_m", cw(a, s_of_b(b), lines["declared_speed_m_s"]), pl.Float64),
        pl.Series("basis", np.where(factor == 1.0, NOT_REBASED, REBASED), pl.String),
    )


def carry_lines(
    printed: pl.DataFrame, log_factors: pl.DataFrame, method: Method, tows: pl.DataFrame
) -> pl.DataFrame:
    """Return printed lines of tows that have no samples, re-based as in `rebase_printed`.

    A printed line of a tow that the warehouse has never counts: that tow was recomputed, doubted,
    rejected or excluded. Of a tow that several registers print, the last of `printed` counts.

    Args:
        printed: lines of printed registers.
        log_factors, method: as for `rebase_printed`.
        tows: rows of `tows`, all that have samples.
    """
    rebased = rebase_printed(printed, log_factors, method).filter(pl.col("cw_kg_m").is_finite())
    without_samples = rebased.join(
        list_tow_days(tows), on=TOW_DAY, how="anti", maintain_order="left"
    )
    return without_samples.unique(TOW_DAY, keep="last", maintain_order=True)


def _find_factor(season: int, known: dict[int, float], method: Method) -> float:
    """Return true speed / printed speed.

    1 where the method calibrates every tow on GPS: in those seasons the printed number was
    calibrated too. Else what was found for the season; without tows of it, what is prescribed.
    """
    try:
        steps = method.get_steps(season)
    except MissingKnowledgeError:
        return 1.0  # the method says nothing about it, so the line stays as printed
    if steps.calibration.rule != "none":
        return 1.0
    return known.get(season, steps.speed.prescribed)
