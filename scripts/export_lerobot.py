#!/usr/bin/env python3
"""Writes the clips of a recording as a LeRobot data set (version 3).

usage: export_lerobot.py RECORDING.h5 DATASET [--labels LABELS.h5] [--images] [--fps N]

A clip is an episode, a glove frame is a frame. pipeline/export/README.md lists the features. Needs h5py, numpy, pandas, pyarrow,
and pillow for images.
"""

import argparse
import contextlib
import io
import json
import pathlib
import sys

try:
    import h5py
    import numpy as np
    import pandas
    import pyarrow
    import pyarrow.parquet
except ImportError as error:
    sys.exit(f"error: {error}\nhint: pip install h5py numpy pandas pyarrow pillow av")

DATA_FILE, EPISODES_FILE = "data/chunk-000/file-000.parquet", "meta/episodes/chunk-000/file-000.parquet"
TACTILE, TIME, SEQUENCE, LOST = (f"observation.tactile{suffix}" for suffix in ("", "_time_s", "_sequence", "_lost"))
STREAMS = {"observation.images.color": "color", "observation.images.depth": "depth"}
MAX_RATE_CHANGE = 0.02
GLOVE_KEYS = ("bits", "polarity", "rate_hz", "scan_s")
STREAM_KEYS = ("intrinsics", "distortion_model", "distortion", "gravity", "depth_unit_m", "registered", "depth_from_color")
AXES = [f"{body}_{quantity}_{axis}" for body in ("object", "hand")
        for quantity in ("position_m", "velocity_m_per_s") for axis in "xyz"]


def fail(message, hint):
    sys.exit(f"error: {message}\nhint: {hint}")


def has_frames(recording, stream):
    return stream in recording and "host_time_s" in recording[stream]


def clips_of(recording):
    """Start and end [s] and object of each clip; what the file lacks has the defaults of pipeline/recording/README.md."""
    stamps = [recording[stream]["host_time_s"][:] for stream in ("glove0", "glove1", "color", "depth")
              if has_frames(recording, stream)]
    whole = {"start_s": min(s.min() for s in stamps), "end_s": np.nextafter(max(s.max() for s in stamps), np.inf),
             "object": b"object"}
    clips = recording.get("clips", {})
    count = max((len(values) for values in clips.values()), default=0 if "clips" in recording else 1)
    columns = (clips[name][:] if name in clips else [value] * count for name, value in whole.items())
    return [(start_s, end_s, plain(name)) for start_s, end_s, name in zip(*columns)]


def sequence_of(glove):
    return glove["sequence"][:].astype(np.int64) if "sequence" in glove else np.arange(len(glove["host_time_s"]))


def rows_of_clips(recording, labels):
    """Sequence numbers of the frames of each clip, lost ones included, and the rows of the labels, if there are any."""
    sequence, time_s = sequence_of(recording["glove0"]), recording["glove0"]["host_time_s"][:]
    clip_of_row = None if labels is None else labels["label/clip"][:]
    for clip, (start_s, end_s, _) in enumerate(clips_of(recording)):
        if labels is None:
            inside = sequence[(time_s >= start_s) & (time_s < end_s)]
            if len(inside):
                yield clip, np.arange(inside[0], inside[-1] + 1), None
            continue
        begin, end = np.searchsorted(clip_of_row, [clip, clip + 1])  # rows are ordered by clip
        frames = labels["label/glove_frame"][begin:end]
        arrived = np.flatnonzero(frames >= 0)
        if len(arrived):
            first = sequence[frames[arrived[0]]] - arrived[0]
            yield clip, np.arange(first, first + end - begin), slice(begin, end)


def touch_columns(glove, sequence):
    """Frames with these sequence numbers; a lost one repeats the frame before it."""
    known = sequence_of(glove)
    frame = np.maximum(np.searchsorted(known, sequence, side="right") - 1, 0)
    lost = known[frame] != sequence
    time_s = np.where(lost, np.nan, glove["host_time_s"][:][frame])
    first, last = frame.min(), frame.max() + 1
    return {TACTILE: glove["counts"][first:last][frame - first].astype(np.int32), TIME: time_s,
            SEQUENCE: sequence, LOST: lost}


def state_columns(labels, rows):
    states, stds, quality = [], [], []
    for body in ("object", "hand"):
        states += [labels[body][name][rows] for name in ("position_m", "velocity_m_per_s")]
        stds.append(np.sqrt(np.diagonal(labels[body]["covariance"][rows], axis1=1, axis2=2)))
        quality.append(labels[body]["quality"][rows])
    return {"observation.state": np.concatenate(states, 1).astype(np.float32),
            "observation.state_std": np.concatenate(stds, 1).astype(np.float32),
            "observation.quality": np.stack(quality, 1).astype(np.int64)}


def png(image):
    from PIL import Image
    file = io.BytesIO()
    Image.fromarray(image).save(file, "png", compress_level=1)
    return {"bytes": file.getvalue(), "path": None}


