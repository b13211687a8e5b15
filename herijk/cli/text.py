"""Results as text for a person: one function per command, from plain data to lines.

The pages of `herijk audit` are in `cli.audit_text`.
"""

import re
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Final

from dashboards.labels import code_in_words
from pipeline.messages import LANGUAGE, headings, in_per_cent, number, say, spoken, tell
from pipeline.tables.row import Row

if TYPE_CHECKING:
    from assets.report import Done
    from warehouse.queries.rebase import RebaseReport
    from warehouse.queries.reports import LogErrorReport, RebuildReport


SIMULATED = say("SIMULATED archive: made by `herijk simulate`, not the federation's measurements.")

_NUMBER: Final = re.compile(r"[-+]?[0-9]+([.,][0-9]+)?( %| N)?\*?|-?")
"""A cell that is aligned to the right."""


def page(parts: Iterable[str], simulated: bool) -> str:
    """Paragraphs; the first says so where the archive is simulated."""
    return "\n\n".join([*([tell(SIMULATED)] if simulated else []), *parts])


def table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Columns lined up, their heads in words; numbers to the right."""
    cells = [[_cell(value) for value in row] for row in rows]
    columns = zip([tell(title) for title in head], *cells, strict=True)
    lines = zip(*map(_lined_up, columns), strict=True)
    return "\n".join(f"  {'  '.join(line).rstrip()}" for line in lines)


def _lined_up(column: Sequence[str]) -> list[str]:
    """A heading and the cells below it, all of one width."""
    width = max(map(len, column))
    to_the_right = all(map(_NUMBER.fullmatch, column[1:]))
    return [cell.rjust(width) if to_the_right else cell.ljust(width) for cell in column]


def _cell(value: object) -> str:
    if value is None:
        return "-"
    if isinstance(value, float):
        return number(value, ".3f")
    return str(spoken(value, LANGUAGE.get()))


def decimals(value: float | None, digits: int) -> str:
    """A number with so many decimals, a dash where it is not known."""
    return "-" if value is None else number(value, f".{digits}f")


def boat(row: Row) -> tuple[str, str, str]:
    """A boat's number, its name, and its crew."""
    return row["fsn_no"], row["name"] or "-", f"{row['rowers']}{row['crew_class']}"


def window(run: Row) -> str:
    """The seconds of a run that count."""
    if run["window_start_s"] is None:
        return "-"
    return f"{run['window_start_s']:.0f}-{run['window_end_s']:.0f}"


def _in_two_hours(row: Row) -> str:
    """What a line of the register gives in a race of two hours."""
    return f"{7200 * (row['time_ratio'] - 1):+.0f} s"


def _per_cent(ratio: float | None) -> str:
    return "-" if ratio is None else number(100 * (ratio - 1), "+z.1f") + " %"


def rebuild(report: "RebuildReport", done: "Done", headlines: list[str]) -> str:
    """The closing summary of a rebuild."""
    tows = ", ".join(f"{row['season']}: {row['tows']}" for row in report.seasons)
    curves = [(r["method"], code_in_words(r["status"]), r["number"]) for r in report.curves]
    parts = [
        _work_done(done),
        tell("Since the last report:\n") + "\n".join(f"  {line}" for line in headlines),
        tell("Tows accepted: ") + tows,
        *_set_aside(report),
        tell("Curves:\n") + table(headings("method", "status", "number"), curves),
    ]
    if report.by_season:
        parts.append(_by_season(report.by_season))
    if report.biggest_changes:
        parts.append(_biggest(report.biggest_changes))
    places = tell("Tables: {}\nSite: {}\nReport: {}", report.database, report.site, report.report)
    return page([*parts, places], report.simulated)


def _work_done(done: "Done") -> str:
    if not done.database:
        return tell("Nothing changed: no file was read again, all tables are up to date.")
    seasons = ", ".join(str(s) for s in done.seasons) or tell("none")
    methods = ", ".join(done.methods) or tell("none")
    return tell("Seasons read: {}. Methods applied: {}.", seasons, methods)


