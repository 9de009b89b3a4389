#!/bin/sh
# SPDX-License-Identifier: MIT
# The committed network must be what its script makes, byte for byte, and at most 100 kB.
# Usage: builtin_model.sh SOURCE
set -eu
made=$(mktemp)
trap 'rm -f "$made"' EXIT
# Debian's Python: the packages onnx and numpy come from there.
/usr/bin/python3 "$1/platform/opencv/model/make_builtin.py" --out "$made"
cmp "$made" "$1/platform/opencv/model/oriented_gradients.onnx"
[ "$(stat -c %s "$made")" -le 100000 ]
