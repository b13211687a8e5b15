"""Every text that people read, in Dutch and English.

Texts of pages and documents have a key (`catalogue`); sentences that are said where they arise,
of faults and of the command line, go by their English text (`sentences`).
"""

from herijk.words.catalogue import LANGUAGES, WORDS, Say, Words, both, speaker
from herijk.words.sentences import (
    DECIMALS,
    DUTCH,
    LANGUAGE,
    Sentence,
    cause_of,
    code,
    innermost,
    number,
    say,
    spoken,
    tell,
)

__all__ = [
    "DECIMALS",
    "DUTCH",
    "LANGUAGE",
    "LANGUAGES",
    "WORDS",
    "Say",
    "Sentence",
    "Words",
    "both",
    "cause_of",
    "code",
    "innermost",
    "number",
    "say",
    "speaker",
    "spoken",
    "tell",
]
