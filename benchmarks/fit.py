"""Batch fit of the hyperbola against scipy.optimize.least_squares, on the same cases in one run.

    PYTHONPATH=. python -m benchmarks.fit [cases]

One thread. Both start from the points alone; scipy gets the analytic Jacobian and well-scaled
parameters, its fastest way for this problem. The equality check polishes scipy's answer with plain
Gauss-Newton steps, since it stops once the sum of squares no longer changes.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"  # read when numpy is imported, so before it
os.environ["OPENBLAS_NUM_THREADS"] = "1"
os.environ["MKL_NUM_THREADS"] = "1"

import sys
import time

import numpy as np
from scipy.optimize import least_squares

from benchmarks.harness import machine, median_seconds
from pipeline import curve

REPEATS = 5
LARGE_BATCH = 200_000
RUN_RATIOS = np.array([0.9, 1.0, 1.1, 0.9, 1.0, 1.1])


def cases(n, seed=20260101):
    """Six run points per boat: r of 0.1-0.45, 1-3 % noise, speeds within 0.5 % of the intended."""
    rng = np.random.default_rng(seed)
    v0, c0, r = rng.uniform(2, 3, n), rng.uniform(15, 60, n), rng.uniform(0.1, 0.45, n)
    a, s = curve.from_c0_q(c0, r / (1 - r), v0)
    speed = v0[:, None] * RUN_RATIOS * rng.normal(1.0, 0.005, (n, 6))
    noise = rng.uniform(0.01, 0.03, (n, 1)) * rng.normal(size=(n, 6))
    return curve.Points.of(speed, curve.cw(a[:, None], s[:, None], speed) * (1 + noise))


class Scipy:
    """One curve by least_squares in C0 and q at the mean speed."""

    def __init__(self, speed, cw):
        self.pivot = speed.mean()
        self.x = (speed / self.pivot) ** 2 - 1
        self.cw = cw

    def residuals(self, p):
        return p[0] / (1 - p[1] * self.x) - self.cw

    def jacobian(self, p):
        g = 1 / (1 - p[1] * self.x)
        return np.stack([g, p[0] * self.x * g * g], axis=1)

    def fit(self):
        start = [self.cw.mean(), 0.1]
        tight = {"xtol": 1e-15, "ftol": 1e-15, "gtol": 1e-15}
        return least_squares(self.residuals, start, self.jacobian, method="lm", **tight).x

    def polish(self, p):
        for _ in range(3):
            p = p - np.linalg.lstsq(self.jacobian(p), self.residuals(p))[0]
        return p


def difference(fitted, solvers, parameters):
    """Largest relative difference in A and, on the scale of v^2, in s."""
    pivots = np.array([solver.pivot for solver in solvers])
    a, s = curve.from_c0_q(*np.transpose(parameters), pivots)
    return np.abs(fitted.a_kg_m / a - 1).max(), np.abs((fitted.s_s2_m2 - s) * pivots**2).max()


def main():
    n = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    points = cases(n)
    solvers = [Scipy(v, c) for v, c in zip(points.speed_m_s, points.cw_kg_m, strict=True)]
    fitted = curve.fit(points)
    assert fitted.converged.all()

    batch_s = median_seconds(lambda: curve.fit(points), REPEATS)
    start = time.perf_counter()
    answers = [solver.fit() for solver in solvers]
    scipy_s = time.perf_counter() - start
    polished = [s.polish(p) for s, p in zip(solvers, answers, strict=True)]
    many = cases(LARGE_BATCH)
    many_s = median_seconds(lambda: curve.fit(many), REPEATS)

    print(machine("numpy", "scipy"))
    print(f"{n} cases, 6 points each, one thread; median of {REPEATS} (scipy: 1 pass)")
    print(f"  batch fit       {batch_s / n * 1e6:9.2f} us a fit {n / batch_s:12,.0f} fits/s")
    print(f"  least_squares   {scipy_s / n * 1e6:9.2f} us a fit {n / scipy_s:12,.0f} fits/s")
    print(f"  ratio           {scipy_s / batch_s:9.0f}")
    print(f"  batch of {LARGE_BATCH:,}: {LARGE_BATCH / many_s:,.0f} fits/s")
    for name, parameters in (("least_squares", answers), ("the same, polished", polished)):
        in_a, in_s = difference(fitted, solvers, parameters)
        print(f"  largest difference from {name}: A {in_a:.1e}, s v^2 {in_s:.1e}")
    assert max(difference(fitted, solvers, polished)) < 1e-8


if __name__ == "__main__":
    main()
