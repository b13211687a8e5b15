"""The log error of each season, estimated from all repeat tows together.

A boat that was not altered must come out the same in two seasons; what is left between them is the
speed log. A speed error acts on Cw at a fixed speed with the elasticity kappa = 2 / (1 - r), so
repeat tows determine it well (docs/method-details.md, 4). It is the ubercalibration of astronomy:
boats are the stars, seasons the nights, tows calibrated on dGPS the absolute anchor.

Belongs here:

- what is assumed (`assumed`), and the unknowns with their effects (`effects`);
- the tows and what ties them together (`archive_tows`), and the density of a boat's (`boats`);
- the posterior of everything (`fit`), what each boat alone says of a fault (`boat_evidence`), and
  which faults there are (`faults`);
- what it says of logs, and which factors are refused (`factors`), of tows (`tow_estimates`) and of
  seasons (`diagnosis`);
- which boats to tow again (`retow_design`).

Does not belong here: how Cw of a tow is computed, prescribed corrections (never data here), and
what is done with the factors.

The model, for tow k of boat i in season j, with lambda = ln(true speed / log speed):

    ln Cw_k = theta_ik + x_k beta + delta (t_k - t0) + h(lambda_k; q_ik) + phi_j + z_k / F_k + eps_k
    q_k     = g(lambda_k; q_ik) - (1 + q) z_k / F_k + eta_k
    ln(GPS / log)_k = lambda_k + b_j + gamma_k                       (plain GPS, where there is)

h and g are what a scale error of the log does to a hyperbola exactly (`effects`). theta and q of a
boat are random, q about its type, and step where it was altered; theta drifts besides, a random
walk over the seasons. lambda_k = lambda_j + trend + change + between-tow scatter. phi is the scale
of the load cell, z its zero. Faults are rare and large: each is there or not. h and g are taken
about the factor at which ln Cw and q hold (`reference_ln`).
"""

from pipeline.season_log.estimate import SeasonFactors, estimate_season_factors, first_estimate
from pipeline.season_log.retow_design import retow_choice

__all__ = ["SeasonFactors", "estimate_season_factors", "first_estimate", "retow_choice"]
