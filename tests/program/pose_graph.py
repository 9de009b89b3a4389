#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What an optimiser makes of the pose graphs that `run` writes: drifted drives with a known truth.

Two laps of a synthetic street, the second in another light, laid onto a ring. Odometry is the true motion
with a drift; `seqloop run --pose-graph` finds the loops, and graph-slam (Debian: mrpt-apps) optimises. The
error at the end of the drive must fall to a tenth or less, and no loop may be false. For comparison, false
loops are put into the optimiser's input: ours has none.

Usage: pose_graph.py SEQLOOP STREET [SEED...]    exit code 77 where mrpt-apps is not installed
"""
import csv
import json
import math
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import numpy as np

FRAMES = 500      # of a lap, a metre each
DRIFTS = 2        # of each street
RATE = 10.0       # frames a second of a folder
NEAR = 10.0       # metres along the ring within which a loop is right
# From its own first lambda graph-slam gives up on some graphs before it is there.
PATIENT = ("--initial-lambda", 1e-3, "--max-iters", 500)
FALSE_SHARES = (0.02, 0.1)  # of loops put in that are false


def call(*command: object) -> str:
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"failed: {[str(word) for word in command]}\n{done.stdout}{done.stderr}")
    return done.stdout


# Poses are 4x4 matrices, x ahead, y left, z up.
def rotation(yaw: float, pitch: float, roll: float) -> np.ndarray:
    """@param pitch up, roll clockwise"""
    cy, sy, cp, sp, cr, sr = (f(a) for a in (yaw, -pitch, roll) for f in (math.cos, math.sin))
    z = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    y = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    x = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    return z @ y @ x


def pose(turn: np.ndarray, position: np.ndarray) -> np.ndarray:
    made = np.eye(4)
    made[:3, :3], made[:3, 3] = turn, position
    return made


def quaternion(turn: np.ndarray) -> list[float]:
    """x, y, z, w by the largest of the four, which is stable"""
    m = turn
    squares = [1 + m[0, 0] - m[1, 1] - m[2, 2], 1 - m[0, 0] + m[1, 1] - m[2, 2],
               1 - m[0, 0] - m[1, 1] + m[2, 2], 1 + m[0, 0] + m[1, 1] + m[2, 2]]
    largest = int(np.argmax(squares))
    half = 2 * math.sqrt(squares[largest])
    a, b, c = (m[2, 1] - m[1, 2]) / half, (m[0, 2] - m[2, 0]) / half, (m[1, 0] - m[0, 1]) / half
    if largest == 3:
        return [a, b, c, half / 4]
    d, e, f = (m[0, 1] + m[1, 0]) / half, (m[0, 2] + m[2, 0]) / half, (m[1, 2] + m[2, 1]) / half
    return [[half / 4, d, e, a], [d, half / 4, f, b], [e, f, half / 4, c]][largest]


def on_ring(laps: list[list[dict]]) -> tuple[list[np.ndarray], np.ndarray, float]:
    """@return true poses, metres along the ring, and the ring's length"""
    start = laps[0][0]["street_m"]
    length = laps[0][-1]["street_m"] - start + 1.0
    radius = length / (2 * math.pi)
    poses, along = [], []
    for row in (row for lap in laps for row in lap):
        at = row["street_m"] - start
        angle = at / radius
        position = (radius - row["left_m"]) * np.array([math.cos(angle), math.sin(angle), 0.0])
        position[2] = row["height_m"]
        poses.append(pose(rotation(angle + math.pi / 2 + row["yaw_rad"], row["pitch_rad"], row["roll_rad"]), position))
        along.append(at % length)
    return poses, np.array(along), length


def drifted(poses: list[np.ndarray], seed: int) -> list[np.ndarray]:
    """A scale that is off by a hundredth or so, and turns that are, all along and at random."""
    random = np.random.default_rng(seed)
    scale = 1 + random.normal(0, 0.01)
    bias = math.radians(random.choice([-1, 1]) * random.uniform(0.02, 0.06))  # a metre
    found = [poses[0]]
    for before, after in zip(poses, poses[1:]):
        motion = np.linalg.inv(before) @ after
        way = np.linalg.norm(motion[:3, 3])
        motion[:3, 3] *= scale * (1 + random.normal(0, 0.01))
        noise = [math.radians(random.normal(0, 0.2 * math.sqrt(way))) for _ in range(3)]
        motion[:3, :3] = motion[:3, :3] @ rotation(bias * way + noise[0], noise[1] / 10, noise[2] / 10)
        found.append(found[-1] @ motion)
    return found


def write_tum(file: pathlib.Path, poses: list[np.ndarray]) -> None:
    lines = ["# time x y z qx qy qz qw"]
    for i, at in enumerate(poses):
        numbers = [i / RATE, *at[:3, 3], *quaternion(at[:3, :3])]
        lines.append(" ".join(f"{number:.9f}" for number in numbers))
    file.write_text("\n".join(lines) + "\n")


def edges(graph: str) -> list[tuple[int, int]]:
    found = [line.split()[1:3] for line in graph.splitlines() if line.startswith("EDGE_SE3:QUAT")]
    return [(int(a), int(b)) for a, b in found]


