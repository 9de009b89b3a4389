#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Write the built-in descriptor, oriented gradients as a small CNN, as an ONNX file.

Why: a place needs a descriptor that works with no model at hand, costs well under a millisecond, and survives night and
season. Which way the edges run does; how bright they are, and which side is the bright one, does not. So every filter
below is fixed, nothing is trained, and orientation is unsigned.

Input   image       [1, 1, 128, 256]  grey levels 0..255, no mean, scale 1 (EPSILON is in these units, squared)
Output  descriptor  [1, 15, 7, 7]    orientation x row x column, each 0..1; 735 values in CHW order. A flat image gives 0.

Stages (unpadded throughout: a padded border would be the strongest edge of every image):
  filters    central differences dx, dy and dx + dy, squared, averaged over 3x3 pixels, every 2nd kept: the structure tensor
             Jxx, Jyy, Jxx + 2 Jxy + Jyy, [62, 126]. Squares of opposite gradients agree, so noise averages out and edges stay.
  rectify    the tensor over the root of its energy E = Jxx + Jyy (grey levels again), projected on ORIENTATIONS double angles;
             what SELECTIVITY * E leaves passes: r = max(0, ((Jxx - Jyy) cos 2a + 2 Jxy sin 2a - SELECTIVITY * E) / sqrt(E)).
  pool       means over cells of 18x48 pixels every 16x32: wide cells forgive a sideways step, overlap forgives a border.
             They leave out 6 pixels on the left and on the right, and the lowest 10, which are road.
  normalise  each cell's histogram to unit length, then its root, so that no single strong edge decides a cell.

Only operators that OpenCV 4.6's dnn imports are used; its results agree with this text written in numpy within 1e-4.
The file is byte-identical from run to run.
"""
import argparse
import math
from pathlib import Path

import numpy as np
from onnx import ModelProto, TensorProto, checker, helper, numpy_helper

HEIGHT, WIDTH = 128, 256       # pixels of the input
ORIENTATIONS = 15              # bins over half a turn, 12 degrees apart
SELECTIVITY = 0.7              # 0..1; a bin answers to edges within acos(0.7)/2 = 23 degrees, and only to coherent ones
TENSOR_WINDOW = 3              # pixels a side, averaged into one structure tensor
TENSOR_STEP = 2                # pixels from one tensor to the next
CELL = (9, 24)                 # tensors, rows x columns
CELL_STEP = (8, 16)            # tensors
CELLS = 7                      # in a row and in a column
EPSILON = 1.0                  # (grey levels)^2 below which an edge, or a cell, counts as flat


class Graph:
    """A chain of ONNX nodes; every method appends one and returns the name of its output."""

    def __init__(self) -> None:
        self.nodes: list = []
        self.weights: list = []

    def op(self, kind: str, name: str, inputs: list[str], **attributes: object) -> str:
        self.nodes.append(helper.make_node(kind, inputs, [name], name=name, **attributes))
        return name

    def conv(self, name: str, x: str, kernel: np.ndarray, bias: float = 0.0) -> str:
        """@param kernel [out, in, rows, columns]; unpadded; the same bias for all outputs."""
        parts = {name + "_kernel": kernel, name + "_bias": np.full(len(kernel), bias)}
        for key, value in parts.items():  # rounded: the file must not depend on a libm's last digit
            self.weights.append(numpy_helper.from_array(np.round(value, 6).astype(np.float32), key))
        return self.op("Conv", name, [x, *parts], kernel_shape=list(kernel.shape[2:]))

    def cut(self, name: str, x: str, rows: tuple[int, int], columns: tuple[int, int]) -> str:
        """@param rows, columns the first, and the one behind the last"""
        parts = {name + "_starts": (rows[0], columns[0]), name + "_ends": (rows[1], columns[1]), name + "_axes": (2, 3)}
        for key, value in parts.items():
            self.weights.append(numpy_helper.from_array(np.array(value, np.int64), key))
        return self.op("Slice", name, [x, *parts])

    def over_root(self, name: str, x: str, power: str, kernel: np.ndarray) -> str:
        """x / sqrt(kernel * power + EPSILON); kernel [channels of x, channels of power, 1, 1], 1 where summed."""
        root = self.op("Sqrt", name + "_root", [self.conv(name + "_power", power, kernel, EPSILON)])
        return self.op("Div", name, [x, root])


def build() -> ModelProto:
    """The whole model; see the module's text for its stages."""
    g = Graph()

    # filters: [3, 62, 126] = Jxx, Jyy, Jxx + 2 Jxy + Jyy
    dx = np.array([[0.0, 0, 0], [-0.5, 0, 0.5], [0, 0, 0]])
    gradient = g.conv("gradient", "image", np.stack([dx, dx.T, dx + dx.T])[:, None])
    squares = g.op("Mul", "squares", [gradient, gradient])
    tensors = g.op("AveragePool", "tensors", [squares], kernel_shape=[TENSOR_WINDOW] * 2, strides=[TENSOR_STEP] * 2)

    # what cells cover: [3, 57, 120], the upper rows and the columns in the middle
    rows, columns = (cell + (CELLS - 1) * step for cell, step in zip(CELL, CELL_STEP))
    left = ((WIDTH - 2 - TENSOR_WINDOW) // TENSOR_STEP + 1 - columns) // 2
    tensor = g.cut("tensor", tensors, (0, rows), (left, left + columns))

    # rectify: [15, 57, 120]
    energy = np.array([1.0, 1.0, 0.0])
    amplitude = g.over_root("amplitude", tensor, tensor, np.tile(energy, (3, 1))[:, :, None, None])
    double_angle = 2 * math.pi * np.arange(ORIENTATIONS)[:, None] / ORIENTATIONS
    steer = (np.cos(double_angle) * [1.0, -1.0, 0.0]       # Jxx - Jyy
             + np.sin(double_angle) * [-1.0, -1.0, 1.0]    # 2 Jxy
             - SELECTIVITY * energy)
    edges = g.op("Relu", "edges", [g.conv("steer", amplitude, steer[:, :, None, None])])

    # pool, normalise: [15, 7, 7]
    cells = g.op("AveragePool", "cells", [edges], kernel_shape=list(CELL), strides=list(CELL_STEP))
    power = g.op("Mul", "cell_squares", [cells, cells])
    histogram = g.over_root("histogram", cells, power, np.ones((ORIENTATIONS, ORIENTATIONS, 1, 1)))
    output = g.op("Sqrt", "descriptor", [histogram])

    graph = helper.make_graph(
        g.nodes, "oriented_gradients",
        [helper.make_tensor_value_info("image", TensorProto.FLOAT, [1, 1, HEIGHT, WIDTH])],
        [helper.make_tensor_value_info(output, TensorProto.FLOAT, [1, ORIENTATIONS, CELLS, CELLS])], g.weights)
    model = helper.make_model(graph, producer_name="seqloop", opset_imports=[helper.make_opsetid("", 11)])
    model.ir_version = 6  # of opset 11, whatever the installed onnx would write
    checker.check_model(model)
    return model


def main() -> None:
    parser = argparse.ArgumentParser(description="Write SeqLoop's built-in descriptor as ONNX.")
    parser.add_argument("--out", type=Path, default=Path(__file__).with_name("oriented_gradients.onnx"))
    out: Path = parser.parse_args().out
    out.write_bytes(build().SerializeToString())
    print(f"{out}: {out.stat().st_size} bytes")


if __name__ == "__main__":
    main()
