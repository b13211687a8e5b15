"""Whether the posterior of the season log is what it says: calibration by simulation, and by MCMC.

    PYTHONPATH=. python -m benchmarks.accuracy.calibration [archives] [steps]

Calibration (Talts et al. 2018): unknowns, faults and variances are drawn from the priors and an
archive from them; the posterior is asked where the truth lies in it. If it is right the answers are
uniform, and of the faults to which it gives a chance p a share p is there. MCMC: on one small
archive without faults a random walk over all unknowns and variances at once, against the Gaussian
approximation at the mode.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"  # read when numpy is imported
os.environ["OPENBLAS_NUM_THREADS"] = "1"

import itertools
import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import scipy

from pipeline.season_log.assumed import USUAL
from pipeline.season_log.likelihood import LEVEL, LEVEL_SD
from pipeline.season_log.network import Network
from pipeline.season_log.posterior import Fit, Problem, _own, _variance_prior, fit, solve
from tests.pipeline.season_worlds import CLEAN, simulate

SMALL = replace(CLEAN, boats=40, tows_a_season=10)
BINS = 10
CHANCES = (0.0, 0.01, 0.05, 0.2, 0.5, 0.8, 1.0)
WARM_UP = 0.3
"""Part of the steps of a chain that is thrown away."""


@dataclass(frozen=True)
class Truth:
    """What an archive was drawn from: a value for every unknown of the problem."""

    problem: Problem
    value: np.ndarray


def blank(seed: int) -> Problem:
    """The problem of an archive of which only the schedule is used: who was towed when."""
    tows = simulate(SMALL, seed).tows
    return Problem.of(Network.of(tows), USUAL)


def drawn(seed: int) -> Truth:
    """An archive from the priors."""
    rng = np.random.default_rng(seed)
    problem = blank(seed)
    unknowns = problem.unknowns
    there = rng.random(len(unknowns)) < [u.chance for u in unknowns]
    value = np.array([u.mean + u.sd * rng.standard_normal() for u in unknowns]) * there
    mean, precision = _variance_prior(problem)
    ln_variance = mean + rng.standard_normal(len(mean)) / np.sqrt(precision)
    active = np.arange(len(unknowns))
    held, residual = replace(problem, observed=0.0 * problem.observed).slopes(value, active)
    own, _ = _own(problem, held, ln_variance)
    noise = np.einsum(
        "nij,nj->ni",
        np.linalg.cholesky(own + 1e-12 * np.eye(3)),
        rng.standard_normal((len(own), 3)),
    )
    state = np.zeros((len(own), 2))
    s = problem.settings
    share, askew_share = (
        rng.beta(mean * count, (1.0 - mean) * count)
        for mean, count in ((s.changed_share, s.changed_gaps), (s.askew_share, s.askew_tows))
    )
    for group in problem.groups:
        for tows, drift in zip(group.tow, group.drift, strict=True):
            early = tows[: group.early]
            askew = rng.random(len(early)) < askew_share
            excess = s.askew_excess.mean + s.askew_excess.sd * rng.standard_normal(len(early))
            noise[early, LEVEL] += askew * excess
            altered = rng.random(len(tows) - 1) < share
            drift_sd = np.sqrt(np.diff(np.diag(drift)) * np.exp(ln_variance[-1]))
            for place, (first, step) in enumerate(
                ((LEVEL_SD, s.changed_sd), (s.bend_sd, s.changed_bend_sd))
            ):
                steps = step * altered * rng.standard_normal(len(altered))
                if place == LEVEL:
                    steps += drift_sd * rng.standard_normal(len(drift_sd))
                start = first * rng.standard_normal()
                state[tows, place] = start + np.concatenate([[0.0], np.cumsum(steps)])
    observed = -residual + np.einsum("nik,nk->ni", held.state, state) + noise
    return Truth(replace(problem, observed=observed), value)


def calibration(archives: int) -> None:
    """Prints where the truth lies in the posterior, and whether chances of faults hold."""
    places: dict[str, list[float]] = {}
    chance, there = [], []
    for seed in range(archives):
        truth = drawn(seed)
        found = solve(truth.problem)
        sd = np.sqrt(np.diag(found.covariance))
        for i, place in enumerate(found.places.tolist()):
            unknown = truth.problem.unknowns[place]
            if unknown.chance == 1.0:
                z = (truth.value[place] - found.mean[i]) / sd[i]
                places.setdefault(unknown.name, []).append(float(scipy.special.ndtr(z)))
        chance += found.chance.tolist()
        there += (truth.value[truth.problem.faults] != 0.0).tolist()
    print(f"{archives} archives; rank of the truth in ten bins, each {1 / BINS:.0%} if right")
    for name, ranks in places.items():
        counts = np.histogram(ranks, BINS, (0.0, 1.0))[0]
        p_value = scipy.stats.chisquare(counts).pvalue
        shares = " ".join(f"{share:4.0%}" for share in counts / len(ranks))
        inside = np.mean(np.abs(np.array(ranks) - 0.5) < 0.475)
        print(f"  {name:18s} {shares}   95 % hold {inside:.0%} of {len(ranks)}, p {p_value:.3f}")
    print("faults: chance given, number, mean chance, share that is there")
    for low, high, told, real in reliability(np.array(chance), np.array(there)):
        print(
            f"  {low:4.0%} to {high:4.0%}  {len(told):6d}  {told.mean():6.1%}  {real.mean():6.1%}"
        )


def reliability(chance: np.ndarray, there: np.ndarray) -> Iterator[tuple]:
    """Chances given and what was there, by how large the chance was."""
    for low, high in itertools.pairwise(CHANCES):
        mine = (chance >= low) & ((chance < high) | (high == 1.0))
        if mine.any():
            yield low, high, chance[mine], there[mine]


def ln_density(problem: Problem, found: Fit, place: np.ndarray) -> float:
    """Ln posterior of unknowns and ln variances, boats and alterations integrated out."""
    k = len(found.active)
    value, ln_variance = place[:k], place[k:]
    chosen = [problem.unknowns[i] for i in found.active]
    mean, precision = _variance_prior(problem)
    total = -0.5 * np.sum(((value - [u.mean for u in chosen]) / [u.sd for u in chosen]) ** 2)
    total -= 0.5 * np.sum(precision * (ln_variance - mean) ** 2)
    held, residual = problem.slopes(value, found.active)
    own, _ = _own(problem, held, ln_variance)
    for group in problem.groups:
        boats, tows = group.tow.shape
        z = held.state[group.tow]
        full = np.zeros((boats, len(group.askew), tows, 3, tows, 3))
        for n, prior in enumerate((group.level, group.bend)):
            full += np.einsum("bki,blj,pkl->bpkilj", z[..., n], z[..., n], prior)
        drift = np.exp(ln_variance[-1]) * group.drift
        full += np.einsum("bki,blj,bkl->bkilj", z[..., 0], z[..., 0], drift)[:, None]
        for tow in range(tows):
            full[:, :, tow, :, tow, :] += own[group.tow[:, tow]][:, None]
            full[:, :, tow, LEVEL, tow, LEVEL] += group.excess_variance * group.askew[:, tow]
        full = full.reshape(boats, -1, 3 * tows, 3 * tows)
        root = np.linalg.cholesky(full)
        off = np.repeat(residual[group.tow][:, None], len(group.askew), axis=1)
        off[..., LEVEL] -= group.excess
        white = np.linalg.solve(root, off.reshape(*full.shape[:3], 1))[..., 0]
        each = -0.5 * (white**2).sum(-1)
        each -= np.log(np.diagonal(root, axis1=-2, axis2=-1)).sum(-1)
        total += scipy.special.logsumexp(each + group.prior(found.state.shares), axis=1).sum()
    return float(total)


def random_walk(problem: Problem, found: Fit, steps: int, seed: int) -> np.ndarray:
    """Metropolis with steps of the shape of the approximation; the unknowns after warming up."""
    rng = np.random.default_rng(seed)
    shape = scipy.linalg.block_diag(found.covariance, found.ln_variance_covariance)
    root = np.linalg.cholesky(shape)
    now = np.concatenate([found.value, found.state.ln_variance])
    here, size, taken = ln_density(problem, found, now), 2.38 / np.sqrt(len(now)), []
    warm_up = int(WARM_UP * steps)
    for step in range(steps):
        there = now + size * root @ rng.standard_normal(len(now))
        its = ln_density(problem, found, there)
        accepted = np.log(rng.random()) < its - here
        if accepted:
            now, here = there, its
        if step < warm_up:
            size *= np.exp((accepted - 0.234) / np.sqrt(step + 1.0))
        else:
            taken.append(now[: len(found.active)])
    return np.array(taken)


def against_mcmc(steps: int) -> None:
    """Prints mean and standard deviation of the logs by both, and how far two chains differ."""
    problem = drawn(0).problem
    found = fit(problem, problem.always)
    chains = [random_walk(problem, found, steps, seed) for seed in (1, 2)]
    both = np.concatenate(chains)
    print(
        f"\nMCMC, two chains of {steps}: log factor, mean and sd by both in %, chains apart in sd"
    )
    for i, place in enumerate(found.active.tolist()):
        unknown = problem.unknowns[place]
        if unknown.name == problem.unknowns[0].name:
            sd = float(np.sqrt(found.covariance[i, i]))
            apart = abs(chains[0][:, i].mean() - chains[1][:, i].mean()) / both[:, i].std()
            means, sds = (found.value[i], both[:, i].mean()), (sd, both[:, i].std())
            texts = (" ".join(f"{100 * x:7.3f}" for x in pair) for pair in (means, sds))
            print(f"  {unknown.season}  mean {{}}   sd {{}}   {apart:.2f}".format(*texts))


def main() -> None:
    """Both checks."""
    archives = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    steps = int(sys.argv[2]) if len(sys.argv) > 2 else 60_000
    calibration(archives)
    against_mcmc(steps)


if __name__ == "__main__":
    main()
