"""Image folders for `touchtrace import`, made of the files in clones of public repositories."""

import itertools
import pathlib

import cv2
import numpy as np
import scipy.io

from clones import extract

DEPTH_HEADER_BYTES, DEPTH_FILE_SIZE = 12, (240, 320)  # of agpetit/RGBDTracking


def read_xyzrgb(file):
    """Point, x right, y up, z backward [m], and colour of each pixel: [480, 640, 6], of oldcat/AV2."""
    return next(value for key, value in scipy.io.loadmat(file).items() if not key.startswith("_")).reshape(480, 640, 6)


def color_bgr(file):
    return read_xyzrgb(file)[..., :2:-1].astype(np.uint8) if file.suffix == ".mat" else cv2.imread(str(file))


def depth_mm(file):
    """Depth image [mm, or counts of depth_scale], 16 bits; 0: unknown."""
    if file.suffix == ".mat":
        return (-1e3 * read_xyzrgb(file)[..., 2]).round().astype(np.uint16)
    if file.suffix == ".png":
        return cv2.imread(str(file), cv2.IMREAD_UNCHANGED)
    if file.suffix == ".txt":
        depth = 1e3 * np.frombuffer(file.read_bytes()[DEPTH_HEADER_BYTES:], "<f4").reshape(DEPTH_FILE_SIZE)
    else:
        loaded = np.load(file)
        depth = loaded if file.suffix == ".npy" else 1e3 * loaded["depth"]
    return np.nan_to_num(depth, posinf=0).round().clip(0, 65535).astype(np.uint16)


def registered(depth, recording):
    """Depth image on the colour camera's pixels, by `depth_camera`: f, cx, cy [px], translation to the colour camera [m]."""
    f, cx, cy, *translation_m = recording["depth_camera"]
    color_fx, color_fy, color_cx, color_cy = recording["intrinsics"]
    v, u = np.nonzero(depth)
    z_m = depth[v, u] / recording.get("depth_scale", 1000)
    nearest_m = np.full(recording.get("color_size", depth.shape), np.inf)
    for du, dv in itertools.product((-0.33, 0, 0.33), repeat=2):  # leaves no holes between pixels
        x_m, y_m, new_m = np.stack([(u + du - cx) / f * z_m, (v + dv - cy) / f * z_m, z_m]) + np.reshape(translation_m, (3, 1))
        column = np.round(x_m / new_m * color_fx + color_cx).astype(int)
        row = np.round(y_m / new_m * color_fy + color_cy).astype(int)
        inside = (column >= 0) & (column < nearest_m.shape[1]) & (row >= 0) & (row < nearest_m.shape[0])
        np.minimum.at(nearest_m, (row[inside], column[inside]), new_m[inside])
    nearest_m[np.isinf(nearest_m)] = 0
    return (nearest_m * recording.get("depth_scale", 1000)).round().astype(np.uint16)


def write_image(source, target, read, recording):
    """Copies an image; converts it where `import` does not read it, registers depth, or reduces the size."""
    is_depth, reduce = read is depth_mm, recording.get("reduce", 1)
    is_displaced = is_depth and "depth_camera" in recording
    if source.suffix in (".png", ".jpg", ".jpeg") and reduce == 1 and not is_displaced:
        return source.rename(target.with_suffix(source.suffix))
    image = read(source)
    if is_displaced:
        image = registered(image, recording)
    elif is_depth:
        image = image[::reduce, ::reduce]
    else:
        image = cv2.resize(image, None, fx=1 / reduce, fy=1 / reduce, interpolation=cv2.INTER_AREA)
    cv2.imwrite(str(target.with_suffix(".png")), image)


def write_images(recording, clone, folder):
    """Writes rgb, depth, masks and cam_K.txt of a row of recordings.toml."""
    readers = dict(color=("rgb", color_bgr), depth=("depth", depth_mm),
                   object_masks=("masks/object", None))
    for kind in readers.keys() & recording.keys():
        name, read = readers[kind]
        (folder / name).mkdir(parents=True)
        files = extract(clone, recording["commit"], recording[kind], folder.with_name(f"{kind}_files"))
        files = files[::recording.get("stride", 1)][:recording.get("max_frames")]
        for i, file in enumerate(files):
            write_image(file, folder / name / f"{i:05d}", read, recording)
    fx, fy, cx, cy = recording["intrinsics"]
    np.savetxt(folder / "cam_K.txt", [[fx, 0, cx], [0, fy, cy], [0, 0, 1]])
