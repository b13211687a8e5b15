"""Recomputes the history of the Dutch rowing-sloop register from its tow tests."""
