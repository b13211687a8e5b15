"""The pages of `herijk audit` in plain words, each statement with its figures and its n.

Words only: every figure and every verdict comes from `warehouse.queries.audit`. True, false and
None of a
verdict are three different things: yes, not seen, and not claimed.
"""

from herijk.cli.audit_text.boat import boat_page
from herijk.cli.audit_text.one_type import one_type
from herijk.cli.audit_text.two_types import two_types
from herijk.cli.text import SIMULATED
from herijk.warehouse.queries.audit import BoatAudit
from herijk.warehouse.queries.audit_types import TypesAudit
from herijk.words import tell


def audit(report: BoatAudit | TypesAudit) -> str:
    """The page of a boat, of one type, or of two types side by side."""
    parts = [tell(SIMULATED)] if report.simulated else []
    if isinstance(report, BoatAudit):
        parts += boat_page(report)
    elif len(report.types) == 1:
        parts += one_type(report)
    else:
        parts += two_types(report)
    return "\n\n".join(parts)
