"""Figure 1: loss and gradient of a 20-step roll-out against PyTorch in double."""
import os
import subprocess

import torch
from safetensors.numpy import load_file
from torch import nn

from .model import Model, loss_of, windows_of
from .problem import noise_problem, weights_of

# How near to a kink of ReLU, L1 or pinball float may take the other side, which changes the gradient by far
# more than rounding does: sums of the MLP and the loss after 20 steps, and sums of the convolutions.
MLP_MARGIN, CONVOLUTION_MARGIN = 5e-6, 5e-7


def loss_in_double(problem, model):
    """The loss, and the distance of the nearest kink in units of its margin."""
    distances, hooks = [], []

    for name, module in model.named_modules():
        if isinstance(module, nn.Conv2d):
            hooks.append(module.register_forward_hook(
                lambda _, inputs, out: distances.append((out.abs().min() / CONVOLUTION_MARGIN).item())))
        if isinstance(module, nn.ReLU):
            hooks.append(module.register_forward_pre_hook(
                lambda _, inputs: distances.append((inputs[0].abs().min() / MLP_MARGIN).item())))
    batch, frames, spec = problem.batch(0, torch.float64), problem.frames(torch.float64), problem.spec
    segments = None
    if "object" in spec:
        segments = windows_of(frames, batch.segment_last_frame, spec["segment_frames"])
    predicted = model(windows_of(frames, batch.last_frame, spec["window_frames"]), segments, batch.initial_state,
                      problem.steps)
    for hook in hooks:
        hook.remove()
    for side in (-1, 0, 1):
        distances.append(((batch.target - predicted[0] + side * predicted[1]).abs().min() / MLP_MARGIN).item())
    return loss_of(predicted, batch, spec["band_quantile"]), min(distances)


def compare(engine_step, folder, spec, sequences, seed):
    """Relative error of loss and of the whole gradient against double, for roll-outs away from kinks."""
    distance = 0.0
    while not distance > 1.0:
        torch.manual_seed(seed)
        problem, model = noise_problem(spec, sequences, seed), Model(spec)
        path, out = os.path.join(folder, "problem"), os.path.join(folder, "gradient")
        problem.save(path, weights_of(model))
        loss, distance = loss_in_double(problem, model.double())
        seed += 1
    loss.backward()
    subprocess.run([engine_step, path, "gradient", out], check=True)
    engine = load_file(out)
    off = total = 0.0
    for name, parameter in model.named_parameters():
        grad = parameter.grad.numpy()
        off += ((engine[name] - grad) ** 2).sum()
        total += (grad ** 2).sum()
    return abs(engine["loss"].item() - loss.item()) / loss.item(), (off / total) ** 0.5
