"""Recorded motion as tracks with known truth.

A set is a folder of recordings `<name>.csv` (time_s,x_m,y_m,z_m without gaps, at 100 Hz or more) and `set.json`:
{"kind": "hand" | "tool" | "flight", "gravity_m_per_s2": [0, 0, -9.81],
 "cutoff_hz": 12, "bodies": {"body": ["name", ...]}, "flights_s": {"name": [[release, landing], ...]}}
"kind" may also be "impact", which has no goals. Recordings of a body share noise parameters; a recording that `bodies`
does not name is a body of its own. Content above `cutoff_hz` counts as noise of the recording."""

import json
import pathlib
import zlib
from dataclasses import dataclass, replace

import numpy as np

from .quintic_spline import System

RATES_HZ = 20, 60
NOISES_M = {"2 mm": (0.002, 0.002, 0.002), "5 mm": (0.005, 0.005, 0.005), "depth": (0.002, 0.002, 0.006)}


@dataclass(frozen=True)
class Track:
    name: str
    body: str
    time_s: np.ndarray
    position_m: np.ndarray  # [frames, 3], true
    velocity_m_per_s: np.ndarray  # [frames, 3], true
    true_variance: np.ndarray  # [frames, 6], of the errors of the true positions and velocities
    flights_s: np.ndarray  # [flights, 2]: release and landing
    measured_m: np.ndarray = None  # [frames, 3], with noise
    sigma_m: np.ndarray = None  # [3]


@dataclass(frozen=True)
class RealSet:
    name: str
    kind: str
    gravity_m_per_s2: list
    recordings: dict  # name: (body, Truth, length in s, flights)

    def thinned(self, rate_hz):
        """All recordings at this rate, without noise."""
        tracks = []
        for name, (body, truth, length_s, flights) in self.recordings.items():
            t = np.arange(int(length_s * rate_hz + 1e-6) + 1) / rate_hz
            position, velocity = (np.stack([spline(t, k) for spline in truth.splines], axis=1) for k in (0, 1))
            tracks.append(Track(name, body, t, position, velocity, truth.variance_at(t), flights))
        return tracks


class Truth:
    """A quintic smoothing spline per axis at the native rate, with half amplitude at the cutoff.

    An interpolating spline would turn the recording's own noise of 0.1 mm into 0.02 m/s; this leaves 0.001 to 0.004 m/s, and
    more where a marker jumps."""

    def __init__(self, t, p, cutoff_hz):
        step = (t[-1] - t[0]) / (len(t) - 1)
        smoothing = 1 / (step * (2 * np.pi * cutoff_hz) ** 6)
        self.t, self.splines = t, [System(t).spline(values, smoothing) for values in p.T]
        residual = p - np.stack([spline(t) for spline in self.splines], axis=1)
        self.variance = self._variance(residual, step, smoothing, int(np.ceil(2 / (cutoff_hz * step))))

    @staticmethod
    def _variance(residual, step, smoothing, reach):
        """Variance [samples, 6] of position and velocity, which are weighted sums of the samples, whose errors are estimated by
        the residuals: sum of (weight * residual)^2 over what smoothing leaves of an error's variance (White, A
        heteroskedasticity-consistent covariance matrix estimator, 1980). A sample's weight is the response to an impulse; beyond
        `reach`, two periods of the cutoff, it is below 0.1 %."""
        t = step * np.arange(-reach, reach + 1)
        impulse = System(t).spline((t == 0).astype(float), smoothing)
        kept = (((t == 0) - impulse(t)) ** 2).sum()
        squares = residual**2 / kept
        return np.hstack([np.stack([np.convolve(axis, impulse(t, order) ** 2, "same") for axis in squares.T], axis=1)
                          for order in (0, 1)])

    def variance_at(self, t):
        return np.stack([np.interp(t, self.t, values) for values in self.variance.T], axis=1)


def load_set(folder):
    about = json.loads((folder / "set.json").read_text())
    bodies = {name: body for body, names in about.get("bodies", {}).items() for name in names}
    recordings, cutoff_hz = {}, about.get("cutoff_hz", 12)
    for file in sorted(folder.glob("*.csv")):
        data = np.loadtxt(file, delimiter=",", skiprows=1)
        flights = np.array(about.get("flights_s", {}).get(file.stem, [])).reshape(-1, 2)
        t = data[:, 0] - data[0, 0]
        recordings[file.stem] = bodies.get(file.stem, file.stem), Truth(t, data[:, 1:], cutoff_hz), t[-1], flights
    return RealSet(folder.name, about["kind"], about["gravity_m_per_s2"], recordings)


def load_sets(folder, match=""):
    return [load_set(file.parent) for file in sorted(pathlib.Path(folder).glob("*/set.json")) if match in file.parent.name]


def noisy(track, rate_hz, noise):
    """The track with white noise. The seed depends on the track's name, the rate and the noise only."""
    sigma = np.array(NOISES_M[noise])
    random = np.random.default_rng(zlib.crc32(f"{track.name} {rate_hz} {noise}".encode()))
    return replace(track, measured_m=track.position_m + sigma * random.normal(size=track.position_m.shape), sigma_m=sigma)
