"""Texts that follow from the program alone, kept where Python keeps its compiled files."""

import importlib.util
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from warehouse.store.files import written_beside


def kept(name: str, made_from: str, make: Callable[[], str]) -> str:
    """A text from an earlier process; made, and kept where that may be, if there is none.

    Args:
        name: what the text is called; an earlier text of that name is forgotten.
        made_from: fingerprint of all that the text follows from.
        make: makes the text.
    """
    folder = Path(importlib.util.cache_from_source(__file__)).parent
    path = folder / f"{name}.{made_from}.txt"
    with suppress(OSError):
        return path.read_text(encoding="utf-8")
    text = make()
    with suppress(OSError):
        for earlier in folder.glob(f"{name}.*.txt"):
            earlier.unlink(missing_ok=True)
        with written_beside(path) as beside:
            beside.write_text(text, encoding="utf-8")
    return text
