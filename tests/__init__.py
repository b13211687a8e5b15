"""Tests: a mirror of the rooms. All of them run on two threads, before any library counts cores."""

import os

for _name in ("POLARS_MAX_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(_name, "2")
