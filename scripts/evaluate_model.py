#!/usr/bin/env python3
"""Evaluates a model of touchtrace with numpy alone, as `touchtrace evaluate --against labels` does.

usage: evaluate_model.py MODEL.safetensors RECORDING.h5 LABELS.h5    prints L1@20, L1@50 and Hausdorff distance by object

A complete description of the model and of its evaluation for readers of Python. MLP dynamics; one recording, on which the
model was trained, of a glove with the model's resolution.
"""

import json
import sys

import h5py
import numpy as np

HORIZON, STRIDE = 50, 5  # steps of a roll-out, frames between starts


def load_model(path):
    """Tensors by name and the model card of a safetensors file."""
    with open(path, "rb") as file:
        header = json.loads(file.read(int.from_bytes(file.read(8), "little")))
        data = file.read()
    metadata = header.pop("__metadata__")
    tensors = {name: np.frombuffer(data[slice(*entry["data_offsets"])], "<f4").reshape(entry["shape"]).astype(float)
               for name, entry in header.items()}
    return tensors, json.loads(metadata["metadata"])


def load_clips(recording, labels):
    """Usable clips: object, index among the clips of its object, pressure [n, rows, cols], states [n, 12], filtered states, trusted."""
    with h5py.File(recording) as r, h5py.File(labels) as l:
        glove = r["glove0"]
        sign, scale = glove.attrs.get("polarity", 1), 2 ** int(glove.attrs.get("bits", 16)) - 1
        baseline = glove["baseline"][:].astype(float) if "baseline" in glove else 0.0
        pressure = np.clip(sign * (glove["counts"][:] - baseline) / scale, 0, 1) * (glove["mask"][:] if "mask" in glove else 1)
        def states(prefix=""):
            return np.hstack([l[f"{body}/{prefix}{quantity}"][:] for body in ("object", "hand")
                              for quantity in ("position_m", "velocity_m_per_s")])
        label, filtered = states(), states("causal_")
        trusted = (l["object/quality"][:] == 0) & (l["hand/quality"][:] == 0) & np.isfinite(label + filtered).all(1)
        frame, clip, objects = l["label/glove_frame"][:], l["label/clip"][:], l["clips/object"][:].astype(str)
        for number, name in enumerate(objects):
            rows = np.flatnonzero(clip == number)
            rows = rows[np.cumsum(frame[rows] >= 0) > 0]  # from the first frame that the glove sent
            if ("clips/dropped" in l and l["clips/dropped"][number]) or not len(rows):
                continue
            last = np.maximum.accumulate(frame[rows])  # a lost frame repeats the previous one
            yield name, int((objects[:number] == name).sum()), pressure[last], label[rows], filtered[rows], trusted[rows]


def convolution(x, weight, bias, stride):
    """ReLU of a convolution with zero padding of half the kernel; x [n, channels, rows, cols]."""
    size = weight.shape[-1]
    padded = np.pad(x, ((0, 0), (0, 0), (size // 2,) * 2, (size // 2,) * 2))
    patches = np.lib.stride_tricks.sliding_window_view(padded, (size, size), (2, 3))[:, :, ::stride, ::stride]
    return np.maximum(np.einsum("ncijkl,dckl->ndij", patches, weight, optimize=True) + bias[:, None, None], 0)


def encode(tensors, name, spec, frames):
    """Embeddings [n, embedding] of windows [n, M, rows, cols]: channels are 5 times the differences of neighbours, and the last frame."""
    x = np.concatenate([5 * np.diff(frames, axis=1), frames[:, -1:]], axis=1)
    for i, stride in enumerate(spec["tactile_strides"], 1):
        x = convolution(x, tensors[f"{name}.conv{i}.weight"], tensors[f"{name}.conv{i}.bias"], stride)
    x = x.reshape(len(x), -1) @ tensors[f"{name}.dense.weight"].T + tensors[f"{name}.dense.bias"]
    x = (x - x.mean(1, keepdims=True)) / np.sqrt(x.var(1, keepdims=True) + 1e-5)
    return x * tensors[f"{name}.norm.weight"] + tensors[f"{name}.norm.bias"]


def roll_out(tensors, spec, pressure, start, state):
    """Normalised states [HORIZON, 12] after the normalised state of frame `start`. Step k sees touch up to frame start + k."""
    rows = start + np.arange(HORIZON)[:, None] + np.arange(1 - spec["window_frames"], 1)
    touch = encode(tensors, "tactile", spec, pressure[rows]) if spec["touch"] else np.zeros((HORIZON, 0))
    known = encode(tensors, "object", spec, pressure[None, :spec["segment_frames"]])[0] if "object" in spec else []
    activation = {"relu": lambda x: np.maximum(x, 0), "tanh": np.tanh, "silu": lambda x: x / (1 + np.exp(-x))}[spec["activation"]]
    states = []
    for embedding in touch:
        x = np.concatenate([state, embedding, known])
        for layer in (0, 2, 4):
            x = tensors[f"dynamics.{layer}.weight"] @ x + tensors[f"dynamics.{layer}.bias"]
            x = activation(x) if layer < 4 else x
        state = state + x[:12]  # x[12:]: half width of the band, before softplus
        states.append(state)
    return np.array(states)


def scores(predicted, target, trusted):
    """L1@20, L1@50 and Hausdorff distance over trusted steps."""
    error = np.where(trusted, np.abs(predicted - target).mean(1), np.nan)
    distance = np.linalg.norm(predicted[trusted][:, None] - target[trusted][None], axis=2)
    return np.nanmean(error[:20]), np.nanmean(error), max(distance.min(0).max(), distance.min(1).max())


def main(model, recording, labels):
    tensors, card = load_model(model)
    if card["spec"]["dynamics"] != "mlp":
        sys.exit(f"{model}: dynamics {card['spec']['dynamics']}; only mlp is evaluated here")
    spec, mean, sigma = card["spec"], np.array(card["scaling"]["mean"]), np.array(card["scaling"]["deviation"])
    history = max(spec["window_frames"], spec["segment_frames"] if "object" in spec else 0)
    results = {}
    for name, index, pressure, label, filtered, trusted in load_clips(recording, labels):
        if index % 5 != 1:  # other clips are for training, validation and calibration
            continue
        for start in range(history - 1, len(label) - HORIZON, STRIDE):
            after = slice(start + 1, start + 1 + HORIZON)
            if trusted[start] and trusted[after].any():
                predicted = roll_out(tensors, spec, pressure, start, (filtered[start] - mean) / sigma)
                results.setdefault(name, []).append(scores(predicted, (label[after] - mean) / sigma, trusted[after]))
    for name, values in results.items():
        print(json.dumps({"object": name, **dict(zip(("l1_at_20", "l1_at_50", "hausdorff"), np.nanmean(values, 0)))}))


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
