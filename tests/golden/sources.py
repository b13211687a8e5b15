"""Reads the copied tables in `tests/data`."""

import csv
from pathlib import Path

DATA = Path(__file__).parents[1] / "data"


def read_table(name):
    """Rows of a table as dictionaries of text, so that printed digits stay visible."""
    with (DATA / name).open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))
