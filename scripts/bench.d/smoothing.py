# `touchtrace smooth` on motion capture that is thinned and given known noise, evaluated against an untuned spline and
# against peers that an oracle tunes on each set. Also: do the stated covariances and event times fit the errors?
# needs: numpy scipy simdkalman
import argparse
import csv
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time
from collections import defaultdict

import numpy as np

import figures
from figures import at_most, row, within
from smoothing_peers import PEERS, real_sets, scores
from smoothing_peers.quintic_spline import GcvSpline
from smoothing_peers.real_sets import NOISES_M, RATES_HZ
from smoothing_peers.scores import Estimate

HELD_GOALS = {"2 mm": 0.9, "5 mm": 0.93, "depth": 0.93}
VELOCITY_GOALS = {"hand": HELD_GOALS, "tool": HELD_GOALS, "flight": dict.fromkeys(NOISES_M, 0.78)}
POSITION_GOAL, EVENTS_GOAL, NEES_GOAL, COVERAGE_GOAL = 0.97, 0.95, (0.7, 1.4), (0.75, 0.86)
ORACLES = [peer for peer in PEERS if len(peer.tunings) > 1]
STATE = "x", "y", "z", "vx", "vy", "vz"
FLIGHT_COLUMNS = "release_s", "landing_s", "release_sigma_s", "landing_sigma_s"
TRACK_COLUMNS = "time_s", "x_m", "y_m", "z_m", "sigma_x_m", "sigma_y_m", "sigma_z_m"


def read_columns(file):
    with open(file) as lines:
        header, *rows = csv.reader(lines)
    values = np.array(rows, float).reshape(len(rows), len(header))
    return dict(zip(header, values.T))


def read_estimate(folder, name):
    columns = read_columns(folder / f"{name}.csv")
    position = np.stack([columns[f"{axis}_m"] for axis in STATE[:3]], axis=1)
    velocity = np.stack([columns[f"{axis}_m_per_s"] for axis in STATE[3:]], axis=1)
    covariance = np.empty((len(position), 6, 6))
    for i in range(6):
        for k in range(i, 6):
            covariance[:, i, k] = covariance[:, k, i] = columns[f"cov_{STATE[i]}_{STATE[k]}"]
    file = folder / f"{name}.flights.csv"  # only written if flights are looked for
    flights = read_columns(file) if file.exists() else dict.fromkeys(FLIGHT_COLUMNS, np.empty(0))
    return Estimate(position, velocity, covariance, np.stack([flights[column] for column in FLIGHT_COLUMNS], axis=1))


def run_touchtrace(program, one, tracks):
    """Estimates and CPU seconds; the tracks of a body go into one call."""
    bodies, estimates = defaultdict(list), {}
    for track in tracks:
        bodies[track.body].append(track)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    for members in bodies.values():
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            for track in members:
                table = np.c_[track.time_s, track.measured_m, np.broadcast_to(track.sigma_m, track.measured_m.shape)]
                np.savetxt(folder / f"{track.name}.csv", table, "%.9g", ",", header=",".join(TRACK_COLUMNS), comments="")
            command = [program, "smooth", *(folder / f"{track.name}.csv" for track in members), "--output", folder / "out",
                       "--gravity", *map(str, one.gravity_m_per_s2), "--flights", "find" if one.kind == "flight" else "none"]
            done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            if done.returncode:
                sys.exit(f"{one.name}, {members[0].body}: touchtrace smooth failed\n{done.stderr}")
            estimates |= {track.name: read_estimate(folder / "out", track.name) for track in members}
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return [estimates[track.name] for track in tracks], after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def by_length(tracks, smooth):
    """Results of `smooth(t, p)` per track. Tracks of equal length go into one call, side by side in the columns of p."""
    groups, made = defaultdict(list), {}
    for track in tracks:
        groups[len(track.time_s)].append(track)
    for members in groups.values():
        result = smooth(members[0].time_s, np.hstack([track.measured_m for track in members]))
        made |= {track.name: result[..., 3 * k:3 * k + 3] for k, track in enumerate(members)}
    return [made[track.name] for track in tracks]


def run_spline(spline, tracks):
    def position_and_velocity(t, p):
        splines = spline.splines(t, p)
        return np.stack([[s(t) for s in splines], [s.derivative()(t) for s in splines]]).transpose(0, 2, 1)

    for track in {len(track.time_s): track for track in tracks}.values():
        spline.trace(track.time_s, 1.0)  # cached, hence not timed
    start = time.process_time()
    estimates = [Estimate(*made) for made in by_length(tracks, position_and_velocity)]
    return estimates, time.process_time() - start


def run_oracle(peer, tracks):
    """Velocity RMS and CPU seconds of the best tuning for these tracks."""
    best = np.inf, 0.0
    for tuning in peer.tunings:
        if peer.name == "Savitzky-Golay" and tuning[0] > min(len(track.time_s) for track in tracks):
            continue
        start = time.process_time()
        velocities = by_length(tracks, lambda t, p: peer.velocity(t, p, tuning))
        seconds = time.process_time() - start
        best = min(best, (scores.rms(tracks, [Estimate(None, velocity) for velocity in velocities], "velocity_m_per_s"), seconds))
    return best


