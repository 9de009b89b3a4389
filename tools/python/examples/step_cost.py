#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What a step from Python costs beyond the step itself.

Usage: step_cost.py      with PYTHONPATH=build/release/tools/python
A detector that searches one place by single frames has next to nothing to do: what its step takes is what
the way there and back costs, and the check of the descriptor's length. Prints microseconds, p50 and p99.
"""
import time

import numpy

import seqloop


def cost(detector: seqloop.Detector, frames: numpy.ndarray, rounds: int) -> str:
    took = []
    for index in range(rounds):
        row = frames[index % len(frames)]
        start = time.perf_counter_ns()
        detector.step(row)
        took.append(time.perf_counter_ns() - start)
    p50, p99 = numpy.percentile(took[rounds // 10:], (50, 99)) / 1e3
    return f"{p50:8.2f} {p99:8.2f}"


def unit(rows: int, size: int) -> numpy.ndarray:
    values = numpy.random.default_rng(1).standard_normal((rows, size))
    return (values / numpy.linalg.norm(values, axis=1, keepdims=True)).astype(numpy.float32)


def main() -> None:
    print("values  places       p50      p99")
    for size in (16, 735, 43_264):
        drive = unit(100, size)
        alone = seqloop.PlaceMap(1, size, method="single", standardise=False)
        alone.add_drive(drive[:1])
        print(f"{size:6}  {1:6} ", cost(seqloop.Detector(alone), drive, 3_000))
    drive = unit(3_476, 735)
    places = seqloop.PlaceMap(3_476, 735)
    places.add_drive(drive)
    print(f"{735:6}  {3_476:6} ", cost(seqloop.Detector(places), drive, 3_000), "  (a usual detector, whole)")


if __name__ == "__main__":
    main()
