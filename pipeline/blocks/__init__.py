"""Blocks: sums of a tow's samples per second, from which every method can be computed."""
