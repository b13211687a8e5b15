"""The register: which tow counts for a boat and crew, and until when.

Here the rule of validity and the choice of the tow. How decisions of people are written down, and
the freezing of an edition, belong to `warehouse`. A boat without a valid tow is listed as such: the
pair A, B with Cw = 1 of the old spreadsheet never comes back.
"""

import datetime as dt
from collections.abc import Sequence
from typing import Final

import polars as pl

from pipeline.method.definition import RegisterRule
from pipeline.tables.keys import LINE as CREW

LINE: Final = CREW + ("empty_thwart",)
"""What a line is for. A curve measured with a thwart left free holds only with that thwart free
(Sleepproef, R. Pot 2017, "Bemanning"); `NO_EMPTY_THWART` where all are manned."""

NO_EMPTY_THWART: Final = ""
TOW_DAY: Final = LINE + ("tow_date",)
"""What tells tows apart in lists and in print, which have no number of a tow."""
CURVE_COLUMNS: Final = (
    "tow_id",
    "tow_date",
    "valid_until",
    "declared_speed_m_s",
    "a_kg_m",
    "b_m_s",
    "cw_kg_m",
    "cw_lo_kg_m",
    "cw_hi_kg_m",
    "flags",
    "basis",
)
CARRIED_COLUMNS: Final = (
    "tow_date",
    "valid_until",
    "declared_speed_m_s",
    "a_kg_m",
    "b_m_s",
    "cw_kg_m",
    "basis",
)
"""What a printed line says, of those."""

MEASURED: Final = "measured"
"""The basis of a line that was computed from a tow."""

DOUBTED: Final = "doubted"
"""Status of a line whose tows the rest of the archive rules out."""

NEWER_TOW_UNMEASURED: Final = "newer_tow_without_samples"
"""Flag of a line that rests on an older tow, because the newest tow has no samples."""

STUDIED_METHOD: Final = "rebased"
"""The method of today, which is shown first."""

FIRST_PUBLISHED: Final = "as-published-2014"
"""Numbers of 2014 before they were recomputed: a ladder leads from them to the first method."""

EXCLUDE, PREFER = "exclude", "prefer"
DECISION_SCHEMA: Final = {"tow_id": pl.String(), "verdict": pl.String()}
NO_DECISIONS: Final = pl.DataFrame(schema=DECISION_SCHEMA)


def add_empty_thwart(lines: pl.DataFrame) -> pl.DataFrame:
    """Add the column `empty_thwart` to lines that were made before it existed."""
    if "empty_thwart" in lines.columns:
        return lines
    return lines.with_columns(pl.lit(NO_EMPTY_THWART).alias("empty_thwart"))


def name_draft(method: str) -> str:
    """Name of the unpublished edition that a method would give."""
    return f"concept-{method}"


def list_shown_methods(names: Sequence[str]) -> list[str]:
    """Return the methods that are shown: all but `FIRST_PUBLISHED`, unless it is the only one."""
    return [name for name in names if name != FIRST_PUBLISHED] or list(names)


def choose_default_method(names: Sequence[str]) -> str:
    """Return the method, or draft, that is shown where none is asked for.

    It is the best method where that is among `names` or there are none, else the last of them.
    """
    for name in (STUDIED_METHOD, name_draft(STUDIED_METHOD)):
        if name in names:
            return name
    return names[-1] if names else STUDIED_METHOD


def valid_until(tow_date: pl.Expr, rule: RegisterRule) -> pl.Expr:
    """Return the last day on which a tow counts: the end of its last calendar year, or to the day.

    Years after 29 February it is 28 February.
    """
    year = tow_date.dt.year()
    years = pl.lit(rule.valid_years)
    if rule.six_years_from is not None:
        years = pl.when(year >= rule.six_years_from).then(6).otherwise(years)
    if rule.counts_until == "same_day":
        return tow_date.dt.offset_by(pl.format("{}y", years))
    return pl.date(year + years, 12, 31)


def find_reference_day(tows: pl.DataFrame, results: pl.DataFrame) -> dt.date:
    """Return the day on which drafts and the due list judge validity: of the last tow or race.

    Not today: the same archive gives the same tables.
    """
    day: dt.date = max(tows["tow_date"].to_list() + results["race_date"].to_list())
    return day


