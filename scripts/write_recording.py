#!/usr/bin/env python3
"""Writes a recording for touchtrace from arrays, with h5py's defaults.

usage: write_recording.py OUTPUT.h5    writes a tiny synthetic recording

Import write_recording() to write your own. pipeline/recording/README.md lists everything that a recording may contain.
"""

import sys

import h5py
import numpy as np


def write_recording(path, color, depth, clips, glove=None, intrinsics=None):
    """Writes a recording whose depth images lie on the pixels of the colour images.

    color: (stamps [s], images [n, height, width, 3] of uint8, RGB).
    depth: (stamps [s], images [n, height, width] of uint16 in mm; 0: no measurement).
    clips: list of dictionaries with start_s, end_s, object, hand_box, object_box (x, y, width, height in pixels).
    glove: (stamps [s], counts [n, rows, columns], counts without contact [rows, columns]).
    intrinsics: (fx, fy, cx, cy) of the colour camera in pixels, if known.
    """
    with h5py.File(path, "w") as file:
        file.attrs["schema"] = "touchtrace/recording/2"
        for name, (stamps, images) in {"color": color, "depth": depth}.items():
            file[f"{name}/host_time_s"] = stamps
            file[f"{name}/image"] = images
        file["depth"].attrs["depth_unit_m"] = 0.001
        file["depth"].attrs["registered"] = True
        if intrinsics is not None:
            file["color"].attrs["intrinsics"] = intrinsics
        for name in clips[0]:
            file[f"clips/{name}"] = [clip[name] for clip in clips]
        if glove is not None:
            stamps, counts, baseline = glove
            file["glove0/host_time_s"] = stamps
            file["glove0/counts"] = counts
            file["glove0/baseline"] = baseline
            file["glove0"].attrs["bits"] = 10


def main(path):
    random = np.random.default_rng(1)
    start_s, seconds, height, width = 1.7e9, 2.0, 48, 64  # Unix time
    camera_s = start_s + np.arange(0.0, seconds, 1 / 20)
    glove_s = start_s + np.arange(0.0, seconds, 1 / 15)
    color = random.integers(0, 256, (len(camera_s), height, width, 3), dtype=np.uint8)
    depth = random.integers(500, 1500, (len(camera_s), height, width), dtype=np.uint16)
    baseline = np.full((16, 16), 20)
    counts = baseline + random.integers(0, 200, (len(glove_s), 16, 16))
    clip = {"start_s": start_s, "end_s": start_s + seconds, "object": "ball",
            "hand_box": (10, 20, 20, 20), "object_box": (18, 10, 12, 12)}
    write_recording(path, (camera_s, color), (camera_s, depth), [clip], (glove_s, counts, baseline),
                    (60.0, 60.0, 31.5, 23.5))


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__.split("\n\n")[1])
    main(sys.argv[1])
