"""Which files an archive has: their names, where they lie, their bytes and their hashes.

Not what is in them: that belongs to `sheets` and `lists`, and to `samples`.
"""
