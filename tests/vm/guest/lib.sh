# SPDX-License-Identifier: MIT
# What the guest's cases share. The machine's tests set SEQLOOP, the program, and FEEDER,
# v4l2-feeder; the machine sets MODULES, OUT and WORK.
set -u
set +m
cd "$WORK"
failed=0

# How many times as long to wait for what should come: by how long this machine, and whatever runs
# beside it, takes to start the program for the first time. Waits end when what they wait for is there.
if [ -z "${PATIENCE:-}" ]; then
  start=$(date +%s)
  "$SEQLOOP" --version >/dev/null
  export PATIENCE=$((2 + $(date +%s) - start))
  echo "patience $PATIENCE"
fi

# run_case NAME: runs the function of that name; prints PASS, or FAIL with all that was not as expected
run_case() {
  why= lines=/dev/null log=/dev/null live=
  local start=$SECONDS
  "$1"
  stop_live
  no_cameras
  if [ -z "$why" ]; then
    echo "PASS $1 ($((SECONDS - start)) s)"
  else
    echo "FAIL $1: $why"
    tail -n 4 "$log" "$lines" | cut -c -300
    failed=$((failed + 1))
  fi
}

# run_cases NAME...: those of them that CASES names, or all
run_cases() {
  local name
  for name; do
    [[ -n "${CASES:-}" && " $CASES " != *" $name "* ]] || run_case "$name"
  done
  exit $((failed > 0))
}

# expect WHAT COMMAND...: the case fails, saying WHAT, unless the command succeeds
expect() {
  local what=$1
  shift
  "$@" && return
  why="${why:+$why; }not so: $what"
  return 1
}

# within SECONDS COMMAND...: waits until the command succeeds, PATIENCE times so long at most, but no
# longer than the live run lasts
within() {
  local end=$((SECONDS + $1 * PATIENCE))
  shift
  until "$@"; do
    ((SECONDS < end)) || return 1
    [ -z "$live" ] || ! is_over || end=0
    sleep 0.1
  done
}

insert() { modprobe -d "$MODULES" "$@"; }

# camera MODULE_SETTINGS...: vivid's camera, anew, as /dev/video0 unless told otherwise
camera() {
  modprobe -d "$MODULES" -r vivid 2>/dev/null
  insert vivid n_devs=1 node_types=0x1 num_inputs=1 input_types=0 "$@"
}
control() { v4l2-ctl -d /dev/video0 -c "$1"; }
no_cameras() { modprobe -q -d "$MODULES" -r v4l2loopback vivid; }

# live FLAGS...: `seqloop run` in the background, its lines in $lines, its log in $log
live() {
  lines=$WORK/live.jsonl log=$WORK/live.log
  : >"$lines"
  # The shell's & makes programs ignore SIGINT.
  env --default-signal=INT "$SEQLOOP" run "$@" >"$lines" 2>"$log" &
  live=$!
}
is_over() { ! kill -0 "$live" 2>/dev/null; }
stop_live() {
  [ -n "$live" ] || return
  kill -TERM "$live" 2>/dev/null
  expect "it stops at SIGTERM" within 10 is_over || kill -KILL "$live"
  wait "$live"
  live=
}

# ends CODE: the live run ends by itself, soon, with that exit code
ends() {
  within 20 is_over || return 1
  wait "$live"
  local code=$?
  live=
  [ "$code" = "$1" ] || { echo "exit code $code"; return 1; }
}

# streams DEVICE [PROCESS]: the live run, or another process, has mapped the device's buffers, which it
# does just before it asks for pictures
streams() { grep -q "$1\$" "/proc/${2:-$live}/maps" 2>/dev/null; }

# count_of STATUS [FILE], good_lines [FILE]: lines with the status; lines of frames that were searched with
# The status of a line stands behind its time; its answers have others.
count_of() { grep -c "\"time_s\":[^,]*,\"status\":\"$1\"" "${2:-$lines}"; }
good_lines() { grep -c '"time_s":[^,]*,"status":"\(warming_up\|waiting\|no_candidate\|not_unique\|new_place\|unsure\|match\)"' "${1:-$lines}"; }
# A line for each frame; the last one of a live run, about none, does not count.
all_lines() { grep -vc '"time_s":[^,]*,"status":"ended"' "$lines"; }

# has N COUNT...: the count is at least N; is N COUNT...: exactly
has() { local n=$1; shift; [ "$("$@")" -ge "$n" ]; }
is() { local n=$1; shift; [ "$("$@")" = "$n" ]; }

# has_written N FILE: a run that will leave FILE has written N lines of frames that were searched with
has_written() {
  local written
  written=$(echo "${2%/*}/.${2##*/}.partial-"*)
  [ -e "$written" ] && has "$1" good_lines "$written"
}

# good_again: five more frames that were searched with, soon
good_again() { local before; before=$(good_lines); within 15 has $((before + 5)) good_lines; }

# last KEY: its value in the last line; most KEY: the highest in all lines
values() { grep -o "\"$1\":-\?[0-9.e+]*" "$lines" | cut -d: -f2; }
last() { values "$1" | tail -n 1; }
most() { values "$1" | sort -g | tail -n 1; }
# below A B: as numbers
below() { awk -v a="$1" -v b="$2" 'BEGIN { exit !(a != "" && a < b) }'; }

# refused CODE TEXT FLAGS...: `seqloop run` does not start, and says so in one line with TEXT in it
refused() {
  local code=$1 text=$2
  shift 2
  log=$WORK/refused.log
  timeout $((30 * PATIENCE)) "$SEQLOOP" run --frames 5 "$@" >/dev/null 2>"$log"
  local got=$?
  [ "$got" = "$code" ] || { echo "exit code $got"; return 1; }
  grep -qi "^seqloop: .*$text" "$log"
}
