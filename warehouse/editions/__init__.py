"""Editions: registers that were published, each a folder that is never changed afterwards.

Nothing here looks at a clock: the day of publication is an argument.
"""
