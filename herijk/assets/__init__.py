"""Who runs: Dagster assets, jobs, checks and resources, as thin as they can be.

If an asset needs an `if` on data, that `if` belongs in `pipeline` or `warehouse`.
"""
