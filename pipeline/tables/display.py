"""The unit and the decimals of a column, by its name.

A name means the same in every table and says its unit by its ending. Whoever shows a column asks
here: the comments of the database, the documents, pages, terminal and paper. Which columns a table
has, with their types, limits and meaning, is declared with the table.
"""

from typing import Final, NamedTuple


class NumberForm(NamedTuple):
    """How the numbers of a column are written.

    Attributes:
        unit: empty for a ratio or a count.
        decimals: how many are shown.
    """

    unit: str
    decimals: int


_BY_ENDING: Final = {
    "_kg_m": NumberForm("kg/m", 2),
    "_m_s": NumberForm("m/s", 2),
    "_kg": NumberForm("kg", 0),
    "_m": NumberForm("m", 2),
    "_w": NumberForm("W", 1),
    "_seconds": NumberForm("s", 0),
    "_s": NumberForm("s", 0),
    "_n": NumberForm("N", 0),
    "_c": NumberForm("°C", 1),
    "_deg": NumberForm("°", 0),
    "_hz": NumberForm("Hz", 0),
    "_percent": NumberForm("%", 1),
    "_deviation_sd": NumberForm("sd", 1),
}

_BY_NAME: Final = {
    "cw_sd": NumberForm("kg/m", 2),
    "cw_ratio": NumberForm("", 3),
    "distance_sd": NumberForm("sd", 1),
    "dof": NumberForm("", 1),
    "e_n": NumberForm("", 2),
    "p_value": NumberForm("", 3),
    "tow_speed_n": NumberForm("", 0),
    "weight_n": NumberForm("", 0),
}
"""Names whose ending does not tell."""

_RATIO: Final = NumberForm("", 4)


def find_number_form(name: str) -> NumberForm:
    """Return the unit and decimals of the numbers in the column of this name."""
    if name in _BY_NAME:
        return _BY_NAME[name]
    for ending, form in _BY_ENDING.items():
        if name.endswith(ending):
            return form
    return _RATIO
