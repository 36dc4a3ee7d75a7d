#!/usr/bin/env python3
"""Rolls an exported model out and prints its states and half widths as JSON, [S, T, 12] each.

usage: roll_out.py numpy|onnxruntime|torch CASE.json

CASE: "model" (.onnx, of torch .safetensors), "object" (.onnx or ""), "stream" (raw float32 [frames, rows, cols]), "rows",
"cols", "window", "segment", "hidden", "first_frame" [S], "segment_frame" [S], "state" [S, 12] in metres, "steps".
"""

import json
import os
import sys

import numpy as np

sys.path.insert(0, os.path.dirname(__file__))


def numpy_session(path):
    import onnx_numpy
    session = onnx_numpy.Session(path)
    return session.run, session.inputs


def onnxruntime_session(path):
    import onnxruntime
    session = onnxruntime.InferenceSession(path, providers=["CPUExecutionProvider"])
    names = [output.name for output in session.get_outputs()]
    def run(inputs):
        return dict(zip(names, session.run(names, {k: v.astype(np.float32) for k, v in inputs.items()})))
    return run, [i.name for i in session.get_inputs()]


def roll_out_onnx(open_session, case, stream):
    run, inputs = open_session(case["model"])
    def windows(last, frames):
        return np.stack([stream[end - frames + 1:end + 1] for end in last])
    first = np.array(case["first_frame"])
    known = {"state": np.array(case["state"])}
    if "hidden" in inputs:
        known["hidden"] = np.zeros((len(first), case["hidden"]))
    if "object" in inputs:
        last = np.array(case["segment_frame"]) + case["segment"] - 1
        known["object"] = open_session(case["object"])[0]({"touch": windows(last, case["segment"])})["object"]
    states, half_widths = [], []
    for step in range(case["steps"]):
        if "touch" in inputs:
            known["touch"] = windows(first + step, case["window"])
        out = run(known)
        known["state"] = out["next_state"]
        if "hidden" in inputs:
            known["hidden"] = out["next_hidden"]
        states.append(out["next_state"]), half_widths.append(out["half_width"])
    return np.stack(states, 1), np.stack(half_widths, 1)


def roll_out_torch(case, stream):
    sys.path.insert(0, os.path.join(os.path.dirname(__file__), "..", "..", "scripts"))
    import torch
    from touchtrace_model import TouchtraceModel
    model = TouchtraceModel.load(case["model"])
    touch = torch.from_numpy(stream.astype(np.float32))
    def windows(last, frames):
        return torch.stack([touch[end - frames + 1:end + 1] for end in last])
    object_segment = None
    if model.has_object:
        object_segment = windows([first + case["segment"] - 1 for first in case["segment_frame"]], case["segment"])
    frames = [windows([first + step for first in case["first_frame"]], case["window"]) for step in range(case["steps"])]
    with torch.no_grad():
        return model(torch.tensor(case["state"]), torch.stack(frames, 1), object_segment)


def main(engine, case_file):
    with open(case_file) as file:
        case = json.load(file)
    stream = np.fromfile(case["stream"], "<f4").reshape(-1, case["rows"], case["cols"]).astype(float)
    if engine == "torch":
        states, half_widths = roll_out_torch(case, stream)
    else:
        session = {"numpy": numpy_session, "onnxruntime": onnxruntime_session}[engine]
        states, half_widths = roll_out_onnx(session, case, stream)
    print(json.dumps({"state": np.ravel(states).astype(float).tolist(),
                      "half_width": np.ravel(half_widths).astype(float).tolist()}))


if __name__ == "__main__":
    main(*sys.argv[1:])
