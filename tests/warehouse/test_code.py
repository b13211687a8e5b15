"""What computes decides what is stale: other words remake nothing, another formula what uses it."""

import datetime as dt
import shutil

import pytest

from herijk.warehouse.build.graph import STEPS
from herijk.warehouse.build.inputs import Inputs
from herijk.warehouse.build.version import MODULES
from herijk.warehouse.store.code import ADDERS, FAULTS_IN_DUTCH, READERS, Sources
from herijk.warehouse.store.store import Store
from tests.architecture.repository import ROOT

COMPUTES = {"samples": (*READERS, FAULTS_IN_DUTCH), "blocks": ADDERS, "version": MODULES} | {
    step.name: (step.compute.__module__, *step.words) for step in STEPS
}
"""The modules with which everything is computed that a rebuild keeps, and a register line."""


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    """A copy of the package that a test may edit."""
    folder = tmp_path_factory.mktemp("package")
    shutil.copytree(ROOT / "herijk", folder / "herijk", ignore=shutil.ignore_patterns("__pyc*"))
    return folder


@pytest.fixture(scope="module")
def known(package):
    """What is known of the modules as they are."""
    sources = Sources(package)
    hashes(sources)
    return sources.known


def hashes(sources):
    return {name: sources.hash_of(*modules) for name, modules in COMPUTES.items()}


def stale_after(package, known, file, edit):
    """What has to be made again when a file of the package is edited."""
    path = package / "herijk" / file
    before, text = hashes(Sources(package, dict(known))), path.read_text("utf-8")
    path.write_text(edit(text), "utf-8")
    try:
        after = hashes(Sources(package, dict(known)))
    finally:
        path.write_text(text, "utf-8")
    return {name for name in COMPUTES if before[name] != after[name]}


def other_words(text):
    """Another docstring and a comment."""
    assert text.startswith('"""')
    return '"""Other words. ' + text[3:] + "\n# A comment.\n"


def another_formula(text):
    return text + "\n_ANOTHER = 1\n"


@pytest.mark.parametrize(
    "file",
    [
        "pipeline/curve.py",
        "warehouse/archive/samples/text_files.py",
        "warehouse/build/registers.py",
    ],
)
def test_other_words_make_nothing_stale(package, known, file):
    assert stale_after(package, known, file, other_words) == set()


@pytest.mark.parametrize(
    "file",
    [
        "simulate/boats.py",
        "dashboards/site/pages.py",
        "warehouse/queries/audit.py",
        "warehouse/archive/lists/registers.py",
        "warehouse/editions/publish.py",
        "cli/main.py",
    ],
)
def test_what_computes_no_table_makes_none_stale(package, known, file):
    assert stale_after(package, known, file, another_formula) == set()


@pytest.mark.parametrize(
    ("file", "stale"),
    [
        ("words/command.py", set()),
        ("words/errors.py", set()),
        ("words/archive.py", {"samples", "archive"}),
    ],
)
def test_other_dutch_makes_stale_only_what_is_kept_with_it(package, known, file, stale):
    assert stale_after(package, known, file, another_formula) == stale


@pytest.mark.parametrize(
    ("file", "stale"),
    [
        ("pipeline/blocks/sums.py", {"blocks", "version"}),
        ("warehouse/archive/samples/text_files.py", {"samples", "version"}),
        ("warehouse/archive/sheets/row.py", {"archive", "version"}),
        ("pipeline/season_log/posterior.py", {"method", "studies", "version"}),
        ("pipeline/studies/options.py", {"studies"}),
        ("pipeline/consistency/reml.py", {"lines", "consistency"}),
        (
            "pipeline/register/register.py",
            {"method", "register", "studies", "summaries", "version"},
        ),
        ("pipeline/register/replay.py", {"summaries"}),
        ("warehouse/store/database.py", {"database"}),
    ],
)
def test_another_formula_makes_stale_what_uses_it(package, known, file, stale):
    assert stale_after(package, known, file, another_formula) == stale


def test_a_step_sees_only_the_inputs_that_it_declares(tmp_path):
    inputs = Inputs(Store(tmp_path), ("curves",), (), dt.date(2026, 1, 1))
    with pytest.raises(KeyError, match="tows is not a declared input"):
        inputs["tows"]


def test_steps_come_after_those_whose_tables_they_read():
    made = [set(step.outputs) for step in STEPS]
    for number, step in enumerate(STEPS):
        assert not set(step.inputs) & set().union(*made[number:]), step.name
