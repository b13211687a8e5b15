"""Types of arrays, and arrays by name that are made on demand. No arithmetic here."""

from collections.abc import Callable, Collection, Iterator, Mapping
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

FloatArray: TypeAlias = NDArray[np.float64]
BoolArray: TypeAlias = NDArray[np.bool_]
IntArray: TypeAlias = NDArray[np.int64]
StrArray: TypeAlias = NDArray[np.str_]


class OnDemand(Mapping[str, FloatArray]):
    """Arrays by name, each made when it is first asked for and then kept.

    Args:
        names: of all arrays that can be asked for.
        make: makes one. If it refers to what refers to this, neither is freed at once.
    """

    def __init__(self, names: Collection[str], make: Callable[[str], FloatArray]) -> None:
        self._names, self._make = names, make
        self._made: dict[str, FloatArray] = {}

    def __getitem__(self, name: str) -> FloatArray:
        if name not in self._made:
            self._made[name] = self._make(name)
        return self._made[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)
