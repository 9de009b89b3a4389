#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs SeqLoop through what evaluation code of visual place recognition passes around.

Usage: vpr_protocol.py REFERENCE QUERY    two drives, the same frame of which shows the same place

Such code takes descriptors, [N, D] of the database and [M, D] of the queries, and gives either a similarity
matrix `S` [N, M], larger for more alike, or `predictions` [M, k], the database's rows for each query, the best
first. It judges by `ground_truth` [N, M], True where both show one place, as recall at k and as the area under
the curve of precision over recall. A describer and a matcher stand for themselves here: any describer's array goes
into SeqLoop's matcher, and SeqLoop's descriptors go into any matcher.
"""
from __future__ import annotations

import sys

import numpy

import seqloop

TOLERANCE = 2
"""Frames by which a match may be off."""


def recall_at(predictions: numpy.ndarray, ground_truth: numpy.ndarray, k: int) -> float:
    """Share of the queries that have a right row among their first k; below 0: no prediction."""
    queries = numpy.arange(predictions.shape[0])[:, None]
    right = ground_truth[predictions[:, :k], queries] & (predictions[:, :k] >= 0)
    return float(right.any(axis=1).mean())


def area_under_curve(S: numpy.ndarray, ground_truth: numpy.ndarray) -> float:
    """Of precision over recall, each query's best row being its match, as the similarity is swept."""
    best = S.argmax(axis=0)
    columns = numpy.arange(S.shape[1])
    order = numpy.argsort(-S[best, columns], kind="stable")
    order = order[numpy.isfinite(S[best, columns][order])]
    right = ground_truth[best, columns][order].cumsum()
    if len(right) == 0:
        return 0.0
    precision, recall = right / numpy.arange(1, len(right) + 1), right / ground_truth.any(axis=0).sum()
    return float(numpy.trapz(numpy.r_[precision[0], precision], numpy.r_[0.0, recall]))


def ranked(S: numpy.ndarray, k: int) -> numpy.ndarray:
    """[M, k], the rows of each query, the most alike first."""
    return numpy.argsort(-S, axis=0, kind="stable")[:k].T


def as_similarity(matches: seqloop.Matches, places: int, frames: int) -> numpy.ndarray:
    """[places, frames]: a match's probability where there is one, elsewhere nothing (-inf)."""
    S = numpy.full((places, frames), -numpy.inf)
    S[matches.match, matches.query] = matches.probability
    return S


def main(reference: str, query: str) -> None:
    describer = seqloop.Describer()
    database, queries = describer.describe_drive(reference), describer.describe_drive(query)
    ground_truth = abs(numpy.arange(len(database))[:, None] - numpy.arange(len(queries))) <= TOLERANCE
    print(f"descriptors {database.shape} and {queries.shape}, {database.dtype}")
    print(f"{'':34}  recall@1  @5     area under the curve")

    matches = seqloop.match(database, queries)
    ways = {
        "our descriptor, dot product": database @ queries.T,
        "our descriptor, our differences": -seqloop.differences(database, queries),
        "our descriptor, our matcher": as_similarity(matches, len(database), len(queries)),
    }
    # Somebody else's descriptor: here, what is left of ours in 64 random directions.
    random = numpy.random.default_rng(1).standard_normal((database.shape[1], 64))
    other = seqloop.match(database @ random, queries @ random)
    ways["another descriptor, our matcher"] = as_similarity(other, len(database), len(queries))
    for name, S in ways.items():
        predictions = ranked(S, 5)
        predictions[~numpy.isfinite(S[predictions.T, numpy.arange(S.shape[1])]).T] = -1
        at_1, at_5 = (recall_at(predictions, ground_truth, k) for k in (1, 5))
        print(f"{name:34}  {at_1:.3f}     {at_5:.3f}  {area_under_curve(S, ground_truth):.3f}")

    measures = seqloop.evaluate(matches, numpy.argwhere(ground_truth.T), tolerance=0, threshold_on="probability")
    print(f"accepted: {measures.accepted} of {len(queries)} frames, precision {measures.accepted_precision:.3f}, "
          f"recall {measures.accepted_recall:.3f}")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
