"""`archief.toml`: what differs from season to season, and how an archive words things."""
