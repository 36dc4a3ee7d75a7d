# Data sets of scripts/export_lerobot.py read by LeRobot's own library, and a data set that the library wrote read by
# scripts/import_lerobot.py. Two minutes and the installation, 6 GB.
# needs: lerobot==0.4.4 h5py
import argparse
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np
from lerobot.datasets.lerobot_dataset import LeRobotDataset

import figures
from figures import at_most

SCRIPTS = pathlib.Path(__file__).resolve().parent.parent
FPS, ROWS, COLUMNS, HEIGHT, WIDTH, FRAMES = 30, 16, 16, 96, 128, 45
LEFT = "observation.tactile_left"


def run(*command):
    subprocess.run([str(word) for word in command], check=True, stdout=sys.stderr)


def script(name, *arguments):
    run(sys.executable, SCRIPTS / f"{name}.py", *arguments)


def simulate(touchtrace, folder):
    recording, labels = folder / "throw.h5", folder / "throw.labels.h5"
    run(touchtrace, "simulate", recording, "--activity", "throw", "--minutes", "0.3")
    run(touchtrace, "calibrate", recording, "--output", folder / "camera")
    run(touchtrace, "label", recording, "--calibration", folder / "camera", "--output", labels)
    return recording, labels


def read_dataset(folder):
    dataset = LeRobotDataset("local/export", root=folder)
    items = [dataset[i] for i in range(len(dataset))]
    return dataset, {name: np.stack([np.asarray(item[name]) for item in items]) for name in items[0] if name != "task"}


def difference(a, b):
    """Largest difference; infinite if only one of two values is not a number."""
    a, b = np.broadcast_arrays(np.asarray(a, np.float64), np.asarray(b, np.float64))
    return float(np.nanmax(np.abs(a - b))) if np.array_equal(np.isnan(a), np.isnan(b)) else np.inf


def export_rows(touchtrace, folder):
    recording, labels = simulate(touchtrace, folder)
    script("export_lerobot", recording, folder / "export", "--labels", labels, "--images")
    dataset, values = read_dataset(folder / "export")
    with h5py.File(recording) as source, h5py.File(labels) as states:
        frame = states["label/glove_frame"][:]
        arrived = frame >= 0
        yield at_most("export: frames that LeRobot misses", abs(len(dataset) - len(frame)), "frames", 0)
        yield at_most("export: touch in LeRobot", difference(values["observation.tactile"][arrived],
                                                             source["glove0/counts"][:][frame[arrived]]), "counts", 0)
        expected = np.concatenate([states[f"{body}/{name}"] for body in ("object", "hand")
                                   for name in ("position_m", "velocity_m_per_s")], 1)
        yield at_most("export: states in LeRobot", difference(values["observation.state"], expected), "m", 1e-6)
        yield from image_rows(source, values)
    yield from round_trip_rows(recording, folder)


def image_rows(source, values):
    for stream, scale in {"color": 255.0, "depth": 1.0}.items():
        stamps = source[stream]["host_time_s"][:]
        nearest = np.abs(stamps[None] - values[f"observation.{stream}_time_s"][:, None]).argmin(1)
        expected = source[stream]["image"][:][nearest].reshape(len(nearest), *source[stream]["image"].shape[1:3], -1)
        images = values[f"observation.images.{stream}"].transpose(0, 2, 3, 1) * scale
        yield at_most(f"export: {stream} in LeRobot", difference(np.round(images), expected), "counts", 0)


def round_trip_rows(recording, folder):
    script("import_lerobot", folder / "export", folder / "again.h5")
    with h5py.File(recording) as source, h5py.File(folder / "again.h5") as again:
        rows = np.searchsorted(source["glove0/sequence"], again["glove0/sequence"])
        for name, unit in {"counts": "counts", "host_time_s": "s", "sequence": "frames"}.items():
            yield at_most(f"round trip: {name} of the glove", difference(again["glove0"][name], source["glove0"][name][:][rows]),
                          unit, 0)
        yield at_most("round trip: counts without contact", difference(again["glove0/baseline"], source["glove0/baseline"]),
                      "counts", 0)


def write_with_lerobot(folder):
    """Two episodes with touch as fractions and colour as a video."""
    names = ["height", "width", "channels"]
    features = {LEFT: {"dtype": "float32", "shape": (ROWS, COLUMNS), "names": None},
                "observation.images.front": {"dtype": "video", "shape": (HEIGHT, WIDTH, 3), "names": names},
                "action": {"dtype": "float32", "shape": (2,), "names": ["x", "y"]}}
    dataset = LeRobotDataset.create("local/import", FPS, features, root=folder, use_videos=True)
    random = np.random.default_rng(1)
    y, x = np.mgrid[:HEIGHT, :WIDTH]
    touch, images = [], []
    for episode in range(2):
        for frame in range(FRAMES):
            touch.append(random.random((ROWS, COLUMNS), np.float32))
            images.append(np.stack([x + 2 * frame, y + 60 * episode, x // 2 + y // 2], -1).astype(np.uint8))
            dataset.add_frame({LEFT: touch[-1], "observation.images.front": images[-1],
                               "action": np.zeros(2, np.float32), "task": f"task {episode}"})
        dataset.save_episode()
    dataset.finalize()
    return np.stack(touch), np.stack(images)


def import_rows(touchtrace, folder):
    touch, images = write_with_lerobot(folder / "foreign")
    script("import_lerobot", folder / "foreign", folder / "foreign.h5")
    with h5py.File(folder / "foreign.h5") as file:
        counts = file["glove0/counts"][:]
        yield at_most("import: touch that LeRobot wrote", difference(counts * (touch.max() / 65535), touch), "of full range", 1e-5)
        mean = np.abs(file["color/image"][:].astype(float) - images).mean((1, 2, 3)).max()
        yield at_most("import: colour of the worst frame of a video (lossy)", mean, "levels", 4)
        clip_s = file["clips/end_s"][:] - file["clips/start_s"][:]
        yield at_most("import: duration of an episode", difference(clip_s, (FRAMES - 0.5) / FPS), "s", 1e-6)
    checked = subprocess.run([touchtrace, "check", folder / "foreign.h5"], stdout=sys.stderr)
    yield at_most("import: `touchtrace check`", checked.returncode, "exit code", 0)


def rows(touchtrace):
    with tempfile.TemporaryDirectory() as folder:
        yield from export_rows(touchtrace, pathlib.Path(folder))
        yield from import_rows(touchtrace, pathlib.Path(folder))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--touchtrace", default="build/release/touchtrace")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    return figures.emit(rows(options.touchtrace), 52, options.json)


if __name__ == "__main__":
    sys.exit(main())
