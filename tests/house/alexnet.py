#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks tools/models/alexnet.py: what the program computes from its files against the net written in numpy, and its check.

Usage: alexnet.py ROOT SEQLOOP    the source folder and the program; needs numpy
"""
import pathlib
import random
import subprocess
import sys
import tempfile
import unittest

import numpy

ROOT, SEQLOOP = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
sys.path.insert(0, str(ROOT / "tools/models"))
import alexnet  # noqa: E402
import caffe_weights  # noqa: E402
from caffe_weights import field, varint  # noqa: E402

MEAN = (105.0, 114.0, 116.0)  # B, G, R


# ---- the net, by the shortest way -----------------------------------------------------------------------------------


def windows(x, size, step):
    """[C, H, W] → [C, rows, columns, size, size]"""
    return numpy.lib.stride_tricks.sliding_window_view(x, (size, size), (1, 2))[:, ::step, ::step]


def convolve(x, weights, bias, step, padding, groups):
    x = numpy.pad(x, ((0, 0), (padding, padding), (padding, padding)))
    parts = [numpy.einsum("cyxij,ocij->oyx", windows(part, weights.shape[2], step), kernels, optimize=True)
             for part, kernels in zip(numpy.split(x, groups), numpy.split(weights, groups))]
    return numpy.concatenate(parts) + bias[:, None, None]


def normalise(x):
    """Over five neighbouring channels, alpha 1e-4, beta 0.75."""
    squares = numpy.pad(x * x, ((2, 2), (0, 0), (0, 0)))
    energy = sum(squares[i:i + len(x)] for i in range(5))
    return x / (1 + 1e-4 / 5 * energy) ** 0.75


def layers_of(x, arrays, order):
    """Every layer up to pool5, by name. @param arrays weights and bias by convolution"""
    out = {}
    step = {"conv": lambda x, n: convolve(x, *arrays[n], *{"conv1": (4, 0, 1), "conv2": (1, 2, 2), "conv3": (1, 1, 1),
                                                          "conv4": (1, 1, 2), "conv5": (1, 1, 2)}[n]),
            "relu": lambda x, n: numpy.maximum(x, 0),
            "pool": lambda x, n: windows(x, 3, 2).max((3, 4)),
            "norm": lambda x, n: normalise(x)}
    second = ["pool", "norm"] if order == "caffenet" else ["norm", "pool"]
    names = [f"{kind}{i}" for i in (1, 2) for kind in ["conv", "relu", *second]]
    for name in [*names, "conv3", "relu3", "conv4", "relu4", "conv5", "relu5", "pool5"]:
        x = out[name] = step[name[:4]](x, name)
    return out


def picture(seed):
    """[227, 227, 3] R, G, B: noise that is smooth enough to have features"""
    noise = numpy.random.default_rng(seed).random((29, 29, 3))
    return (numpy.kron(noise, numpy.ones((8, 8, 1)))[:227, :227] * 255).astype(numpy.uint8)


# ---- weights files --------------------------------------------------------------------------------------------------


def arrays_in(parts, layers):
    """The arrays of made-up weights, by layer."""
    data = iter([part for part in parts if isinstance(part, numpy.ndarray)])
    return {layer.name: [next(data).reshape(shape) for shape in layer.shapes] for layer in layers if layer.shapes}


def number(place, value):
    return [varint(place << 3) + varint(value)]


def old_form(arrays):
    """As Caffe wrote weights before 2015: V1LayerParameter, four numbers a shape."""
    parts = []
    for name, blobs in arrays.items():
        message = field(4, [name.encode()]) + number(5, 4)  # CONVOLUTION
        for blob in blobs:
            shape = (1,) * (4 - blob.ndim) + blob.shape
            dims = [part for place, n in enumerate(shape, 1) for part in number(place, n)]
            message += field(6, dims + field(5, [blob.tobytes()]))
        parts += field(2, message)
    return parts


def layer(name, *shapes, values=None):
    """A layer of zeros. @param values float32 a blob, where they are not the shape's product"""
    blobs = []
    for shape in shapes:
        blobs += caffe_weights.blob(shape, bytes(4 * (numpy.prod(shape, dtype=int) if values is None else values)))
    return caffe_weights.layer(name, "Convolution", blobs)


