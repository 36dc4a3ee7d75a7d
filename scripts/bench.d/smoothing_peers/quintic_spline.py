"""The quintic smoothing spline: least squares plus `penalty` times the integral of the squared third derivative, over
B-splines of degree 5 with a knot at each frame."""
import numpy as np
import scipy.interpolate
import scipy.linalg
import scipy.sparse

DEGREE, ORDER = 5, 3


class System:
    """The banded least squares of frames at `t`."""

    def __init__(self, t):
        self.knots = np.r_[[t[0]] * DEGREE, t, [t[-1]] * DEGREE]
        self.basis = scipy.interpolate.BSpline.design_matrix(t, self.knots, DEGREE).tocsr()
        self.normal, self.rough = (self.basis.T @ self.basis).tocsr(), self.roughness(t)

    def roughness(self, t):
        """Of third derivatives, which are piecewise quadratic: three points of Gauss make their squares' integrals exact."""
        nodes, weights = np.polynomial.legendre.leggauss(ORDER)
        half = np.diff(t)[:, None] / 2
        at, weight = (t[:-1, None] + half * (1 + nodes)).ravel(), (half * weights).ravel()
        knots, count = self.knots, len(self.knots) - DEGREE - 1
        derivative = scipy.sparse.identity(count, format="csr")
        for degree in range(DEGREE, DEGREE - ORDER, -1):
            slope = degree / (knots[degree + 1:-1] - knots[1:-degree - 1])
            derivative = scipy.sparse.diags([-slope, slope], [0, 1], (len(slope), len(slope) + 1)) @ derivative
            knots = knots[1:-1]
        third = scipy.interpolate.BSpline.design_matrix(at, knots, DEGREE - ORDER) @ derivative
        third = scipy.sparse.diags(np.sqrt(weight)) @ third
        return (third.T @ third).tocsr()

    def coefficients(self, values, penalty):
        matrix = self.normal + penalty * self.rough
        bands = np.zeros((DEGREE + 1, matrix.shape[0]))
        for k in range(DEGREE + 1):
            bands[DEGREE - k, k:] = matrix.diagonal(k)
        return scipy.linalg.solveh_banded(bands, self.basis.T @ values)

    def spline(self, values, penalty):
        return scipy.interpolate.BSpline(self.knots, self.coefficients(values, penalty), DEGREE)


def grid(t):
    """The same for all clips of a length and rate."""
    return len(t), round(t[1] - t[0], 9)


class QuinticSpline:
    def __init__(self):
        self.systems = {}

    def system(self, t):
        """Kept: one for all clips of a length and rate."""
        if grid(t) not in self.systems:
            self.systems[grid(t)] = System(t)
        return self.systems[grid(t)]

    def __call__(self, t, p, penalty):
        return self.system(t).spline(p, penalty).derivative()(t)


class GcvSpline(QuinticSpline):
    """With the penalty of each axis by generalised cross-validation, n RSS / (n - trace)^2. The eigenvalues of
    (rough, normal + rough), kept as well, give the trace at any penalty."""

    penalties = 10.0 ** np.arange(-12, 0, 0.125)

    def __init__(self):
        super().__init__()
        self.shares = {}

    def trace(self, t, penalty):
        if grid(t) not in self.shares:
            system, scale = self.system(t), 1e-8
            rough, normal = scale * system.rough.toarray(), system.normal.toarray()
            self.shares[grid(t)] = scipy.linalg.eigh(rough, normal + rough, eigvals_only=True) / scale, scale
        rough, scale = self.shares[grid(t)]
        normal = 1 - scale * rough
        return (normal / (normal + penalty * rough)).sum()

    def splines(self, t, p):
        """One for each column of p."""
        system = self.system(t)
        scores = []
        for penalty in self.penalties:
            residual = p - system.basis @ system.coefficients(p, penalty)
            scores.append(len(t) * (residual ** 2).sum(axis=0) / (len(t) - self.trace(t, penalty)) ** 2)
        chosen = self.penalties[np.argmin(scores, axis=0)]
        return [system.spline(p[:, k], penalty) for k, penalty in enumerate(chosen)]

    def __call__(self, t, p, _):
        return np.stack([spline.derivative()(t) for spline in self.splines(t, p)], axis=1)
