"""A small file of settings may not take the machine."""

import pytest

from pipeline.toml_text import parse_toml


@pytest.mark.parametrize(
    "text",
    [
        "a = " + "[" * 20_000 + "]" * 20_000,
        "a = " + "{a = " * 5_000 + "1" + "}" * 5_000,
        "# " + "x" * 2_000_000,
    ],
    ids=["arrays", "tables", "length"],
)
def test_what_is_too_deep_or_too_long_is_refused_at_once(text):
    with pytest.raises(ValueError, match=r"too deep|at most"):
        parse_toml(text)


def test_what_people_write_is_read():
    assert parse_toml("[a.b]\nc = 1.5\n") == {"a": {"b": {"c": 1.5}}}
