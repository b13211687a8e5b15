"""What each step and each choice changes, and what many tows have in common."""
