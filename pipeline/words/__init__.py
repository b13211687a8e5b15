"""Every text that people read, in Dutch and English.

Texts of pages and documents have a key (`catalogue`); sentences that are said where they arise,
of faults and of the command line, go by their English text (`sentences`).
"""

from pipeline.words.sentences import (
    DECIMALS,
    LANGUAGE,
    LANGUAGES,
    Sentence,
    cause_of,
    dutch,
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
    "dutch",
    "in_per_cent",
    "innermost",
    "number",
    "say",
    "spoken",
    "tell",
]
