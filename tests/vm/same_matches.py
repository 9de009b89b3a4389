#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Compares two runs of `seqloop run` over the same pictures: the answers must be the same.

Usage: same_matches.py LIVE.jsonl RECORDED.jsonl
"""
import json
import sys


def answers(path):
    """By frame: its status, and the place that it matched.

    Which line has an answer may differ: a live run does not know its last frame beforehand.
    """
    with open(path) as lines:
        due = [answer for line in lines for answer in json.loads(line)["answers"]]
    found = ((answer["frame"], answer["status"], answer["match"]) for answer in due)
    return sorted(found, key=lambda answer: answer[0])


live, recorded = (answers(path) for path in sys.argv[1:3])
different = [number for number, pair in enumerate(zip(live, recorded)) if pair[0] != pair[1]]
matched = sum(match is not None for *_, match in recorded)
print(f"{len(live)} and {len(recorded)} answers, {matched} matched, {len(different)} different")
for number in different[:10]:
    print(f"answer {number}: {live[number]}, recorded {recorded[number]}")
sys.exit(bool(different) or len(live) != len(recorded) or matched == 0)
