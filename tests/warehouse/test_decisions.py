"""A file of decisions that cannot be understood is told with what it may hold."""

import pytest

from pipeline.errors import MissingKnowledgeError
from warehouse.store.decisions import read_decisions

DECISION = """
[[besluit]]
sleep_id = "2014-001"
oordeel = "{}"
reden = "wind"
wie = "commissie"
datum = 2015-01-24
"""


def test_decisions_come_oldest_first(tmp_path):
    file = tmp_path / "besluiten.toml"
    assert read_decisions(file) == ()
    older = DECISION.format("voorkeur").replace("2014-001", "2013-001").replace("2015", "2014")
    file.write_text(DECISION.format("uitsluiten") + older)
    assert [decision.sleep_id for decision in read_decisions(file)] == ["2013-001", "2014-001"]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (DECISION.format("weg"), "besluit.0.oordeel.*not 'weg'; it may hold .*uitsluiten or voor"),
        (DECISION.format("voorkeur") * 2, "more than one decision about 2014-001"),
        ("[[besluit]", "not valid TOML"),
    ],
)
def test_what_is_wrong_in_a_file_of_decisions_is_said(tmp_path, text, said):
    file = tmp_path / "besluiten.toml"
    file.write_text(text)
    with pytest.raises(MissingKnowledgeError, match=said):
        read_decisions(file)
