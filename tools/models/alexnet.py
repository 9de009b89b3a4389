#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Places-CNN / AlexNet for OpenCV's Caffe importer: write its network file, check a weights file, make weights up for tests.

The net is Caffe's reference net, of which Places-CNN is a training; its layers have the names of the published deploy files, so
that weights trained for it find their places. How many values a layer gives (Table 1 of the paper):

  conv1 96x55x55 = 290,400   conv2 256x27x27 = 186,624   conv3 384x13x13 = 64,896   fc6 4,096
  pool1 96x27x27 =  69,984   pool2 256x13x13 =  43,264   conv4 384x13x13 = 64,896   fc7 4,096
                                                         conv5 256x13x13 = 43,264   fc8 205 (its classes)
                                                         pool5 256x6x6   =  9,216

relu1 … relu7 work in place: what Caffe's blob `conv3` holds at the end is what the layer relu3 gives.

  alexnet.py --check original.caffemodel --last relu3 --prototxt net.prototxt --cut net.caffemodel

writes the two files that describing by relu3 needs, without the 226 MB of weights after it. Pooling comes before
normalisation, as in bvlc_reference_caffenet and Places-CNN; `--order alexnet` has it after, as in bvlc_alexnet. Exit
status: 0 done, and the weights fit; 1 they do not fit; 2 bad usage, or a file cannot be read or written. Needs numpy to make
weights up, for nothing else.
"""
import argparse
import math
import sys
from pathlib import Path
from typing import NamedTuple

import caffe_weights
from caffe_weights import Blob, Broken, Parts, StoredLayer

INPUT = (3, 227, 227)  # B, G, R planes; pixels down, pixels across
CONVOLUTIONS = {  # outputs, kernel, stride, padding, groups
    "conv1": (96, 11, 4, 0, 1),
    "conv2": (256, 5, 1, 2, 2),
    "conv3": (384, 3, 1, 1, 1),
    "conv4": (384, 3, 1, 1, 2),
    "conv5": (256, 3, 1, 1, 2),
}
# After relu1 and relu2. The two published nets differ in nothing else.
ORDERS = {"caffenet": ("pool", "norm"), "alexnet": ("norm", "pool")}
POOL5_VALUES, FC_VALUES = 256 * 6 * 6, 4096
OTHERS = {  # type and settings of layers without weights
    "relu": ("ReLU", ""),
    "pool": ("Pooling", "pooling_param { pool: MAX kernel_size: 3 stride: 2 }"),
    "norm": ("LRN", "lrn_param { local_size: 5 alpha: 0.0001 beta: 0.75 }"),
    "drop": ("Dropout", "dropout_param { dropout_ratio: 0.5 }"),
    "prob": ("Softmax", ""),
}
IN_PLACE = ("ReLU", "Dropout")


class Layer(NamedTuple):
    name: str
    type: str
    settings: str
    shapes: tuple[tuple[int, ...], ...] = ()  # of the weights [outputs, inputs of a group, ...] and the bias [outputs]


def other(name: str) -> Layer:
    return Layer(name, *OTHERS[name[:4]])


def convolution(name: str, channels: int) -> Layer:
    outputs, kernel, stride, padding, groups = CONVOLUTIONS[name]
    settings = (f"convolution_param {{ num_output: {outputs} kernel_size: {kernel} stride: {stride} "
                f"pad: {padding} group: {groups} }}")
    return Layer(name, "Convolution", settings, ((outputs, channels // groups, kernel, kernel), (outputs,)))


def connected(name: str, inputs: int, outputs: int) -> Layer:
    settings = f"inner_product_param {{ num_output: {outputs} }}"
    return Layer(name, "InnerProduct", settings, ((outputs, inputs), (outputs,)))


def network(order: str, classes: int, last: str) -> list[Layer]:
    """The layers in the order in which they run, up to the last one asked for."""
    layers: list[Layer] = []
    channels = INPUT[0]
    for number, name in enumerate(CONVOLUTIONS, 1):
        layers += [convolution(name, channels), other(f"relu{number}")]
        if number <= 2:
            layers += [other(f"{kind}{number}") for kind in ORDERS[order]]
        channels = CONVOLUTIONS[name][0]
    layers += [other("pool5"),
               connected("fc6", POOL5_VALUES, FC_VALUES), other("relu6"), other("drop6"),
               connected("fc7", FC_VALUES, FC_VALUES), other("relu7"), other("drop7"),
               connected("fc8", FC_VALUES, classes), other("prob")]
    return layers[:[layer.name for layer in layers].index(last) + 1]


def prototxt(layers: list[Layer], order: str) -> str:
    lines = [f'name: "{order}"', 'input: "data"', "input_shape { dim: 1 dim: %d dim: %d dim: %d }" % INPUT]
    bottom = "data"
    for layer in layers:
        top = bottom if layer.type in IN_PLACE else layer.name
        ends = f'bottom: "{bottom}" top: "{top}"'
        lines.append(f'layer {{ name: "{layer.name}" type: "{layer.type}" {ends} {layer.settings} }}')
        bottom = top
    return "\n".join(lines) + "\n"


# ---- weights --------------------------------------------------------------------------------------------------------


def essential(shape: tuple[int, ...]) -> tuple[int, ...]:
    """Old files write four numbers for every shape, 1 for those that it does not have."""
    return shape[next((i for i, n in enumerate(shape) if n != 1), len(shape)):]


def faults_of(layer: Layer, blobs: list[Blob]) -> list[str]:
    if not blobs:
        return ["it has no weights in the file"]
    if len(blobs) != len(layer.shapes):
        return [f"it has {len(blobs)} arrays in the file instead of weights and bias"]
    faults = []
    for role, wanted, found in zip(("weights", "bias"), layer.shapes, blobs):
        if essential(found.shape) != essential(wanted):
            faults.append(f"{role} are {by(found.shape)} instead of {by(wanted)}")
        elif found.values != math.prod(wanted):
            faults.append(f"{role} are {found.values} values instead of {math.prod(wanted)}")
    if layer.name == "fc8" and faults and blobs[1].shape:
        faults.append(f"give --classes {blobs[1].shape[-1]} if that is the net's number of classes")
    return faults


def by(shape: tuple[int, ...]) -> str:
    return "x".join(map(str, shape)) or "nothing"


def other_order(stored: list[StoredLayer], order: str) -> str | None:
    """The order of pooling and normalisation in the file, if it tells and is not the one asked for: no shape would show it."""
    found = tuple(layer.name[:4] for layer in stored if layer.name in ("pool1", "norm1"))
    return next((name for name, kinds in ORDERS.items() if kinds == found and name != order), None)


def check(path: Path, stored: list[StoredLayer], layers: list[Layer], order: str) -> bool:
    """Prints a line for each layer that wants weights, and every fault. @return whether all fit"""
    weights: dict[str, list[Blob]] = {}
    for found in stored:
        if found.blobs:
            weights.setdefault(found.name, found.blobs)  # of two with one name OpenCV takes the first
    fits = True
    for layer in (layer for layer in layers if layer.shapes):
        faults = faults_of(layer, weights.get(layer.name, []))
        fits = fits and not faults
        print(f"{layer.name}: {'; '.join(faults) or 'fits, ' + by(layer.shapes[0])}")
    if found_order := other_order(stored, order):
        fits = False
        print(f"norm1, pool1: they come in the other order; give --order {found_order}")
    print(f"{path}: fits" if fits else f"{path}: does not fit; it has weights for: {', '.join(weights) or 'no layer'}")
    return fits


def cut(stored: list[StoredLayer], layers: list[Layer]) -> Parts:
    """A weights file with these layers and no others."""
    names = {layer.name for layer in layers}
    return [part for layer in stored if layer.name in names for part in layer.parts]


def made_up(layers: list[Layer], seed: int) -> Parts:
    """A weights file of random numbers, spread so that values neither fade nor explode from layer to layer."""
    import numpy

    random = numpy.random.default_rng(seed)
    parts: Parts = []
    for layer in layers:
        blobs: Parts = []
        for shape in layer.shapes:
            spread = math.sqrt(6 / math.prod(layer.shapes[0][1:]))
            data = random.random(math.prod(shape), dtype=numpy.float32)
            data -= numpy.float32(0.5)
            data *= numpy.float32(2 * spread)
            blobs += caffe_weights.blob(shape, data.astype("<f4", copy=False))
        parts += caffe_weights.layer(layer.name, layer.type, blobs)
    return parts


# ---- the command ----------------------------------------------------------------------------------------------------


def write(path: Path, parts: Parts) -> None:
    """The file has its name only once it is whole."""
    unfinished = path.with_name(path.name + ".part")
    try:
        with unfinished.open("wb") as file:
            for part in parts:
                file.write(part)
        unfinished.replace(path)
    except BaseException:
        unfinished.unlink(missing_ok=True)
        raise
    print(f"{path}: written, {path.stat().st_size} bytes")


def arguments() -> argparse.Namespace:
    names = [layer.name for layer in network("caffenet", 1, "prob")]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--prototxt", type=Path, metavar="FILE", help="write the network file")
    parser.add_argument("--check", type=Path, metavar="FILE", help="does this .caffemodel fit?")
    parser.add_argument("--cut", type=Path, metavar="FILE", help="write what is needed of the checked .caffemodel, if it fits")
    parser.add_argument("--made-up-weights", type=Path, metavar="FILE", help="write a .caffemodel of random weights")
    parser.add_argument("--last", choices=names, default="prob", metavar="LAYER",
                        help="leave out the layers after this one: " + ", ".join(names))
    parser.add_argument("--order", choices=ORDERS, default="caffenet",
                        help="pool1 before norm1 (caffenet, default) or after it (alexnet)")
    parser.add_argument("--classes", type=int, default=205, metavar="N", help="outputs of fc8 (default: 205, Places-CNN)")
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="of the made-up weights (default: 1)")
    given = parser.parse_args()
    if not (given.prototxt or given.check or given.made_up_weights):
        parser.error("nothing to do: give --prototxt, --check or --made-up-weights")
    if given.cut and not given.check:
        parser.error("--cut needs --check, the file to cut from")
    if given.classes < 1 or given.seed < 0:
        parser.error("--classes must be at least 1, --seed at least 0")
    return given


def main() -> int:
    given = arguments()
    layers = network(given.order, given.classes, given.last)
    if given.check:  # first: where it does not fit, nothing is written
        try:
            stored = caffe_weights.read(given.check)
        except Broken as fault:
            print(f"alexnet.py: {given.check}: {fault}", file=sys.stderr)
            return 2
        if not check(given.check, stored, layers, given.order):
            return 1
        if given.cut:
            write(given.cut, cut(stored, layers))
    if given.prototxt:
        write(given.prototxt, [prototxt(layers, given.order).encode()])
    if given.made_up_weights:
        write(given.made_up_weights, made_up(layers, given.seed))
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (OSError, ImportError) as error:
        print(f"alexnet.py: {error}", file=sys.stderr)
        sys.exit(2)
