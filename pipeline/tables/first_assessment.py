"""What is said of a tow while the boat waits; returned to who asks, and stored nowhere."""

from typing import Final, Literal, TypeAlias, get_args

from pipeline.tables import column
from pipeline.tables.declare import dy

Rule: TypeAlias = Literal[
    "no_malfunction",
    "plausible",
    "near_earlier_curve",
    "explained_by_size",
    "intended_speed",
    "little_variation",
    "trimming_suffices",
]
RULES: Final[tuple[Rule, ...]] = get_args(Rule)
"""What the first assessment looks at, in the order of the source (Sleepproef, R. Pot 2017, "Eerste
beoordeling")."""

Verdict: TypeAlias = Literal["not_made", "good", "look", "tow_again"]
VERDICTS: Final[tuple[Verdict, ...]] = get_args(Verdict)
"""From the best to the worst; `not_made` where there is nothing to compare with."""


class FirstAssessment(dy.Schema):
    """What was found by each rule of the first assessment: a row per finding, or one without."""

    method = column.method(primary_key=True)
    tow_id = column.tow_id(primary_key=True)
    place = dy.Int16(description="place in the assessment, from 1", primary_key=True, min=1)
    rule = column.text("rule of the first assessment", regex=f"^({'|'.join(RULES)})$")
    finding = column.text("code of a check, or of what else was found; empty: nothing was")
    verdict = column.text(
        "good; look: somebody must decide; tow_again: these runs, all where none are named; "
        "not_made: nothing to compare with",
        regex=f"^({'|'.join(VERDICTS)})$",
    )
    observed = column.optional("what was observed", unit="as in unit")
    limit = column.optional("the limit that is exceeded", unit="as in unit")
    unit = column.text("unit of both; 1 for a ratio, a count or yes (1) and no (0)")
    runs = dy.List(dy.Int8(), description="runs that it is about")
    instead_of = dy.List(dy.Int8(), description="runs in whose place these could be used")
    old_value = column.optional("size or weight at the tow before", unit="as in the boat's sizes")
    new_value = column.optional("size or weight at this tow", unit="as in the boat's sizes")
    explained_ratio = column.optional("change of Cw that follows from the two")
    others = column.count("other tows of its season of which the check was made", nullable=True)
    others_median = column.optional("median of what was observed of these", unit="as in unit")
