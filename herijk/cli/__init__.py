"""The command `herijk`: reads arguments, shows progress and results, holds no logic."""