def in_counts(stream, index):
    """Image with whole numbers; depth that has none in millimetres."""
    image = stream["image"][index]
    if image.dtype.kind != "f":
        return image
    return np.round(1000.0 * stream.attrs.get("depth_unit_m", 1.0) * np.nan_to_num(image)).astype(np.uint16)


def image_columns(recording, time_s):
    """For each time the image that arrived nearest to it."""
    columns = {}
    for name, stream in STREAMS.items():
        if not has_frames(recording, stream):
            continue
        stamps = recording[stream]["host_time_s"][:]
        nearest = np.abs(stamps[None] - time_s[:, None]).argmin(1)
        columns[name] = [png(in_counts(recording[stream], i)) for i in nearest]
        columns[f"observation.{stream}_time_s"] = stamps[nearest]
    return columns


def arrow_array(values):
    """Arrow's array for a column: numbers, lists of fixed length, nested lists or images."""
    if isinstance(values, list):
        return pyarrow.array(values, pyarrow.struct({"bytes": pyarrow.binary(), "path": pyarrow.string()}))
    array = pyarrow.array(values.ravel())
    for size in values.shape[:0:-1]:
        array = pyarrow.FixedSizeListArray.from_arrays(array, size)
    return array if values.ndim < 3 else array.cast(pyarrow.list_(pyarrow.list_(pyarrow.from_numpy_dtype(values.dtype))))


def plain(value):
    """Attribute of HDF5 as a value for JSON."""
    value = np.asarray(value).tolist()
    return value.decode() if isinstance(value, bytes) else value


def touch_info(glove):
    return {"unit": "counts", **{key: plain(glove.attrs[key]) for key in GLOVE_KEYS if key in glove.attrs},
            **{key: glove[key][:].tolist() for key in ("baseline", "mask") if key in glove}}


def image_feature(stream):
    height, width, *channels = stream["image"].shape[1:]
    info = {key: plain(stream.attrs[key]) for key in STREAM_KEYS if key in stream.attrs}
    if stream["image"].dtype.kind == "f":
        info["depth_unit_m"] = 0.001
    return {"dtype": "image", "shape": [height, width, *(channels or [1])], "names": ["height", "width", "channels"],
            "info": info}


def feature(name, values, recording):
    """Entry of meta/info.json."""
    if name in STREAMS:
        return image_feature(recording[STREAMS[name]])
    entry = {"dtype": str(values.dtype), "shape": list(values.shape[1:]) or [1],
             "names": AXES if name.startswith("observation.state") else None}
    return {**entry, "info": touch_info(recording["glove0"])} if name == TACTILE else entry


class Statistics:
    """Minimum, maximum, mean and standard deviation of each element of a feature."""

    def __init__(self):
        self.count, self.sum, self.squares = 0, 0.0, 0.0
        self.low, self.high = np.inf, -np.inf

    def add(self, values):
        values = values.reshape(len(values), *(values.shape[1:] or (1,))).astype(np.float64)
        values = values[np.isfinite(values).reshape(len(values), -1).all(1)]
        if len(values) == 0:
            return
        self.count += len(values)
        self.sum = self.sum + values.sum(0)
        self.squares = self.squares + (values**2).sum(0)
        self.low, self.high = np.minimum(self.low, values.min(0)), np.maximum(self.high, values.max(0))

    def json(self):
        mean = self.sum / self.count
        std = np.sqrt(np.maximum(self.squares / self.count - mean**2, 0.0))
        return {"min": self.low.tolist(), "max": self.high.tolist(), "mean": mean.tolist(), "std": std.tolist(),
                "count": [self.count]}


