#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Makes the pictures of platform/http/README.md again, with pages of other sizes to look at.
# Usage: readme_pictures.sh BUILD FOLDER    after tools/check browser; then look, and copy page_*.png
set -euo pipefail
build=$(realpath "$1") folder=$(realpath "$2")
here=$(dirname "$(realpath "$0")")
seqloop=$build/tools/seqloop
work=$(mktemp -d)
run=
cleanup() {
  [ -z "$run" ] || { kill "$run" 2>/dev/null || true; wait "$run" || true; }
  rm -rf "$work"
}
trap cleanup EXIT
cd "$work"
for light in autumn winter; do
  "$build/tools/street/seqloop-street" --quiet --drives localise --frames 260 --second-light $light --out $light
done
"$seqloop" run --source winter/reference --map street.seqloop --session monday --out /dev/null 2>said
"$seqloop" run --source autumn/query --map street.seqloop --session tuesday --out /dev/null 2>said
"$seqloop" run --source winter/query --map street.seqloop --session wednesday --pace live --fps 3 --realtime-priority 10 \
  --serve 127.0.0.1:0 --out w.jsonl 2>served &
run=$!
until url=$(sed -n 's/.*serving on \(http:[^ ]*\)$/\1/p' served) && [ -n "$url" ]; do sleep 0.2; done
NODE_PATH=$build/browser/node_modules node "$here/readme_pictures.cjs" \
  "$(command -v chromium-headless-shell || command -v chromium)" "$url" "$folder"
