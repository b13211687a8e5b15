"""What comes in from the archive, how tables are made, kept and asked, and what an edition is.

The measuring method is in `pipeline`, Dagster in `assets`.
"""
