"""The closing summary of a rebuild."""

from dataclasses import dataclass

from assets.report import Report
from dashboards.statements.rebuild import headlines
from herijk.cli.render import page, place, section, speech, table, why_set_aside
from pipeline.messages import tell
from pipeline.tables.row import Row
from warehouse.queries.reports import RebuildReport


@dataclass(frozen=True)
class Rebuilt:
    """What a rebuild did, and what the tables hold now.

    Attributes:
        report: what the tables hold.
        since: what the rebuild did, and what changed.
    """

    report: RebuildReport
    since: Report


def text(made: Rebuilt) -> str:
    """What was done, what that changed, what was set aside, and where the results are."""
    report, news = made.report, made.since
    done = tell("Nothing changed: no file was read again, all tables are up to date.")
    if news.done.database:
        seasons = ", ".join(map(str, news.done.seasons)) or tell("none")
        methods = ", ".join(news.done.methods) or tell("none")
        done = tell("Seasons read: {}. Methods applied: {}.", seasons, methods)
    lines = [line(speech()) for line in headlines(news, news.checks)]
    tows = ", ".join(f"{row['season']}: {row['tows']}" for row in report.seasons)
    places = tell("Tables: {}\nSite: {}\nReport: {}", report.database, report.site, report.report)
    since = section(tell("Since the last report:"), *(f"  {line}" for line in lines))
    parts = [done, since, tell("Tows accepted: ") + tows, _set_aside(report), places]
    return page(parts, report.simulated)


def _set_aside(report: RebuildReport) -> str:
    """How much was set aside, and the first fault of each cause."""
    if not report.set_aside:
        return tell("Set aside: nothing.")
    counted = [row | {"lost": f"lost_{row['lost']}"} for row in report.set_aside]
    shown = sum(fault["number"] for fault in report.first_faults)
    more = sum(row["number"] for row in report.set_aside) - shown
    return section(
        tell("Set aside:"),
        table(counted, "lost reason_code number"),
        *map(_fault, report.first_faults),
        tell("  and {} more: see the table quarantine", more) if more else "",
    )


def _fault(fault: Row) -> str:
    more = tell(" and {} more", fault["number"] - 1) if fault["number"] > 1 else ""
    return f"  {place(fault)}{more}: {why_set_aside(fault)}"
