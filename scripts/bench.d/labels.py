# Velocity from the positions of a track: touchtrace's smoothing, Savitzky-Golay, Butterworth, a quintic spline and
# Kalman smoothers on the same synthetic tracks, interleaved, each peer tuned by an oracle: error against run time.
# With --real: labels of public recordings against references (real_labels).
# needs: numpy scipy simdkalman h5py opencv-python-headless
import argparse
import json
import os
import statistics
import subprocess
import sys
import time

import numpy as np

import figures
import real_labels
from figures import at_most, row
from smoothing_peers import PEERS

GOALS = {"wave": 0.8, "throw": 0.5, "pingpong": 0.05}
EDGE_S, IMPACT_S = 0.5, 0.005


def run_touchtrace(program, activity):
    result = json.loads(subprocess.run([program, activity], check=True, capture_output=True, text=True).stdout)
    clips = [{key: np.array(values) for key, values in clip.items()} for clip in result["clips"]]
    return clips, [clip["velocity_m_per_s"] for clip in clips], result["cpu_s"]


def rms(clips, velocities, all_frames):
    """Of velocity over frames and axes [m/s], half a second at the ends left out, and frames next to impacts if so wanted."""
    squares = []
    for clip, velocity in zip(clips, velocities):
        t = clip["time_s"]
        counts = (t >= EDGE_S) & (t <= 40.0 - EDGE_S)
        if not all_frames and len(clip["landings_s"]):
            counts &= np.abs(t[:, None] - clip["landings_s"]).min(axis=1) >= IMPACT_S
        squares.append((velocity - clip["true_velocity_m_per_s"])[counts] ** 2)
    return np.sqrt(np.concatenate(squares).mean())


def smooth(peer, tuning, clips):
    start = time.process_time()
    velocities = [peer.velocity(clip["time_s"], clip["position_m"], tuning) for clip in clips]
    return velocities, time.process_time() - start


def best_tuning(peer, clips, all_frames):
    return min(peer.tunings, key=lambda tuning: rms(clips, smooth(peer, tuning, clips)[0], all_frames))


def figures_of(options, activity):
    start = time.time()
    clips, *_ = run_touchtrace(options.smoothing_tracks, activity)
    tunings = {peer: best_tuning(peer, clips, True) for peer in PEERS}
    seconds, errors = {"touchtrace": []}, {}
    for _ in range(options.rounds):
        _, ours, cpu_s = run_touchtrace(options.smoothing_tracks, activity)
        seconds["touchtrace"].append(cpu_s)
        errors["touchtrace"] = rms(clips, ours, True), rms(clips, ours, False)
        for peer, tuning in tunings.items():
            velocities, cpu_s = smooth(peer, tuning, clips)
            seconds.setdefault(peer.name, []).append(cpu_s)
            errors[peer.name] = rms(clips, velocities, True), rms(clips, velocities, False)
    times = {name: statistics.median(several) for name, several in seconds.items()}
    curves = [dict(name=name, x=[times[name]], y=[errors[name][0]]) for name in times]
    picture = dict(x_label="processor time [s]", y_label="velocity RMS [m/s]", log_x=True, log_y=True, curves=curves)
    names = {"touchtrace": "touchtrace"} | {peer.name: f"{peer.name} ({peer.describe(tuning)})" for peer, tuning in tunings.items()}
    for name, title in names.items():
        yield row(f"{activity}: velocity RMS, {title}", errors[name][0], "m/s", seconds=time.time() - start,
                  picture=picture if name == "touchtrace" else None)
        if activity != "wave":
            yield row(f"{activity}: 5 ms from impacts, {name}", errors[name][1], "m/s")
        yield row(f"{activity}: processor time, {name}", times[name], "s")
    best = min(tunings, key=lambda peer: errors[peer.name][0]).name
    yield at_most(f"{activity}: touchtrace over best peer, {best}", errors["touchtrace"][0] / errors[best][0], "", GOALS[activity])


def main():
    parser = argparse.ArgumentParser(prog="scripts/bench labels", description="touchtrace's smoothing and its peers on the same tracks")
    parser.add_argument("--smoothing-tracks", default="build/release/tests/smoothing_tracks")
    parser.add_argument("--rounds", type=int, default=3, help="alternating runs of a timing")
    parser.add_argument("--real", metavar="FOLDER", help="label public recordings instead, of which this folder has clones: real_labels/__init__.py")
    parser.add_argument("--match", metavar="TEXT", default="", help="of --real: only recordings with this text in their names")
    parser.add_argument("--touchtrace", default="build/release/touchtrace")
    parser.add_argument("--json", action="store_true", help="print all rows as one JSON object")
    options = parser.parse_args()
    program = options.touchtrace if options.real else options.smoothing_tracks
    if not os.access(program, os.X_OK):
        parser.error(f"{program} is missing: run cmake --preset release && cmake --build --preset release")
    if options.real:
        return figures.emit(real_labels.figures(options), 78, options.json)
    all_figures = (figure for activity in GOALS for figure in figures_of(options, activity))
    return figures.emit(all_figures, 78, options.json)


if __name__ == "__main__":
    sys.exit(main())
