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
    flights_s: np.ndarray  # [flights, 2]: release and landing
    measured_m: np.ndarray = None  # [frames, 3], with noise
    sigma_m: np.ndarray = None  # [3]


@dataclass(frozen=True)
class RealSet:
    name: str
    kind: str
    gravity_m_per_s2: list
    recordings: dict  # name: (body, spline of each axis, length in s, flights)

    def thinned(self, rate_hz):
        """All recordings at this rate, without noise."""
        tracks = []
        for name, (body, splines, length_s, flights) in self.recordings.items():
            t = np.arange(int(length_s * rate_hz + 1e-6) + 1) / rate_hz
            position, velocity = (np.stack([spline(t, k) for spline in splines], axis=1) for k in (0, 1))
            tracks.append(Track(name, body, t, position, velocity, flights))
        return tracks


def true_splines(t, p, cutoff_hz):
    """The truth: a quintic smoothing spline per axis at the native rate, with half amplitude at the cutoff.

    An interpolating spline would turn the recording's own noise of 0.1 mm into 0.02 m/s; this leaves 0.001 to 0.004 m/s."""
    step = (t[-1] - t[0]) / (len(t) - 1)
    return [System(t).spline(values, 1 / (step * (2 * np.pi * cutoff_hz) ** 6)) for values in p.T]


def load_set(folder):
    about = json.loads((folder / "set.json").read_text())
    bodies = {name: body for body, names in about.get("bodies", {}).items() for name in names}
    recordings, cutoff_hz = {}, about.get("cutoff_hz", 12)
    for file in sorted(folder.glob("*.csv")):
        data = np.loadtxt(file, delimiter=",", skiprows=1)
        flights = np.array(about.get("flights_s", {}).get(file.stem, [])).reshape(-1, 2)
        t = data[:, 0] - data[0, 0]
        recordings[file.stem] = bodies.get(file.stem, file.stem), true_splines(t, data[:, 1:], cutoff_hz), t[-1], flights
    return RealSet(folder.name, about["kind"], about["gravity_m_per_s2"], recordings)


def load_sets(folder, match=""):
    return [load_set(file.parent) for file in sorted(pathlib.Path(folder).glob("*/set.json")) if match in file.parent.name]


def noisy(track, rate_hz, noise):
    """The track with white noise. The seed depends on the track's name, the rate and the noise only."""
    sigma = np.array(NOISES_M[noise])
    random = np.random.default_rng(zlib.crc32(f"{track.name} {rate_hz} {noise}".encode()))
    return replace(track, measured_m=track.position_m + sigma * random.normal(size=track.position_m.shape), sigma_m=sigma)
