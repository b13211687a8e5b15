"""How serious a check of the assessment is; what each asks of people is said with the checks."""

from typing import Final, Literal, get_args

Severity = Literal["note", "look", "refuse"]
SEVERITY_PATTERN: Final = f"^({'|'.join(get_args(Severity))})$"
