"""Labels of public recordings: `touchtrace import`, `mark` and `label`, and their errors.

recordings.toml says what is read and which boxes are drawn; sources.py makes it a folder of images. The folder that is
given has clones of the repositories: `git clone https://github.com/OWNER/NAME FOLDER/OWNER/NAME`.
References are in references/*.csv: body, frame (index of the colour image), x_m, y_m, z_m in the colour camera's frame,
sigma_m per axis. They were made by a person without touchtrace: colour segmentation, SAM 2 masks or clicks, with depth."""

import pathlib
import subprocess
import sys
import tempfile
import time
import tomllib

import h5py
import numpy as np

from figures import row
from real_labels import sources

HERE = pathlib.Path(__file__).parent
WRONG_M, FAR_M = 0.06, 0.15
MAX_INTERVALS = 0.6  # between a frame and its label, in frame periods


def touchtrace(program, *arguments):
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(f"touchtrace {arguments[0]}: {done.stderr.strip()}")


def make_labels(options, recording, clone, folder):
    """Paths of the recording and of its labels."""
    images, file, labels = folder / "images", folder / "clip.h5", folder / "clip.labels.h5"
    images.mkdir()
    sources.write_images(recording, clone, images)
    scale = ["--depth-scale", recording["depth_scale"]] if "depth_scale" in recording else []
    masks = ["--masks", images / "masks"] if "object_masks" in recording else []
    boxes = [f"--box={body}={','.join(map(str, recording[body]))}" for body in ("hand", "object")]
    touchtrace(options.touchtrace, "import", images, *recording["options"], *scale, *masks, "--output", file)
    touchtrace(options.touchtrace, "mark", file, *boxes, "--frame", recording["frame"])
    touchtrace(options.touchtrace, "label", file, "--output", labels)
    return file, labels


def read_references(name):
    table = np.genfromtxt(HERE / "references" / f"{name}.csv", delimiter=",", names=True, dtype=None, encoding="utf-8")
    return {body: table[table["body"] == body] for body in ("object", "hand")}


def good_at(reference, frame_time_s, label_time_s, label):
    """Errors [m] of good labels at references, NEES of each, and the number of flagged labels at references."""
    times_s = frame_time_s[reference["frame"]]
    index = np.abs(label_time_s[None] - times_s[:, None]).argmin(axis=1)
    is_near = np.abs(label_time_s[index] - times_s) < MAX_INTERVALS * np.median(np.diff(frame_time_s))
    reference, index = reference[is_near], index[is_near]
    is_good = label["quality"][:][index] == 0
    reference, index = reference[is_good], index[is_good]
    error_m = label["position_m"][:][index] - np.stack([reference[f"{axis}_m"] for axis in "xyz"], axis=1)
    covariance = label["covariance"][:][index, :3, :3] + reference["sigma_m"][:, None, None] ** 2 * np.eye(3)
    nees = np.einsum("ni,ni->n", error_m, np.linalg.solve(covariance, error_m[..., None])[..., 0]) / 3
    return np.linalg.norm(error_m, axis=1), nees, (~is_good).sum()


def rows_of_body(name, error_m, nees, flagged):
    yield row(f"{name}: good labels at references", len(error_m), "")
    yield row(f"{name}: flagged labels at references", flagged, "")
    yield row(f"{name}: good labels over 60 mm off", (~(error_m <= WRONG_M)).sum(), "")
    yield row(f"{name}: good labels over 150 mm off", (~(error_m <= FAR_M)).sum(), "")
    if len(error_m):
        yield row(f"{name}: median error of good labels", 1e3 * np.median(error_m), "mm")
        yield row(f"{name}: largest error of good labels", 1e3 * error_m.max(), "mm")
        yield row(f"{name}: NEES of good labels, with the reference's sigma", nees.mean(), "")


def rows_of_recording(options, name, recording, clone, errors):
    """Appends the errors of good labels to `errors`, by body."""
    start = time.time()
    references = read_references(recording.get("references", name))
    with tempfile.TemporaryDirectory() as folder:
        file, labels = make_labels(options, recording, clone, pathlib.Path(folder))
        with h5py.File(file) as images, h5py.File(labels) as states:
            frame_time_s, label_time_s = images["color/host_time_s"][:], states["label/time_s"][:]
            judged = {body: good_at(reference, frame_time_s, label_time_s, states[body])
                      for body, reference in references.items()}
    yield row(f"{name}: labelled", 1, "", seconds=time.time() - start)
    for body, of_body in judged.items():
        errors[body].append(of_body[0])
        yield from rows_of_body(f"{name}, {body}", *of_body)


def figures(options):
    """Rows of the recordings of which the folder has a clone, and sums. Those that `label` refuses are named on stderr."""
    folder, errors = pathlib.Path(options.real), dict(object=[], hand=[])
    recordings = {name: recording for name, recording in tomllib.loads((HERE / "recordings.toml").read_text()).items()
                  if options.match in name and (folder / recording["repository"]).is_dir()}
    if not recordings:
        sys.exit(f"no clone below {folder}; hint: git clone https://github.com/OWNER/NAME {folder}/OWNER/NAME, "
                 f"repositories are in {HERE / 'recordings.toml'}")
    for name, recording in recordings.items():
        try:
            yield from rows_of_recording(options, name, recording, folder / recording["repository"], errors)
        except RuntimeError as refusal:
            print(f"{name}: {refusal}", file=sys.stderr)
            yield row(f"{name}: labelled", 0, "")
        except subprocess.CalledProcessError as missing:
            print(f"{name}: {missing.stderr}", file=sys.stderr)
            yield row(f"{name}: labelled", float("nan"), "")
    for body, of_body in errors.items():
        error_m = np.concatenate([*of_body, []])
        yield row(f"all, {body}: good labels at references", len(error_m), "")
        yield row(f"all, {body}: good labels over 60 mm off", (~(error_m <= WRONG_M)).sum(), "")
        yield row(f"all, {body}: good labels over 150 mm off", (~(error_m <= FAR_M)).sum(), "")
