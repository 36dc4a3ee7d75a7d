# Calibration from the same corners of OpenCV's sample photographs: touchtrace, OpenCV and mrcal, interleaved in one run.
# mrcal is Debian's package python3-mrcal; it runs in Debian's Python.
# needs: numpy opencv-python-headless
import argparse
import glob
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import cv2
import numpy as np

import figures
from calibration_peers import public_sets, real_rigs, real_sets
from figures import at_most, row

PHOTOGRAPHS = "/usr/share/doc/opencv-doc/examples/data"
COLUMNS, ROWS, SQUARE_M, FOLDS = 9, 6, 0.025, 10
OPENCV = {"radtan4": cv2.CALIB_FIX_K3, "radtan5": 0, "rational8": cv2.CALIB_RATIONAL_MODEL}
FREE_BOARD = ", free board"  # calibrateCameraRO: the board's corners are unknowns (Strobl and Hirzinger)
MRCAL = {"radtan4": "LENSMODEL_OPENCV4", "radtan5": "LENSMODEL_OPENCV5", "rational8": "LENSMODEL_OPENCV8"}


def run_touchtrace(options, side):
    """Its own corners, which the others take, and what it makes of them."""
    with tempfile.TemporaryDirectory() as folder:
        command = [options.touchtrace, "calibrate", "--images", f"{PHOTOGRAPHS}/{side}0?.jpg", "--output", folder, "--json", "--quiet"]
        result = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    details = result["details"]
    return result, dict(fx=result["color"]["intrinsics_px"][0], rms_px=result["rms_px"],
                        held_out_px=details["held_out"]["held_out_rms_px"], lens=details["lens"], **details["solving"])


def board():
    grid = np.mgrid[:COLUMNS, :ROWS].T.reshape(-1, 2) * SQUARE_M
    return np.hstack([grid, np.zeros((len(grid), 1))]).astype(np.float32)


def fit_opencv(views, size, lens):
    """RMS, camera, distortion, and the board's corners."""
    criteria = cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 200, 1e-12
    boards, how = [board()] * len(views), dict(flags=OPENCV[lens.removesuffix(FREE_BOARD)], criteria=criteria)
    if lens.endswith(FREE_BOARD):
        rms, matrix, distortion, _, _, corners = cv2.calibrateCameraRO(boards, views, size, COLUMNS - 1, None, None, **how)
        return rms, matrix, distortion, corners.reshape(-1, 3)
    return *cv2.calibrateCamera(boards, views, size, None, None, **how)[:3], board()


def run_opencv(request, lens):
    views, size = [np.array(v, np.float32) for v in request["corners"]], tuple(request["size"])
    wall, processor = time.perf_counter(), time.process_time()
    rms, matrix, *_ = fit_opencv(views, size, lens)
    timing = dict(wall_s=time.perf_counter() - wall, cpu_s=time.process_time() - processor)
    squares = 0.0
    for first in range(FOLDS):
        train = [v for i, v in enumerate(views) if i % FOLDS != first]
        if len(train) == len(views):
            continue
        _, k, d, corners = fit_opencv(train, size, lens)
        for view in views[first::FOLDS]:
            _, turn, place = cv2.solvePnP(board(), view, k, d)
            turn, place = cv2.solvePnPRefineLM(corners, view, k, d, turn, place)
            squares += ((cv2.projectPoints(corners, turn, place, k, d)[0].reshape(-1, 2) - view) ** 2).sum()
    return dict(timing, fx=matrix[0, 0], rms_px=rms, held_out_px=np.sqrt(squares / (len(views) * COLUMNS * ROWS)))


