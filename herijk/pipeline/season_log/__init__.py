"""The log error of each season, estimated from all repeat tows together.

A boat that was not altered must come out the same in two seasons; what is left between them is the
speed log. A speed error acts on Cw at a fixed speed with the elasticity kappa = 2 / (1 - r), so
repeat tows determine it well (research, method.md 8.1). It is the ubercalibration of astronomy:
boats are the stars, seasons the nights, tows calibrated on dGPS the absolute anchor.

Belongs here: the joint estimate (`joint`), how far tows scatter (`scatter`), how sure it all is
(`left_out`) and what it rests on (`network`); which boats would tie the seasons together better
(`ties`); the second estimate without boat identity (`without_boats`); the factor of the log that is
not in use (`other_log`); the test whether a step is the log's or the load cell's (`cause`). Does
not: how Cw of a tow is computed, prescribed corrections (never data here) and what is done with the
factors.

The model, for tow k of boat i in season j, with lambda = ln(true speed / log speed):

    ln Cw_k = theta_i + x_k beta + delta (t_k - t0) + h(lambda_j + w_k; r_k) + eps_k
    ln(GPS / log)_k = lambda_j + w_k + b_j + gamma_k                    (plain GPS, where there is)

h is what a scale error of the log does to a hyperbola exactly, about kappa lambda. Boats theta are
eliminated. Wander w, tow noise eps and GPS noise gamma have variances of their own; their
residuals get the weights of a t distribution, against alterations that nobody reported; of a boat's
only two tows, the weight of their difference.
"""

from herijk.pipeline.season_log.assumed import Prior, Settings
from herijk.pipeline.season_log.cause import log_or_force
from herijk.pipeline.season_log.estimate import SeasonFactors, estimate_season_factors
from herijk.pipeline.season_log.network import GROUP, LINE
from herijk.pipeline.season_log.other_log import other_log_factors
from herijk.pipeline.season_log.scale import scale_effect
from herijk.pipeline.season_log.ties import retow_choice

__all__ = [
    "GROUP",
    "LINE",
    "Prior",
    "SeasonFactors",
    "Settings",
    "estimate_season_factors",
    "log_or_force",
    "other_log_factors",
    "retow_choice",
    "scale_effect",
]
