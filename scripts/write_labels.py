#!/usr/bin/env python3
"""Writes labels for touchtrace from states that another program measured.

usage: write_labels.py RECORDING.h5 OUTPUT.labels.h5    labels of a hand and an object at rest, for every frame of the glove

Import write_labels() to write your own. pipeline/recording/README.md lists everything that labels may contain.
"""

import sys

import h5py
import numpy as np


def write_labels(path, recording, hand, object):
    """Writes labels of a recording of which no frame of the glove was lost.

    hand, object: functions of the time [n] in s, as stamped in the recording, that return
      position [n, 3] in m and velocity [n, 3] in m/s in the colour camera's frame, smoothed,
      the same from earlier measurements only (roll-outs start from it),
      covariance [n, 6, 6] of position and velocity, and whether the body was visible [n].
    """
    with h5py.File(recording) as source, h5py.File(path, "w") as file:
        file.attrs.update(schema="touchtrace/labels/1", summary="{}", provenance="{}",
                          activity=source.attrs.get("activity", ""))
        first_s = min(source[f"{stream}/host_time_s"][0] for stream in ("color", "depth", "glove0") if stream in source)
        origin_s = first_s if first_s > 1e6 else 0.0  # labels have no Unix time
        for name in ("start_s", "end_s"):
            file[f"clips/{name}"] = source[f"clips/{name}"][:] - origin_s
        file["clips/object"] = source["clips/object"][:]
        time_s = source["glove0/host_time_s"][:]
        rows = [(frame, clip) for clip, (start_s, end_s) in enumerate(zip(source["clips/start_s"][:], source["clips/end_s"][:]))
                for frame in np.flatnonzero((time_s >= start_s) & (time_s < end_s))]
        frame, file["label/clip"] = np.array(rows).T
        file["label/glove_frame"], file["label/time_s"] = frame, time_s[frame] - origin_s
        for body, states in {"hand": hand, "object": object}.items():
            position, velocity, causal_position, causal_velocity, covariance, visible = states(time_s[frame])
            file[f"{body}/position_m"], file[f"{body}/velocity_m_per_s"] = position, velocity
            file[f"{body}/causal_position_m"], file[f"{body}/causal_velocity_m_per_s"] = causal_position, causal_velocity
            file[f"{body}/covariance"], file[f"{body}/quality"] = covariance, np.where(visible, 0, 1).astype(np.uint8)
        for name, shape in {"time_s": (0,), "clip": (0,), "hand_m": (0, 3), "object_m": (0, 3),
                            "hand_sigma_m": (0, 3), "object_sigma_m": (0, 3)}.items():
            file[f"raw/{name}"] = np.zeros(shape, int if name == "clip" else float)


def at_rest(x):
    def states(time_s):
        n = len(time_s)
        position, velocity = np.tile([x, 0.0, 1.0], (n, 1)), np.zeros((n, 3))
        return position, velocity, position, velocity, np.tile(1e-6 * np.eye(6), (n, 1, 1)), np.full(n, True)
    return states


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__.split("\n\n")[1])
    write_labels(sys.argv[2], sys.argv[1], at_rest(0.0), at_rest(0.1))
