#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What a step from Python costs beyond the program's: the same descriptors, map and settings, in turn.

Usage: step_cost.py [PROGRAM [FRAMES]]      with PYTHONPATH=build/release/tools/python
PROGRAM is `seqloop`, from PATH unless named, FRAMES the length of a drive (2000). The program's time is that of its
own clock around the step (`latency_ms.match`), Python's is around `Detector.step`, with all that the binding does.
Prints microseconds, and how many answers both accept: the same.
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy

import seqloop

SHAPES = ((735, 200), (735, 3_476), (9_216, 1_000), (43_264, 200))  # values, places
TURNS = 3


def unit(rows: numpy.ndarray) -> numpy.ndarray:
    return (rows / numpy.linalg.norm(rows, axis=1, keepdims=True)).astype(numpy.float32)


def by_program(program: str, folder: pathlib.Path) -> tuple[list[float], int]:
    """Microseconds of each step, and how many answers are accepted."""
    lines = folder / "lines.jsonl"
    subprocess.run([program, "run", "--source", folder / "query.npy", "--reference", folder / "map.npy", "--out", lines],
                   check=True, capture_output=True)
    said = [json.loads(line) for line in lines.read_text().splitlines()]
    return ([1e3 * line["latency_ms"]["match"] for line in said if line["newest"] is not None],
            sum(answer["status"] == "match" for line in said for answer in line["answers"]))


def by_python(places: numpy.ndarray, drive: numpy.ndarray) -> tuple[list[float], int]:
    map = seqloop.PlaceMap(len(places), places.shape[1])
    map.add_drive(places)
    detector = seqloop.Detector(map)
    took, answers = [], []
    for row in drive:
        start = time.perf_counter_ns()
        report = detector.step(row)
        took.append((time.perf_counter_ns() - start) / 1e3)
        answers += report.answers
    answers += detector.finish()
    return took, sum(answer.gate == "match" for answer in answers)


def main() -> None:
    if any(word.startswith("-") for word in sys.argv[1:]):
        sys.exit(__doc__)
    program = sys.argv[1] if len(sys.argv) > 1 else "seqloop"
    frames = int(sys.argv[2]) if len(sys.argv) > 2 else 2_000
    random = numpy.random.default_rng(1)
    print("values places   program: p50    p99   Python: p50    p99   more: p50   accepted by each")
    for values, count in SHAPES:
        places = unit(random.standard_normal((count, values)))
        noise = random.standard_normal((frames, values)) / values ** .5
        drive = unit(places[numpy.arange(frames) % count] + noise)
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            numpy.save(folder / "map.npy", places)
            numpy.save(folder / "query.npy", drive)
            took: list[list[float]] = [[], []]
            for _ in range(TURNS):
                here, accepted = by_program(program, folder)
                there, same = by_python(places, drive)
                took[0] += here
                took[1] += there
        (a50, a99), (b50, b99) = (numpy.percentile(side, (50, 99)) for side in took)
        print(f"{values:6} {count:6} {a50:14.1f} {a99:6.0f} {b50:13.1f} {b99:6.0f} {b50 - a50:11.1f} {accepted:10} {same}")


if __name__ == "__main__":
    main()
