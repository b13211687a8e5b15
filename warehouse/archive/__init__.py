"""The federation's files: what they look like, how they are read, and simulated ones written."""
