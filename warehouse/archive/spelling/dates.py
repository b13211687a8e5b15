"""Dates in cells, in the orders and words in which people write them."""

import datetime as dt
import re
from collections.abc import Iterable
from typing import Final

_ISO_DATE: Final = re.compile(r"([0-9]{4})[-/.]([0-9]{1,2})[-/.]([0-9]{1,2})")
_DAY_FIRST: Final = re.compile(r"([0-9]{1,2})([-./ ])([0-9]{1,2})\2([0-9]{4}|[0-9]{2})")
_MONTH_NAMED: Final = re.compile(r"([0-9]{1,2})[. -]+([a-zäé]{3,9})[. -]+'?([0-9]{4}|[0-9]{2})")
_SERIAL_DATE: Final = re.compile(r"(?:3[3-9]|4[0-9]|5[0-4])[0-9]{3}")
"""What a spreadsheet shows of a date in a cell that is not set to show dates: 1990 to 2050."""
_EXCEL_DAY_0: Final = dt.date(1899, 12, 30)
_WEEKDAY: Final = re.compile(r"^[a-z]{2,10}[.,]*\s+(?=[0-9])")
_TIME_OF_DAY: Final = re.compile(r"[ T]+[0-9]{1,2}:[0-9]{2}(:[0-9]{2}([.,][0-9]+)?)?$")
_MONTHS: Final = {
    name: number
    for number, names in enumerate(
        ("jan", "feb", "mrt mar maa mär", "apr", "mei may mai", "jun", "jul", "aug", "sep",
         "okt oct", "nov", "dec dez"), start=1
    )
    for name in names.split()
}  # fmt: skip


class AmbiguousDateError(ValueError):
    """Day and month can be exchanged."""


def parse_date(text: str, order: str = "") -> dt.date:
    """The date in a text, the year first or the day first; a time of day is left out.

    Args:
        text: `2014-03-01`, `1-3-2014`, `01.03.14`, `1/3/2014`, `za 1 maart 2014`, `1-mrt-14`,
            or the number of days that a spreadsheet holds.
        order: `dmy` or `mdy` for dates with slashes; without, only one meaning may be possible.

    Raises:
        AmbiguousDateError: day and month can be exchanged.
        ValueError: it is not a date.
    """
    text = _WEEKDAY.sub("", _TIME_OF_DAY.sub("", text.strip().casefold()))
    iso, day_first = _ISO_DATE.fullmatch(text), _DAY_FIRST.fullmatch(text)
    named = _MONTH_NAMED.fullmatch(text)
    if iso:
        return dt.date(int(iso[1]), int(iso[2]), int(iso[3]))
    if _SERIAL_DATE.fullmatch(text):
        return _EXCEL_DAY_0 + dt.timedelta(days=int(text))
    if named and named[2][:3] in _MONTHS:
        return dt.date(_year(named[3]), _MONTHS[named[2][:3]], int(named[1]))
    if not day_first:
        raise ValueError(text)
    first, second = int(day_first[1]), int(day_first[3])
    if day_first[2] == "/" and not order and first != second and max(first, second) <= 12:
        raise AmbiguousDateError(text)
    month_first = day_first[2] == "/" and (order == "mdy" or (not order and second > 12))
    day, month = (second, first) if month_first else (first, second)
    return dt.date(_year(day_first[4]), month, day)


def _year(digits: str) -> int:
    return int(digits) + (2000 if len(digits) == 2 else 0)


def date_order(cells: Iterable[str]) -> str:
    """`dmy` or `mdy` where dates with slashes in a list can only be meant so, else empty."""
    matches = (_DAY_FIRST.fullmatch(_TIME_OF_DAY.sub("", cell.strip())) for cell in cells)
    pairs = [(int(m[1]), int(m[3])) for m in matches if m and m[2] == "/"]
    orders = {"dmy" for first, _ in pairs if first > 12}
    orders |= {"mdy" for _, second in pairs if second > 12}
    return orders.pop() if len(orders) == 1 else ""
