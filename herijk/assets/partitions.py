"""Partitions: the seasons the archive has, and the methods that ship."""

import dagster as dg

from herijk.pipeline.method.definition import shipped_methods

seasons = dg.DynamicPartitionsDefinition(name="season")
"""Seasons are found in the archive, so a new campaign needs no change of code."""

methods = dg.StaticPartitionsDefinition(list(shipped_methods()))
