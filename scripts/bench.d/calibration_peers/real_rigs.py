"""Halves of real sets of two cameras: does the stated covariance explain how much their relative poses disagree?

A set is a folder with a folder of images for each of two cameras, and `set.json` as in real_sets.py. Images of one
number are simultaneous."""

import json
import pathlib
import random
import re
import tempfile

import cv2
import numpy as np

from calibration_peers import real_sets
from figures import row


def numbered_views(calibration):
    """The used views by the number in their names."""
    views = [view for view in calibration["details"]["views"] if view["used"]]
    return {int((re.findall(r"\d+", view["name"]) or [-1])[-1]): view for view in views}


def touchtrace_pose(touchtrace, wholes, views, numbers, board, lens):
    """Rotation and translation of the second camera from the first, and their covariance."""
    with tempfile.TemporaryDirectory() as folder:
        sources = []
        for name, whole in wholes.items():
            corners = pathlib.Path(folder) / f"{name}.json"
            corners.write_text(json.dumps(dict(color=whole["color"], details=dict(views=[views[name][n] for n in numbers]))))
            sources.append(f"{name}={corners}")
        rig = real_sets.calibrate(touchtrace, ["--camera", *sources], board, lens)
    if rig is None:
        return None
    first = next(i for i, name in enumerate(rig["parameters"]) if name.endswith(".rx"))
    pose = np.array(rig["cameras"][1]["camera_from_rig"])
    covariance = np.array(rig["covariance"])[first : first + 6, first : first + 6]
    return dict(rotation=pose[:3, :3], place=pose[:3, 3], covariance=covariance)


def opencv_pose(wholes, views, numbers, board, lens):
    """calibrateCamera for each camera, then stereoCalibrate for all parameters."""
    grid = np.mgrid[: board["columns"], : board["rows"]].T.reshape(-1, 2) * board["square_mm"] * 1e-3
    boards = [np.hstack([grid, np.zeros((len(grid), 1))]).astype(np.float32)] * len(numbers)
    flags, how = real_sets.OPENCV[lens], dict(criteria=(cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 200, 1e-12))
    size, images, cameras = None, [], []
    for name, whole in wholes.items():
        size = whole["color"]["width"], whole["color"]["height"]
        images.append([np.array(views[name][n]["corners_px"], np.float32) for n in numbers])
        cameras += cv2.calibrateCamera(boards, images[-1], size, None, None, flags=flags, **how)[1:3]
    result = cv2.stereoCalibrate(boards, *images, *cameras, size, flags=flags | cv2.CALIB_USE_INTRINSIC_GUESS, **how)
    return dict(rotation=result[5], place=result[6].ravel())


def difference(first, second):
    """Rotation vector, then translation."""
    return np.concatenate([cv2.Rodrigues(first["rotation"] @ second["rotation"].T)[0].ravel(), first["place"] - second["place"]])


def rms_mm(differences):
    return 1e3 * float(np.sqrt(np.mean([np.sum(d[3:] ** 2) for d in differences])))


def figures_of(folder, touchtrace):
    board, lens = real_sets.board_options(folder)
    names = sorted(p.name for p in folder.iterdir() if p.is_dir())
    wholes = {name: real_sets.calibrate(touchtrace, ["--images", str(folder / name)], board, lens) for name in names}
    if None in wholes.values():
        yield row(f"{folder.name}: refused", float("nan"), "")
        return
    views = {name: numbered_views(whole) for name, whole in wholes.items()}
    shared = sorted(set.intersection(*(set(v) for v in views.values())))
    lens = wholes[names[0]]["details"]["lens"]
    nees, ours, theirs, order = [], [], [], random.Random(1)
    for _ in range(real_sets.SPLITS):
        shuffled = order.sample(shared, len(shared))
        halves = shuffled[: len(shared) // 2], shuffled[len(shared) // 2 :]
        fits = [touchtrace_pose(touchtrace, wholes, views, half, board, lens) for half in halves]
        if None in fits:
            continue
        ours.append(difference(*fits))
        nees.append(ours[-1] @ np.linalg.solve(fits[0]["covariance"] + fits[1]["covariance"], ours[-1]) / 6)
        if lens in real_sets.OPENCV:
            theirs.append(difference(*(opencv_pose(wholes, views, half, board, lens) for half in halves)))
    about = f"{folder.name} ({len(shared)} frames, {lens}), {len(nees)} of {real_sets.SPLITS} splits"
    value = float(np.mean(nees)) if nees else float("nan")
    yield row(f"{about}: NEES of the relative pose of halves", value, "", "in [.7, 1.5]", 0.7 <= value <= 1.5)
    yield row(f"{about}: difference of the position of halves, RMS", rms_mm(ours) if ours else float("nan"), "mm")
    if theirs:
        yield row(f"{about}: difference of the position of halves, RMS, OpenCV", rms_mm(theirs), "mm")
