#!/usr/bin/env python3
"""Writes files of tactile gloves as the programs of other projects do, with known counts. usage: write_glove_files.py FOLDER

wiresens.hdf5   append_data() of Sensor.py, WiReSens toolkit: blocks of 1024 rows, `frame_count` is the last index
early.hdf5      the same of earlier scripts, which count before they write: row 0 stays empty
relative.hdf5   the same with times from 0
late.hdf5       the same of a user who recorded from frame 800 on: earlier rows and their chunks stay empty
open.hdf5       actionsense.hdf5 of a program that was killed: the datasets are not trimmed
actionsense.hdf5   DataLogger.py of ActionNet: growing datasets, trimmed when the file is closed
"""

import os
import sys

import h5py
import numpy as np

FRAMES, ROWS, COLS, RATE_HZ, START_S = 1500, 4, 3, 20.0, 1700000000.0


def counts(frame):
    """Counts that fall when the glove is squeezed, every second half of 2 s after 3 s at rest; 12 bits."""
    rest = 3000 + 10 * np.arange(ROWS)[:, None] + np.arange(COLS) + (7 * frame + np.arange(COLS)) % 3 - 1
    return rest - (800 if frame >= 60 and frame % 40 < 20 else 0)


def time_s(frame):
    """Unix time; a pause of 10 s after frame 1199."""
    return START_S + frame / RATE_HZ + (10 if frame >= 1200 else 0)


def write_wiresens(path, first_row=0, start_s=START_S):
    block = 1024
    with h5py.File(path, "w") as f:
        f.create_dataset("frame_count", (1,), maxshape=(None,), dtype=np.uint32)
        f.create_dataset("ts", (block,), maxshape=(None,), dtype=np.float64, chunks=True)
        f.create_dataset("predCount", (block,), maxshape=(None,), dtype=np.float64, chunks=True)
        f.create_dataset("pressure", (block, ROWS, COLS), maxshape=(None, ROWS, COLS), dtype=np.int32, chunks=True)
        rows = slice(first_row, first_row + FRAMES)
        for name in "ts", "pressure", "predCount":
            f[name].resize(-(-rows.stop // block) * block, axis=0)
        f["frame_count"][0] = rows.stop - 1
        f["ts"][rows] = [time_s(i) - START_S + start_s for i in range(FRAMES)]
        f["predCount"][rows] = 0
        f["pressure"][rows] = [counts(i) for i in range(FRAMES)]


def write_actionsense(path, is_closed=True):
    increment, frames = 1000, 300
    with h5py.File(path, "w") as f:
        for side, offset in ("left", 0), ("right", 100):
            group = f.create_group(f"tactile-glove-{side}").create_group("tactile_data")
            data = group.create_dataset("data", (increment, 32, 32), maxshape=(None, 32, 32), dtype="float32", chunks=True)
            times = group.create_dataset("time_s", (increment, 1), maxshape=(None, 1), dtype="float64", chunks=True)
            texts = group.create_dataset("time_str", (increment, 1), maxshape=(None, 1), dtype="S26", chunks=True)
            values = [500 + offset + (200 if i >= 60 and i % 40 < 20 else 0) + (7 * i) % 3 for i in range(frames)]
            data[:frames] = np.broadcast_to(np.array(values)[:, None, None], (frames, 32, 32))
            times[:frames, 0] = [time_s(i) for i in range(frames)]
            texts[:frames, 0] = b"2023-11-14 22:13:20.000000"
            for dataset in (data, times, texts) if is_closed else ():
                dataset.resize((frames, *dataset.shape[1:]))


def main(folder):
    write_wiresens(os.path.join(folder, "wiresens.hdf5"))
    write_wiresens(os.path.join(folder, "early.hdf5"), first_row=1)
    write_wiresens(os.path.join(folder, "late.hdf5"), first_row=800)
    write_wiresens(os.path.join(folder, "relative.hdf5"), start_s=0)
    write_actionsense(os.path.join(folder, "open.hdf5"), is_closed=False)
    write_actionsense(os.path.join(folder, "actionsense.hdf5"))
    frames = np.array([counts(i) for i in range(300)])
    stamps = np.array([time_s(i) for i in range(300)])
    np.savez(os.path.join(folder, "timeless.npz"), counts=frames)
    np.savez(os.path.join(folder, "flat.npz"), ts=(stamps * 1e9).astype(np.int64), tactile=frames.reshape(300, -1),
             note=np.array(["text"]))
    np.savez_compressed(os.path.join(folder, "fraction.npz"), time_s=stamps, pressure=1 - (frames / 4095.0).astype(np.float32))
    swapped = frames.astype(">i4")
    np.savez(os.path.join(folder, "columns.npz"), ts=stamps, counts=np.asfortranarray(swapped))
    np.savez(os.path.join(folder, "dates.npz"), ts=(stamps * 1e3).astype("datetime64[ms]"), counts=swapped)
    np.savez(os.path.join(folder, "half.npz"), ts=stamps, counts=(frames - 2000).astype(np.float16))
    np.savez(os.path.join(folder, "last.npz"), counts=np.moveaxis(frames, 0, 2))
    np.savez(os.path.join(folder, "middle.npz"), counts=np.moveaxis(frames, 0, 1))
    gap = frames.astype(np.float32)
    gap[120, 0, 0] = np.nan
    np.savez(os.path.join(folder, "gap.npz"), ts=stamps, counts=gap)
    np.savez(os.path.join(folder, "bool.npz"), ts=stamps, counts=frames > 2600)
    np.save(os.path.join(folder, "single.npy"), frames)
    np.savetxt(os.path.join(folder, "plain.csv"), np.column_stack([stamps, frames.reshape(300, -1)]), delimiter=",", fmt="%.3f")
    names = ["timestamp_ms", "frame"] + [f"t{i}" for i in range(12)]
    np.savetxt(os.path.join(folder, "named.csv"), np.column_stack([1e3 * stamps, range(300), frames.reshape(300, -1)]),
               delimiter=",", fmt="%.0f", header=",".join(names), comments="")


if __name__ == "__main__":
    main(sys.argv[1])
