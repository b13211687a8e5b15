"""The page about a rebuild: what came in, what was set aside, what changed and why, the checks.

It lies beside the site and uses its style.
"""

from collections.abc import Sequence
from typing import Final

import polars as pl
from markupsafe import Markup

from dashboards.site.parts import Page, Section, Table
from dashboards.site.render import Edition
from dashboards.statements.rebuild import (
    PAGES,
    Check,
    LastRun,
    describe_run,
    in_short,
    judged,
    outcome_of,
    show_minute,
    values_found,
    verdict,
)
from pipeline.messages import LANGUAGES, pgettext, say, speaker
from warehouse.queries.change_report import ChangeReport
from warehouse.queries.views import Views
from warehouse.store.store import Store

TO_SITE: Final = "../site/"

OF_A_CHECK: Final = "check outcome quantity value"
_TITLES: Final = {
    "lines": say("Changed lines of the drafts"),
    "tows": pgettext("number", "Tows"),
    "set_aside": say("Set aside"),
    "factors": say("Log factors that moved"),
    "checks": say("Checks"),
}
_COLUMNS: Final = {
    "tows": "what tow_id fsn_no season",
    "set_aside": "what path tow_id line reason_code message",
    "factors": "method season old_factor new_factor ratio",
    "lines": (
        "to_edition name fsn_no rowers crew_class change old_cw_kg_m new_cw_kg_m cw_ratio "
        "gain_in_two_hours_s exceeds_interval causes"
    ),
    "checks": OF_A_CHECK,
}


def report_pages(
    store: Store, changes: ChangeReport, checks: Sequence[Check], run: LastRun
) -> dict[str, str]:
    """Return the page by its file name, in each language.

    It has what came in, what was set aside, what changed and why, what the checks say, and when and
    how the last run ended.
    """
    of_checks = pl.DataFrame(
        [
            [check.check, outcome_of(check), *found]
            for check in sorted(checks, key=lambda check: check.passed)
            for found in ([("", "")] if check.passed else values_found(check))
        ],
        schema=dict.fromkeys(OF_A_CHECK.split(), pl.String),
        orient="row",
    )
    changed = ("lines", "tows", "set_aside", "factors")
    frames = {
        name: pl.DataFrame(getattr(changes, name), infer_schema_length=None) for name in changed
    } | {"checks": of_checks}
    sections = [
        Section(f"report_{name}", _TITLES[name], tables=[Table(name, frame, _COLUMNS[name])])
        if frame.height
        else Section(f"report_{name}", _TITLES[name], empty=say("Nothing."))
        for name, frame in frames.items()
    ]
    in_words = Section(
        "report_summary",
        say("In short"),
        headline=verdict(changes, checks),
        state="good" if all(check.passed for check in checks) else "bad",
        prose=lambda speech: Markup("<p>{}</p><p>{}</p><p>{}</p>").format(
            in_short(changes)(speech),
            judged(changes)(speech),
            " ".join(line(speech) for line in describe_run(run)),
        ),
    )
    changed_at = show_minute(run.changed_at)
    with Views(store) as views:
        return {
            PAGES[language]: Edition(views, language).html(
                Page(
                    PAGES[language],
                    say("Report of the rebuild"),
                    [in_words, *sections],
                    name=f"{speaker(language)('Report of the rebuild')} {changed_at}",
                    site=TO_SITE,
                    others=PAGES,
                )
            )
            for language in LANGUAGES
        }
