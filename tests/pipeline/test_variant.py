"""Variants of a method: what is changed, and the file that says so."""

import pytest

from pipeline.method.definition import SeasonSteps
from pipeline.method.options import Steps
from pipeline.method.reading import MethodFileError, parse_method, read_shipped_method
from pipeline.method.variant import cut_at, list_differences, variant, write_variant_text

SEASONS = range(2009, 2019)


def changed(base, step, option, value):
    """The ranges of a method with one option set in all seasons."""
    found = []
    for held in cut_at(base, SEASONS):
        options = held.steps.model_dump()
        options[step][option] = value
        steps = Steps.model_validate(options)
        found.append(SeasonSteps(first=held.first, last=held.last, steps=steps))
    return found


def test_ranges_are_cut_where_a_season_or_a_range_begins():
    cut = cut_at(read_shipped_method("rebased-2015"), (2010, 2016, 1990))
    assert [(held.first, held.last) for held in cut] == [
        (2009, 2009), (2010, 2011), (2012, 2013), (2014, 2015), (2016, 9999),
    ]  # fmt: skip


def test_a_change_of_all_seasons_is_one_line():
    base = read_shipped_method("rebased")
    made = variant(base, "own", "Mijn", "omdat", changed(base, "runs", "highest_target_ratio", 1.3))
    assert write_variant_text(made) == (
        'name = "own"\ntitle = "Mijn"\ndescription = "omdat"\nextends = "rebased"\n'
        'seasons = "2009:"\n\n[steps]\nruns = { highest_target_ratio = 1.3 }\n'
    )


def test_nothing_changed_is_the_method_itself():
    base = read_shipped_method("rebased")
    made = variant(base, "own", "t", "", cut_at(base, SEASONS))
    assert list_differences(made, base) == []
    assert made.content_hash == base.content_hash
    with pytest.raises(MethodFileError, match="seasons"):
        variant(base, "own", "t", "", cut_at(base, SEASONS)[:-1])


def test_a_variant_of_a_file_extends_what_the_file_extends():
    text = (
        'name = "mine"\ntitle = "t"\nextends = "rebased"\n[register]\nvalid_years = 3\n'
        "[steps]\nwind = { side = 0.3 }\n"
    )
    base = parse_method(text, "mine.toml")
    made = variant(base, "own", "t", "", changed(base, "wind", "ahead", 0.4))
    written = write_variant_text(made)
    for said in ('extends = "rebased"', "valid_years = 3", "wind = { ahead = 0.4, side = 0.3 }"):
        assert said in written
    assert parse_method(written, "own.toml") == made
