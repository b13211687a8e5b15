"""A federation's own methods: known by name, checked like those that ship."""

import pytest

from pipeline.errors import HerijkError
from pipeline.method.reading import list_shipped_methods, read_shipped_method
from warehouse.store.methods import KnownMethods

OWN = """
name = "ours"
title = "Onze methode"
extends = "rebased-2015"
[steps.wind]
side = 0.3
"""


@pytest.fixture
def known(tmp_path):
    return KnownMethods(tmp_path / "methods")


def write(file, text, encoding="utf-8"):
    file.parent.mkdir(exist_ok=True)
    file.write_text(text, encoding=encoding)
    return str(file)


def test_without_files_there_are_those_that_ship(known):
    assert known.names == list_shipped_methods()
    assert known.get("rebased") == read_shipped_method("rebased")


def test_a_file_is_kept_under_its_name(known, tmp_path):
    assert known.keep(write(tmp_path / "draft.toml", OWN)) == "ours"
    assert known.own == ("ours",)
    assert known.get("ours").get_steps(2010).wind.side == 0.3
    assert known.keep("ours") == "ours"


def test_one_own_method_extends_another(known, tmp_path):
    known.keep(write(tmp_path / "draft.toml", OWN))
    child = OWN.replace('"ours"', '"theirs"').replace("rebased-2015", "ours").replace("0.3", "0.4")
    method = known.find(write(tmp_path / "child.toml", child))
    assert method.get_steps(2010).wind.side == 0.4


@pytest.mark.parametrize(
    ("text", "encoding", "says"),
    [
        (OWN.replace("ours", "rebased"), "utf-8", "ships"),
        (OWN.replace("Onze", "Oné"), "cp1252", "UTF-8"),
        (OWN.replace("side", "zij"), "utf-8", "unknown key"),
    ],
)
def test_a_file_that_cannot_be_used_is_refused(known, tmp_path, text, encoding, says):
    with pytest.raises(HerijkError, match=says):
        known.keep(write(tmp_path / "draft.toml", text, encoding))
    assert known.own == ()


def test_a_file_with_the_name_of_another_method_is_refused(known):
    write(known.folder / "others.toml", OWN)
    with pytest.raises(HerijkError, match="'ours'"):
        known.get("others")


@pytest.mark.parametrize("name", ["best", "../ours", "no/such.toml"])
def test_an_unknown_method_is_said(known, name):
    with pytest.raises(HerijkError, match="there is no method"):
        known.find(name)
