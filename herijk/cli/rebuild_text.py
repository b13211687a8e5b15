"""The closing summary of a rebuild."""

from collections.abc import Iterator
from dataclasses import dataclass

from assets.report import Report
from dashboards.statements.rebuild import describe_run, headlines, judged
from herijk.cli.render import Part, Section, marked, set_aside
from pipeline.messages import tell
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


@dataclass(frozen=True)
class NoTowsYet:
    """What a rebuild of a new archive says: nothing was made, because no tow can be used yet.

    Attributes:
        reason: why, and what to do.
    """

    reason: str


def text(made: Rebuilt) -> Iterator[Part]:
    """What was done, what that changed, what was set aside, and where the results are."""
    report, done = made.report, made.since.done
    yield marked(report.simulated)
    yield (
        tell(
            "Seasons read: {}. Methods applied: {}.",
            ", ".join(map(str, done.seasons)) or tell("none"),
            ", ".join(done.methods) or tell("none"),
        )
        if done.database
        else tell("Nothing changed: no file was read again, all tables are up to date.")
    )
    news = [*headlines(made.since, made.since.checks), *describe_run(made.since.last_run)]
    yield Section(tell("Since the last report:"), news)
    tows = ", ".join(f"{row['season']}: {row['tows']}" for row in report.seasons)
    yield Section(tell("Tows by season: ") + tows, [judged(made.since)])
    yield from _set_aside(report)
    yield tell("Tables: {}\nSite: {}\nReport: {}", report.database, report.site, report.report)


def _set_aside(report: RebuildReport) -> Iterator[Part]:
    """How much was set aside, and the first fault of each cause."""
    counted = [row | {"lost": f"lost_{row['lost']}"} for row in report.set_aside]
    yield Section(
        tell("Set aside:"),
        rows=counted,
        columns="lost reason_code number",
        empty=tell("nothing"),
    )
    faults = [
        set_aside(fault, tell(" and {} more", fault["number"] - 1) if fault["number"] > 1 else "")
        for fault in report.first_faults
    ]
    shown = sum(fault["number"] for fault in report.first_faults)
    more = sum(row["number"] for row in report.set_aside) - shown
    if more:
        faults.append(tell("  and {} more: see the table quarantine", more))
    yield Section(lines=faults)
