"""Building: which table is stale, and making each of them from the lake."""
