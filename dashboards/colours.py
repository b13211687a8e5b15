"""Colours of charts and of pictures that are drawn without a library."""

from typing import Final

OKABE_ITO: Final = (
    "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#999999",
)  # fmt: skip
"""Okabe and Ito (2008), dark ones first; yellow is left out, it cannot be seen on white."""
GREY: Final = "#666666"
