#!/usr/bin/env python3
"""Writes labels for touchtrace from states that another program measured, such as motion capture.

usage: write_labels.py [--overwrite] RECORDING.h5 OUTPUT.labels.h5 HAND.csv OBJECT.csv    states of `touchtrace smooth`
       write_labels.py [--overwrite] RECORDING.h5 OUTPUT.labels.h5                        a hand and an object at rest

Import write_labels() to write states of your own. pipeline/recording/README.md lists everything that labels may contain.
Times are on the recording's clock. `import` makes it start at 0. The recording's attribute epoch_unix_s, if there is one, is the
Unix time of that; it converts Unix times of tracks.
"""

import os
import sys

import h5py
import numpy as np

AXES = "xyz"
max_gap_rows = 3.0  # interpolation over more rows is wrong by more than the rows' covariance
max_sigma_m = 0.1   # of a position, RMS over the axes


def frame_numbers(glove):
    """The counter of the glove's frames; if it has none, one that skips pauses, as touchtrace counts."""
    if "sequence" in glove:
        return glove["sequence"][:].astype(int)
    gap_s = np.diff(glove["host_time_s"][:])
    rate_hz = glove.attrs.get("rate_hz", 1 / np.median(gap_s))
    steps = np.where(gap_s > max(0.5, 5 / rate_hz), np.round(gap_s * rate_hz), 1).astype(int)
    return np.concatenate([[0], np.cumsum(steps)])


def clips_of(source):
    """Start and end [s] and object of each clip; without /clips one over all stamps."""
    if "clips" in source:
        return [source[f"clips/{name}"][:] for name in ("start_s", "end_s", "object")]
    stamps = [source[f"{stream}/host_time_s"] for stream in ("color", "depth", "glove0") if stream in source]
    stamps = [times for times in stamps if len(times)]
    end_s = np.nextafter(max(times[-1] for times in stamps), np.inf)
    return [np.array([min(times[0] for times in stamps)]), np.array([end_s]), np.array(["object"], dtype=h5py.string_dtype())]


def frames_between(number, time_s, start_s, end_s):
    """Index of each frame of a clip, -1 for a lost one, and its time [s]. number, time_s: of all frames of the glove."""
    received = np.flatnonzero((time_s >= start_s) & (time_s < end_s))
    if not len(received):
        return received, time_s[received]
    numbers = np.arange(number[received[0]], number[received[-1]] + 1)
    frame = np.full(len(numbers), -1)
    frame[number[received] - numbers[0]] = received
    return frame, np.interp(numbers, number[received], time_s[received])


def write_labels(path, recording, hand, object):
    """Writes labels of all frames of the glove, lost ones included.

    hand, object: functions of the time [n] in s, as stamped in the recording, that return
      position [n, 3] in m and velocity [n, 3] in m/s in one fixed frame, e.g. the colour camera's, smoothed,
      the same from earlier measurements only (roll-outs start from it),
      covariance [n, 6, 6] of position and velocity, and whether the body was visible [n].
    """
    with h5py.File(recording) as source, h5py.File(path, "w") as file:
        file.attrs.update(schema="touchtrace/labels/1", summary="{}", provenance="{}",
                          activity=source.attrs.get("activity", ""))
        stamps = [f"{stream}/host_time_s" for stream in ("color", "depth", "glove0")]
        first_s = min(source[name][0] for name in stamps if name in source and len(source[name]))
        origin_s = first_s if first_s > 1e6 else 0.0  # labels have no Unix time
        start_s, end_s, objects = clips_of(source)
        file["clips/start_s"], file["clips/end_s"], file["clips/object"] = start_s - origin_s, end_s - origin_s, objects
        number, glove_s = frame_numbers(source["glove0"]), source["glove0/host_time_s"][:]
        frames = [frames_between(number, glove_s, *span) for span in zip(start_s, end_s)]
        time_s = np.concatenate([times for _, times in frames])
        file["label/glove_frame"], file["label/time_s"] = np.concatenate([index for index, _ in frames]), time_s - origin_s
        file["label/clip"] = np.repeat(np.arange(len(frames)), [len(index) for index, _ in frames])
        for body, states in {"hand": hand, "object": object}.items():
            position, velocity, causal_position, causal_velocity, covariance, visible = states(time_s)
            file[f"{body}/position_m"], file[f"{body}/velocity_m_per_s"] = position, velocity
            file[f"{body}/causal_position_m"], file[f"{body}/causal_velocity_m_per_s"] = causal_position, causal_velocity
            file[f"{body}/covariance"], file[f"{body}/quality"] = covariance, np.where(visible, 0, 1).astype(np.uint8)
            print(f"{body}: {len(visible)} labels, {np.mean(~visible):.1%} lost", file=sys.stderr)
            if np.mean(~visible) > 0.1:
                print("  lost labels are in the track's gaps; `touchtrace smooth --rate 100` fills short ones", file=sys.stderr)
        for name, shape in {"time_s": (0,), "clip": (0,), "hand_m": (0, 3), "object_m": (0, 3),
                            "hand_sigma_m": (0, 3), "object_sigma_m": (0, 3)}.items():
            file[f"raw/{name}"] = np.zeros(shape, int if name == "clip" else float)


