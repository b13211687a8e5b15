"""What computes decides what is stale: other words remake nothing, other code what uses it."""

import pytest

from assets.archive import READS_WITH
from assets.database import SHOWING
from tests.architecture.repository import ROOT
from warehouse.store import code

USED = {
    "samples of a tow": code.READING,
    "blocks of a tow": code.ADDING,
    "table samples": READS_WITH,
    "tables": code.COMPUTING,
    "site": SHOWING,
}
"""The packages with which everything is computed that a rebuild keeps."""


def stale_after(file):
    """What has to be made again when a file of the package changes."""
    return {
        name
        for name, packages in USED.items()
        if ROOT / file in {f for package in packages for f in code._modules(package)}
    }


@pytest.mark.parametrize(
    ("file", "stale"),
    [
        ("herijk/simulate/boats.py", set()),
        ("herijk/cli/main.py", set()),
        ("pipeline/locale/nl/LC_MESSAGES/herijk.po", set()),
        ("pipeline/tables/archive.py", set()),
        ("dashboards/site.py", {"site"}),
        ("dashboards/templates/boat.html.j2", {"site"}),
        ("warehouse/queries/types.py", {"site"}),
        ("warehouse/editions/publish.py", {"site"}),
        ("warehouse/intake/seasons.py", {"table samples", "site"}),
        ("warehouse/intake/lake.py", {"table samples", "site"}),
        ("warehouse/intake/reading.py", {"samples of a tow", "table samples", "site"}),
        ("pipeline/curve.py", {"table samples", "tables", "site"}),
        ("pipeline/blocks/sums.py", {"blocks of a tow", "table samples", "tables", "site"}),
        (
            "warehouse/archive/samples.py",
            {"samples of a tow", "table samples", "tables", "site"},
        ),
    ],
)
def test_other_code_makes_stale_what_is_computed_with_it(file, stale):
    assert (ROOT / file).is_file()
    assert stale_after(file) == stale


def test_the_hash_is_of_the_bytes(monkeypatch, tmp_path):
    for name, text in (("a.py", "x = 1\n"), ("b.py", "y = 2\n")):
        (tmp_path / name).write_text(text)
    monkeypatch.setattr(code, "_ROOT", tmp_path)
    monkeypatch.setattr(code, "_modules", lambda _: list(tmp_path.glob("*.py")))
    before = code.hash_code.__wrapped__("any")
    (tmp_path / "b.py").write_text("y = 3\n")
    assert code.hash_code.__wrapped__("any") != before
