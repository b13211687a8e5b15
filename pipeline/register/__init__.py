"""The register: which tow counts, until when, what changes, and what that does to races."""