def smoothed(file, epoch_unix_s=0.0):
    """States of a CSV file of `touchtrace smooth`, interpolated. Unix times become seconds since `epoch_unix_s`.

    Not visible: before the first and after the last row, where the bracketing rows are further apart than max_gap_rows
    usual intervals, and where the position is not known to max_sigma_m, as in the gaps of a file of `smooth --rate`.
    """
    table = np.genfromtxt(file, delimiter=",", names=True)
    names = [*AXES, *(f"v{axis}" for axis in AXES)]
    if "cov_vz_vz" not in (table.dtype.names or ()):
        sys.exit(f"{file} is not a track of `touchtrace smooth`")
    rows_s = np.atleast_1d(table["time_s"]) - (epoch_unix_s if np.max(table["time_s"]) > 1e6 else 0.0)
    if len(rows_s) < 2:
        sys.exit(f"{file} has fewer than two rows")
    interval_s = np.median(np.diff(rows_s))

    def states(time_s):
        def columns(pattern):
            return np.stack([np.interp(time_s, rows_s, table[pattern.format(axis)]) for axis in AXES], axis=1)
        covariance = np.empty((len(time_s), 6, 6))
        for i, first in enumerate(names):
            for j, second in enumerate(names[i:], i):
                covariance[:, i, j] = covariance[:, j, i] = np.interp(time_s, rows_s, table[f"cov_{first}_{second}"])
        after = np.clip(np.searchsorted(rows_s, time_s), 1, len(rows_s) - 1)
        gap_s = rows_s[after] - rows_s[after - 1]
        to_row_s = np.minimum(np.abs(time_s - rows_s[after - 1]), np.abs(rows_s[after] - time_s))
        visible = (time_s >= rows_s[0]) & (time_s <= rows_s[-1])
        visible &= (gap_s <= max_gap_rows * interval_s) | (to_row_s <= 0.1 * interval_s)
        visible &= np.sqrt(np.trace(covariance[:, :3, :3], axis1=1, axis2=2) / 3) <= max_sigma_m
        if not np.any(visible):
            sys.exit(f"no frame of the glove is within the times of {file}: {rows_s[0]:.3f} to {rows_s[-1]:.3f} s; "
                     f"the glove's are {time_s[0]:.3f} to {time_s[-1]:.3f} s. Times are on the recording's clock, or Unix times if "
                     "the recording has an epoch_unix_s")
        return (columns("{}_m"), columns("v{}_m_per_s"), columns("causal_{}_m"), columns("causal_v{}_m_per_s"), covariance, visible)
    return states


def at_rest(x):
    def states(time_s):
        n = len(time_s)
        position, velocity = np.tile([x, 0.0, 1.0], (n, 1)), np.zeros((n, 3))
        return position, velocity, position, velocity, np.tile(1e-6 * np.eye(6), (n, 1, 1)), np.full(n, True)
    return states


def main(arguments):
    overwrite = "--overwrite" in arguments
    files = [argument for argument in arguments if argument != "--overwrite"]
    if len(files) not in (2, 4):
        sys.exit(__doc__.split("\n\n")[1])
    recording, output, *tracks = files
    if not h5py.is_hdf5(recording):
        sys.exit(f"{recording} is not an HDF5 file")
    with h5py.File(recording) as source:
        if "glove0" not in source:
            sys.exit(f"{recording} is not a recording with a glove")
        is_unix = len(source["glove0/host_time_s"]) and source["glove0/host_time_s"][0] > 1e6
        epoch_unix_s = 0.0 if is_unix else float(source.attrs.get("epoch_unix_s", 0.0))
    if os.path.exists(output) and not overwrite:
        sys.exit(f"{output} exists: give another name, or --overwrite")
    bodies = [smoothed(file, epoch_unix_s) for file in tracks] or [at_rest(0.0), at_rest(0.1)]
    part = output + ".part"
    try:
        write_labels(part, recording, *bodies)
        os.replace(part, output)
    finally:
        if os.path.exists(part):
            os.remove(part)


if __name__ == "__main__":
    main(sys.argv[1:])