def draft_register(
    curves: pl.DataFrame,
    tows: pl.DataFrame,
    boats: pl.DataFrame,
    on_date: dt.date,
    rule: RegisterRule,
    decisions: pl.DataFrame = NO_DECISIONS,
    carried: pl.DataFrame | None = None,
) -> pl.DataFrame:
    """Return one line per boat and crew under one method: the newest sound tow, valid or not.

    Args:
        curves: rows of the warehouse's `curves` of one method.
        tows: rows of `tows`.
        boats: listed boats with `fsn_no`, `rowers`, `crew_class`; those never towed are listed too.
        on_date: the day on which validity is judged; later tows do not exist yet.
        rule: how long a tow counts, and which of its estimates.
        decisions: `tow_id` and `verdict`: a tow to `exclude`, or to `prefer` over newer ones.
        carried: printed lines of tows without samples (`pipeline.register.printed.carry_lines`).

    Returns:
        Rows of the table `register`, `as_of` that day. Their status is `valid`, `expired`,
        `never_towed` or one of these. `rejected`: towed, but no tow gives a curve. `doubted`: the
        rest of the archive rules its tows out; a person may look and prefer one. `excluded`: by
        decision, and there is no other tow.
    """
    made_by_then = tows.filter(pl.col("tow_date") <= on_date)
    towed = _add_days(apply_rule(curves, rule), made_by_then)
    curved = towed.filter(pl.col("status") != "rejected")
    sound = curved.join(_find_doubted(tows, decisions), on="tow_id", how="anti")
    history = list_lines_of_all_days(curves, made_by_then, rule, decisions, carried)
    chosen = list_lines_on_days(history, [on_date]).drop("as_of")
    crews = boats.drop_nulls(["rowers", "crew_class"]).select(
        pl.col(LINE[:-1]), pl.lit(NO_EMPTY_THWART).alias("empty_thwart")
    )
    never_towed = crews.join(towed, on="fsn_no", how="anti").join(chosen, on="fsn_no", how="anti")
    without = {
        "excluded": sound.join(chosen, on=LINE, how="anti"),
        DOUBTED: curved.join(sound, on=LINE, how="anti"),
        "rejected": towed.join(curved, on=LINE, how="anti"),
        "never_towed": never_towed,
    }
    parts = [chosen]
    for status, frame in without.items():
        lines = frame.select(LINE).unique()
        parts.append(lines.with_columns(status=pl.lit(status)))
    both = pl.concat(parts, how="diagonal")
    return both.with_columns(pl.lit(on_date).alias("as_of")).sort(LINE)


def list_lines_of_all_days(
    curves: pl.DataFrame,
    tows: pl.DataFrame,
    rule: RegisterRule,
    decisions: pl.DataFrame = NO_DECISIONS,
    carried: pl.DataFrame | None = None,
) -> pl.DataFrame:
    """Return every line that a register of one method had at some time.

    Args:
        curves, tows, rule, decisions, carried: as for `draft_register`.

    Returns:
        `LINE` and `CURVE_COLUMNS` of every tow that can count, in such an order that on any day the
        last one counts whose `tow_date` is not after it.
    """
    curved = _add_days(apply_rule(curves, rule), tows).filter(pl.col("status") != "rejected")
    sound = curved.join(_find_doubted(tows, decisions), on="tow_id", how="anti")
    allowed = sound.join(decisions.filter(verdict=EXCLUDE), on="tow_id", how="anti")
    is_preferred = pl.col("tow_id").is_in(decisions.filter(verdict=PREFER)["tow_id"].implode())
    until = valid_until(pl.col("tow_date"), rule).alias("valid_until")
    lines = allowed.with_columns(until, basis=pl.lit(MEASURED), is_preferred=is_preferred)
    if carried is not None:
        printed = carried.select(pl.col(LINE), pl.col(CARRIED_COLUMNS))
        lines = pl.concat([lines, printed], how="diagonal_relaxed")
    ordered = lines.sort(
        pl.col("is_preferred").fill_null(value=False), "tow_date", "tow_id", maintain_order=True
    )
    return ordered.select(pl.col(LINE), pl.col(CURVE_COLUMNS))


def list_lines_on_days(
    history: pl.DataFrame, days: Sequence[dt.date], key: Sequence[str] = LINE
) -> pl.DataFrame:
    """Return the lines that count on each of some days.

    Args:
        history: what a register had at some time, in the order of `list_lines_of_all_days`.
        days: the days.
        key: the columns that tell lines apart; with `edition`, those of several registers.

    Returns:
        The columns of `history`, with the day as `as_of`, and `status`: `valid` or `expired`.
    """
    days_of = pl.DataFrame({"as_of": days}, schema={"as_of": pl.Date})
    begun = pl.col("tow_date").is_null() | (pl.col("tow_date") <= pl.col("as_of"))
    is_expired = (pl.col("valid_until") < pl.col("as_of")).fill_null(False)
    status = pl.when(is_expired).then(pl.lit("expired")).otherwise(pl.lit("valid"))
    return (
        history.join(days_of, how="cross", maintain_order="left")
        .filter(begun)
        .group_by(["as_of"] + list(key), maintain_order=True)
        .last()
        .with_columns(status.alias("status"))
    )


