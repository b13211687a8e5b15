"""Who runs: Dagster assets, checks, job, schedule and sensors.

- Assets by subject: `archive`, `rules` (what people decide), `curves`, `consistency`, `register`,
  `database` (with site, report and checks). Each is a function of the tables that it names.
- `lake` reads and writes tables, and holds the one rule of freshness. `definitions` is what
  Dagster loads; `automation`, what starts by itself, by the `settings` in `beheer.toml`.
- The command: `rebuild` asks whether anything changed, `run` runs the job in this process.
"""
