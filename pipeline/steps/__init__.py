"""The steps from samples to run points: window, speed, calibration, wind, resistance."""
