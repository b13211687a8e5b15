"""Every snippet of docs/library.md runs, one after the other."""

import re
import runpy

from tests.architecture.repository import ROOT


def test_snippets_run(built, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "demo").mkdir()
    (tmp_path / "demo" / "data").symlink_to(built.data)
    page = (ROOT / "docs" / "library.md").read_text(encoding="utf-8")
    code = "\n".join(re.findall(r"```python\n(.*?)```", page, re.DOTALL))
    snippets = tmp_path / "snippets.py"
    snippets.write_text(code.replace('concept-rebased"', 'concept-rebased-2015"'), "utf-8")
    assert runpy.run_path(str(snippets))["curves"].height > 0
