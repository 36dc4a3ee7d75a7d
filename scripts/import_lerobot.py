#!/usr/bin/env python3
"""Makes a recording from a LeRobot data set (version 3) with touch.

usage: import_lerobot.py DATASET RECORDING.h5 [--tactile FEATURE] [--color FEATURE] [--depth FEATURE]

An episode becomes a clip. `touchtrace check` tells what the recording can be used for. pipeline/export/README.md says which features
are taken. Needs h5py, numpy, pandas, pyarrow, for images pillow, for videos av.
"""

import argparse
import io
import json
import pathlib
import re
import sys

from export_lerobot import GLOVE_KEYS, LOST, SEQUENCE, STREAM_KEYS, TACTILE, TIME, fail, h5py, np, pyarrow

TOUCH_NAME = re.compile("tactile|pressure|touch|taxel", re.IGNORECASE)
EPISODE_GAP_S = 1.0
MAX_COUNT = 65535
CONVERTER_BITS = (8, 10, 12, 14, 16)


class Dataset:
    """Tables and features of a data set."""

    def __init__(self, folder):
        self.folder = folder
        try:
            self.info = json.loads((folder / "meta/info.json").read_text())
            self.features, self.fps = self.info["features"], float(self.info["fps"])
            self.episodes = pyarrow.parquet.read_table(folder / "meta/episodes").to_pylist()
        except (OSError, ValueError, KeyError, TypeError) as error:
            fail(f"{folder} cannot be read: {error}", "give the folder of a data set of version 3, which has meta/info.json and "
                 "meta/episodes; LeRobot itself converts older versions")
        self.episodes.sort(key=lambda episode: episode["episode_index"])

    def batches(self, names):
        """Parts of the table in the order of the frames: Arrow arrays by name."""
        for path in sorted((self.folder / "data").glob("*/*.parquet")):
            with pyarrow.parquet.ParquetFile(path) as file:
                yield from file.iter_batches(batch_size=64, columns=names)

    def column(self, name):
        """All values of a feature, [frames, shape...]."""
        parts = []
        for batch in self.batches([name]):
            values = batch.column(0)
            while pyarrow.types.is_nested(values.type):
                values = values.flatten()
            parts.append(values.to_numpy(zero_copy_only=False))
        return np.concatenate(parts).reshape(-1, *self.features[name]["shape"])

    def choose(self, option, wanted, is_suitable):
        """The wanted feature, or the first suitable one, or None."""
        suitable = [name for name, feature in self.features.items() if is_suitable(name, feature)]
        if wanted is not None and wanted not in self.features:
            fail(f"the data set has no feature {wanted}", f"{option} may be: {', '.join(suitable) or 'none of its features'}")
        return wanted or (suitable[0] if suitable else None)

    def images(self, name):
        """Images of a feature in the order of the frames."""
        if self.features[name]["dtype"] == "video":
            for episode in self.episodes:
                yield from self.video(name, episode)
            return
        from PIL import Image
        for batch in self.batches([name]):
            for cell in batch.column(0).to_pylist():
                content = cell["bytes"] or (self.folder / cell["path"]).read_bytes()
                yield np.asarray(Image.open(io.BytesIO(content)))

    def video(self, name, episode):
        import av
        path = self.folder / self.info["video_path"].format(
            video_key=name, chunk_index=episode[f"videos/{name}/chunk_index"], file_index=episode[f"videos/{name}/file_index"])
        first_s = episode[f"videos/{name}/from_timestamp"]
        with av.open(str(path)) as file:
            stream = file.streams.video[0]
            file.seek(int(first_s / stream.time_base), stream=stream)
            frames = (frame for frame in file.decode(stream) if frame.time > first_s - 0.5 / self.fps)
            for _, frame in zip(range(episode["length"]), frames):
                yield frame.to_ndarray(format="rgb24")


def is_touch(name, feature):
    return bool(TOUCH_NAME.search(name)) and feature["dtype"] not in ("image", "video", "string", "bool") and \
        np.prod(feature["shape"]) > 1


def is_color(name, feature):
    return feature["dtype"] in ("image", "video") and 3 in feature["shape"] and not TOUCH_NAME.search(name)


def is_depth(name, feature):
    return feature["dtype"] == "image" and 1 in feature["shape"]


class Frames:
    """Episode, arrival time, sequence number and arrival of each frame."""

    def __init__(self, dataset, is_exported):
        own = {name: dataset.column(name).ravel() for name in (TIME, SEQUENCE, LOST)} if is_exported else {}
        self.episode = dataset.column("episode_index").ravel()
        lengths_s = np.bincount(self.episode) / dataset.fps + EPISODE_GAP_S
        start_s = np.concatenate(([0.0], np.cumsum(lengths_s)))[self.episode]
        self.time_s = start_s + dataset.column("timestamp").ravel().astype(np.float64)
        self.sequence = own.get(SEQUENCE, np.round(self.time_s * dataset.fps).astype(np.int64))
        self.is_lost = own.get(LOST, np.zeros(len(self.episode), bool)).astype(bool)
        if is_exported:  # stamps of the recording; between them, for lost frames
            self.time_s = np.interp(self.sequence, self.sequence[~self.is_lost], own[TIME][~self.is_lost])

    def clips(self, num_clips):
        return [np.flatnonzero(self.episode == index) for index in range(num_clips)]


