"""Recomputes the history of the Dutch rowing-sloop register from its tow tests.

The public library; docs/library.md has an example of each. Nothing else is public.

- `fit`, `Curve`, `Fit`, `Estimate`, `FitWarning`: curves from speeds and forces, power and speed.
- `open_data`, `DataFolder`, `compare_registers`: the tables of a rebuild as Polars frames.
- `methods`, `method`, `apply_method`, `Applied`: methods, and one tow under a method.
- `HerijkError`: what all of them raise where something is missing or wrong.
"""

from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from herijk.library.curves import Curve, Estimate, Fit, FitWarning, fit
    from herijk.library.data import DataFolder, compare_registers, open_data
    from herijk.library.methods import Applied, apply_method, method, methods
    from pipeline.errors import HerijkError

__all__ = [
    "Applied",
    "Curve",
    "DataFolder",
    "Estimate",
    "Fit",
    "FitWarning",
    "HerijkError",
    "apply_method",
    "compare_registers",
    "fit",
    "method",
    "methods",
    "open_data",
]

_HOMES: Final = {
    "herijk.library.curves": {"Curve", "Estimate", "Fit", "FitWarning", "fit"},
    "herijk.library.data": {"DataFolder", "compare_registers", "open_data"},
    "herijk.library.methods": {"Applied", "apply_method", "method", "methods"},
    "pipeline.errors": {"HerijkError"},
}


def _look_at_neighbours() -> None:
    """Raise an error where a room is somebody else's module: names of rooms are common.

    Why they have such names is in docs/decisions.md, "Rooms at the top".

    Raises:
        ImportError: Python would find somebody else's module under the name of a room.
    """
    here = Path(__file__).resolve().parents[1]
    for room in ("assets", "dashboards", "warehouse", "pipeline"):
        spec = find_spec(room)
        origin = (spec and spec.origin) or "nothing"
        if Path(origin).resolve().parent != here / room:
            raise ImportError(
                f"import {room} finds {origin}, which is not Herijk's: rename that file or folder, "
                "or give Herijk an environment of its own"
            )


_look_at_neighbours()


def __getattr__(name: str) -> Any:  # the command would otherwise wait for SciPy and Polars
    for home, names in _HOMES.items():
        if name in names:
            return getattr(import_module(home), name)
    raise AttributeError(f"module 'herijk' has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
