"""What a table is, where it lies, what comes in from the archive and what an edition is.

No measuring method here (that is `pipeline`) and no Dagster (that is `assets`).
"""
