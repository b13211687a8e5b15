"""What computes decides what is stale: other words remake nothing, other code what uses it."""

import pytest

from tests.architecture.repository import ROOT
from warehouse.derive.graph import STEPS
from warehouse.store import code

USED = {"samples": code.READING, "blocks": code.ADDING} | {s.name: s.code for s in STEPS}
"""The packages with which everything is computed that a rebuild keeps."""


def stale_after(file):
    """What has to be made again when a file of the package changes."""
    return {
        name
        for name, packages in USED.items()
        if ROOT / file in {f for package in packages for f in code._modules(package)}
    }


@pytest.mark.parametrize(
    "file",
    [
        "herijk/simulate/boats.py",
        "dashboards/site/pages.py",
        "warehouse/queries/audit.py",
        "warehouse/editions/publish.py",
        "pipeline/locale/nl/LC_MESSAGES/herijk.po",
        "pipeline/tables/archive.py",
        "herijk/cli/main.py",
    ],
)
def test_what_computes_no_table_makes_none_stale(file):
    assert (ROOT / file).is_file()
    assert stale_after(file) == set()


@pytest.mark.parametrize(
    ("file", "not_stale"),
    [
        ("pipeline/blocks/sums.py", {"samples"}),
        ("warehouse/archive/samples/text_files.py", {"blocks"}),
        ("pipeline/curve.py", {"samples", "blocks"}),
    ],
)
def test_other_code_makes_stale_what_is_computed_with_it(file, not_stale):
    assert stale_after(file) == USED.keys() - not_stale


def test_the_hash_is_of_the_bytes(monkeypatch, tmp_path):
    for name, text in (("a.py", "x = 1\n"), ("b.py", "y = 2\n")):
        (tmp_path / name).write_text(text)
    monkeypatch.setattr(code, "_ROOT", tmp_path)
    monkeypatch.setattr(code, "_modules", lambda _: list(tmp_path.glob("*.py")))
    before = code.code_hash.__wrapped__("any")
    (tmp_path / "b.py").write_text("y = 3\n")
    assert code.code_hash.__wrapped__("any") != before


def test_steps_come_after_those_whose_tables_they_read():
    made = [set(step.outputs) for step in STEPS]
    for number, step in enumerate(STEPS):
        assert not {*step.reads} & set().union(*made[number:]), step.name
