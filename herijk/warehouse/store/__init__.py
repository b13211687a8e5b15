"""Where things lie: the lake of Parquet files, buckets, locks, safe writing, the database."""
