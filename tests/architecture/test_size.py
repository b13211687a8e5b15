"""The project becomes smaller: lines and statements per folder only go down.

`size.toml` has the most that each folder may hold. `python -m tests.architecture.test_size` writes
lower numbers after a change that took something away. This goes once the project is half as large.
"""

import ast
import tomllib
from collections import Counter
from pathlib import PurePath

import pytest

from tests.architecture.repository import ROOT, read, tracked_files

SIZES = "tests/architecture/size.toml"
MOST = tomllib.loads(read(SIZES))
NOT_WRITTEN = ("tests/data/", "pipeline/locale/", "CHANGELOG.md", "LICENSE", SIZES)
"""Data from outside, translations, and what grows by its nature; locks besides."""


def folder_of(name):
    """The innermost folder of `size.toml` that a file lies in."""
    return max((f for f in MOST if PurePath(name).is_relative_to(f)), key=len)


def sizes():
    """Lines, and statements of Python, per folder. Other languages and texts count as lines."""
    lines, statements = Counter(), Counter()
    for path in tracked_files():
        name = path.relative_to(ROOT).as_posix()
        if name.startswith(NOT_WRITTEN) or name.endswith(".lock") or not path.is_file():
            continue
        content = path.read_bytes()
        if b"\0" in content:  # a font, a picture
            continue
        lines[folder_of(name)] += content.count(b"\n")
        if path.suffix == ".py":
            nodes = ast.walk(ast.parse(content))
            statements[folder_of(name)] += sum(isinstance(node, ast.stmt) for node in nodes)
    return {f: {"lines": lines[f], "statements": statements[f]} for f in MOST}


@pytest.mark.parametrize("measure", ["lines", "statements"])
def test_no_folder_grows(measure):
    grown = {f: (size[measure], MOST[f][measure]) for f, size in sizes().items()}
    assert {f: pair for f, pair in grown.items() if pair[0] > pair[1]} == {}


def write_lower():
    """Puts today's sizes in `size.toml` where they are lower."""
    now = sizes()
    head = read(SIZES).split('["', maxsplit=1)[0]
    tables = [
        f'["{f}"]\n' + "".join(f"{k} = {min(v, most[k])}\n" for k, v in now[f].items())
        for f, most in MOST.items()
    ]
    (ROOT / SIZES).write_text(head + "\n".join(tables), encoding="utf-8")


if __name__ == "__main__":
    write_lower()
