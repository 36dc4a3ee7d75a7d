# mrcal on corners from stdin, one JSON object a line in and out; run by the Python that Debian's python3-mrcal is for.
import json
import sys
import time

import mrcal
import numpy as np


def problem_of(request, views):
    corners = np.array(request["corners"])[views]
    shape = (len(views), request["rows"], request["columns"])
    observations = np.concatenate([corners, np.ones(corners.shape[:2] + (1,))], axis=-1).reshape(shape + (3,))
    indices = np.array([(i, 0, -1) for i in range(len(views))], dtype=np.int32)
    return dict(observations_board=observations, indices_frame_camintrinsics_camextrinsics=indices,
                extrinsics_rt_fromref=np.zeros((0, 6)), points=None, observations_point=None,
                indices_point_camintrinsics_camextrinsics=None,
                imagersizes=np.array([request["size"]], dtype=np.int32),
                calibration_object_spacing=request["square_m"], do_apply_regularization=True,
                do_apply_outlier_rejection=False, verbose=False)


def frames_of(problem, intrinsics):
    poses = mrcal.estimate_monocular_calobject_poses_Rt_tocam(
        problem["indices_frame_camintrinsics_camextrinsics"][:, :2].copy(), problem["observations_board"],
        problem["calibration_object_spacing"], [("LENSMODEL_PINHOLE", intrinsics[0, :4])])
    return mrcal.rt_from_Rt(poses)


def solve(request, views, camera=None):
    """The camera (intrinsics, warp) of these views, or only their poses before `camera`; and the residuals [px]."""
    width, height = request["size"]
    problem = problem_of(request, views)
    count = mrcal.lensmodel_num_params(request["lens"])
    intrinsics, warp = camera or (np.zeros((1, count)), np.zeros(2))
    if camera is None:
        intrinsics[0, :4] = request["focal_px"], request["focal_px"], (width - 1) / 2, (height - 1) / 2
        intrinsics[0, 4:] = 1e-6
    problem.update(lensmodel=request["lens"], intrinsics=intrinsics, calobject_warp=warp,
                   frames_rt_toref=frames_of(problem, intrinsics))
    free = camera is None
    stages = [(True, False), (True, True)] if free else [(False, False)]
    for core, rest in stages:
        result = mrcal.optimize(**problem, do_optimize_intrinsics_core=core, do_optimize_intrinsics_distortions=rest,
                                do_optimize_extrinsics=False, do_optimize_frames=True,
                                do_optimize_calobject_warp=rest)
    residuals = result["x"][:2 * len(views) * request["rows"] * request["columns"]]
    return (problem["intrinsics"], problem["calobject_warp"]), residuals


def rms(squares, corners):
    return float(np.sqrt(squares / corners))


def answer(request):
    views = list(range(len(request["corners"])))
    wall, processor = time.perf_counter(), time.process_time()
    camera, residuals = solve(request, views)
    timing = dict(wall_s=time.perf_counter() - wall, cpu_s=time.process_time() - processor)
    squares = 0.0
    for first in range(request["folds"]):
        fold = views[first::request["folds"]]
        trained, _ = solve(request, [view for view in views if view not in fold])
        squares += float((solve(request, fold, trained)[1] ** 2).sum())
    return dict(timing, fx=float(camera[0][0, 0]), rms_px=rms((residuals ** 2).sum(), residuals.size / 2),
                held_out_px=rms(squares, residuals.size / 2), warp_mm=[1e3 * w for w in camera[1]])


for line in sys.stdin:
    print(json.dumps(answer(json.loads(line))), flush=True)
