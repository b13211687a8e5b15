"""Partitions: the seasons of the archive, and the methods that were applied."""

import dagster as dg

seasons = dg.DynamicPartitionsDefinition(name="season")
"""Seasons are found in the archive, so a new campaign needs no change of code."""

methods = dg.DynamicPartitionsDefinition(name="method")
"""A federation may add a method of its own to those that ship."""
