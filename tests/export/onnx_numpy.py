"""Evaluates the ONNX files of touchtrace with numpy in double precision, from the wire format of Protocol Buffers alone.

Field numbers: onnx/onnx.proto. Only what touchtrace writes is supported.
"""

import struct

import numpy as np


def fields(data):
    """(field number, value) of a message: int, 4 bytes of a fixed32, or bytes."""
    at = 0

    def varint():
        nonlocal at
        value = shift = 0
        while True:
            byte = data[at]
            at, value, shift = at + 1, value | (byte & 127) << shift, shift + 7
            if byte < 128:
                return value - (1 << 64) if value >> 63 else value

    while at < len(data):
        number, kind = divmod(varint(), 8)
        if kind == 0:
            yield number, varint()
            continue
        size = varint() if kind == 2 else {5: 4, 1: 8}[kind]
        yield number, data[at:at + size]
        at += size


def all_of(message, number):
    return [value for field, value in fields(message) if field == number]


def tensor(message):
    kind = {1: "<f4", 7: "<i8"}[all_of(message, 2)[0]]
    values = np.frombuffer(all_of(message, 9)[0], kind).reshape(all_of(message, 1))
    return all_of(message, 8)[0].decode(), values.astype(float) if kind == "<f4" else values


def attribute(message):
    kind = all_of(message, 20)[0]
    value = {1: lambda: struct.unpack("<f", all_of(message, 2)[0])[0], 2: lambda: all_of(message, 3)[0],
             7: lambda: all_of(message, 8)}[kind]()
    return all_of(message, 1)[0].decode(), value


def convolution(x, weight, bias, kernel_shape, pads, strides):
    padded = np.pad(x, ((0, 0), (0, 0), (pads[0], pads[2]), (pads[1], pads[3])))
    patches = np.lib.stride_tricks.sliding_window_view(padded, kernel_shape, (2, 3))
    patches = patches[:, :, ::strides[0], ::strides[1]]
    return np.einsum("ncijkl,dckl->ndij", patches, weight, optimize=True) + bias[:, None, None]


def layer_normalization(x, gain, bias, axis, epsilon):
    centred = x - x.mean(axis, keepdims=True)
    return centred / np.sqrt((centred**2).mean(axis, keepdims=True) + epsilon) * gain + bias


OPERATIONS = {
    "Add": lambda a, b: a + b,
    "Concat": lambda *x, axis: np.concatenate(x, axis),
    "Conv": convolution,
    "Div": lambda a, b: a / b,
    "Flatten": lambda x: x.reshape(len(x), -1),
    "Gemm": lambda a, b, c, transB: a @ b.T + c,
    "Identity": lambda x: x,
    "LayerNormalization": layer_normalization,
    "Mul": lambda a, b: a * b,
    "Relu": lambda x: np.maximum(x, 0),
    "Sigmoid": lambda x: 1 / (1 + np.exp(-x)),
    "Slice": lambda x, begin, end, axis: np.take(x, range(begin[0], end[0]), axis[0]),
    "Softplus": lambda x: np.logaddexp(x, 0),
    "Sub": lambda a, b: a - b,
    "Tanh": np.tanh,
}


class Session:
    """The part of onnxruntime.InferenceSession that tests use."""

    def __init__(self, path):
        with open(path, "rb") as file:
            model = file.read()
        self.graph = all_of(model, 7)[0]
        self.metadata = {all_of(m, 1)[0].decode(): all_of(m, 2)[0].decode() for m in all_of(model, 14)}
        self.inputs = [all_of(m, 1)[0].decode() for m in all_of(self.graph, 11)]
        self.outputs = [all_of(m, 1)[0].decode() for m in all_of(self.graph, 12)]
        self.constants = dict(tensor(m) for m in all_of(self.graph, 5))
        assert all_of(model, 1) == [8] and all_of(all_of(model, 8)[0], 2) == [17]

    def run(self, inputs):
        assert set(inputs) == set(self.inputs), (inputs.keys(), self.inputs)
        values = {**self.constants, **inputs}
        for node in all_of(self.graph, 1):
            names = [name.decode() for name in all_of(node, 1)]
            outputs = [name.decode() for name in all_of(node, 2)]
            operation, attributes = all_of(node, 4)[0].decode(), dict(attribute(m) for m in all_of(node, 5))
            arguments = [values[name] for name in names]
            if operation == "Split":
                results = np.split(arguments[0], len(outputs), attributes["axis"])
            else:
                results = [OPERATIONS[operation](*arguments, **attributes)]
            values.update(zip(outputs, results))
        return {name: values[name] for name in self.outputs}
