# SPDX-License-Identifier: MIT
"""What is accepted of a peer's guesses, and how good that is. Used by tools/peers."""
import csv
import dataclasses
import json
import pathlib

import numpy as np

Truth = dict[int, list[int]]  # right places of a frame; none: nothing is right; unlisted: unknown
STEADY = 5  # rows by which guesses of frames one after the other may differ
RUNS = (1, 3, 5, 10, 20)  # frames whose guesses must be steady


@dataclasses.dataclass(frozen=True)
class Guesses:
    """What a method says of each frame of a drive, [frames] each; lower values are surer."""
    place: np.ndarray  # -1: none
    values: dict[str, np.ndarray]
    usual: np.ndarray  # whether it is accepted by the usual settings
    see_ms: np.ndarray  # reading not counted
    answer_ms: np.ndarray
    bytes: float  # at the end of the drive, for the places


def steady(place: np.ndarray, run: int) -> np.ndarray:
    """Whether the last `run` frames, this one among them, were taken for places side by side."""
    follows = (place[1:] >= 0) & (place[:-1] >= 0) & (abs(np.diff(place)) <= STEADY)
    length = np.zeros(len(place), int)
    for i, goes_on in enumerate(np.concatenate([[False], follows])):
        length[i] = length[i - 1] + 1 if goes_on else 1
    return (place >= 0) & (length >= run)


def of_peer(path: pathlib.Path, words: bool) -> Guesses:
    """A file that `seqloop-peers loops` wrote."""
    with path.open(encoding="ascii") as stream:
        rows = list(csv.DictReader(stream))
    place = np.array([int(row["place"] or -1) for row in rows])
    column = {name: np.array([float(row[name]) for row in rows])
              for name in ("distance", "ratio", "inliers", "see_ms", "answer_ms", "bytes")}
    values = {"distance": column["distance"], "ratio": column["ratio"]}
    usual = steady(place, 3)
    if words:  # as DLoopDetector has it: 3 steady, .3 of what could be expected, 12 inliers
        values["inliers"] = -column["inliers"]
        usual &= (column["distance"] <= 0.7) & (column["inliers"] >= 12)
    else:  # Lowe's ratio
        usual &= column["ratio"] <= 0.8
    return Guesses(place, values, usual, column["see_ms"], column["answer_ms"], column["bytes"][-1])


def of_ours(path: pathlib.Path, frames: int, planned: float) -> Guesses:
    """The lines of `seqloop run`."""
    place = np.full(frames, -1)
    values = {name: np.full(frames, np.inf) for name in ("improbability", "uniqueness", "score")}
    usual = np.zeros(frames, bool)
    see, answer = [], []
    with path.open(encoding="utf-8") as stream:
        for line in map(json.loads, stream):
            if line["newest"] is not None:
                see.append(line["latency_ms"]["describe"])
                answer.append(line["latency_ms"]["match"])
            for said in line["answers"]:
                frame = said["frame"]
                if said["match"] is None:
                    continue
                place[frame] = said["match"]
                usual[frame] = said["status"] == "match"
                if said["probability"] is not None:
                    values["improbability"][frame] = 1.0 - said["probability"]
                for name in ("uniqueness", "score"):
                    if said[name] is not None:
                        values[name][frame] = said[name]
    known = {name: value for name, value in values.items() if np.isfinite(value).any()}
    return Guesses(place, known, usual, np.array(see), np.array(answer), planned)


@dataclasses.dataclass(frozen=True)
class Score:
    precision: float  # NaN where nothing is accepted
    recall: float
    accepted: int
    by: str = ""


class Judge:
    """@param tolerance frames"""
    def __init__(self, guesses: Guesses, truth: Truth, tolerance: int) -> None:
        frames = len(guesses.place)
        self.guesses = guesses
        self.labelled = np.array([frame in truth for frame in range(frames)])
        self.asked = sum(1 for places in truth.values() if places)
        self.right = np.array([any(abs(int(place) - right) <= tolerance for right in truth.get(frame, []))
                               for frame, place in enumerate(guesses.place)])

    def score(self, accepted: np.ndarray, by: str = "") -> Score:
        accepted = accepted & self.labelled
        right = int((accepted & self.right).sum())
        count = int(accepted.sum())
        return Score(right / count if count else float("nan"), right / max(1, self.asked), count, by)

    def usual(self) -> Score:
        return self.score(self.guesses.usual)

    def best(self) -> Score:
        """The highest recall that any threshold, after any number of steady frames, has without a
        false answer."""
        best = Score(float("nan"), 0.0, 0, "none")
        for run in RUNS:
            allowed = steady(self.guesses.place, run)
            wrong = allowed & self.labelled & ~self.right
            for name, value in self.guesses.values.items():
                below = value[wrong].min() if wrong.any() else np.inf
                found = self.score(allowed & (value < below) & np.isfinite(value),
                                   f"{name}, {run} steady" if run > 1 else name)
                if found.recall > best.recall:
                    best = found
        return best


def growth(times: np.ndarray) -> tuple[float, float]:
    """Median of the drive's first tenth and of its last."""
    tenth = max(1, len(times) // 10)
    return float(np.median(times[:tenth])), float(np.median(times[-tenth:]))
