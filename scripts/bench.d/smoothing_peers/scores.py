"""Scores of smoothed tracks against the truth. The first and last EDGE_S of a track do not count, nor do frames within
EVENT_S of a true release or landing: there the low-passed truth itself is wrong by a part of the velocity's jump."""

from dataclasses import dataclass

import numpy as np

EDGE_S = 0.5
EVENT_S = 0.015
QUANTILE_80 = 1.2815515655446004  # of a normal distribution, two-sided
TRUE_EVENT_S = 0.005  # standard deviation of a true release or landing


@dataclass(frozen=True)
class Estimate:
    position_m: np.ndarray  # [frames, 3]
    velocity_m_per_s: np.ndarray
    covariance: np.ndarray = None  # [frames, 6, 6] of position and velocity
    flights_s: np.ndarray = None  # [flights, 4]: release, landing, their sigmas


def counted(track):
    """Mask of the frames that count."""
    events = track.flights_s.ravel()
    near_event = (np.abs(track.time_s[:, None] - events) < EVENT_S).any(axis=1)
    return (track.time_s >= EDGE_S) & (track.time_s <= track.time_s[-1] - EDGE_S) & ~near_event


def errors(tracks, estimates, key):
    """Errors [frames, 3] of "position_m" or "velocity_m_per_s" over the counted frames of all tracks."""
    return np.concatenate([(getattr(estimate, key) - getattr(track, key))[counted(track)] for track, estimate in zip(tracks, estimates)])


def rms(tracks, estimates, key):
    """Per axis."""
    return np.sqrt((errors(tracks, estimates, key) ** 2).mean())


def consistency(tracks, estimates):
    """Mean NEES over 6, and the shares of positions and velocities inside their stated 80 % intervals, both with the truth's own
    error: a marker that jumps by 2 mm is 40 mm/s in the truth, where a smoother states 3 mm/s."""
    error = np.hstack([errors(tracks, estimates, key) for key in ("position_m", "velocity_m_per_s")])
    covariance = np.concatenate([(estimate.covariance + track.true_variance[:, None] * np.eye(6))[counted(track)]
                                 for track, estimate in zip(tracks, estimates)])
    nees = np.einsum("ni,ni->n", error, np.linalg.solve(covariance, error[:, :, None])[:, :, 0]) / 6
    inside = np.abs(error) <= QUANTILE_80 * np.sqrt(np.einsum("nii->ni", covariance))
    return dict(nees=nees.mean(), position_coverage=inside[:, :3].mean(), velocity_coverage=inside[:, 3:].mean())


def flights(tracks, estimates):
    """Numbers of true, found and false flights, of events of found flights, and of those within 2 sigma of the true time.

    A true flight is found if one of the estimate's covers more than half of their union. A false flight overlaps no true
    one. Flights that reach into the edges do not count."""
    counts = dict(true=0, found=0, false=0, events=0, within=0)
    for track, estimate in zip(tracks, estimates):
        last = track.time_s[-1] - EDGE_S
        for release, landing, *_ in estimate.flights_s:
            overlap = np.minimum(track.flights_s[:, 1], landing) - np.maximum(track.flights_s[:, 0], release)
            counts["false"] += int(release >= EDGE_S and landing <= last and not (overlap > 0).any())
        for true in track.flights_s:
            if true[0] < EDGE_S or true[1] > last:
                continue
            counts["true"] += 1
            common = np.minimum(estimate.flights_s[:, 1], true[1]) - np.maximum(estimate.flights_s[:, 0], true[0])
            union = np.maximum(estimate.flights_s[:, 1], true[1]) - np.minimum(estimate.flights_s[:, 0], true[0])
            found = np.flatnonzero(common > 0.5 * union)
            if len(found):
                times, sigmas = np.split(estimate.flights_s[found[0]], 2)
                counts["found"] += 1
                counts["events"] += 2
                counts["within"] += int((np.abs(times - true) <= 2 * np.hypot(sigmas, TRUE_EVENT_S)).sum())
    return counts
