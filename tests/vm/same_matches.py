#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Compares two runs of `seqloop run` over the same pictures: every frame must have the same answer.

Usage: same_matches.py LIVE.jsonl RECORDED.jsonl
"""
import json
import sys


def answers(path):
    """Of each frame in order: the centre that the answer is about, and the place that it matched."""
    with open(path) as lines:
        return [(line["frame"], line["match"]) for line in map(json.loads, lines)]


live, recorded = (answers(path) for path in sys.argv[1:3])
different = [number for number, pair in enumerate(zip(live, recorded)) if pair[0] != pair[1]]
matched = sum(match is not None for _, match in recorded)
print(f"{len(live)} and {len(recorded)} frames, {matched} matched, {len(different)} different")
for number in different[:10]:
    print(f"frame {number}: (centre, match) {live[number]}, recorded {recorded[number]}")
sys.exit(bool(different) or len(live) != len(recorded) or matched == 0)
