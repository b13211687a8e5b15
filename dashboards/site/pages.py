"""Which page shows what. A section whose tables and charts hold no rows is left out."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cache, partial

import polars as pl

from dashboards.addresses import edition_page, race_path
from dashboards.site.glossary import words_page
from dashboards.site.parts import (
    Chart,
    Page,
    Section,
    Table,
    editions_select,
    methods_select,
    with_page,
)
from dashboards.site.prose import audit_guide, edition_pages, guide_links, method_pages
from dashboards.site.start import ABOUT, MENU, RELATIVE, season_change, start_page
from dashboards.site.types import type_pages, types_page
from dashboards.site.years import years_page
from dashboards.speech import Headline
from dashboards.statements import due as of_due
from dashboards.statements import edition, season
from dashboards.statements.race import winners
from pipeline.messages import Sentence, say
from pipeline.register.register import default_method
from warehouse.derive.studies import FIRST_PUBLISHED, JUDGEMENT
from warehouse.queries.answers import line_changes, race_chances
from warehouse.queries.views import Views


def shared_pages(views: Views, by_reports: bool) -> dict[str, Callable[[], Iterable[Page]]]:
    """What makes the pages of the site but those of boats, by what they show."""
    methods = method_names(views)
    changes = cache(partial(line_changes, views))
    return {
        "start": lambda: [start_page(views, methods, changes(), by_reports)],
        "register": lambda: [_register(views, methods)],
        "boats": lambda: [_boats(views, methods)],
        "types": lambda: [types_page(views, methods)],
        "of types": lambda: type_pages(views, methods),
        "seasons": lambda: [_seasons(views, methods)],
        "changes": lambda: [_changes(views, methods, changes())],
        "years": lambda: [years_page(views, methods)],
        "races": lambda: _races(views, methods),
        "about": lambda: [_about()],
        "quality": lambda: [_quality(views, methods)],
        "words": lambda: [words_page()],
        "methods": lambda: method_pages(views, methods),
        "audits": lambda: [audit_guide()],
        "editions": lambda: edition_pages(views),
    }


def method_names(views: Views) -> list[str]:
    """Return the names of the methods that pages show, in the order of the database.

    How 2014 was first printed is left out, unless it is the only method.
    """
    names = views.table("methods")["method"].to_list()
    return [name for name in names if name != FIRST_PUBLISHED] or names


def _register(views: Views, methods: Sequence[str]) -> Page:
    lines = views.register()
    published = views.table("editions")
    select = editions_select("edition", lines["edition"], methods)
    table = Table(
        "register",
        lines,
        "name fsn_no boat_type rowers crew_class empty_thwart tow_date valid_until status flags "
        "declared_speed_m_s a_kg_m b_m_s cw_kg_m cw_lo_kg_m cw_hi_kg_m waterline_length_m "
        "beam_m bow_height_m weight_kg verification_code",
        follows=["edition"],
        search=True,
        cards="name fsn_no boat_type rowers crew_class cw_kg_m cw_lo_kg_m cw_hi_kg_m valid_until "
        "status flags",
    )
    register = Section(
        "register",
        say("Register"),
        edition.REGISTER,
        tables=[table],
        headline=edition.register(lines.filter(edition=select.chosen)),
    )
    editions = Section(
        "editions",
        say("Published editions"),
        links=[(edition_page(name), name, "") for name in published["edition"]],
        tables=[
            Table(
                "editions",
                published,
                "edition method valid_from published_on decision previous code_version seal",
            )
        ],
    )
    return Page("register.html", say("Register"), [register, editions], selects=[select])


def _boats(views: Views, methods: Sequence[str]) -> Page:
    """Return the page of who has to tow again, and at what speed."""
    rows = views.ask("due_list").filter(method=default_method(methods))
    rows = rows.rename({"tow_date": "last_tow"})
    due = Table(
        "due_list",
        rows,
        "name fsn_no boat_type rowers crew_class empty_thwart valid_until status "
        "tow_speed_m_s speed_reason beyond_curve declared_speed_m_s power_w raced_speed_m_s "
        "lowest_speed_m_s highest_speed_m_s last_tow as_of",
        search=True,
        cards="name fsn_no rowers crew_class valid_until status tow_speed_m_s",
    )
    due_list = Section(
        "due_list",
        say("Who has to tow again"),
        of_due.SPEEDS,
        tables=[due],
        headline=of_due.due(rows),
    )
    return Page("boats.html", say("Boats"), [due_list])


def _seasons(views: Views, methods: Sequence[str]) -> Page:
    """What was wrong with the instruments of each season, and how well repeat tows agree."""
    first, shown = default_method(methods), pl.col("method").is_in(methods)

    def rows(name: str) -> pl.DataFrame:
        return views.table(name).filter(shown)

    logs, spread = rows("log_factors"), rows("reproducibility")
    sections = [
        season_change("season_change", RELATIVE, views, methods),
        _drawn(
            "log_factors",
            say("Log factor per season"),
            say("True speed = log speed x factor. A factor without a bar has no known interval."),
            logs,
            headline=season.log_factors(logs.filter(method=first)),
        ),
        _drawn(
            "reproducibility",
            say("Spread of one tow"),
            say(
                "Standard deviation of one tow from repeats of unaltered boats, with 95 % "
                "interval. Lower is better."
            ),
            spread,
            headline=season.reproducibility(spread, first),
        ),
        _drawn(
            "ladder",
            say("What each step does"),
            say(
                "Factor on Cw of each step, geometric mean over a season's tows. The factors of a "
                "season multiply to the total."
            ),
            views.table("season_ladder"),
            to_method="method",
        ),
        _drawn(
            "options",
            say("Sensitivity to choices"),
            say(
                "How Cw would change if one choice were made otherwise: median and the middle 90 % "
                "of tows."
            ),
            views.table("option_summary").filter(study=JUDGEMENT),
        ),
        _drawn(
            "era_shifts",
            say("Does an era differ?"),
            say(
                "Next tow of the same boats, in a later era, against that in the era itself, "
                "without ageing: median of n pairs with 95 % interval, all types together."
            ),
            rows("era_shifts").filter(boat_type="all").drop_nulls("shift_ratio"),
            "eras",
        ),
        _drawn(
            "repeat_pairs",
            say("Every pair"),
            say(
                "New Cw / old Cw, at the season of the new tow. E_n: the difference divided by "
                "both intervals together; beyond 1 two tows disagree. Where these are the spread "
                "of the runs alone, that may be the log's error. Click a point to go to the boat."
            ),
            with_page(views.ask("repeat_pairs").filter(shown)),
            "repeats",
        ),
        _season_links(views),
        _season_levels(views),
        _season_diagnosis(views),
    ]
    selects = [methods_select(methods)]
    return Page("seasons.html", say("Seasons"), sections, selects=selects)


def _drawn(
    name: str,
    title: Sentence,
    note: Sentence,
    rows: pl.DataFrame,
    figure: str = "",
    headline: Headline | None = None,
    **follows: str,
) -> Section:
    """A section of one chart, called as its figure unless said otherwise; open with a headline."""
    chart = Chart(figure or name, [rows], follows=follows)
    return Section(name, title, note, [chart], headline=headline, folded=headline is None)


PART = pl.col("part") + 1
"""Parts of a season as people count them."""


def _season_links(views: Views) -> Section:
    links = views.table("season_links").with_columns(PART)
    return Section(
        "season_links",
        say("What a log factor rests on"),
        say(
            "Where a log was replaced within a season each part has its own factor; "
            "the chart above shows their mean."
        ),
        tables=[
            Table(
                "season_links",
                links,
                "season part source n_tows n_links factor lo hi",
                follows=["method"],
            )
        ],
        folded=True,
    )


def _season_levels(views: Views) -> Section:
    """What all tows of each season have in common."""
    levels = views.ask("season_diagnosis").filter(instrument="season_level")
    columns = "season verdict size size_lo size_hi unit"
    return Section(
        "season_levels",
        say("Level of each season"),
        season.LEVEL,
        tables=[Table("season_levels", levels, columns, follows=["method"])],
        folded=True,
    )


SOUND_VERDICTS = ("sound", "estimated")


def _season_diagnosis(views: Views) -> Section:
    """What may be wrong with the instruments of a season."""
    is_level = (pl.col("instrument") == "season_level") & (pl.col("verdict") != "alarm")
    doubted = views.ask("season_diagnosis").filter(
        ~pl.col("verdict").is_in(SOUND_VERDICTS) & ~is_level
    )
    # What else it could be: the kinds, without their seasons.
    rows = doubted.with_columns(
        PART, pl.col("confused_with").str.replace_all(r" \d+", "").str.replace_all(", ", ",")
    )
    return Section(
        "season_diagnosis",
        say("Instruments by season"),
        season.DIAGNOSIS,
        tables=[
            Table(
                "season_diagnosis",
                rows,
                "season part instrument verdict p_fault size size_lo size_hi unit first_tow "
                "shown_by confused_with",
                follows=["method"],
            )
        ],
        folded=True,
    )


def _changes(views: Views, methods: Sequence[str], changes: pl.DataFrame) -> Page:
    """What changes from one edition to the next, and the races computed again by both."""
    changed = changes.filter(pl.col("change") != "same")
    days = views.race_days()
    select = editions_select("to_edition", changed["to_edition"], methods)
    table = Table(
        "changes",
        changed,
        "name fsn_no rowers crew_class change old_cw_kg_m new_cw_kg_m cw_ratio "
        "gain_in_two_hours_s exceeds_interval old_speed_rank new_speed_rank causes",
        follows=["to_edition"],
        search=True,
        cards="name fsn_no rowers crew_class old_cw_kg_m new_cw_kg_m gain_in_two_hours_s "
        "exceeds_interval",
    )
    drawn = changed.select(*DRAWN_CHANGES).drop_nulls("gain_in_two_hours_s")
    chart = Chart(
        "changes",
        [drawn],
        say("Time that crews gain or lose in two hours"),
        {"to_edition": "to_edition"},
    )
    lines = Section(
        "changes_list",
        say("Changed lines"),
        say(
            "New / old: at the old declared speed; power changes as much. In 2 h: seconds "
            "that the crew may take longer (+) or has to be faster (-) for the same power. "
            "Speed rank: among all boats of the class at equal power, not the place in a "
            "race. The causes multiply to Cw new / old."
        ),
        [chart],
        [table],
        headline=edition.changes(changes.filter(to_edition=select.chosen)),
    )
    if changed.is_empty():
        lines = Section(lines.name, lines.title, empty=say("There are no changed lines."))
    races = Section(
        "races",
        say("Races"),
        say("Every result computed again by the old and the new edition; choose a race."),
        links=[(race_path(race, day), f"{race} {day}", "") for race, day in days],
    )
    if not days:
        none = say("The archive holds no races to compute again.")
        races = Section(races.name, races.title, empty=none)
    selects = [select] if changed.height else []
    return Page("changes.html", MENU["changes"], [lines, races], selects=selects)


DRAWN_CHANGES = ("to_edition", "fsn_no", "name", "rowers", "crew_class", "gain_in_two_hours_s")


def _races(views: Views, methods: Sequence[str]) -> Iterator[Page]:
    """A page for each race."""
    races = views.ask("races")
    if races.is_empty():
        return
    select = editions_select("to_edition", races["to_edition"], methods)
    now = races.filter(to_edition=select.chosen)
    chances = race_chances(views, now["from_edition"][0], select.chosen)
    for race, day in views.race_days():
        table = Table(
            "race_changes",
            races.filter(race=race, race_date=day),
            "name fsn_no crew_class rowers rowing_time_s old_power_w new_power_w old_rank "
            "new_rank podium_changed old_remark new_remark",
            follows=["to_edition"],
            search=True,
            cards="name fsn_no new_power_w old_rank new_rank",
        )
        results = Section(
            "race_results",
            say("Results by both editions"),
            say(
                "Power per rower in this race, and the place by it, by class: among the crews "
                "that have a valid line on that day in both editions."
            ),
            tables=[table],
            headline=winners(now.filter(race=race, race_date=day), chances),
        )
        path, name = race_path(race, day), f"{race} {day}"
        yield Page(path, say("Races"), [results], name=name, selects=[select])


def _about() -> Page:
    """The method, what the words mean, and how the data fared."""
    links = [*guide_links(), *((f"{name}.html", *texts) for name, texts in ABOUT.items())]
    where = say("Where to find what")
    return Page("about.html", MENU["about"], [Section("about_pages", where, links=links)])


def _quality(views: Views, methods: Sequence[str]) -> Page:
    statuses = views.ask("statuses").filter(method=default_method(methods))
    by_method = ["method"]
    flags = Table(
        "flagged_boats",
        views.ask("flagged_boats"),
        "flag name fsn_no rowers crew_class tow_date",
        follows=by_method,
    )
    reasons = Table("run_reasons", views.ask("counts", "run"), "code number", follows=by_method)
    checks = Table(
        "check_counts", views.ask("checks"), "check severity tows beyond", follows=by_method
    )
    sections = [
        Section("statuses", say("Status of the curves"), headline=season.statuses(statuses)),
        _set_aside(views),
        Section(
            "flags",
            say("Flags"),
            say("A flag says what a person should look at; it never changes a number."),
            tables=[flags],
        ),
        Section("run_reasons", say("Runs that do not count"), tables=[reasons]),
        Section(
            "checks",
            say("What the checks found"),
            say(
                "On how many tows each check was made, and how often something lay "
                "beyond its limit."
            ),
            tables=[checks],
        ),
    ]
    return Page("quality.html", say("Quality"), sections, selects=[methods_select(methods)])


def _set_aside(views: Views) -> Section:
    faults = views.table("quarantine").with_columns(
        lost="lost_" + pl.col("lost"), messages=pl.concat_list("message_nl", "message")
    )
    return Section(
        "set_aside",
        say("Set aside"),
        say("Files, lines and tows not used, with the reason."),
        tables=[
            Table(
                "quarantine",
                faults,
                "path tow_id line lost run lost_s reason_code messages first_seen",
                search=True,
            )
        ]
        if faults.height
        else [],
        empty=None if faults.height else say("Nothing was set aside."),
    )