class Case(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def write(self, name, parts):
        (self.folder / name).write_bytes(b"".join(bytes(part) for part in parts))

    def script(self, *arguments, code=0):
        """What it prints, both streams."""
        done = subprocess.run([sys.executable, ROOT / "tools/models/alexnet.py", *map(str, arguments)], text=True,
                              cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        self.assertEqual(done.returncode, code, done.stdout)
        self.assertNotIn("Traceback", done.stdout)
        return done.stdout


class Numbers(Case):
    def describe(self, model, prototxt, name):
        subprocess.run([SEQLOOP, "describe", "--source", "drive", "--out", "out.npy", "--model", model,
                        "--config-model", prototxt, "--layer", name, "--mean", ",".join(map(str, MEAN))],
                       cwd=self.folder, check=True, stderr=subprocess.DEVNULL)
        return numpy.load(self.folder / "out.npy")

    def make_drive(self):
        (self.folder / "drive").mkdir()
        for seed in (1, 2):
            (self.folder / f"drive/{seed}.ppm").write_bytes(b"P6 227 227 255\n" + picture(seed).tobytes())

    def expect(self, got, wanted):
        for row, features in zip(got, wanted, strict=True):
            unit = features.ravel() / numpy.linalg.norm(features)
            self.assertLess(numpy.abs(row - unit).max(), 2e-6)

    def test_every_layer_is_the_net_written_in_numpy(self):
        self.make_drive()
        pictures = [picture(seed)[:, :, ::-1].transpose(2, 0, 1) - numpy.array(MEAN)[:, None, None] for seed in (1, 2)]
        for order in alexnet.ORDERS:
            layers = alexnet.network(order, 205, "pool5")
            self.script("--prototxt", "n.prototxt", "--made-up-weights", "n.caffemodel", "--last", "pool5", "--order", order)
            arrays = arrays_in(alexnet.made_up(layers, 1), layers)
            wanted = [layers_of(x, arrays, order) for x in pictures]
            for name in ("conv1", "pool1", "norm1", "conv2", "pool2", "conv3", "relu3", "pool5"):
                with self.subTest(order=order, layer=name):
                    self.expect(self.describe("n.caffemodel", "n.prototxt", name), [w[name] for w in wanted])
            self.assertLess(wanted[0]["conv3"].min(), 0)

    def test_cut_and_old_files_give_the_same(self):
        self.make_drive()
        self.script("--prototxt", "n.prototxt", "--made-up-weights", "n.caffemodel", "--last", "pool5")
        wanted = self.describe("n.caffemodel", "n.prototxt", "relu3")
        self.script("--check", "n.caffemodel", "--last", "relu3", "--prototxt", "c.prototxt", "--cut", "c.caffemodel")
        numpy.testing.assert_array_equal(self.describe("c.caffemodel", "c.prototxt", "relu3"), wanted)
        layers = alexnet.network("caffenet", 205, "pool5")
        self.write("old.caffemodel", old_form(arrays_in(alexnet.made_up(layers, 1), layers)))
        self.assertIn("fits", self.script("--check", "old.caffemodel", "--last", "pool5"))
        numpy.testing.assert_array_equal(self.describe("old.caffemodel", "n.prototxt", "relu3"), wanted)


class Check(Case):
    CONV1 = ((96, 3, 11, 11), (96,))

    def says(self, parts, *wanted, last="relu1", code=1, options=()):
        self.write("a.caffemodel", parts)
        words = self.script("--check", "a.caffemodel", "--last", last, *options, code=code)
        for part in wanted:
            self.assertIn(part, words)

    def test_fits(self):
        self.says(layer("conv1", *self.CONV1), "conv1: fits, 96x3x11x11", "a.caffemodel: fits", code=0)
        # Of two layers with one name the first with weights counts.
        twice = layer("conv1") + layer("conv1", *self.CONV1) + layer("conv1", (1,), (1,))
        self.says(twice, "a.caffemodel: fits", code=0)

    # Bad input: every fault of every layer at once.
    def test_every_fault_is_named(self):
        parts = (layer("conv1", (96, 3, 7, 7), (95,)) + layer("conv2", (256, 48, 5, 5)) + layer("conv3", values=0) +
                 layer("fc8", (1000, 4096), (1000,)) + layer("conv4", (384, 192, 3, 3), (384,), values=5))
        self.says(parts, "conv1: weights are 96x3x7x7 instead of 96x3x11x11; bias are 95 instead of 96",
                  "conv2: it has 1 arrays in the file instead of weights and bias", "conv3: it has no weights in the file",
                  "conv4: weights are 5 values instead of 663552", "fc6: it has no weights in the file",
                  "fc8: weights are 1000x4096 instead of 205x4096", "give --classes 1000",
                  "does not fit; it has weights for: conv1, ", last="prob")

    # Bad input: the other of the two published nets, which no shape tells apart.
    def test_order_of_pooling_and_normalisation(self):
        parts = layer("conv1", *self.CONV1) + layer("norm1") + layer("pool1")
        self.says(parts, "norm1, pool1: they come in the other order; give --order alexnet")
        self.says(parts, "a.caffemodel: fits", options=("--order", "alexnet"), code=0)

    # Bad input: a file that was cut off, anywhere.
    def test_truncated(self):
        whole = b"".join(map(bytes, layer("conv1", *self.CONV1)))
        for length in (1, 3, 20, len(whole) // 2, len(whole) - 1):
            self.says([whole[:length]], "a.caffemodel: it is cut off", code=2)

    # Bad input: no weights file at all; nothing is written then.
    def test_no_weights_file(self):
        for content in (b"", b"hello, world\n", b"\x00" * 9, b"\xff" * 99, bytes(field(1, [b"name"])[0]) + b"name"):
            self.says([content], "a.caffemodel: it ", code=2, options=("--prototxt", "n.prototxt", "--cut", "c.caffemodel"))
        self.assertIn("No such file", self.script("--check", "none.caffemodel", code=2))
        self.assertIn("directory", self.script("--check", ".", code=2))
        self.assertEqual([path.name for path in self.folder.iterdir()], ["a.caffemodel"])

    # Bad input: bytes changed, taken out, put in.
    def test_damaged(self):
        parts = layer("conv1", (2, 3), (2,)) + layer("pool1") + old_form({"conv2": [numpy.ones((4, 4, 1))]})
        whole = b"".join(map(bytes, parts))
        chance = random.Random(7)
        for _ in range(3000):
            damaged = bytearray(whole)
            for _ in range(chance.randint(1, 5)):
                place = chance.randrange(len(damaged))
                damaged[place:place + chance.randint(0, 2)] = chance.randbytes(chance.randint(0, 2))
            self.write("a.caffemodel", [damaged])
            try:
                stored = caffe_weights.read(self.folder / "a.caffemodel")
                for found in stored:
                    alexnet.faults_of(alexnet.network("caffenet", 205, "conv1")[0], found.blobs)
            except caffe_weights.Broken:
                pass

    # Bad input: options.
    def test_bad_usage(self):
        for options in ((), ("--cut", "c"), ("--check", "a", "--last", "conv9"), ("--prototxt", "a", "--classes", "0"),
                        ("--prototxt", "nowhere/a")):
            self.assertIn("alexnet.py: ", self.script(*options, code=2))
        self.assertEqual(list(self.folder.iterdir()), [])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