def _set_aside(report: "RebuildReport") -> list[str]:
    """How much was set aside, and the first fault of each cause."""
    if not report.set_aside:
        return [tell("Set aside: nothing.")]
    rows = [
        (code_in_words("lost_" + r["lost"]), r["reason_code"], r["number"])
        for r in report.set_aside
    ]
    counted = tell("Set aside:\n") + table(headings("lost", "reason", "number"), rows)
    return [counted, _faults(report.first_faults, sum(number for *_, number in rows))]


def _faults(first: list[Row], number: int) -> str:
    lines = []
    for fault in first:
        more = tell(" and {} more", fault["number"] - 1) if fault["number"] > 1 else ""
        lines.append(f"  {place(fault)}{more}: {why_set_aside(fault)}")
    told = sum(fault["number"] for fault in first)
    if number > told:
        lines.append(tell("  and {} more: see the table quarantine", number - told))
    return "\n".join(lines)


def why_set_aside(fault: Row) -> str:
    """What is wrong with something that was set aside."""
    return str(fault["message_nl" if LANGUAGE.get() == "nl" else "message"])


def place(fault: Row) -> str:
    """Where a fault is: its file, and the line and the tow where these are known."""
    said = fault["line"] is None or fault.get("message", "").startswith(f"Line {fault['line']}:")
    line = "" if said else tell(", line {}", fault["line"])
    tow = "" if fault["tow_id"] is None else tell(" (tow {})", fault["tow_id"])
    return f"{fault['path']}{line}{tow}"


def _by_season(rows: list[Row]) -> str:
    ends = headings("median", "lowest", "highest")
    lines = [
        (r["method"], r["season"], r["tows"], *(_per_cent(r[f"{end}_ratio"]) for end in ends))
        for r in rows
    ]
    title = tell("Change of Cw at the declared speed against {}:\n", rows[0]["compared_with"])
    return title + table((say("method"), say("season"), say("tows"), *ends), lines)


def _biggest(rows: list[Row]) -> str:
    lines = [(r["to_edition"], *boat(r), _per_cent(r["cw_ratio"]), _in_two_hours(r)) for r in rows]
    head = headings("register", "boat", "name", "crew", "Cw", "in 2 h at equal power")
    return tell("Biggest changes against {}:\n", rows[0]["from_edition"]) + table(head, lines)


def methods(report: Row) -> str:
    """The list of methods."""
    rows = [(m["method"], m["title"], m["content_hash"][:12]) for m in report["methods"]]
    return table(headings("method", "title", "hash"), rows)


PLOT_WIDTH = 41
PLOT_RANGE = (0.94, 1.08)


def log_error(report: "LogErrorReport") -> str:
    """The season table with a small plot of each factor and its interval."""
    parts = [
        tell("True speed = log speed x factor, under {} (95 % intervals):", report.method),
        _factors(report.factors),
        _plots(report.factors),
        tell(
            "links: boats also towed in other seasons; step is of: whether the season "
            "differs by its\nlog or by its load cell (force), as the bend of the same "
            "boats' curves tells; prescribed:\nnothing ties the season to one with dGPS, "
            "so its factor is not determined and the method's\nprescribed one is used."
        ),
    ]
    lacking = _seasons_between([r["season"] for r in report.factors])
    if lacking:
        parts.append(tell("No sound tow in {}: nothing is known of the log there.", lacking))
    if report.parts:
        parts += [
            tell("Each log, and each part of a season in which one was replaced:"),
            _parts(report.parts),
        ]
    parts += [tell("What may be wrong with the instruments of a season:"), _diagnosis(report)]
    return page(parts, report.simulated)


def _factors(factors: list[Row]) -> str:
    head = headings("season", "factor", "from", "to", "source", "tows", "links", "step is of")
    rows = [
        (
            r["season"],
            *_factor(r),
            code_in_words(r["cause"]),
        )
        for r in factors
    ]
    return table(head, rows)


def _factor(row: Row) -> tuple[object, ...]:
    """A factor with its interval, where it is from, and on how many tows and links it rests."""
    ends = (decimals(row[name], 4) for name in ("factor", "lo", "hi"))
    return (*ends, code_in_words(row["source"]), row["n_tows"], row["n_links"])


def _plots(factors: list[Row]) -> str:
    low, high = PLOT_RANGE
    place = _place_on_line(1.0)
    scale = f"{number(low, '.2f'):<{place}}{'1':<{PLOT_WIDTH - place - 4}}{number(high, '.2f')}"
    return "\n".join([f"  {'':4}  {scale}", *(f"  {r['season']}  {_plot(r)}" for r in factors)])


