"""The tables: every name, dtype, unit, range, key and meaning, declared once."""
