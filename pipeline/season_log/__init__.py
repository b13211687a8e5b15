"""The log error of each season, estimated from all repeat tows together.

A boat that was not altered must come out the same in two seasons; what is left between them is the
speed log. A speed error acts on Cw at a fixed speed with the elasticity kappa = 2 / (1 - r), so
repeat tows determine it well (docs/method-details.md, 4). It is the ubercalibration of astronomy
(Padmanabhan et al. 2008): boats are the stars, seasons the nights, dGPS the absolute anchor.

A linear mixed model, in the order in which to read it:

1. `priors`: the size of everything that is assumed;
2. `archive`: what is observed of each tow, and which tows share a boat or a log;
3. `observation_model`: the unknowns, and what each does to the observed numbers (the design
   matrix);
4. `patterns`: boats that were altered or pulled askew without a report (a normal mixture per boat);
5. `fit`: effects by generalised least squares, variances by REML, patterns by EM;
6. `faults`: which faults of instruments there are (score test, refit, evidence), with
   `boat_evidence`: what each boat alone says of them;
7. `factors`, `tow_estimates`, `season_levels`, `diagnosis`: what follows for logs, tows, seasons;
8. `estimate`: all of it as tables.

Not here: how Cw of a tow is computed, prescribed corrections (never data here), and what is done
with the factors.
"""

from pipeline.season_log.estimate import SeasonFactors, estimate_roughly, estimate_season_factors

__all__ = ["SeasonFactors", "estimate_roughly", "estimate_season_factors"]
