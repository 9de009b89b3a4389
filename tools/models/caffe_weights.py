# SPDX-License-Identifier: MIT
"""Caffe's weights files (.caffemodel) without Caffe: what is in them, and new ones.

A file is one protocol buffer message, NetParameter of caffe.proto; the numbers below are its fields'. Weights stay on disk:
what has a length is a view into the mapped file, so 240 MB are listed in milliseconds. Python's standard library alone.
"""
import mmap
import os
from pathlib import Path
from typing import Iterator, NamedTuple

NET_OLD_LAYER, NET_LAYER = 2, 100  # old: V1LayerParameter, in files from before 2015
LAYER_NAME, LAYER_TYPE, LAYER_BLOBS = 1, 2, 7
OLD_LAYER_NAME, OLD_LAYER_BLOBS = 4, 6
BLOB_OLD_SHAPE, BLOB_DATA, BLOB_SHAPE = (1, 2, 3, 4), 5, 7  # old: num, channels, height, width
SHAPE_DIM = 1
VARINT, EIGHT_BYTES, BYTES, FOUR_BYTES = 0, 1, 2, 5  # wire types
FLOAT_BYTES = 4

Parts = list  # of buffers that follow one another: weights are never copied into one string


class Broken(Exception):
    """A file that is no weights file."""


class Blob(NamedTuple):
    """One array of a layer: its weights, or its bias."""
    shape: tuple[int, ...]
    values: int  # float32 that the file holds for it; with a sound file the shape's product


class StoredLayer(NamedTuple):
    name: str
    blobs: list[Blob]  # weights, bias; empty where the layer has none
    parts: Parts  # the layer as the file has it, to be copied


# ---- reading --------------------------------------------------------------------------------------------------------


def take_varint(data: memoryview, at: int) -> tuple[int, int]:
    """The number that begins there, and where it ends."""
    value = 0
    for shift in range(0, 70, 7):
        if at >= len(data):
            raise Broken("it is cut off, or no weights file")
        byte = data[at]
        at += 1
        value |= (byte & 0x7F) << shift
        if byte < 0x80:
            return value, at
    raise Broken("it is no weights file")


def fields(message: memoryview) -> Iterator[tuple[int, int | memoryview]]:
    """Number and value of every field of a message."""
    at = 0
    while at < len(message):
        key, at = take_varint(message, at)
        number, wire = key >> 3, key & 7
        if number == 0 or wire not in (VARINT, BYTES, EIGHT_BYTES, FOUR_BYTES):
            raise Broken("it is no weights file")
        if wire == VARINT:
            value, at = take_varint(message, at)
            yield number, value
            continue
        size = {EIGHT_BYTES: 8, FOUR_BYTES: 4}.get(wire)
        if size is None:
            size, at = take_varint(message, at)
        if size > len(message) - at:
            raise Broken("it is cut off, or no weights file")
        yield number, message[at:at + size]
        at += size


def views(message: memoryview, number: int) -> list[memoryview]:
    return [value for found, value in fields(message) if found == number and isinstance(value, memoryview)]


def read_shape(message: memoryview) -> tuple[int, ...]:
    dims: list[int] = []
    for number, value in fields(message):
        if number == SHAPE_DIM and isinstance(value, int):
            dims.append(value)
        elif number == SHAPE_DIM:
            at = 0
            while at < len(value):
                dim, at = take_varint(value, at)
                dims.append(dim)
    return tuple(dims)


def read_blob(message: memoryview) -> Blob:
    old = [0, 0, 0, 0]
    shape = None
    data_bytes = 0
    for number, value in fields(message):
        if number in BLOB_OLD_SHAPE and isinstance(value, int):
            old[number - 1] = value
        elif number == BLOB_DATA and isinstance(value, memoryview):
            data_bytes += len(value)
        elif number == BLOB_SHAPE and isinstance(value, memoryview):
            shape = read_shape(value)
    return Blob(tuple(old) if shape is None else shape, data_bytes // FLOAT_BYTES)


def read(path: Path) -> list[StoredLayer]:
    """All layers in the file's order. Raises Broken, OSError."""
    with path.open("rb") as file:
        if os.fstat(file.fileno()).st_size == 0:
            raise Broken("it is empty")
        net = memoryview(mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ))
    layers = []
    for number, message in fields(net):
        if number not in (NET_LAYER, NET_OLD_LAYER) or isinstance(message, int):
            continue
        old = number == NET_OLD_LAYER
        names = views(message, OLD_LAYER_NAME if old else LAYER_NAME)
        name = bytes(names[-1]).decode("ascii", "backslashreplace") if names else ""
        blobs = [read_blob(blob) for blob in views(message, OLD_LAYER_BLOBS if old else LAYER_BLOBS)]
        layers.append(StoredLayer(name, blobs, field(number, [message])))
    if not layers:
        raise Broken("it holds no layers")
    return layers


# ---- writing --------------------------------------------------------------------------------------------------------


def varint(value: int) -> bytes:
    out = bytearray()
    while value > 0x7F:
        out.append(value & 0x7F | 0x80)
        value >>= 7
    out.append(value)
    return bytes(out)


def field(number: int, parts: Parts) -> Parts:
    """A field with a length: bytes, text or a message."""
    return [varint(number << 3 | BYTES) + varint(sum(memoryview(part).nbytes for part in parts)), *parts]


def blob(shape: tuple[int, ...], data: object) -> Parts:
    """@param data a buffer of float32, little-endian, the shape's product of them"""
    return field(LAYER_BLOBS, field(BLOB_SHAPE, field(SHAPE_DIM, [b"".join(map(varint, shape))])) + field(BLOB_DATA, [data]))


def layer(name: str, kind: str, blobs: Parts) -> Parts:
    return field(NET_LAYER, field(LAYER_NAME, [name.encode()]) + field(LAYER_TYPE, [kind.encode()]) + blobs)
