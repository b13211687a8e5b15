"""Looking through an archive before a rebuild: what is wrong, and what would settle it."""

from warehouse.archive.check.check import CauseReport, CheckReport, check_archive

__all__ = ["CauseReport", "CheckReport", "check_archive"]
