"""Whether a tow may be believed: the checks of the federation and their limits."""