def optimised(graph: str, first: np.ndarray, work: pathlib.Path, *more: object) -> np.ndarray:
    """@param first the first vertex' pose   @param more of the optimiser's flags   @return positions"""
    (work / "in.g2o").write_text(graph)
    call("graph-slam", "--3d", "--levmarq", *more, "-i", work / "in.g2o", "-o", work / "out.graph")
    rows = [line.split() for line in (work / "out.graph").read_text().splitlines() if line.startswith("VERTEX")]
    found = np.array([[float(value) for value in row[2:5]] for row in sorted(rows, key=lambda row: int(row[1]))])
    # It puts the first vertex at the origin, ahead along x; where that was is known.
    return found @ first[:3, :3].T + first[:3, 3]


def errors(found: np.ndarray, truth: np.ndarray) -> tuple[float, float]:
    """@return at the end, and the root of the mean square over the drive, metres"""
    off = np.linalg.norm(found - truth, axis=1)
    return float(off[-1]), float(np.sqrt(np.mean(off ** 2)))


def with_false(graph: str, along: np.ndarray, length: float, share: float, seed: int) -> str:
    """Replaces a share of the loops by some that lead elsewhere, with the same information."""
    random = np.random.default_rng(seed)
    lines = graph.splitlines()
    loops = [i for i, line in enumerate(lines)
             if line.startswith("EDGE_SE3:QUAT") and int(line.split()[2]) - int(line.split()[1]) > 1]
    for i in random.choice(loops, max(1, round(share * len(loops))), replace=False):
        words = lines[i].split()
        while True:
            place = int(random.integers(0, FRAMES))
            off = abs(along[place] - along[int(words[2])])
            if min(off, length - off) > 5 * NEAR:
                break
        lines[i] = " ".join([words[0], str(place), *words[2:]])
    return "\n".join(lines) + "\n"


def try_street(seqloop: str, street: str, seed: int, work: pathlib.Path) -> bool:
    drives = work / f"street{seed}"
    call(street, "--out", drives, "--frames", FRAMES, "--seed", seed, "--second-light", "evening", "--quiet")
    source = work / f"laps{seed}"
    source.mkdir()
    laps, count = [], 0
    for lap in ("reference", "query"):
        with open(drives / f"{lap}.csv", newline="") as file:
            rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
        # Beyond the first lap's end there is nothing to come back to.
        rows = [row for row in rows if not laps or laps[0][0]["street_m"] <= row["street_m"] <= laps[0][-1]["street_m"]]
        for row in rows:
            os.symlink(drives / lap / f"{int(row['frame']):06}.jpg", source / f"{count:06}.jpg")
            count += 1
        laps.append(rows)
    poses, along, length = on_ring(laps)
    truth = np.array([at[:3, 3] for at in poses])
    call(seqloop, "describe", "--source", source, "--out", work / "laps.npy")
    good = True
    for drift in range(1, DRIFTS + 1):
        odometry = drifted(poses, 100 * seed + drift)
        write_tum(work / "odometry.tum", odometry)
        call(seqloop, "run", "--source", work / "laps.npy", "--odometry", work / "odometry.tum", "--out", work / "a.jsonl",
             "--pose-graph", work / "graph.g2o", "--trajectory", work / "trajectory.tum")
        graph = (work / "graph.g2o").read_text()
        loops = [(a, b) for a, b in edges(graph) if b - a > 1]
        accepted = sum(answer["status"] == "match" for line in (work / "a.jsonl").read_text().splitlines()
                       for answer in json.loads(line)["answers"])
        offs = [abs(along[a] - along[b]) for a, b in loops]
        false = sum(min(off, length - off) > NEAR for off in offs)
        written = np.loadtxt(work / "trajectory.tum")
        same = np.allclose(written[:, 1:4], [at[:3, 3] for at in odometry], atol=1e-6)
        before = errors(np.array([at[:3, 3] for at in odometry]), truth)
        plain = errors(optimised(graph, poses[0], work), truth)
        after = errors(optimised(graph, poses[0], work, *PATIENT), truth)
        passed = (max(plain[0], after[0]) <= before[0] / 10 and after[1] <= before[1] / 5
                  and false == 0 and same and len(loops) == accepted > FRAMES // 2)
        good = good and passed
        print(f"street {seed}, drift {drift}: {len(loops)} loops, {false} false; error at the end {before[0]:.2f} -> "
              f"{after[0]:.2f} m, over all frames {before[1]:.2f} -> {after[1]:.2f} m; without {PATIENT[0]} "
              f"{plain[0]:.2f} m, {plain[1]:.2f} m{'' if passed else ' FAILED'}")
        for share in FALSE_SHARES:
            end, over_all = errors(optimised(with_false(graph, along, length, share, drift), poses[0], work, *PATIENT), truth)
            print(f"    with {share:.0%} of them made false: {end:.2f} m, {over_all:.2f} m")
    return good


def main() -> int:
    if not shutil.which("graph-slam"):
        print("graph-slam is not installed (mrpt-apps)")
        return 1 if os.environ.get("SEQLOOP_REQUIRE_DATA") else 77
    seeds = [int(seed) for seed in sys.argv[3:]] or [1, 2, 3]
    with tempfile.TemporaryDirectory() as work:
        results = [try_street(sys.argv[1], sys.argv[2], seed, pathlib.Path(work)) for seed in seeds]
    return 0 if all(results) else 1


if __name__ == "__main__":
    sys.exit(main())
