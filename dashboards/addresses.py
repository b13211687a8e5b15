"""Where the pages of boats, types, editions and races lie within the site."""

import datetime as dt
import hashlib
import re
from typing import Final

INSPECTIONS: Final = "inspection.html"
"""The page with the inspection sheets of all boats."""


def boat_path(fsn_no: str) -> str:
    """Return the page of a boat: its number if that can be a file name, else with a hash of it."""
    return _path("boats", fsn_no)


def type_path(boat_type: str) -> str:
    """Return the page of a type of boat."""
    return _path("types", boat_type)


def edition_page(edition: str) -> str:
    """Return the page of a published edition."""
    return _path("editions", edition)


def race_path(race: str, day: dt.date) -> str:
    """Return the page of a race."""
    return f"races/{make_race_key(race, day)}.html"


def make_race_key(race: str, day: dt.date) -> str:
    """Return how addresses name a race of a day."""
    return make_key(f"{race}-{day}")


def boat_sheet(fsn_no: str) -> str:
    """Return the inspection sheet of a boat, on the page of all."""
    return f"{INSPECTIONS}#{make_key(fsn_no)}"


def race_sheets(race_key: str) -> str:
    """Return the inspection sheets of the boats of a race, by its key."""
    return f"{INSPECTIONS}?race={race_key}"


def make_key(name: str) -> str:
    """Return a name as it can stand in an address: itself if it can, else with a hash of it."""
    safe = re.sub(r"[^A-Za-z0-9-]+", "-", name)
    if safe != name:
        safe += "-" + hashlib.sha256(name.encode()).hexdigest()[:8]
    return safe


def _path(folder: str, name: str) -> str:
    return f"{folder}/{make_key(name)}.html"


def trace_path(tow_id: str) -> str:
    """Return the picture of the traces of a tow."""
    return _path("traces", tow_id).removesuffix(".html") + ".svg"
