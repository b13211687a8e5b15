"""Who runs: Dagster assets, jobs, checks and resources, as thin as they can be.

If an asset needs an `if` on data, that `if` belongs in `pipeline` or `warehouse`.

- What Dagster loads: `definitions`, with the assets of `archive`, `tables` and `site`, their
  `checks`, `partitions` and `resources`, and what its page shows of them (`shown`).
- A rebuild: `rebuild`, in one run (`runs`) that records `events`; its steps `side_by_side`, seasons
  on a `cluster`; its `progress`, and whether the site is stale (`site_state`).
- Afterwards: `report` writes what changed, `notify` tells people.
- Without anybody asking: `automation`, by the `settings` in `beheer.toml`.
- Dagster itself: its `event_log`, and its page behind the guard (`webserver`).
"""
