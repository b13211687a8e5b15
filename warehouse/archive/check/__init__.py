"""Looking through an archive before a rebuild, and proposing what would mend it."""

from warehouse.archive.check.check import check_archive
from warehouse.archive.check.proposals import Proposal
from warehouse.archive.check.report import CauseReport, CheckReport, check_report

__all__ = ["CauseReport", "CheckReport", "Proposal", "check_archive", "check_report"]
