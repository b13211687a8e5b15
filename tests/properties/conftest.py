"""Settings of the property tests: the same examples every time, whatever the machine's speed."""

from hypothesis import settings

settings.register_profile("repeatable", deadline=None, derandomize=True)
settings.load_profile("repeatable")
