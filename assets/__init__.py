"""Who runs: Dagster assets, jobs, checks and resources, as thin as they can be.

If an asset needs an `if` on data, that `if` belongs in `pipeline` or `warehouse`.

- What Dagster loads: `definitions`; assets and checks are put together in `location`, from
  `archive`, `tables`, `site` and `checks`, with `resources` and the `workers` that help.
- A rebuild: `rebuild` asks what is stale, has it made in one run (`instance`), and `report`
  writes what changed.
- Without anybody asking: `automation`, by the `settings` in `beheer.toml`; it mails how it went.
- Dagster's page behind the guard: `webserver`.
"""
