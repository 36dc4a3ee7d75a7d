"""Halves of real sets of photographs, and subsets of few views: does the stated covariance explain how much they disagree?

A set is a folder of images, with `set.json` where the board is not OpenCV's 9x6 of 25 mm:
{"columns": 7, "rows": 7, "square_mm": 25.4, "markers": "5x5_100", "marker_mm": 12.7, "lens": "radtan5"}"""

import json
import pathlib
import random
import subprocess
import sys
import tempfile

import cv2
import numpy as np

from figures import row

SPLITS, FEW_VIEWS = 10, 4
NAMES = ["color.fx", "color.fy", "color.cx", "color.cy"]
OPENCV = {"none": cv2.CALIB_FIX_K1 | cv2.CALIB_FIX_K2 | cv2.CALIB_FIX_K3 | cv2.CALIB_ZERO_TANGENT_DIST,
          "radtan4": cv2.CALIB_FIX_K3, "radtan5": 0, "rational8": cv2.CALIB_RATIONAL_MODEL}


def board_options(folder):
    file = folder / "set.json"
    board = dict(columns=9, rows=6, square_mm=25.0) | (json.loads(file.read_text()) if file.exists() else {})
    lens = board.pop("lens", "auto")
    return board, lens


def calibrate(touchtrace, source, board, lens):
    """calibration.json from images or corners; None if it is refused."""
    with tempfile.TemporaryDirectory() as output:
        command = [touchtrace, "calibrate", *source, "--lens", lens, "--output", output, "--json", "--quiet", "--overwrite"]
        for name, value in board.items():
            command += [f"--{name.replace('_', '-')}", str(value)]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode not in (0, 3) or not done.stdout:
            print(done.stderr, file=sys.stderr)
            return None
        return json.loads(done.stdout)


def ours(touchtrace, whole, views, board, lens):
    with tempfile.TemporaryDirectory() as folder:
        corners = pathlib.Path(folder) / "corners.json"
        corners.write_text(json.dumps(dict(color=whole["color"], details=dict(views=views))))
        result = calibrate(touchtrace, ["--corners", str(corners)], board, lens)
    if result is None:
        return None
    index = [result["parameters"].index(name) for name in NAMES]
    return dict(values=np.array(result["color"]["intrinsics_px"]), covariance=np.array(result["covariance"])[np.ix_(index, index)])


def opencv(whole, views, board, lens):
    """calibrateCamera and the covariance of independent corners, from its own Jacobian."""
    flags = OPENCV.get(lens)
    if flags is None:
        return None
    ids = [v.get("corner_ids", range(len(v["corners_px"]))) for v in views]
    on_board = [np.array([[i % board["columns"], i // board["columns"], 0] for i in list_], np.float32) * board["square_mm"] * 1e-3 for list_ in ids]
    in_image = [np.array(v["corners_px"], np.float32) for v in views]
    size = whole["color"]["width"], whole["color"]["height"]
    criteria = cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 200, 1e-12
    _, matrix, distortion, turns, places = cv2.calibrateCamera(on_board, in_image, size, None, None, flags=flags, criteria=criteria)
    free = {"none": 0, "radtan4": 4, "radtan5": 5, "rational8": 8}[lens]
    sums, squares, count = np.zeros((4 + free, 4 + free)), 0.0, 0
    for points, seen, turn, place in zip(on_board, in_image, turns, places):
        projected, jacobian = cv2.projectPoints(points, turn, place, matrix, distortion)
        pose, shared = jacobian[:, :6], jacobian[:, 6:10 + free]
        sums += shared.T @ shared - shared.T @ pose @ np.linalg.solve(pose.T @ pose, pose.T @ shared)
        squares += ((projected.reshape(-1, 2) - seen) ** 2).sum()
        count += 2 * len(seen) - 6
    covariance = np.linalg.inv(sums)[:4, :4] * squares / (count - 4 - free)
    return dict(values=matrix[[0, 1, 0, 1], [0, 1, 2, 2]], covariance=covariance)


def nees(first, second):
    difference = first["values"] - second["values"]
    return difference @ np.linalg.solve(first["covariance"] + second["covariance"], difference) / len(NAMES)


def figures_of(folder, touchtrace):
    board, lens = board_options(folder)
    whole = calibrate(touchtrace, ["--images", str(folder)], board, lens)
    if whole is None:
        yield row(f"{folder.name}: refused", float("nan"), "")
        return
    lens = whole["details"]["lens"]
    views = [view for view in whole["details"]["views"] if view["used"]]
    width = whole["color"]["width"]
    about = f"{folder.name} ({len(views)} views, {width}x{whole['color']['height']}, {lens}, {whole['rms_px']:.2f} px)"
    peers = {"touchtrace": lambda some: ours(touchtrace, whole, some, board, lens), "OpenCV": lambda some: opencv(whole, some, board, lens)}
    yield from disagreement(f"{about}: NEES of halves", views, len(views) // 2, len(views), peers)
    if len(views) >= 2 * FEW_VIEWS:
        yield from disagreement(f"{about}: NEES of two times {FEW_VIEWS} views", views, FEW_VIEWS, 2 * FEW_VIEWS, peers)
    yield row(f"{about}: sigma over that of independent corners", whole["details"]["view_inflation"], "")


def disagreement(about, views, first, both, peers):
    """NEES of pairs of disjoint subsets, drawn at random: of `both` views, of which the first has `first`."""
    values, order = {name: [] for name in peers}, random.Random(1)
    for _ in range(SPLITS):
        shuffled = order.sample(views, len(views))
        for name, fit in peers.items():
            fits = [fit(shuffled[:first]), fit(shuffled[first:both])]
            if None not in fits:
                values[name].append(nees(*fits))
    for name, list_ in values.items():
        if name == "touchtrace":
            about_fits = "" if len(list_) == SPLITS else f", {len(list_)} of {SPLITS} splits converge"
            value = float(np.mean(list_)) if list_ else float("nan")
            yield row(f"{about}{about_fits}", value, "", "in [.7, 1.5]", 0.7 <= value <= 1.5)
        elif list_:
            yield row(f"{about}, {name}", np.mean(list_), "")
