"""Which page shows what. A section is there only if its table is, and holds rows."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cache, partial
from typing import Final

import polars as pl

from dashboards.addresses import edition_page, race_path
from dashboards.site.glossary import words_page
from dashboards.site.methods import method_pages
from dashboards.site.parts import (
    Chart,
    Page,
    Section,
    Table,
    default_method,
    draft_of,
    editions_select,
    listed,
    methods_select,
    with_page,
)
from dashboards.site.prose import audit_guide, edition_pages, guide_links
from dashboards.site.start import ABOUT, MENU, start_page
from dashboards.site.types import type_pages, types_page
from dashboards.statements import due as of_due
from dashboards.statements import edition, season
from dashboards.statements.race import Chances, winners
from pipeline.messages import Sentence, say
from warehouse.derive.studies import FIRST_PUBLISHED, JUDGEMENT
from warehouse.queries.answers import line_changes, newest_edition, race_chances
from warehouse.queries.views import Views


def shared_pages(views: Views, by_reports: bool) -> dict[str, Callable[[], Iterable[Page]]]:
    """What makes the pages of the site but those of boats and slides, by what they show."""
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
        "races": lambda: _races(views, methods),
        "about": lambda: [_about()],
        "quality": lambda: [_quality(views, methods)],
        "words": lambda: [words_page()],
        "methods": lambda: method_pages(views, methods),
        "audits": lambda: [audit_guide()],
        "editions": lambda: edition_pages(views),
    }


def method_names(views: Views) -> list[str]:
    """Names of the methods, in the order of the database, but for how 2014 was first printed."""
    return [name for name in views.table("methods")["method"] if name != FIRST_PUBLISHED]


REGISTER_COLUMNS = (
    *("name", "fsn_no", "boat_type", "rowers", "crew_class", "empty_thwart", "tow_date"),
    *("valid_until", "status"),
    *("declared_speed_m_s", "a_kg_m", "b_m_s", "cw_kg_m", "cw_lo_kg_m", "cw_hi_kg_m"),
    *("waterline_length_m", "beam_m", "bow_height_m", "weight_kg"),
    "verification_code",
)
REGISTER_CARDS = (
    *("name", "fsn_no", "boat_type", "rowers", "crew_class", "cw_kg_m", "cw_lo_kg_m"),
    *("cw_hi_kg_m", "valid_until", "status"),
)
EDITION_COLUMNS = (
    *("edition", "method", "valid_from", "published_on", "decision", "previous"),
    *("code_version", "seal"),
)


def _register(views: Views, methods: Sequence[str]) -> Page:
    lines = views.register()
    editions = lines["edition"].unique().sort().to_list()
    chosen = newest_edition(editions, draft_of(methods))
    table = Table(
        "register", lines, REGISTER_COLUMNS, follows=["edition"], search=True,
        cards=REGISTER_CARDS,
    )  # fmt: skip
    headline = edition.register(lines.filter(edition=chosen))
    return Page(
        "register.html",
        say("Register"),
        [
            Section(
                "register",
                say("Register"),
                edition.REGISTER,
                tables=[table],
                headline=headline,
            ),
            *_editions(views),
        ],
        selects=[editions_select("edition", editions, chosen)],
    )


def _editions(views: Views) -> list[Section]:
    """Every published edition; its page has its notice and its sheets."""
    frame = views.table("editions")
    if frame.is_empty():
        return []
    table = Table("editions", frame, EDITION_COLUMNS)
    links = [(edition_page(name), name, "") for name in frame["edition"]]
    return [Section("editions", say("Published editions"), links=links, tables=[table])]


DUE_COLUMNS = (
    *("name", "fsn_no", "boat_type", "rowers", "crew_class", "empty_thwart", "valid_until"),
    "status",
    *("tow_speed_m_s", "speed_reason", "beyond_curve", "declared_speed_m_s", "power_w"),
    *("raced_speed_m_s", "lowest_speed_m_s", "highest_speed_m_s", "last_tow", "as_of"),
)
DUE_CARDS = ("name", "fsn_no", "rowers", "crew_class", "valid_until", "status", "tow_speed_m_s")
CHOICE_COLUMNS = (
    *("position", "name", "fsn_no", "rowers", "crew_class", "seasons", "valid_until"),
    *("tow_speed_m_s", "factor_sd_before_percent", "factor_sd_after_percent"),
)


def _boats(views: Views, methods: Sequence[str]) -> Page:
    """Who has to tow again, at what speed, and which boats to tow again."""
    rows = views.ask("due_list").filter(method=default_method(methods))
    rows = rows.rename({"tow_date": "last_tow"})
    due = Table("due_list", rows, DUE_COLUMNS, search=True, cards=DUE_CARDS)
    choice = views.ask("retow_choice").filter(method=default_method(methods))
    sd = choice.select((pl.col("^factor_sd.*$") * 100).name.replace("ratio", "percent"))
    sections = [
        Section(
            "due_list",
            say("Who has to tow again"),
            of_due.SPEEDS,
            tables=[due],
            headline=of_due.due(rows),
        ),
        *listed(
            Section(
                "retow_choice",
                of_due.RETOW_TITLE,
                of_due.RETOW,
            ),
            "retow_choice",
            choice.hstack(sd),
            CHOICE_COLUMNS,
            follows=(),
            headline=of_due.retow(choice) if choice.height else None,
        ),
    ]
    return Page("boats.html", say("Boats"), sections)


PART = pl.col("part") + 1
"""Parts of a season as people count them."""

LINK_COLUMNS = (*("season", "part", "source", "n_tows", "n_links", "factor", "lo", "hi"),)


def _seasons(views: Views, methods: list[str]) -> Page:
    """What was wrong with the instruments of each season, and how well repeat tows agree."""
    shown = pl.col("method").is_in(methods)
    frames = {
        "season_change": views.table("season_changes").filter(shown),
        "log_factors": views.table("log_factors").filter(shown),
        "ladder": views.table("season_ladder"),
        "options": views.table("option_summary").filter(study=JUDGEMENT),
        "reproducibility": views.table("reproducibility").filter(shown),
        "era_shifts": views.table("era_shifts")
        .drop_nulls("shift_ratio")
        .filter(shown, boat_type="all"),
        "repeat_pairs": with_page(views.ask("repeat_pairs").filter(shown)),
        "variance_components": views.table("variance_components")
        .drop_nulls("sd_ratio")
        .filter(shown),
        "predicted_cw": with_page(views.ask("predicted").filter(shown)),
    }
    first = default_method(methods)
    said = {
        "season_change": season.changes(frames["season_change"], first),
        "log_factors": season.log_factors(frames["log_factors"].filter(method=first)),
        "reproducibility": season.reproducibility(frames["reproducibility"], first),
    }
    links = views.table("season_links").with_columns(PART)
    sections = [
        Section(
            name,
            title,
            note,
            [Chart(figure, [frames[name]], follows=follows)],
            headline=said.get(name),
            folded=name not in said,
        )
        for name, (figure, title, note, follows) in SEASON_CHARTS.items()
        if frames[name].height
    ]
    told = (*listed(LINKS, "season_links", links, LINK_COLUMNS), *_season_diagnosis(views))
    return Page(
        "seasons.html",
        say("Seasons"),
        [*sections, *(replace(section, folded=True) for section in told)],
        selects=[methods_select(methods)],
    )


LINKS = Section(
    "season_links",
    say("What a log factor rests on"),
    say(
        "Where a log was replaced within a season each part has its own factor; "
        "the chart above shows their mean."
    ),
)


SEASON_CHARTS: Final[dict[str, tuple[str, Sentence, Sentence, dict[str, str]]]] = {
    "season_change": (
        "season_change",
        say("Relative to the published Cw"),
        say("Cw by the method / Cw as published, of the same tow: median, and lowest to highest."),
        {},
    ),
    "log_factors": (
        "log_factors",
        say("Log factor per season"),
        say("True speed = log speed x factor. A factor without a bar has no known interval."),
        {},
    ),
    "reproducibility": (
        "reproducibility",
        say("Spread of one tow"),
        say(
            "Standard deviation of one tow from repeats of unaltered boats, with 95 % interval."
            " Lower is better."
        ),
        {},
    ),
    "ladder": (
        "ladder",
        say("What each step does"),
        say(
            "Factor on Cw of each step, geometric mean over a season's tows. The factors of a "
            "season multiply to the total."
        ),
        {"to_method": "method"},
    ),
    "options": (
        "options",
        say("Sensitivity to choices"),
        say(
            "How Cw would change if one choice were made otherwise: median and the middle 90 % "
            "of tows."
        ),
        {},
    ),
    "era_shifts": (
        "eras",
        say("Does an era differ?"),
        say(
            "Next tow of the same boats, in a later era, against that in the era itself, "
            "without ageing: median of n pairs with 95 % interval, all types together."
        ),
        {},
    ),
    "repeat_pairs": (
        "repeats",
        say("Every pair"),
        say(
            "New Cw / old Cw, at the season of the new tow. E_n: the difference divided by both"
            " intervals together; beyond 1 two tows disagree. Where these are the spread of the"
            " runs alone, that may be the log's error. Click a point to go to the boat."
        ),
        {},
    ),
    "variance_components": (
        "components",
        say("Where the spread comes from"),
        say(
            "What differences between boats, between seasons, of a boat between seasons, and "
            "between runs add to the spread of Cw: standard deviation with 95 % interval, from "
            "one model of all tows with a curve (n). Each crew of a boat counts as a boat, and "
            "again after an alteration."
        ),
        {},
    ),
    "predicted_cw": (
        "predicted",
        say("Predicted without towing"),
        say(
            "Cw from length, weight, beam and type against Cw from the tow. On the line they "
            "agree. Disagrees: by more than the uncertainty of both; under a method that does "
            "not estimate the log's error, that is not in it."
        ),
        {"method": "method"},
    ),
}
"""By the rows that it draws, a chart of the seasons: figure, title, note, and what it follows."""


def _changes(views: Views, methods: Sequence[str], changes: pl.DataFrame) -> Page:
    """What changes from one edition to the next, and the races computed again by both."""
    changed = changes.filter(pl.col("change") != "same")
    days = views.race_days() if views.has("race_changes") else []
    races = Section(
        "races",
        say("Races"),
        say("Every result computed again by the old and the new edition; choose a race."),
        links=[(race_path(race, day), f"{race} {day}", "") for race, day in days],
    )
    if not days:
        races = Section(
            "races", say("Races"), empty=say("The archive holds no races to compute again.")
        )
    if changed.is_empty():
        empty = Section(
            "changes_list", say("Changed lines"), empty=say("There are no changed lines.")
        )
        return Page("changes.html", MENU["changes"], [empty, races])
    editions = changed["to_edition"].unique().sort().to_list()
    chosen = newest_edition(editions, draft_of(methods))
    table = Table(
        "changes", changed, CHANGE_COLUMNS, follows=["to_edition"], search=True, cards=CHANGE_CARDS,
    )  # fmt: skip
    drawn = changed.select(*DRAWN_CHANGES).drop_nulls("gain_in_two_hours_s")
    chart = Chart(
        "changes", [drawn], say("Time that crews gain or lose in two hours"),
        {"to_edition": "to_edition"},
    )  # fmt: skip
    return Page(
        "changes.html",
        MENU["changes"],
        [
            Section(
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
                headline=edition.changes(changes.filter(to_edition=chosen)),
            ),
            races,
        ],
        selects=[editions_select("to_edition", editions, chosen)],
    )


CHANGE_COLUMNS = (
    *("name", "fsn_no", "rowers", "crew_class", "change", "old_cw_kg_m", "new_cw_kg_m"),
    *("cw_ratio", "gain_in_two_hours_s", "exceeds_interval", "old_speed_rank", "new_speed_rank"),
    "causes",
)
CHANGE_CARDS = (
    *("name", "fsn_no", "rowers", "crew_class", "old_cw_kg_m", "new_cw_kg_m"),
    *("gain_in_two_hours_s", "exceeds_interval"),
)
DRAWN_CHANGES = ("to_edition", "fsn_no", "name", "rowers", "crew_class", "gain_in_two_hours_s")


RACE_COLUMNS = (
    *("name", "fsn_no", "crew_class", "rowers", "rowing_time_s", "old_power_w", "new_power_w"),
    *("old_rank", "new_rank", "podium_changed", "old_remark", "new_remark"),
)
RACE_CARDS = ("name", "fsn_no", "new_power_w", "old_rank", "new_rank")


def _races(views: Views, methods: Sequence[str]) -> Iterator[Page]:
    """A page for each race."""
    races = views.ask("races") if views.has("race_changes") else pl.DataFrame()
    if races.is_empty():
        return
    editions = races["to_edition"].unique().sort().to_list()
    chosen = newest_edition(editions, draft_of(methods))
    chances = race_chances(views, races.filter(to_edition=chosen)["from_edition"][0], chosen)
    for race, day in views.race_days():
        own = races.filter(race=race, race_date=day)
        yield _race(race_path(race, day), f"{race} {day}", own, editions, chosen, chances)


def _race(
    path: str, name: str, rows: pl.DataFrame, editions: Sequence[str], chosen: str, chances: Chances
) -> Page:
    now = rows.filter(to_edition=chosen)
    follows = ["to_edition"]
    table = Table(
        "race_changes", rows, RACE_COLUMNS, follows=follows, search=True, cards=RACE_CARDS
    )
    return Page(
        path,
        say("Races"),
        [
            Section(
                "race_results",
                say("Results by both editions"),
                say(
                    "Power per rower in this race, and the place by it, by class: among the crews "
                    "that have a valid line on that day in both editions."
                ),
                tables=[table],
                headline=winners(now, chances),
            )
        ],
        name=name,
        selects=[editions_select("to_edition", editions, chosen)],
    )


def _about() -> Page:
    """The method, what the words mean, and how the data fared."""
    links = [*guide_links(), *((f"{name}.html", *texts) for name, texts in ABOUT.items())]
    where = say("Where to find what")
    return Page("about.html", MENU["about"], [Section("about_pages", where, links=links)])


def _quality(views: Views, methods: list[str]) -> Page:
    statuses = views.ask("statuses").filter(method=default_method(methods))
    flagged, checks = views.ask("flagged_boats"), views.ask("checks")
    left_out = Section("run_reasons", say("Runs that do not count"))
    flags = Section(
        "flags",
        say("Flags"),
        say("A flag says what a person should look at; it never changes a number."),
    )
    return Page(
        "quality.html",
        say("Quality"),
        [
            Section("statuses", say("Status of the curves"), headline=season.statuses(statuses)),
            _set_aside(views),
            *listed(flags, "flagged_boats", flagged, FLAG_COLUMNS),
            *listed(left_out, "run_reasons", views.ask("counts", "run"), ("code", "number")),
            *listed(
                Section(
                    "checks",
                    say("What the checks found"),
                    say(
                        "On how many tows each check was made, and how often something lay "
                        "beyond its limit."
                    ),
                ),
                "check_counts",
                checks,
                ("check", "severity", "tows", "beyond"),
            ),
        ],
        selects=[methods_select(methods)],
    )


FLAG_COLUMNS = ("flag", "name", "fsn_no", "rowers", "crew_class", "tow_date")
SOUND_VERDICTS = ("sound", "estimated")
DIAGNOSIS_COLUMNS = (
    *("season", "part", "instrument", "verdict", "p_fault", "size", "size_lo", "size_hi"),
    *("unit", "first_tow", "confused_with"),
)


def _season_diagnosis(views: Views) -> list[Section]:
    """What may be wrong with the instruments of a season; none where no method asks."""
    if not views.has("season_diagnosis"):
        return []
    doubted = views.ask("season_diagnosis").filter(~pl.col("verdict").is_in(SOUND_VERDICTS))
    # What else it could be: the kinds, without their seasons.
    rows = doubted.with_columns(
        PART, pl.col("confused_with").str.replace_all(r" \d+", "").str.replace_all(", ", ",")
    )
    table = Table("season_diagnosis", rows, DIAGNOSIS_COLUMNS, follows=["method"])
    return [
        Section("season_diagnosis", say("Instruments by season"), season.DIAGNOSIS, tables=[table])
    ]


def _set_aside(views: Views) -> Section:
    section = Section(
        "set_aside", say("Set aside"), say("Files, lines and tows not used, with the reason.")
    )
    if not views.has("quarantine"):
        return replace(section, empty=say("Nothing was set aside."))
    columns = (
        *("path", "tow_id", "line", "lost", "run", "lost_s", "reason_code", "messages"),
        "first_seen",
    )
    faults = views.table("quarantine").with_columns(
        lost="lost_" + pl.col("lost"), messages=pl.concat_list("message_nl", "message")
    )
    table = Table("quarantine", faults, columns, search=True)
    return replace(section, tables=[table])
