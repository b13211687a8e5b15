"""How serious a check of the assessment is; what each asks of people stands with the checks."""

from typing import Final, Literal, get_args

Severity = Literal["note", "look", "refuse"]
SEVERITIES: Final[tuple[str, ...]] = get_args(Severity)
SEVERITY_PATTERN: Final = f"^({'|'.join(SEVERITIES)})$"
