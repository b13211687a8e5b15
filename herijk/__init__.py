"""The front door: the `herijk` command. Reads arguments, shows results, holds no logic."""
