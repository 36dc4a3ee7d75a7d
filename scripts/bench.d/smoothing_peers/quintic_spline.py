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
        count = len(self.knots) - DEGREE - 1
        third = scipy.interpolate.BSpline(self.knots, np.eye(count), DEGREE).derivative(ORDER)(at)
        third = scipy.sparse.csr_matrix(np.sqrt(weight)[:, None] * third)
        return (third.T @ third).tocsr()

    def coefficients(self, values, penalty):
        matrix = self.normal + penalty * self.rough
        bands = np.zeros((DEGREE + 1, matrix.shape[0]))
        for k in range(DEGREE + 1):
            bands[DEGREE - k, k:] = matrix.diagonal(k)
        return scipy.linalg.solveh_banded(bands, self.basis.T @ values)

    def velocity(self, t, values, penalty):
        return scipy.interpolate.BSpline(self.knots, self.coefficients(values, penalty), DEGREE).derivative()(t)


class QuinticSpline:
    def __init__(self):
        self.systems = {}

    def system(self, t):
        """Kept: one for all clips of a length."""
        if len(t) not in self.systems:
            self.systems[len(t)] = System(t)
        return self.systems[len(t)]

    def __call__(self, t, p, penalty):
        return self.system(t).velocity(t, p, penalty)


class GcvSpline(QuinticSpline):
    """With the penalty of each axis by generalised cross-validation, n RSS / (n - trace)^2. The eigenvalues of
    (rough, normal + rough), kept as well, give the trace at any penalty."""

    penalties = 10.0 ** np.arange(-12, -4, 0.125)

    def __init__(self):
        super().__init__()
        self.shares = {}

    def trace(self, t, penalty):
        if len(t) not in self.shares:
            system, scale = self.system(t), 1e-8
            rough, normal = scale * system.rough.toarray(), system.normal.toarray()
            self.shares[len(t)] = scipy.linalg.eigh(rough, normal + rough, eigvals_only=True) / scale, scale
        rough, scale = self.shares[len(t)]
        normal = 1 - scale * rough
        return (normal / (normal + penalty * rough)).sum()

    def __call__(self, t, p, _):
        system = self.system(t)
        scores = []
        for penalty in self.penalties:
            residual = p - system.basis @ system.coefficients(p, penalty)
            scores.append(len(t) * (residual ** 2).sum(axis=0) / (len(t) - self.trace(t, penalty)) ** 2)
        chosen = self.penalties[np.argmin(scores, axis=0)]
        return np.stack([system.velocity(t, p[:, k], penalty) for k, penalty in enumerate(chosen)], axis=1)
