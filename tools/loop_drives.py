# SPDX-License-Identifier: MIT
"""The drives on which loops are measured, and how each is made. Used by tools/loops, and in part by
tools/confidence."""
import array
import csv
import dataclasses
import math
import pathlib
import random
import shlex
import struct
import subprocess
import sys
from typing import Callable

POOL5 = ["--layer", "pool5", "--input-size", "224x224", "--mean", "104.05,112.51,116.67",
         "--scale", "0.0039216"]
GARDENS_DAY, GARDENS_NIGHT = "gardens_point/day_left", "gardens_point/night_right"
SUMMER, WINTER = "nordland_64x32/summer", "nordland_64x32/winter"
MODEL = "../models/squeezenet11_places365.onnx"
# The street: places and queries, and the pieces that the query is cut into.
STREET_FRAMES, STREET_PIECES, STREET_SEED = 24_000, 24, 1


def say(text: str) -> None:
    print(f"{pathlib.Path(sys.argv[0]).name}: {text}", file=sys.stderr, flush=True)


@dataclasses.dataclass(frozen=True)
class Tools:
    """The programs, and the folder with real drives."""
    seqloop: pathlib.Path
    street: pathlib.Path
    data: pathlib.Path

    def describe(self, drive: str, out: pathlib.Path, *flags: str) -> None:
        """`drive` is below the data folder, or a path of its own."""
        if not out.exists():
            call([self.seqloop, "describe", "--source", self.data / drive, "--out", out, *flags])


def call(command: list) -> str:
    """What a command prints; ends the program where it fails."""
    words = [str(word) for word in command]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        say(f"{shlex.join(words)}: exit code {done.returncode}\n{done.stderr.rstrip()}")
        sys.exit(1)
    return done.stdout


def write_whole(out: pathlib.Path, parts) -> None:
    """The file has its name only when it is whole."""
    part = out.with_name(out.name + ".part")
    with part.open("wb") as stream:
        for some in parts:
            stream.write(some)
    part.replace(out)


def npy_header(rows: int, columns: int) -> bytes:
    text = f"{{'descr': '<f4', 'fortran_order': False, 'shape': ({rows}, {columns}), }}"
    text += " " * (-(10 + len(text) + 1) % 64) + "\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text.encode("ascii")


def npy_shape(path: pathlib.Path) -> tuple[int, int, int]:
    """Rows, columns, and where the rows begin, of a file that seqloop or this script wrote."""
    with path.open("rb") as stream:
        start = stream.read(10)
        size = struct.unpack("<H", start[8:10])[0]
        text = stream.read(size).decode("ascii")
    rows, columns = text[text.index("(") + 1:text.index(")")].split(",")[:2]
    return int(rows), int(columns), 10 + size


def join(out: pathlib.Path, pieces: list[tuple[pathlib.Path, int, int]]) -> None:
    """@param pieces (file, first row, row after the last one), one after the other"""
    columns = npy_shape(pieces[0][0])[1]

    def parts():
        yield npy_header(sum(last - first for _, first, last in pieces), columns)
        for path, first, last in pieces:
            begin = npy_shape(path)[2]
            with path.open("rb") as stream:
                stream.seek(begin + first * columns * 4)
                yield stream.read((last - first) * columns * 4)

    write_whole(out, parts())


def write_truth(folder: pathlib.Path, rows) -> None:
    """The last file of a drive: where it is, the drive is whole."""
    lines = ["query,reference\n"] + [f"{query},{reference}\n" for query, reference in rows]
    write_whole(folder / "truth.csv", [line.encode("ascii") for line in lines])


def one_after_the_other(first: str, second: str, frames: int):
    """One drive that closes loops: the first frames of a real drive, then of its second pass."""
    def make(tools: Tools, folder: pathlib.Path) -> None:
        halves = []
        for drive in (first, second):
            halves.append((folder / f"{pathlib.Path(drive).name}.npy", 0, frames))
            tools.describe(drive, halves[-1][0])
        join(folder / "query.npy", halves)
        write_truth(folder, ((frames + i, i) for i in range(frames)))
    return make


def real(reference: str, query: str, *flags: str):
    def make(tools: Tools, folder: pathlib.Path) -> None:
        more = [*flags, *(["--model", str(tools.data / MODEL)] if flags else [])]
        tools.describe(reference, folder / "reference.npy", *more)
        tools.describe(query, folder / "query.npy", *more)
        frames = npy_shape(folder / "query.npy")[0]
        write_truth(folder, ((i, i) for i in range(frames)))
    return make


