"""Looking through an archive before a rebuild: what is wrong, and what would settle it."""

from warehouse.archive.check.check import check_archive
from warehouse.archive.check.report import CauseReport, CheckReport, check_report

__all__ = ["CauseReport", "CheckReport", "check_archive", "check_report"]
