#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Debian's Prometheus reads a run, and its promtool finds no fault with what it is given.
# Usage: prometheus_test.sh SEQLOOP STREET
# Exit code 77 where Prometheus is missing; with SEQLOOP_REQUIRE_BROWSER set, that fails.
set -euo pipefail
seqloop=$1 street=$2
if ! command -v prometheus >/dev/null || ! command -v promtool >/dev/null; then
  echo "Debian's prometheus is missing"
  [ -z "${SEQLOOP_REQUIRE_BROWSER:-}" ] && exit 77
  exit 1
fi
work=$(mktemp -d)
run=
monitor=
cleanup() {
  for process in $run $monitor; do kill "$process" 2>/dev/null || true; done
  wait
  rm -rf "$work"
}
trap cleanup EXIT
# ask ADDRESS PATH: with nothing but a shell and Python
ask() { python3 -c 'import sys, urllib.request as u; sys.stdout.buffer.write(u.urlopen(sys.argv[1]).read())' "$1$2"; }
# found COMMAND...: until it succeeds
found() {
  for _ in $(seq 300); do
    "$@" && return
    sleep 0.2
  done
  echo "not so: $*"
  cat "$work/said" "$work/monitor" 2>/dev/null
  exit 1
}

"$street" --quiet --drives localise --frames 200 --size 160x90 --out "$work/street"
"$seqloop" run --source "$work/street/query" --reference "$work/street/reference" --pace live --fps 1 \
  --serve 127.0.0.1:0 --out "$work/run.jsonl" 2>"$work/said" &
run=$!
url() { sed -n 's/.*serving on \(http:[^ ]*\)$/\1/p' "$work/said"; }
served() { [ -n "$(url)" ]; }
found served
frames() { ask "$(url)" /metrics | grep -q '^seqloop_frames_total [1-9]'; }
found frames
ask "$(url)" /metrics | promtool check metrics

port=$(python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')
cat >"$work/prometheus.yml" <<END
scrape_configs:
  - job_name: seqloop
    scrape_interval: 1s
    static_configs: [{targets: ["$(url | sed 's|http://||')"]}]
END
prometheus --config.file="$work/prometheus.yml" --storage.tsdb.path="$work/data" \
  --web.listen-address="127.0.0.1:$port" >"$work/monitor" 2>&1 &
monitor=$!
scraped() {
  ask "http://127.0.0.1:$port" '/api/v1/query?query=seqloop_frames_total' 2>/dev/null |
    python3 -c 'import json, sys; sys.exit(not json.load(sys.stdin)["data"]["result"])' 2>/dev/null
}
found scraped
echo "scraped: $(ask "http://127.0.0.1:$port" '/api/v1/query?query=seqloop_stage_seconds_count')" | head -c 300
