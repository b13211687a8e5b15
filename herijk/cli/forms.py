"""What `--json` of each command prints, as a class: for the documentation and for tests.

Fields may be added to a result; none is renamed or dropped without a line in the changelog.
"""

from dataclasses import dataclass
from typing import Any, Final

from pydantic import TypeAdapter

from dashboards.statements import Said
from herijk.cli.check_text import Checked
from herijk.cli.compare_text import Compared
from herijk.cli.methods_text import MethodReport
from herijk.cli.rebuild_text import NoTowsYet, Rebuilt
from pipeline.tables.row import Row
from warehouse.editions.lineage import Lineage
from warehouse.editions.publish import Published
from warehouse.editions.verify import Verification
from warehouse.queries.assess import Assessment
from warehouse.queries.audit import BoatAudit, TypesAudit
from warehouse.queries.registers import DueReport, RegisterReport
from warehouse.queries.reports import LogErrorReport
from warehouse.queries.years import YearsReport


@dataclass(frozen=True)
class Files:
    """The files that were written."""

    files: list[str]


@dataclass(frozen=True)
class Simulated:
    """A simulated archive, and the file with its truth."""

    archive: str
    truth: str


@dataclass(frozen=True)
class Methods:
    """The methods: `method`, `title`, `content_hash`, and whether it `ships`."""

    methods: list[Row]


FORMS: Final[dict[str, Any]] = {
    "assess TOW": Assessment,
    "audit BOAT": BoatAudit,
    "audit BOAT --edition EDITION": Lineage,
    "audit TYPE": TypesAudit,
    "check": Checked,
    "compare OLD NEW": Compared,
    "export": Files,
    "init": Files,
    "methods": Methods,
    "methods check": MethodReport,
    "methods new": Files,
    "methods show": MethodReport,
    "publish": Published,
    "rebuild": Rebuilt,
    "rebuild of an archive without tows": NoTowsYet,
    "register": RegisterReport,
    "register --due": DueReport,
    "register --years": YearsReport,
    "seasons": LogErrorReport,
    "simulate": Simulated,
    "verify": Verification,
}
"""Classes by the call."""

PLAIN: Final = (Files, Simulated, Methods)
"""Classes of which nothing is said in words."""


def schema(call: str) -> dict[str, Any]:
    """The JSON Schema of what a call prints."""
    form = TypeAdapter(FORMS[call]).json_schema()
    if FORMS[call] not in PLAIN:
        form["properties"]["statements"] = TypeAdapter(list[Said]).json_schema()
        form["required"].append("statements")
    return form
