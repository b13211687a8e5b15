"""What is true: the measuring method, physics and statistics.

Pure functions from arrays, frames and a `Method` to frames. No Dagster, no files, no clock,
no environment: those belong to `warehouse` and `assets`.
"""
