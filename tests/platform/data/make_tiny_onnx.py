#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Makes the tiny ONNX files of the describer's tests (needs python3-onnx)."""

import pathlib

import numpy
import onnx
from onnx import TensorProto, helper, numpy_helper

FOLDER = pathlib.Path(__file__).parent


def value(name, shape):
    return helper.make_tensor_value_info(name, TensorProto.FLOAT, shape)


def weights(name, array):
    return numpy_helper.from_array(numpy.asarray(array, numpy.float32), name)


def save(name, nodes, input_shape, output_shape, constants=()):
    graph = helper.make_graph(
        nodes, name, [value("x", input_shape)], [value("y", output_shape)], list(constants)
    )
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 11)])
    model.ir_version = 6
    onnx.checker.check_model(model)
    onnx.save(model, FOLDER / f"{name}.onnx")


def conv(inputs, output, name):
    return helper.make_node("Conv", inputs, [output], name=name, kernel_shape=[1, 1])


# Named nodes, an unnamed one (the pooling), tensors that are named otherwise than their nodes.
save(
    "gray_chain",
    [
        conv(["x", "w"], "c_out", "conv"),
        helper.make_node("Relu", ["c_out"], ["r_out"], name="relu"),
        helper.make_node("MaxPool", ["r_out"], ["p_out"], kernel_shape=[2, 2], strides=[2, 2]),
        helper.make_node("Sqrt", ["p_out"], ["y"], name="root"),
    ],
    [1, 1, 4, 4],
    [1, 2, 2, 2],
    [weights("w", [[[[1]]], [[[-1]]]])],
)

# Activations that run into a concatenation: OpenCV's fusion overwrites them.
save(
    "fork",
    [
        conv(["x", "v"], "a", "conv_a"),
        helper.make_node("Relu", ["a"], ["ra"], name="relu_a"),
        conv(["x", "w"], "b", "conv_b"),
        helper.make_node("Relu", ["b"], ["rb"], name="relu_b"),
        helper.make_node("Concat", ["ra", "rb"], ["y"], name="joined", axis=1),
    ],
    [1, 1, 4, 4],
    [1, 4, 4, 4],
    [weights("v", [[[[1]]], [[[2]]]]), weights("w", [[[[3]]], [[[4]]]])],
)

# The input as it is: three channels, any size.
save(
    "colour",
    [conv(["x", "w"], "y", "same")],
    [1, 3, "height", "width"],
    [1, 3, "height", "width"],
    [weights("w", numpy.eye(3).reshape(3, 3, 1, 1))],
)

save(
    "four_channels",
    [conv(["x", "w"], "y", "sum")],
    [1, 4, 4, 4],
    [1, 1, 4, 4],
    [weights("w", numpy.ones((1, 4, 1, 1)))],
)

# Minus infinity where the picture is black.
save("logarithm", [helper.make_node("Log", ["x"], ["y"], name="log")], [1, 1, 2, 2], [1, 1, 2, 2])
