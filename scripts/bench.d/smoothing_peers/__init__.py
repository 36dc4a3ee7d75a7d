"""What velocity is made of positions with elsewhere. A peer has `tunings`, of which an oracle takes the best (one that
tunes itself has one), and velocity(time_s [frames], position_m [frames, 3], tuning) -> [frames, 3] in m/s."""
import itertools
from dataclasses import dataclass
from typing import Callable

import numpy as np
import scipy.signal
import simdkalman

from .quintic_spline import GcvSpline, QuinticSpline

MEASUREMENT_M = 0.002


@dataclass(frozen=True)
class Peer:
    name: str
    tunings: tuple
    velocity: Callable
    describe: Callable = lambda tuning: "tunes itself"


def savitzky_golay(t, p, tuning):
    window, degree = tuning
    return scipy.signal.savgol_filter(p, window, degree, deriv=1, delta=t[1] - t[0], axis=0)


def butterworth(t, p, tuning):
    order, cutoff_hz = tuning
    sections = scipy.signal.butter(order, cutoff_hz, fs=1 / (t[1] - t[0]), output="sos")
    return np.gradient(scipy.signal.sosfiltfilt(sections, p, axis=0), t, axis=0)


def butterworth_by_residuals(t, p, _):
    """Winter's residual analysis: the RMS residual over the cutoff is a line where only noise is left; the cutoff is where
    the residual has come down to that line's value at 0 Hz."""
    cutoffs_hz = np.linspace(1.0, 0.475 / (t[1] - t[0]), 30)
    sections = [scipy.signal.butter(2, f, fs=1 / (t[1] - t[0]), output="sos") for f in cutoffs_hz]
    residuals = np.array([np.sqrt(((scipy.signal.sosfiltfilt(s, p, axis=0) - p) ** 2).mean(axis=0)) for s in sections])
    noise = np.polyfit(cutoffs_hz[20:], residuals[20:], 1)[1]  # [3] at 0 Hz
    columns = [butterworth(t, p[:, k:k + 1], (2, cutoffs_hz[np.argmax(residuals[:, k] <= noise[k])])) for k in range(p.shape[1])]
    return np.hstack(columns)


def kalman(t, p, density):
    """White noise on jerk, by simdkalman; the first state is as good as unknown."""
    h = t[1] - t[0]
    transition = np.array([[1, h, h * h / 2], [0, 1, h], [0, 0, 1]])
    noise = density * np.array([[h ** 5 / 20, h ** 4 / 8, h ** 3 / 6], [h ** 4 / 8, h ** 3 / 3, h * h / 2], [h ** 3 / 6, h * h / 2, h]])
    smoother = simdkalman.KalmanFilter(transition, noise, np.array([[1.0, 0.0, 0.0]]), MEASUREMENT_M ** 2)
    first = np.stack([[x, 0.0, 0.0] for x in p[0]])[:, :, None]
    return smoother.smooth(p.T, initial_value=first, initial_covariance=np.diag([1.0, 1e2, 1e4])).states.mean[:, :, 1].T


def windows():
    halves = (*range(1, 8), 9, 11, 14, 18, 23, 29)  # the long ones are for 60 Hz
    return tuple((2 * half + 1, degree) for half, degree in itertools.product(halves, range(2, 7)) if degree <= 2 * half)


def described(unit, *names):
    return lambda tuning: ", ".join(f"{name} {value:g}" for name, value in zip(names, np.atleast_1d(tuning))) + unit


PEERS = (
    Peer("Savitzky-Golay", windows(), savitzky_golay, described("", "window", "degree")),
    Peer("Butterworth", tuple(itertools.product((2, 4), np.arange(1.0, 9.6, 0.5))), butterworth, described(" Hz", "order", "cutoff")),
    Peer("Butterworth by residual analysis", (None,), butterworth_by_residuals),
    Peer("quintic spline, GCV", (None,), GcvSpline()),
    Peer("quintic spline", tuple(10.0 ** np.arange(-12, -1, 0.25)), QuinticSpline(), described(" m^2 s^5", "penalty")),
    Peer("RTS, simdkalman", tuple(10.0 ** np.arange(-1.5, 5.1, 0.25)), kalman, described(" m^2/s^5", "density")),
)
