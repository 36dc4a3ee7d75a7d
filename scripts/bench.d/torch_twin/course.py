"""Figure 5: the error on validation clips over the time of training, on the same clips and batches."""
import pathlib
import subprocess
import sys

import numpy as np
import torch
from safetensors.numpy import load_file

from .model import ONE_ENCODER, Model, windows_of
from .problem import Problem
from .training import EngineTrainer, TorchTrainer

LOOKS, HORIZON, AT_ONCE = 20, 50, 64
OPTIONS = dict(weight_decay=1.0)  # as scripts/demo trains
SETTLED = 1.02  # the target lies so much above the worse of the two best errors


def labelled_wave(touchtrace, folder):
    """One object waved about for four minutes, labelled from its video; made once."""
    wave, labels = folder / "wave.h5", folder / "wave.labels.h5"
    if not labels.exists():
        for arguments in (["simulate", wave, "--activity", "wave", "--minutes", "4"],
                          ["calibrate", wave, "--output", folder / "wave.calibration"],
                          ["label", wave, "--calibration", folder / "wave.calibration", "--output", labels]):
            print(f"touchtrace {arguments[0]}: a wave set for the training curves", file=sys.stderr)
            subprocess.run([touchtrace, *map(str, arguments), "--overwrite", "--quiet"], check=True, stdout=sys.stderr)
    return wave, labels


class Validation:
    """Mean L1 over 50 steps of the validation roll-outs, in PyTorch for both sides."""

    def __init__(self, arrays, frames):
        self.frames = frames
        cases = {name.removeprefix("validation."): array for name, array in arrays.items()
                 if name.startswith("validation.")}
        self.problem = Problem(ONE_ENCODER, cases, len(cases["first_frame"]), HORIZON)

    def __call__(self, model):
        batch = self.problem.batch(0)
        last, total = batch.last_frame.view(HORIZON, -1), 0.0
        with torch.inference_mode():
            for some in torch.arange(self.problem.sequences).split(AT_ONCE):
                windows = windows_of(self.frames, last[:, some].flatten(), ONE_ENCODER["window_frames"])
                states, _, _ = model(windows, None, batch.initial_state[some], HORIZON)
                total += ((states - batch.target[:, some]).abs() * batch.weight[:, some, None]).sum().item()
        return total


def time_until(curve, kind, target):
    """Seconds until a curve first falls to `target`, linear between looks."""
    at = int(np.argmax(curve[:, 2] <= target))
    before, after = curve[max(at - 1, 0)], curve[at]
    share = (before[2] - target) / (before[2] - after[2]) if at else 0.0
    return before[kind] + share * (after[kind] - before[kind])


def settled(curves):
    return SETTLED * max(curve[:, 2].min() for curve in curves)


def picture_of(curves, kind, peer):
    """As engine/base/figure.h has it, without the error before training."""
    return dict(x_label=("seconds of training", "CPU seconds of training")[kind],
                y_label="L1 over 50 steps, validation clips", log_x=False, log_y=False,
                curves=[dict(name=name, x=curve[1:, kind].tolist(), y=curve[1:, 2].tolist())
                        for name, curve in zip(("engine", peer), curves)])


class Course:
    """A run of both sides from the same weights on the same batches, with looks at the validation clips.

    Curves are (wall seconds, CPU seconds, error) of every look; looking itself takes no time."""

    def __init__(self, options, folder, setting, seed):
        self.folder = pathlib.Path(folder)
        wave = labelled_wave(options.touchtrace, options.cache)
        path = self.folder / f"course{seed}"
        subprocess.run([options.study_course, *wave, str(options.updates), str(seed), path], check=True)
        arrays = load_file(path)
        batches = {name: array for name, array in arrays.items() if not name.startswith("validation.")}
        batches["stream"] = batches["stream"].reshape(-1, ONE_ENCODER["rows"], ONE_ENCODER["cols"])
        problem = Problem(ONE_ENCODER, batches, 8, options=dict(updates=options.updates, seed=seed, **OPTIONS))
        problem.save(path, {})
        self.validation, self.weights = Validation(arrays, problem.frames()), self.folder / "weights"
        subprocess.run([options.engine_step, path, "train", "0", self.weights], check=True)
        self.peer, self.engine = TorchTrainer(problem, setting), EngineTrainer(options.engine_step, path)
        self.peer(2), self.engine(2)  # builds what is built at the first use
        self.engine.close()
        self.peer.start(load_file(self.weights))
        self.engine = EngineTrainer(options.engine_step, path, self.weights)

    def run(self, updates):
        """The curves of the engine and of PyTorch."""
        curves = [[(0.0, 0.0, self.peer_error())] for _ in range(2)]
        each = updates // LOOKS
        for _ in range(LOOKS):
            for curve, side, error in zip(curves, (self.engine, self.peer), (self.engine_error, self.peer_error)):
                wall, cpu, _ = curve[-1]
                spent = side(each)
                curve.append((wall + spent[0] * each / 1e3, cpu + spent[1] * each / 1e3, error()))
        self.engine.close()
        return [np.array(curve) for curve in curves]

    def peer_error(self):
        return self.validation(self.peer.model)

    def engine_error(self):
        model = Model(ONE_ENCODER)
        model.load_state_dict({name: torch.tensor(value) for name, value in load_file(self.weights).items()})
        return self.validation(model)
