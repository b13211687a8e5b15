"""The pages of `herijk audit` in plain words, each statement with its figures and its n.

Words only: every figure and every verdict comes from `warehouse.queries.audit`. A verdict is true,
false or None: yes, not seen, and not claimed.
"""

from herijk.cli.audit_text.boat import boat_page
from herijk.cli.audit_text.one_type import one_type
from herijk.cli.audit_text.two_types import two_types
from herijk.cli.text import page
from warehouse.queries.audit import BoatAudit
from warehouse.queries.audit_types import TypesAudit


def audit(report: BoatAudit | TypesAudit) -> str:
    """The page of a boat, of one type, or of two types side by side."""
    if isinstance(report, BoatAudit):
        parts = boat_page(report)
    else:
        parts = one_type(report) if len(report.types) == 1 else two_types(report)
    return page(parts, report.simulated)
