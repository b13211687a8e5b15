"""What building the package adds: compiled catalogues of Dutch texts, and compiled templates."""

import sys
from os import getpid
from pathlib import Path
from typing import Any

from babel.messages.mofile import write_mo
from babel.messages.pofile import read_po
from hatchling.builders.hooks.plugin.interface import BuildHookInterface

CATALOGUES = "pipeline/locale/*/LC_MESSAGES/*.po"


def compile_catalogues(root: Path) -> None:
    """Write a `.mo` beside every `.po` that is newer."""
    for source in root.glob(CATALOGUES):
        target = source.with_suffix(".mo")
        if target.exists() and target.stat().st_mtime >= source.stat().st_mtime:
            continue
        with source.open("rb") as file:
            catalogue = read_po(file)
        beside = target.with_suffix(f".{getpid()}")
        with beside.open("wb") as file:
            write_mo(file, catalogue)
        beside.replace(target)


def compile_templates(root: Path) -> None:
    """Write a Python module for every template that is newer."""
    sys.path.insert(0, str(root))
    try:
        from dashboards import templates  # noqa: PLC0415 - of this checkout, which needs only Jinja
    finally:
        sys.path.remove(str(root))
    templates.compile_templates()


class CustomBuildHook(BuildHookInterface):
    """Compiles before a wheel or an editable install is made."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:  # noqa: ARG002
        """Compile what the wheel needs, before Hatchling gathers files."""
        compile_catalogues(Path(self.root))
        compile_templates(Path(self.root))


if __name__ == "__main__":
    compile_catalogues(Path(__file__).parent)
    compile_templates(Path(__file__).parent)