def counts_of(values, is_counts):
    """Values as 16-bit counts. Whole numbers that fit stay as they are, unless all are 0 or 1 and not known to be counts."""
    values = values.astype(np.float64)
    low, high = min(float(values.min()), 0.0), float(values.max())
    if low >= 0.0 and high <= MAX_COUNT and (is_counts or high != 1.0) and np.array_equal(values, np.round(values)):
        return values.astype(np.uint16)
    print(f"touch from {low:g} to {high:g} is scaled to counts from 0 to {MAX_COUNT}", file=sys.stderr)
    return np.round((values - low) * (MAX_COUNT / max(high - low, 1e-30))).astype(np.uint16)


def write_glove(file, dataset, tactile, frames):
    feature = dataset.features[tactile]
    rows = feature["shape"][0] if len(feature["shape"]) > 1 else 1
    values = dataset.column(tactile)
    values = values.reshape(len(values), rows, -1)
    arrived = ~frames.is_lost & np.isfinite(values).all((1, 2))
    info = feature.get("info") or {}
    group = file.create_group("glove0")
    group["counts"] = counts = counts_of(values[arrived], "bits" in info)
    group.attrs["bits"] = next(bits for bits in CONVERTER_BITS if counts.max() < 2**bits)
    group["host_time_s"], group["sequence"] = frames.time_s[arrived], frames.sequence[arrived]
    group.attrs.update({"rate_hz": dataset.fps, **{key: info[key] for key in GLOVE_KEYS if key in info}})
    for key, kind in {"baseline": np.float32, "mask": np.uint8}.items():
        if key in info:
            group[key] = np.asarray(info[key], kind)


def write_images(file, stream, dataset, name, frames):
    group = file.create_group(stream)
    stored = None
    for i, image in enumerate(dataset.images(name)):
        if stored is None:
            stored = group.create_dataset("image", (len(frames.time_s), *image.shape), image.dtype, chunks=(1, *image.shape),
                                          compression="gzip", compression_opts=1)
        stored[i] = image
        if i % 100 == 0:
            print(f"\r{stream}: {i}/{len(frames.time_s)}", end="", file=sys.stderr)
    print(f"\r{stream}: {len(frames.time_s)} images", file=sys.stderr)
    own_time = f"observation.{stream}_time_s"
    group["host_time_s"] = dataset.column(own_time).ravel() if own_time in dataset.features else frames.time_s
    info = dataset.features[name].get("info") or {}
    group.attrs.update({key: info[key] for key in STREAM_KEYS if key in info})
    if stream == "depth" and "depth_unit_m" not in info:
        print("depth is taken as millimetres on the pixels of the colour images", file=sys.stderr)
        group.attrs.update({"depth_unit_m": 0.001, "registered": True})


def write_recording(file, dataset, tactile, streams):
    frames = Frames(dataset, tactile == TACTILE and TIME in dataset.features)
    own = dataset.info.get("touchtrace", {})
    file.attrs.update({"schema": "touchtrace/recording/2"} | own)
    write_glove(file, dataset, tactile, frames)
    for stream, name in streams.items():
        write_images(file, stream, dataset, name, frames)
    clips = frames.clips(len(dataset.episodes))
    file["clips/start_s"] = [frames.time_s[rows[0]] for rows in clips]
    file["clips/end_s"] = [frames.time_s[rows[-1]] + 0.5 / dataset.fps for rows in clips]
    file["clips/object"] = [episode["tasks"][0].removeprefix(own.get("activity", "") + " ") for episode in dataset.episodes]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dataset", type=pathlib.Path)
    parser.add_argument("recording", type=pathlib.Path)
    parser.add_argument("--tactile", metavar="FEATURE", help="[the first whose name contains tactile, touch, pressure or taxel]")
    parser.add_argument("--color", metavar="FEATURE", help="[the first with three channels]")
    parser.add_argument("--depth", metavar="FEATURE", help="[the first image with one channel]")
    options = parser.parse_args()
    if options.recording.exists():
        fail(f"{options.recording} exists", "choose another name")
    dataset = Dataset(options.dataset)
    tactile = dataset.choose("--tactile", options.tactile, is_touch)
    if tactile is None:
        fail("no feature's name tells that it is touch", f"name one with --tactile: {', '.join(dataset.features)}")
    streams = {"color": dataset.choose("--color", options.color, is_color),
               "depth": dataset.choose("--depth", options.depth, is_depth)}
    streams = {stream: name for stream, name in streams.items() if name}
    print(f"glove0: {tactile}", *(f"{stream}: {name}" for stream, name in streams.items()), sep="\n", file=sys.stderr)
    partial = options.recording.with_name(options.recording.name + ".partial")
    with h5py.File(partial, "w") as file:
        write_recording(file, dataset, tactile, streams)
    partial.rename(options.recording)


if __name__ == "__main__":
    main()
