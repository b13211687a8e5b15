"""Races: from time and distance to speed and power, and back."""
