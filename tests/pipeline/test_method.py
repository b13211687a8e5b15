"""A method file: every error says where and what; the hash is honest."""
# ruff: noqa: E501 - tables of cases, one a line

import re

import pytest

from pipeline.errors import MissingKnowledgeError
from pipeline.messages import write_in_language
from pipeline.method.reading import (
    MethodFileError,
    list_shipped_methods,
    parse_method,
    read_shipped_method,
)
from tests.pipeline.methods import PLAIN, write_method_text

LINE_OF = {step: number for number, step in enumerate(PLAIN, 4)}
"""Line of each step in `write_method_text`: name, title and [steps] come first."""


def parse(text: str, **others: str):
    def text_of(name: str) -> str:
        if name not in others:
            raise MissingKnowledgeError(f"there is no method {name!r}; the methods are {others}")
        return others[name]

    return parse_method(text, "own.toml", text_of)


def changed(step: str, options: str) -> str:
    return write_method_text(**{step: options})


def with_override(text: str, range_text: str = '"2010:2012"') -> str:
    return write_method_text() + f"[[overrides]]\nrange = {range_text}\n{text}\n"


FIRST_OVERRIDE = len(write_method_text().splitlines()) + 1

WRONG = {
    "no TOML": ("name = \n", ["own.toml", "line 1", "not valid TOML"]),
    "name with capitals": (write_method_text("Own"), ["line 1", "name", "'Own'"]),
    "unknown key at the top": (
        'titel = "x"\n' + write_method_text(), ["line 1", "titel", "unknown key", "title", "overrides"],
    ),
    "unknown step": (
        write_method_text(winds="{}"), [f"line {len(PLAIN) + 4}", "winds", "unknown step", "wind", "curve"],
    ),
    "missing step": (
        "\n".join(li for li in write_method_text().splitlines() if not li.startswith("curve")),
        ["own.toml", "curve.b", "missing", "2009"],
    ),
    "unknown key": (
        changed("wind", '{ model = "head", sides = 0.2 }'),
        [f"line {LINE_OF['wind']}", "wind.sides", "unknown key", "averaging_s", "side"],
    ),
    "unknown option": (
        changed("wind", '{ model = "sideways" }'),
        [f"line {LINE_OF['wind']}", "wind.model", "'head', 'oblique'", "'sideways'"],
    ),
    "wrong type": (
        changed("wind", '{ model = "head", ahead = "half" }'),
        [f"line {LINE_OF['wind']}", "wind.ahead", "number", "'half'"],
    ),
    "impossible value": (
        changed("wind", '{ model = "head", ahead = -0.5 }'),
        [f"line {LINE_OF['wind']}", "wind.ahead", "at least 0", "-0.5"],
    ),
    "too many per cent": (
        changed("speed", '{ correction = "prescribed", factor = 6.0 }'),
        [f"line {LINE_OF['speed']}", "speed.factor", "at most 1.2", "6.0"],
    ),
    "range that is no range": (
        with_override('wind = { ahead = 0.4 }', '"2010-2012"'),
        [f"line {FIRST_OVERRIDE + 1}", "range", "'2010-2012'", "2009:2011"],
    ),
    "range backwards": (
        with_override('wind = { ahead = 0.4 }', '"2012:2010"'), ["range", "ends before it begins"],
    ),
    "impossible value in an override": (
        with_override("wind = { ahead = 4.0 }"),
        [f"line {FIRST_OVERRIDE + 2}", "wind.ahead", "at most 2", "season 2010"],
    ),
    "overlap": (
        with_override("wind = { ahead = 0.4 }")
        + '[[overrides]]\nrange = "2012:"\nwind = { ahead = 0.3 }\n',
        ["wind.ahead", "twice", "season 2012", "overlap"],
    ),
    "unknown parent": (
        'extends = "parent"\n' + write_method_text(), ["line 1", "extends", "there is no method 'parent'"],
    ),
    "its own parent": ('extends = "test"\n' + write_method_text(), ["line 1", "extends", "itself", "test"]),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_every_error_says_where_what_and_what_is_allowed(case):
    text, expected = WRONG[case]
    with pytest.raises(MethodFileError) as caught:
        parse(text)
    message = str(caught.value)
    assert message.startswith("own.toml")
    assert [part for part in expected if part not in message] == [], message
    assert "\n" not in message
    assert "pydantic" not in message
    dutch = write_in_language(caught.value, "nl")
    english = {"line", "missing", "must", "not", "key", "allowed", "season", "ranges"}
    assert not english & set(re.findall(r"[a-z]+", re.sub(r"'[^']*'", "", dutch))), dutch


def test_a_circle_over_two_files_is_found():
    one, two = (
        f'extends = "{o}"\n' + write_method_text(n) for n, o in (("one", "two"), ("two", "one"))
    )
    with pytest.raises(MethodFileError, match="one > two > one"):
        parse(one, one=one, two=two)


def test_an_error_in_the_parent_names_the_parents_file():
    parent = changed("wind", '{ model = "head" }').replace("[steps]", "[steps]\nwinds = {}")
    with pytest.raises(MethodFileError, match=r"^parent\.toml, line 4: 'steps\.winds'"):
        parse('name = "own"\ntitle = "x"\nextends = "parent"\n', parent=parent)


def test_a_child_takes_all_and_replaces_what_it_names():
    parent = write_method_text(wind='{ model = "head", ahead = 0.5, behind = 0.7 }')
    child = (
        'name = "own"\ntitle = "x"\nextends = "parent"\n[steps]\nwind = { ahead = 0.4 }\n'
        '[[overrides]]\nrange = "2012:2013"\nwind = { behind = 0.6 }\n'
    )
    made = parse(child, parent=parent)
    assert [(r.first, r.last) for r in made.ranges] == [(2009, 2011), (2012, 2013), (2014, 9999)]
    wind = made.get_steps(2010).wind
    assert (wind.model, wind.ahead, wind.behind) == ("head", 0.4, 0.7)
    assert made.get_steps(2012).wind.behind == 0.6
    assert made.get_steps(2010).curve == parse(parent).get_steps(2010).curve


def test_a_season_before_the_first_is_missing_knowledge():
    made = parse(write_method_text().replace("title =", 'seasons = "2012:2016"\ntitle ='))
    for season in (2011, 2017):
        with pytest.raises(MissingKnowledgeError, match=rf"{season}.*2012 to 2016"):
            made.get_steps(season)
    assert made.get_steps(2012) == made.get_steps(2016)


def test_tows_of_2014_were_recomputed_by_all_rules_of_2015():
    """Slide "2014 opnieuw berekend": Cw "na alle verbeteringen in berekening"."""
    published, at_first = map(read_shipped_method, ("as-published", "as-published-2014"))
    assert published.get_steps(2014) == published.get_steps(2015)
    assert at_first.get_steps(2014) == published.get_steps(2013)


SAME_RESULT = {
    "title": lambda t: t.replace('"Test"', '"Other"'),
    "description": lambda t: t.replace("title =", 'description = "long"\ntitle ='),
    "comment": lambda t: "# why\n" + t,
    "order": lambda t: t.replace('model = "oblique", ahead = 0.0', 'ahead = 0.0, model = "oblique"'),
    "default written out": lambda t: t.replace('"mean_of_ratios" }', '"mean_of_ratios", inertia = "none" }'),
    "override that changes nothing": lambda t: t + '[[overrides]]\nrange = "2012:"\nwind = { ahead = 0.0 }\n',
    "why": lambda t: t + '[[overrides]]\nrange = "2012:"\nwhy = "x"\nwind = { ahead = 0.0 }\n',
}  # fmt: skip


@pytest.mark.parametrize("case", SAME_RESULT)
def test_the_hash_stays_when_results_do(case):
    text = SAME_RESULT[case](write_method_text())
    assert text != write_method_text()
    assert parse(text).content_hash == parse(write_method_text()).content_hash


def test_extending_gives_the_hash_of_the_same_written_out():
    child = 'name = "own"\ntitle = "x"\nextends = "parent"\n[steps]\nwind = { model = "head" }\n'
    written_out = write_method_text(wind='{ model = "head", ahead = 0, behind = 0, side = 0 }')
    assert parse(child, parent=write_method_text()).content_hash == parse(written_out).content_hash


OTHER_RESULT = {
    "speed": '{ correction = "prescribed" }',
    "force": "{ ratio = 1.04 }",
    "calibration": '{ rule = "gps_per_tow" }',
    "window": '{ rule = "steady" }',
    "wind": '{ model = "head", ahead = 0.50001 }',
    "run_point": '{ estimator = "ratio_of_means" }',
    "temperature": '{ rule = "ittc57" }',
    "runs": "{ highest_target_ratio = 1.4 }",
    "unrecorded": '{ rule = "expected" }',
    "curve": '{ b = "capped" }',
}


@pytest.mark.parametrize("step", OTHER_RESULT)
def test_the_hash_changes_with_any_option(step):
    other = parse(changed(step, OTHER_RESULT[step]))
    assert other.content_hash != parse(write_method_text()).content_hash


def test_the_hash_changes_with_one_season_of_an_override_and_with_the_seasons_covered():
    texts = (
        write_method_text(),
        with_override("wind = { ahead = 0.4 }"),
        with_override("wind = { ahead = 0.4 }", '"2010:2011"'),
        write_method_text().replace("title =", 'seasons = "2009:2016"\ntitle ='),
    )
    assert len({parse(text).content_hash for text in texts}) == len(texts)


@pytest.mark.parametrize(
    ("name", "begins"), [("as-published", "63682eef40296ac5"), ("rebased-2015", "9770f184628b4b26")]
)
def test_a_new_option_leaves_the_methods_of_history_what_they_were(name, begins):
    """Editions name them by this hash: a default that is left out of it changes no method."""
    assert read_shipped_method(name).content_hash.startswith(begins)


@pytest.mark.parametrize("name", list_shipped_methods())
def test_only_a_method_that_estimates_log_factors_has_complete_intervals(name):
    assert read_shipped_method(name).interval == ("complete" if name == "rebased" else "runs_alone")


def test_the_method_of_an_edition_is_read_without_options_that_are_gone() -> None:
    """An edition of then is shown today; an own method with such an option has an error."""
    text = changed("calibration", '{ rule = "gps_per_tow", stream = "drifting" }')
    with pytest.raises(MethodFileError, match=r"calibration\.stream"):
        parse(text)
    now = parse(changed("calibration", '{ rule = "gps_per_tow" }'))
    assert parse_method(text, "edition", published=True) == now
