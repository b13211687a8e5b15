"""Where things lie: the lake of Parquet files, locks, safe writing, the database."""