def scores_of_set(program, spline, one, rate_hz, noise):
    """Scores of one set, of which figures_of_kind makes figures."""
    tracks = [real_sets.noisy(track, rate_hz, noise) for track in one.thinned(rate_hz)]
    seconds = {}
    ours, seconds["touchtrace"] = run_touchtrace(program, one, tracks)
    untuned, seconds["quintic spline, GCV"] = run_spline(spline, tracks)
    oracles = {}
    for peer in ORACLES:
        oracles[peer.name], seconds[peer.name] = run_oracle(peer, tracks)
    velocity, position = (scores.rms(tracks, ours, key) for key in ("velocity_m_per_s", "position_m"))
    ratios = dict(velocity=velocity / scores.rms(tracks, untuned, "velocity_m_per_s"),
                  position=position / scores.rms(tracks, untuned, "position_m"), best_peer=velocity / min(oracles.values()))
    return dict(weight=sum(scores.counted(track).sum() for track in tracks), ratios=ratios, means=scores.consistency(tracks, ours),
                counts=scores.flights(tracks, ours), cpu_s=seconds)


def sum_of(all_scores, key):
    return {name: sum(score[key][name] for score in all_scores) for name in all_scores[0][key]}


def figures_of_kind(kind, rate_hz, noise, all_scores, seconds):
    """Sets count by their frames: ratios by their geometric mean, NEES and shares by their mean."""
    weights = np.array([score["weight"] for score in all_scores]) / sum(score["weight"] for score in all_scores)
    ratios = {name: np.exp(weights @ np.log([score["ratios"][name] for score in all_scores])) for name in all_scores[0]["ratios"]}
    means = {name: weights @ [score["means"][name] for score in all_scores] for name in all_scores[0]["means"]}
    about, goal = f"{kind}, {rate_hz} Hz, {noise}", VELOCITY_GOALS.get(kind, {}).get(noise)
    judged = [at_most(f"{about}: velocity RMS over the untuned spline's", ratios["velocity"], "", goal or np.inf, seconds=seconds),
              at_most(f"{about}: position RMS over the untuned spline's", ratios["position"], "", POSITION_GOAL),
              within(f"{about}: NEES of position and velocity over 6", means["nees"], "", *NEES_GOAL)]
    judged += [within(f"{about}: share of {part} in 80 % intervals", means[f"{part}_coverage"], "", *COVERAGE_GOAL)
               for part in ("position", "velocity")]
    yield from (figure if goal else figure | dict(goal="reported", holds=True) for figure in judged)
    yield row(f"{about}: velocity RMS over the best oracle peer's", ratios["best_peer"], "")
    if kind == "flight":
        counts = sum_of(all_scores, "counts")
        yield row(f"{about}: flights found of {counts['true']}", counts["found"], "")
        yield row(f"{about}: false flights", counts["false"], "")
        share = counts["within"] / counts["events"] if counts["events"] else float("nan")
        yield row(f"{about}: share of event times within 2 sigma", share, "", f">= {EVENTS_GOAL:g}", share >= EVENTS_GOAL)


def all_figures(options, sets):
    spline = GcvSpline()
    for rate_hz in options.rates:
        for kind in sorted({one.kind for one in sets}):
            all_scores = []
            for noise in NOISES_M:
                start = time.time()
                new_scores = [scores_of_set(options.touchtrace, spline, one, rate_hz, noise) for one in sets if one.kind == kind]
                yield from figures_of_kind(kind, rate_hz, noise, new_scores, time.time() - start)
                all_scores += new_scores
            for name, seconds in sum_of(all_scores, "cpu_s").items():
                yield row(f"{kind}, {rate_hz} Hz: CPU time of all noises, {name}", seconds, "s")


def main():
    parser = argparse.ArgumentParser(prog="scripts/bench smoothing", description="touchtrace smooth and its peers on motion capture")
    parser.add_argument("--touchtrace", default="build/release/touchtrace")
    parser.add_argument("--real", metavar="FOLDER", required=True, help="sets of recordings, one folder each: smoothing_peers/real_sets.py")
    parser.add_argument("--match", default="", metavar="TEXT", help="only sets with this text in their names")
    parser.add_argument("--rates", type=int, nargs="+", default=RATES_HZ, metavar="HZ", help="frame rates of the tracks")
    parser.add_argument("--json", action="store_true", help="print all rows as one JSON object")
    options = parser.parse_args()
    if not os.access(options.touchtrace, os.X_OK):
        parser.error(f"{options.touchtrace} is missing: run cmake --preset release && cmake --build --preset release")
    sets = real_sets.load_sets(options.real, options.match)
    if not sets:
        parser.error(f"no set with {options.match!r} in its name below {options.real}; hint: a set is a folder with set.json")
    return figures.emit(all_figures(options, sets), 72, options.json)


if __name__ == "__main__":
    sys.exit(main())