def walk_twice(_: Tools, folder: pathlib.Path) -> None:
    """600 places along a smooth random walk in 128 dimensions, passed twice, under fresh noise."""
    size, places, keeps, noise = 128, 600, 0.9, 0.5
    dice = random.Random(1)
    place = [dice.gauss(0.0, 1.0) for _ in range(size)]
    walk = []
    for _ in range(places):
        walk.append(place)
        fresh = math.sqrt(1.0 - keeps * keeps)
        place = [keeps * value + fresh * dice.gauss(0.0, 1.0) for value in place]

    def row(of: list[float]) -> bytes:
        values = [value + noise * dice.gauss(0.0, 1.0) for value in of]
        length = math.sqrt(sum(value * value for value in values))
        floats = array.array("f", (value / length for value in values))
        if sys.byteorder == "big":
            floats.byteswap()
        return floats.tobytes()

    write_whole(folder / "query.npy",
                [npy_header(2 * places, size), *(row(place) for place in walk + walk)])
    write_truth(folder, ((places + i, i) for i in range(places)))


def kidnapped_order(dice: random.Random, pieces: int) -> list[int]:
    """A shuffle in which no piece follows the one that it followed in the drive."""
    order = list(range(pieces))
    while any(after == before + 1 for before, after in zip(order, order[1:])):
        dice.shuffle(order)
    return order


def kidnapped_on_the_street(tools: Tools, folder: pathlib.Path) -> None:
    """The synthetic street in summer; in winter the camera is put elsewhere after each piece."""
    if not all((folder / name).exists() for name in ("reference.npy", "whole_query.npy")):
        call([tools.street, "--keep", "--quiet", "--drives", "localise", "--frames", STREET_FRAMES,
              "--size", "160x90", "--format", "avi", "--seed", STREET_SEED,
              "--out", folder / "drives"])
        tools.describe(str(folder / "drives/reference.avi"), folder / "reference.npy")
        tools.describe(str(folder / "drives/query.avi"), folder / "whole_query.npy")
    dice = random.Random(STREET_SEED)
    usual = STREET_FRAMES // STREET_PIECES
    cuts = [i * usual + dice.randint(-usual // 4, usual // 4) for i in range(1, STREET_PIECES)]
    cuts = [0, *cuts, STREET_FRAMES]
    order = kidnapped_order(dice, STREET_PIECES)
    whole = folder / "whole_query.npy"
    join(folder / "query.npy", [(whole, cuts[k], cuts[k + 1]) for k in order])
    with (folder / "drives/truth.csv").open(encoding="ascii") as stream:
        place = {int(row["query"]): int(row["reference"]) for row in csv.DictReader(stream)}
    frames = [frame for k in order for frame in range(cuts[k], cuts[k + 1])]
    write_truth(folder, ((i, place[frame]) for i, frame in enumerate(frames)))


@dataclasses.dataclass(frozen=True)
class Drive:
    name: str  # of its folder; begins with the letter that chooses it
    title: str
    closes_loops: bool
    tolerance: int  # frames
    lengths: tuple[int, ...]  # ds
    make: Callable[[Tools, pathlib.Path], None]
    needs: tuple[str, ...] = ()  # below the data folder

    @property
    def synthetic_street(self) -> bool:
        return self.make is kidnapped_on_the_street


GARDENS, NORDLAND = (GARDENS_DAY, GARDENS_NIGHT), (SUMMER, WINTER)
DRIVES = (
    Drive("a-gardens", "Gardens Point, day then night", True, 2, (40, 20),
          one_after_the_other(*GARDENS, 200), GARDENS),
    Drive("b-made", "synthetic walk, passed twice", True, 2, (20,), walk_twice),
    Drive("b-nordland", "Nordland, 1,200 of summer then of winter", True, 1, (20,),
          one_after_the_other(*NORDLAND, 1200), NORDLAND),
    Drive("c-street", f"synthetic street, {STREET_PIECES - 1} kidnappings", False, 10, (40, 80),
          kidnapped_on_the_street),
    Drive("d-nordland", "Nordland, summer → winter", False, 1, (20,), real(*NORDLAND), NORDLAND),
    Drive("d-pool5", "the same, pool5", False, 1, (80,), real(*NORDLAND, *POOL5),
          (*NORDLAND, MODEL)),
    Drive("d-gardens", "Gardens Point, day → night", False, 2, (40, 20), real(*GARDENS), GARDENS),
)
