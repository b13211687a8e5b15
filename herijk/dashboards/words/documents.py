"""Texts of the documents that are printed: certificate and proposal."""

from typing import Final

DOCUMENTS: Final[dict[str, tuple[str, str]]] = {}
