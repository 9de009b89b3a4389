#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The page in headless Chromium, before a run that goes on.
# Usage: page_test.sh SOURCE BUILD SEQLOOP STREET [PICTURES]
#   PICTURES is a folder for screenshots
# Exit code 77 where the browser, node or its packages are missing (tools/check browser installs
# them); with SEQLOOP_REQUIRE_BROWSER set, that fails.
set -euo pipefail
source=$1 build=$2 seqloop=$3 street=$4 pictures=${5:-}
missing() {
  echo "$1 is missing"
  [ -z "${SEQLOOP_REQUIRE_BROWSER:-}" ] && exit 77
  exit 1
}
browser=$(command -v chromium-headless-shell || command -v chromium || true)
[ -n "$browser" ] || missing "Debian's chromium"
command -v node >/dev/null || missing node
modules=$build/browser/node_modules
[ -d "$modules/playwright-core" ] && [ -d "$modules/axe-core" ] || missing "playwright-core or axe-core in $modules"

work=$(mktemp -d)
run=
look=
cleanup() {
  for process in $run $look; do kill "$process" 2>/dev/null || true; done
  rm -rf "$work"
}
trap cleanup EXIT
"$street" --quiet --drives localise --frames 200 --size 160x90 --out "$work/street"
echo 0123456789abcdef >"$work/token"
# Names are text, whatever they hold.
mv "$work/street/query" "$work/street/<b>query"
address=127.0.0.1:0
# served DRIVE FLAGS...: a run at 10 frames a second, with a page; sets run and url
served() {
  local drive=$1
  shift
  : >"$work/said"
  "$seqloop" run --source "$drive" --pace live --fps 10 --budget-total 10000 "$@" \
    --serve "$address" --serve-token "$work/token" --out "$work/run.jsonl" --summary "$work/run.json" 2>"$work/said" &
  run=$!
  for _ in $(seq 600); do
    url=$(sed -n 's/.*serving on \(http:[^ ]*\)$/\1/p' "$work/said")
    [ -z "$url" ] || return 0
    sleep 0.1
  done
  cat "$work/said"
  return 1
}
# looked_at MODE FLAGS...: the page of such a run, until it has been stopped from there
looked_at() {
  local mode=$1
  shift
  rm -f "$work/url" "$work/url.wanted" "$work/url.again" "$work/url.next"
  NODE_PATH=$modules node "$source/tests/browser/page_test.cjs" "$browser" "$work/url" 0123456789abcdef "$mode" $pictures &
  look=$!
  # The browser first: on a busy machine it takes longer to start than the run lasts.
  until [ -e "$work/url.wanted" ] || ! kill -0 "$look" 2>/dev/null; do sleep 0.1; done
  served "$work/street/<b>query" "$@"
  echo "$url" >"$work/url.new"
  mv "$work/url.new" "$work/url"
  if [ "$mode" = again ] || [ "$mode" = after ]; then
    until [ -e "$work/url.again" ] || ! kill -0 "$look" 2>/dev/null; do sleep 0.1; done
    if [ "$mode" = again ]; then
      kill -KILL "$run"
      wait "$run" || true
    else
      kill -TERM "$run"
      wait "$run" || true
      until [ -e "$work/url.next" ] || ! kill -0 "$look" 2>/dev/null; do sleep 0.1; done
    fi
    address=${url#http://} served "$work/later" "$@"
  fi
  wait "$look" || { cat "$work/said"; exit 1; }
  wait "$run" || { cat "$work/said"; exit 1; }
  run= look=
}
looked_at twins --reference "$work/street/reference" --paper --ds 20 --max-uniqueness 0.1
mkdir "$work/later"
find "$work/street/<b>query" -name '*.jpg' | sort | tail -n +61 | xargs -d '\n' cp -t "$work/later"
looked_at after --reference "$work/street/reference"
looked_at again --reference "$work/street/reference"
looked_at page --reference "$work/street/reference"
"$seqloop" report "$work/run.jsonl" --summary "$work/run.json" --out "$work/report.html"
NODE_PATH=$modules node "$source/tests/browser/report_test.cjs" "$browser" "$work/report.html" $pictures
"$seqloop" run --source "$work/street/<b>query" --reference "$work/street/reference" --paper --out "$work/run.jsonl" \
  --summary "$work/run.json" 2>/dev/null
"$seqloop" report "$work/run.jsonl" --summary "$work/run.json" --out "$work/uniqueness.html"
NODE_PATH=$modules node "$source/tests/browser/report_test.cjs" "$browser" "$work/uniqueness.html"
# A build without SQLite keeps no maps.
if "$seqloop" run --source "$work/street/reference" --map "$work/m.seqloop" --session '<i>monday' --out /dev/null \
  2>"$work/said"; then
  looked_at map --map "$work/m.seqloop" --session tuesday
  "$seqloop" map check "$work/m.seqloop"
else
  grep -q 'made without SQLite' "$work/said" || { cat "$work/said"; exit 1; }
fi
