"""Moved to `pipeline.messages`."""

from pipeline.messages import (
    DECIMALS,
    LANGUAGE,
    LANGUAGES,
    Sentence,
    cause_of,
    in_per_cent,
    innermost,
    number,
    say,
    spoken,
    tell,
)

__all__ = [
    "DECIMALS",
    "LANGUAGE",
    "LANGUAGES",
    "Sentence",
    "cause_of",
    "in_per_cent",
    "innermost",
    "number",
    "say",
    "spoken",
    "tell",
]
