"""Labels of real clips: `touchtrace import`, `mark` and `label` on folders in TUM layout, and their errors.

A clip is a folder with rgb.txt, depth.txt and their images (depth in mm, on the colour camera's pixels), camera_info.yaml,
boxes.json and, if there is one, reference.csv:
    boxes.json     {"frame_index": i, "hand": [x, y, width, height], "object": [...]}, pixels of colour image i
    reference.csv  time_s, x_m, y_m, z_m, sigma_m: the object's centre in the colour camera's frame"""

import json
import pathlib
import subprocess
import sys
import tempfile
import time

import h5py
import numpy as np

from figures import row

WRONG_M, MAX_INTERVAL_S = 0.06, 0.012
WINDOW_PX, BEHIND_M, IN_FRONT_M = 4, 0.02, 0.10  # of the object's surface about its centre


def touchtrace(options, *arguments):
    done = subprocess.run([options.touchtrace, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(f"touchtrace {arguments[0]}: {done.stderr.strip()}")


def make_labels(options, clip, folder):
    """Paths of the recording and of its labels."""
    recording, labels = folder / "clip.h5", folder / "clip.labels.h5"
    boxes = json.loads((clip / "boxes.json").read_text())
    drawn = [f"--box={body}={','.join(map(str, boxes[body]))}" for body in ("hand", "object")]
    touchtrace(options, "import", clip, "--camera-info", clip / "camera_info.yaml", "--registered", "--depth-scale", 1000,
               "--output", recording)
    touchtrace(options, "mark", recording, *drawn, "--frame", boxes["frame_index"], "--overwrite")
    touchtrace(options, "label", recording, "--output", labels, "--tracker", options.tracker)
    return recording, labels


def read_labels(file, clock_shift_s):
    """Labels that have a position."""
    with h5py.File(file) as labels:
        body = labels["object"]
        states = dict(time_s=labels["label/time_s"][:] + clock_shift_s, position_m=body["position_m"][:],
                      covariance=body["covariance"][:, :3, :3], is_good=body["quality"][:] == 0)
    has_position = np.isfinite(states["position_m"]).all(axis=1)
    return len(has_position), {name: values[has_position] for name, values in states.items()}


def nearest(sorted_times_s, times_s):
    """Indices of the nearest times, and whether they are near enough."""
    after = np.clip(np.searchsorted(sorted_times_s, times_s), 1, len(sorted_times_s) - 1)
    is_before = times_s - sorted_times_s[after - 1] < sorted_times_s[after] - times_s
    index = np.where(is_before, after - 1, after)
    return index, abs(sorted_times_s[index] - times_s) <= MAX_INTERVAL_S


def reference_rows(name, labels, file):
    reference = np.genfromtxt(file, delimiter=",", names=True)
    index, is_near = nearest(reference["time_s"], labels["time_s"])
    true_m = np.stack([reference[f"{axis}_m"] for axis in "xyz"], axis=1)[index]
    error_m = labels["position_m"] - true_m
    distance_m, good = np.linalg.norm(error_m, axis=1), is_near & labels["is_good"]
    covariance = labels["covariance"] + reference["sigma_m"][index, None, None] ** 2 * np.eye(3)
    chi2 = np.einsum("ni,ni->n", error_m[good], np.linalg.solve(covariance[good], error_m[good][..., None])[..., 0])
    yield row(f"{name}: median error", 1e3 * np.median(distance_m[good]), "mm")
    yield row(f"{name}: 95 % of errors below", 1e3 * np.percentile(distance_m[good], 95), "mm")
    yield row(f"{name}: chi-square / 3", chi2.mean() / 3, "")
    yield row(f"{name}: wrong (> 60 mm) and not flagged", 100 * (distance_m[good] > WRONG_M).sum() / is_near.sum(), "%")


def agreement(depth_m, intrinsics, position_m):
    """Fraction of the measured depth pixels around a position that fit an object there; NaN without any."""
    fx, fy, cx, cy = intrinsics
    x, y, z = position_m
    u, v = round(fx * x / z + cx), round(fy * y / z + cy)
    window = depth_m[max(0, v - WINDOW_PX):max(0, v + WINDOW_PX + 1), max(0, u - WINDOW_PX):max(0, u + WINDOW_PX + 1)]
    measured = window[window > 0]
    return ((measured > z - IN_FRONT_M) & (measured < z + BEHIND_M)).mean() if measured.size else np.nan


def agreement_rows(name, labels, recording):
    with h5py.File(recording) as file:
        times_s, unit_m = file["depth/host_time_s"][:], file["depth"].attrs["depth_unit_m"]
        intrinsics = np.ravel(file["color"].attrs["intrinsics"])
        index, is_near = nearest(times_s, labels["time_s"])
        shares = [agreement(file["depth/image"][index[i]] * unit_m, intrinsics, labels["position_m"][i])
                  for i in np.flatnonzero(is_near & labels["is_good"])]
    yield row(f"{name}: depth near the label that agrees", 100 * np.nanmean(shares), "%")


def figures_of_clip(options, clip):
    start = time.time()
    with tempfile.TemporaryDirectory() as folder:
        recording, file = make_labels(options, clip, pathlib.Path(folder))
        with h5py.File(recording) as images:
            first_s = images["color/host_time_s"][0]
        count, labels = read_labels(file, first_s if first_s > 1e6 else 0.0)
        yield row(f"{clip.name}: found and not flagged", 100 * labels["is_good"].sum() / count, "%", seconds=time.time() - start)
        if (clip / "reference.csv").exists():
            yield from reference_rows(clip.name, labels, clip / "reference.csv")
        else:
            yield from agreement_rows(clip.name, labels, recording)


def figures(options):
    """Rows of all clips below the folder. A clip that cannot be labelled is named on stderr and fails."""
    for boxes in sorted(pathlib.Path(options.real).glob("*/boxes.json")):
        try:
            yield from figures_of_clip(options, boxes.parent)
        except (RuntimeError, KeyError, ValueError) as error:
            print(f"{boxes.parent.name}: {error}", file=sys.stderr)
            yield row(f"{boxes.parent.name}: found and not flagged", float("nan"), "%")