class DatasetWriter:
    """Writes the episodes of a data set one after the other."""

    def __init__(self, folder, fps):
        if folder.exists() and any(folder.iterdir()):
            fail(f"{folder} is not empty", "choose a new folder")
        self.folder, self.fps = folder, fps
        self.file = self.features = None
        self.episodes, self.tasks, self.statistics, self.frames = [], [], {}, 0

    def add(self, task, columns, recording):
        if task not in self.tasks:
            self.tasks.append(task)
        count = len(columns[SEQUENCE])
        number = np.arange(count)
        columns = {**columns, "timestamp": (number / self.fps).astype(np.float32), "frame_index": number,
                   "episode_index": np.full(count, len(self.episodes)), "index": self.frames + number,
                   "task_index": np.full(count, self.tasks.index(task))}
        table = pyarrow.table({name: arrow_array(values) for name, values in columns.items()})
        if self.file is None:
            self.features = {name: feature(name, values, recording) for name, values in columns.items()}
            (self.folder / DATA_FILE).parent.mkdir(parents=True, exist_ok=True)
            self.file = pyarrow.parquet.ParquetWriter(self.folder / DATA_FILE, table.schema)
        self.file.write_table(table)
        for name, values in columns.items():
            if not isinstance(values, list):
                self.statistics.setdefault(name, Statistics()).add(values)
        self.episodes.append({
            "episode_index": len(self.episodes), "tasks": [task], "length": count, "dataset_from_index": self.frames,
            "dataset_to_index": self.frames + count, "data/chunk_index": 0, "data/file_index": 0,
            "meta/episodes/chunk_index": 0, "meta/episodes/file_index": 0})
        self.frames += count

    def close(self, own):
        """own: attributes of the recording, for import_lerobot.py."""
        if self.file is None:
            fail("no clip has glove frames", "run `touchtrace check` on the recording")
        self.file.close()
        (self.folder / EPISODES_FILE).parent.mkdir(parents=True)
        pyarrow.parquet.write_table(pyarrow.Table.from_pylist(self.episodes), self.folder / EPISODES_FILE)
        pandas.DataFrame({"task_index": range(len(self.tasks))}, index=self.tasks).to_parquet(
            self.folder / "meta/tasks.parquet")
        info = {"codebase_version": "v3.0", "robot_type": "human", "fps": self.fps, "total_episodes": len(self.episodes),
                "total_frames": self.frames, "total_tasks": len(self.tasks), "chunks_size": 1000,
                "data_files_size_in_mb": 100, "video_files_size_in_mb": 200,
                "splits": {"train": f"0:{len(self.episodes)}"}, "video_path": None,
                "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet", "features": self.features,
                "touchtrace": own}
        (self.folder / "meta/info.json").write_text(json.dumps(info, indent=1))
        statistics = {name: values.json() for name, values in self.statistics.items() if values.count}
        (self.folder / "meta/stats.json").write_text(json.dumps(statistics))


def whole_rate(recording, options):
    """The glove's rate as the whole number that LeRobot needs."""
    if "glove0" not in recording:
        fail(f"{options.recording} has no glove", "labels alone are exported by `touchtrace export`")
    glove = recording["glove0"]
    rate_hz = float(glove.attrs["rate_hz"] if "rate_hz" in glove.attrs else round(1.0 / np.median(np.diff(glove["host_time_s"])), 6))
    fps = options.fps or max(round(rate_hz), 1)
    if not options.fps and abs(fps - rate_hz) > MAX_RATE_CHANGE * rate_hz:
        fail(f"the glove's rate is {rate_hz:g} Hz, but a LeRobot data set needs a whole number",
             f"give --fps {fps}: timestamps are then frame_index / {fps}, and {TIME} keeps the glove's")
    if fps != rate_hz:
        print(f"timestamps are frame_index / {fps}: the glove's rate of {rate_hz:g} Hz is not that whole number. "
              f"{TIME} has the glove's times", file=sys.stderr)
    return fps


def export(options, recording, labels):
    if labels is not None and not np.array_equal(labels["clips/start_s"], [start_s for start_s, *_ in clips_of(recording)]):
        fail(f"{options.labels} has other clips than {options.recording}", "give the labels of this recording")
    writer = DatasetWriter(options.dataset, whole_rate(recording, options))
    activity = plain(recording.attrs.get("activity", ""))
    for clip, sequence, rows in rows_of_clips(recording, labels):
        columns = touch_columns(recording["glove0"], sequence)
        if labels is not None:
            columns |= state_columns(labels, rows)
        if options.images:
            arrived = ~columns[LOST]
            columns |= image_columns(recording, np.interp(sequence, sequence[arrived], columns[TIME][arrived]))
        task = f"{activity} {clips_of(recording)[clip][2]}".strip()
        writer.add(task, columns, recording)
        print(f"clip {clip}: {len(sequence)} frames", file=sys.stderr)
    writer.close({"activity": activity} | {key: float(recording.attrs[key]) for key in ["epoch_unix_s"] if key in recording.attrs})
    print(f"written: {options.dataset}", file=sys.stderr)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("recording", type=pathlib.Path)
    parser.add_argument("dataset", type=pathlib.Path)
    parser.add_argument("--labels", type=pathlib.Path, help="file of `touchtrace label`: adds positions and velocities")
    parser.add_argument("--fps", type=int, metavar="N", help="frames per second of the data set [the glove's rate, if a whole "
                        "number is within 2 %% of it]")
    parser.add_argument("--images", action="store_true", help="adds the images nearest in time to each frame")
    options = parser.parse_args()
    if options.fps is not None and options.fps < 1:
        parser.error(f"--fps is {options.fps}, not a positive number")
    try:
        with h5py.File(options.recording) as recording, contextlib.ExitStack() as stack:
            export(options, recording, stack.enter_context(h5py.File(options.labels)) if options.labels else None)
    except (OSError, KeyError) as error:
        text = str(error).strip('"')
        fail(f"cannot export {options.recording}: {text}", "`touchtrace check` lists what a file lacks")


if __name__ == "__main__":
    main()