def _seasons_between(seasons: list[int]) -> str:
    """Seasons that are missing between the first and the last."""
    every = range(min(seasons, default=0), max(seasons, default=0))
    return ", ".join(str(season) for season in every if season not in seasons)


def _diagnosis(report: "LogErrorReport") -> str:
    """Faults that were found, or that cannot be told."""
    if not report.diagnosis:
        return tell("  nothing was found, and nothing is in doubt")
    head = headings("season", "what", "verdict", "size", "from", "to", "chance", "or else")
    rows = [
        (
            r["season"],
            _what(r),
            code_in_words(r["verdict"]),
            *(_size(r[name], r["unit"]) for name in ("estimate", "lo", "hi")),
            "-" if r["p_fault"] is None else in_per_cent(r["p_fault"]),
            _or_else(r["confused_with"]),
        )
        for r in report.diagnosis
    ]
    note = tell(
        "would not show: a fault of the usual size would be taken for what is given under "
        "'or else'. The interval\ncounts how seldom such a fault is, so where nothing points to "
        "one it can be 0 to 0."
    )
    return f"{table(head, rows)}\n\n{note}"


def _or_else(confused_with: str | None) -> str:
    """What else would explain it: kinds of faults, and their seasons."""
    if confused_with is None:
        return "-"
    kinds = (kind.partition(" ") for kind in confused_with.split(", "))
    return ", ".join(f"{code_in_words(kind)}{space}{season}" for kind, space, season in kinds)


def _what(row: Row) -> str:
    """What may be wrong, in words, and from which tow on."""
    words = code_in_words(row["instrument"])
    return words if row["first_tow"] is None else tell("{}, from {}", words, row["first_tow"])


def _size(value: float, unit: str) -> str:
    return number(value, "+z.1f") + " N" if unit == "N" else number(100 * value, "+z.1f") + " %"


def _parts(parts: list[Row]) -> str:
    head = headings("season", "part", "factor", "from", "to", "source", "tows", "links")
    return table(head, [(r["season"], r["part"] + 1, *_factor(r)) for r in parts])


def _plot(row: Row) -> str:
    """A line of text: the interval as dashes, the factor as o, no error at the bar."""
    marks = [" "] * PLOT_WIDTH
    marks[_place_on_line(1.0)] = "|"
    if row["lo"] is not None and row["hi"] is not None:
        for i in range(_place_on_line(row["lo"]), _place_on_line(row["hi"]) + 1):
            marks[i] = "-"
    marks[_place_on_line(row["factor"])] = "o"
    return "".join(marks).rstrip()


def _place_on_line(factor: float) -> int:
    low, high = PLOT_RANGE
    place = round((factor - low) / (high - low) * (PLOT_WIDTH - 1))
    return min(max(place, 0), PLOT_WIDTH - 1)


def rebase(report: "RebaseReport") -> str:
    """What a method changes: the ladder per season, and the boats most affected."""
    counts = ", ".join(f"{row['count']} {code_in_words(row['change'])}" for row in report.changes)
    seasons = report.by_season
    steps = [key for key in seasons[0] if key not in ("season", "tows", "total")]
    season_head = (say("season"), say("tows"), *map(code_in_words, steps), say("total"))
    lines = [
        (row["season"], row["tows"], *(_per_cent(row[step]) for step in (*steps, "total")))
        for row in seasons
    ]
    boats = [
        (
            *boat(row),
            *(_per_cent(row[step]) for step in (*steps, "cw_ratio")),
            _in_two_hours(row),
        )
        for row in report.boats
    ]
    boat_head = (
        say("boat"),
        say("name"),
        say("crew"),
        *map(code_in_words, steps),
        say("Cw"),
        say("in 2 h"),
    )
    by_step = tell(
        "Change of Cw at the declared speed by each step, median of the season's "
        "tows; a tow's\nown steps multiply to its total, medians need not:\n"
    )
    parts = [
        tell("{} against {}; nothing was stored.", report.method, report.against),
        tell("Register lines: {}.", counts),
        by_step + table(season_head, lines),
        tell("Register lines most affected:\n") + table(boat_head, boats),
    ]
    return page(parts, report.simulated)
