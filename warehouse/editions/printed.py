"""Printed registers: their lines as an edition, re-based in closed form, and beside measured lines.

A printed register says nothing about its method; its A, B and speed are all there is. The formula
of the closed form is in `pipeline.curve.rebase`.
"""

import datetime as dt
from typing import Final

import numpy as np
import polars as pl

from pipeline.curve import cw, rebase, s_of_b
from pipeline.errors import MissingKnowledgeError
from pipeline.messages import say
from pipeline.method.definition import Method, shipped_method
from pipeline.register.register import LINE, TOW_DAY, tow_days, valid_until
from pipeline.register.years import method_in_force
from warehouse.editions.inputs import INPUTS_HASH
from warehouse.store.editions import Edition
from warehouse.store.store import Store, fingerprint

AS_PRINTED, REBASED, NOT_REBASED = "printed", "printed_rebased", "printed_not_rebased"
PRINTED_METHOD: Final = "as-printed"
"""What stands for the method of a line that none was applied to."""

NO_VALID_CURVE: Final = "no_valid_curve"


def method_in_print(season: int) -> Method:
    """Return the method that was in force when the register of a season was printed."""
    return shipped_method(method_in_force(season))


def printed_path(store: Store, season: int) -> str:
    """Return the file of the register printed in a season, to be published whole.

    Raises:
        MissingKnowledgeError: the archive holds no such register, or one with a line that cannot be
            read: an edition is kept for ever and must not lack it.
    """
    registers = store.read("printed_registers")
    paths = registers.filter(season=season)["path"].unique().sort()
    if paths.is_empty():
        known = ", ".join(str(s) for s in registers["season"].unique().sort()) or say("none")
        raise MissingKnowledgeError(
            "the archive holds no readable register printed in {}; it holds: {}", season, known
        )
    path = str(paths[0])
    for unread in store.read("list_faults").filter(path=path)["message"]:
        raise MissingKnowledgeError("{}: {} Mend the line, or take it out", path, unread)
    return path


def printed_lines(store: Store, path: str) -> pl.DataFrame:
    """Return the lines of a printed register, each with the hash of what it says.

    Raises:
        MissingKnowledgeError: it names a line twice.
    """
    printed = store.read("printed_registers").filter(path=path)
    for row in printed.filter(pl.struct(LINE).is_duplicated()).iter_rows(named=True):
        raise MissingKnowledgeError(
            "{}, line {}: {} is listed twice for {}{}; take one of the lines out",
            row["path"],
            row["line"],
            row["fsn_no"],
            row["rowers"],
            row["crew_class"],
        )
    hashes = [fingerprint(row) for row in printed.drop("path", "line").rows()]
    has_curve = pl.col("has_valid_curve")
    return printed.select(
        *TOW_DAY,
        *("declared_speed_m_s", "a_kg_m", "b_m_s", "cw_kg_m"),
        status=pl.when(has_curve).then(pl.lit("valid")).otherwise(pl.lit(NO_VALID_CURVE)),
        basis=pl.when(has_curve).then(pl.lit(AS_PRINTED)),
        **{INPUTS_HASH: pl.Series(hashes, dtype=pl.String)},
    )


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
    factor = np.array([_season_factor(day.year, known, method) for day in lines["tow_date"]])
    a, b = rebase(lines["a_kg_m"], lines["b_m_s"], factor)
    return lines.with_columns(
        valid_until(pl.col("tow_date"), method.validity).alias("valid_until"),
        pl.Series("a_kg_m", a, pl.Float64),
        pl.Series("b_m_s", b, pl.Float64),
        pl.Series("cw_kg_m", cw(a, s_of_b(b), lines["declared_speed_m_s"]), pl.Float64),
        pl.Series("basis", np.where(factor == 1.0, NOT_REBASED, REBASED), pl.String),
    )


def _season_factor(season: int, known: dict[int, float], method: Method) -> float:
    """True speed / printed speed.

    1 where the method calibrates every tow on GPS: in those seasons the printed number was
    calibrated too. Else what was found for the season; without tows of it, what is prescribed.
    """
    try:
        steps = method.for_season(season)
    except MissingKnowledgeError:
        return 1.0  # the method says nothing about it, so the line stays as printed
    if steps.calibration.rule != "none":
        return 1.0
    return known.get(season, steps.speed.prescribed)


# The newest tow counts


def carry_over(
    lines: pl.DataFrame,
    printed: Edition,
    log_factors: pl.DataFrame,
    method: Method,
    tows: pl.DataFrame,
    valid_from: dt.date,
) -> pl.DataFrame:
    """Put printed lines in place of measured ones where the newest tow has no samples.

    The newest tow counts. A printed line of a tow that the warehouse has never counts: that tow was
    recomputed, doubted, rejected or excluded.

    Args:
        lines: measured lines.
        printed: an edition as printed, whose lines are re-based as in `rebase_printed`.
        log_factors, method: as for `rebase_printed`.
        tows: rows of `tows`, all that have samples.
        valid_from: day from which the lines are to count.

    Raises:
        MissingKnowledgeError: the edition is not a printed one.
    """
    if printed.manifest.kind != "as_printed":
        raise MissingKnowledgeError(
            "edition {} was recomputed; only lines of an edition as printed can be carried over",
            printed.manifest.edition,
        )
    names = ("declared_speed_m_s", "a_kg_m", "b_m_s", "cw_kg_m", "status", "basis", "valid_until")
    is_valid = pl.lit(valid_from).is_between("tow_date", "valid_until")
    measured = lines.filter(status="valid").select(*LINE, measured_on="tow_date")
    carried = (
        rebase_printed(printed.register, log_factors, method)
        .filter(is_valid & pl.col("cw_kg_m").is_finite())
        .join(tow_days(tows), on=TOW_DAY, how="anti")
        .join(measured, on=LINE, how="left", maintain_order="left")
        .filter((pl.col("tow_date") > pl.col("measured_on")).fill_null(True))
        .select(*TOW_DAY, INPUTS_HASH, *names)
    )
    return pl.concat([lines.join(carried, on=LINE, how="anti"), carried], how="diagonal_relaxed")