def list_tow_days(tows: pl.DataFrame) -> pl.DataFrame:
    """Return the line and day of tows: columns `TOW_DAY`."""
    thwart = pl.col("empty_thwart").fill_null(NO_EMPTY_THWART)
    return tows.select(pl.col(LINE[:-1]), thwart, "tow_date")


def find_unmeasured_tows(
    listed: pl.DataFrame, printed: pl.DataFrame, tows: pl.DataFrame, day: dt.date
) -> pl.DataFrame:
    """Return the newest tow of each line, up to a day, that lists or print name without samples.

    Args:
        listed: rows of `listed_tows`, also those without samples.
        printed: rows of `printed_registers`.
        tows: rows of `tows`, all that have samples.
        day: the day.

    Returns:
        Rows of `TOW_DAY`.
    """
    in_print = printed.filter("has_valid_curve").select(TOW_DAY)
    named = pl.concat([list_tow_days(listed), in_print], how="vertical_relaxed")
    unmeasured = named.filter(pl.col("tow_date") <= day).join(
        list_tow_days(tows), on=TOW_DAY, how="anti"
    )
    return unmeasured.group_by(LINE, maintain_order=True).agg(pl.col("tow_date").max())


def flag_unmeasured(
    lines: pl.DataFrame, unmeasured: pl.DataFrame, decisions: pl.DataFrame
) -> pl.DataFrame:
    """Flag valid lines that rest on an older tow than the newest one, which has no samples.

    Args:
        lines: lines of a register.
        unmeasured: rows of `find_unmeasured_tows`.
        decisions: as for `draft_register`; a preferred tow counts whatever is newer.
    """
    newer = unmeasured.select(pl.col(LINE), unmeasured_on="tow_date")
    joined = lines.join(newer, on=LINE, how="left", maintain_order="left")
    preferred = decisions.filter(verdict=PREFER)["tow_id"].to_list()
    is_older = (
        (pl.col("status") == "valid")
        & (pl.col("tow_date") < pl.col("unmeasured_on"))
        & ~pl.col("tow_id").is_in(preferred).fill_null(False)
    )
    flags = pl.col("flags").fill_null([]).list.concat(pl.lit([NEWER_TOW_UNMEASURED]))
    flagged = pl.when(is_older).then(flags).otherwise("flags")
    return joined.with_columns(flagged.alias("flags")).drop("unmeasured_on")


def _add_days(curves: pl.DataFrame, tows: pl.DataFrame) -> pl.DataFrame:
    """Return curves with the day of their tow and the thwart that was left free."""
    thwart = pl.col("empty_thwart").fill_null(NO_EMPTY_THWART)
    return curves.join(
        tows.select("tow_id", "tow_date", thwart), on="tow_id", maintain_order="left"
    )


def _find_doubted(tows: pl.DataFrame, decisions: pl.DataFrame) -> pl.DataFrame:
    """Return tows that the rest of the archive rules out and nobody confirmed."""
    if "doubts" not in tows.columns:
        return tows.clear()
    doubted = tows.filter(pl.col("doubts").list.len() > 0)
    return doubted.join(decisions.filter(verdict=PREFER), on="tow_id", how="anti")


def apply_rule(curves: pl.DataFrame, rule: RegisterRule) -> pl.DataFrame:
    """Return curves with the estimate that the rule asks for; A follows Cw, B stays."""
    if rule.estimate == "as_measured":
        return curves
    has_best = pl.when(pl.col("cw_best_kg_m").is_not_null())
    ratio = has_best.then(pl.col("cw_best_kg_m") / pl.col("cw_kg_m")).otherwise(1.0)
    return curves.with_columns(
        a_kg_m=pl.col("a_kg_m") * ratio,
        cw_kg_m=has_best.then("cw_best_kg_m").otherwise("cw_kg_m"),
        cw_lo_kg_m=has_best.then("cw_best_lo_kg_m").otherwise("cw_lo_kg_m"),
        cw_hi_kg_m=has_best.then("cw_best_hi_kg_m").otherwise("cw_hi_kg_m"),
    )