class Mrcal:
    """In Debian's Python, which its package is for."""

    def __init__(self):
        script = pathlib.Path(__file__).parent / "calibration_peers" / "mrcal_peer.py"
        environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
        self.process = subprocess.Popen(["/usr/bin/python3", str(script)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment)

    def __call__(self, request, lens):
        self.process.stdin.write(json.dumps(dict(request, lens=MRCAL[lens])) + "\n")
        self.process.stdin.flush()
        line = self.process.stdout.readline()
        if not line:
            sys.exit("mrcal gave up; is Debian's package python3-mrcal installed?")
        return json.loads(line)


def request_of(result):
    """All of touchtrace's views that it used, in JSON."""
    views = [v["corners_px"] for v in result["details"]["views"] if v["used"]]
    return dict(corners=views, rows=ROWS, columns=COLUMNS, square_m=SQUARE_M, folds=min(FOLDS, len(views)),
                size=[result["color"]["width"], result["color"]["height"]], focal_px=result["color"]["width"])


def figures_of(options, side, mrcal):
    runs, start = {}, time.time()
    for _ in range(options.rounds):
        result, ours = run_touchtrace(options, side)
        request = request_of(result)
        runs.setdefault("touchtrace", []).append(ours)
        for lens in OPENCV:
            runs.setdefault(f"OpenCV {cv2.__version__} {lens}", []).append(run_opencv(request, lens))
            runs.setdefault(f"mrcal {lens}", []).append(mrcal(request, lens))
    lens = ours["lens"] if ours["lens"] in MRCAL else "radtan4"
    runs[f"OpenCV {cv2.__version__} {lens}{FREE_BOARD}"] = [run_opencv(request, lens + FREE_BOARD)]  # slow
    yield at_most(f"{side}: RMS, touchtrace", ours["rms_px"], "px", 0.24, seconds=time.time() - start)
    yield at_most(f"{side}: fx from mrcal's ({lens})", abs(ours["fx"] - runs[f"mrcal {lens}"][0]["fx"]), "px", 1.5)
    yield at_most(f"{side}: held-out over training RMS", ours["held_out_px"] / ours["rms_px"], "", 1.1)
    best_peer = min(several[0]["held_out_px"] for name, several in runs.items() if name != "touchtrace")
    yield at_most(f"{side}: held-out RMS over the best peer's", ours["held_out_px"] / best_peer, "", 1.0)
    for name, several in runs.items():
        for key, unit in (("fx", "px"), ("rms_px", "px"), ("held_out_px", "px")):
            yield row(f"{side}: {key.removesuffix('_px')}, {name}", several[0][key], unit)
        for key in ("wall_s", "cpu_s"):
            yield row(f"{side}: solving, {key.removesuffix('_s')}, {name}", 1e3 * statistics.median(r[key] for r in several), "ms")


def figures_of_sets(folder, touchtrace):
    """A set of several cameras has a folder for each."""
    for path in sorted(p for p in pathlib.Path(folder).iterdir() if p.is_dir()):
        is_rig = any(p.is_dir() for p in path.iterdir())
        yield from (real_rigs if is_rig else real_sets).figures_of(path, touchtrace)


def main():
    parser = argparse.ArgumentParser(prog="scripts/bench calibration", description="touchtrace, OpenCV and mrcal on the same corners")
    parser.add_argument("--touchtrace", default="build/release/touchtrace")
    parser.add_argument("--rounds", type=int, default=5, help="alternating runs of a timing")
    parser.add_argument("--real", metavar="FOLDER", help="sets of photographs, one folder each, instead: calibration_peers/real_sets.py, real_rigs.py")
    parser.add_argument("--clones", metavar="FOLDER", help="clones of which the sets of calibration_peers/public_sets.toml are written below --real first")
    parser.add_argument("--json", action="store_true", help="print all rows as one JSON object")
    options = parser.parse_args()
    if options.clones:
        public_sets.write_sets(options.clones, options.real or parser.error("--clones needs --real FOLDER"))
    if options.real:
        return figures.emit(figures_of_sets(options.real, options.touchtrace), 80, options.json)
    if not glob.glob(f"{PHOTOGRAPHS}/left0?.jpg"):
        parser.error("the sample photographs of OpenCV are missing: apt-get install opencv-doc")
    if not os.access(options.touchtrace, os.X_OK):
        parser.error(f"{options.touchtrace} is missing: run cmake --preset release && cmake --build --preset release")
    mrcal = Mrcal()
    all_figures = (figure for side in ("left", "right") for figure in figures_of(options, side, mrcal))
    return figures.emit(all_figures, 52, options.json)


if __name__ == "__main__":
    sys.exit(main())
