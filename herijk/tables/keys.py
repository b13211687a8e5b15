"""Keys that more than one table has; here so that naming them imports nothing."""

from typing import Final

LINE: Final = ("fsn_no", "rowers", "crew_class")
"""What names a line of the register: a boat and one of its crews."""
