#!/bin/sh
# SPDX-License-Identifier: MIT
# Checks tools/board-report: what it prints, what it warns of, and what it refuses. The program's times
# are made up, except in the last check; so are the board's files.
# Usage: board_report.sh ROOT SEQLOOP
set -eu
report=$1/tools/board-report
seqloop=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failed=0
# expect WHAT COMMAND...
expect() {
  what=$1
  shift
  "$@" >/dev/null || { echo "not so: $what"; failed=1; }
}
# refused TEXT ARGUMENT...: board-report fails, with the text in its message
refused() {
  text=$1
  shift
  ! BOARD_ROOT=$folder/board "$report" "$@" >/dev/null 2>"$folder/err" && grep -q "$text" "$folder/err"
}

board=$folder/board
mkdir -p "$board/proc/device-tree" "$board/sys/devices/system/cpu/cpu0/cpufreq" \
  "$board/sys/class/thermal/thermal_zone0" "$board/sys/class/thermal/cooling_device0"
printf 'Raspberry Pi 4 Model B Rev 1.5\0' >"$board/proc/device-tree/model"
echo performance >"$board/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor"
echo 48312 >"$board/sys/class/thermal/thermal_zone0/temp"
echo cpufreq-cpu0 >"$board/sys/class/thermal/cooling_device0/type"
echo 0 >"$board/sys/class/thermal/cooling_device0/cur_state"
cat >"$folder/seqloop" <<'END'
#!/bin/sh
[ "$1" != --version ] || exec echo "seqloop 0.1.0 (abc)"
echo "seqloop: Raspberry Pi 4, 4 cores; compiler 12.2.0; OpenCV 4.6.0; seqloop 0.1.0 (abc); bench --n 3476" >&2
echo "seqloop: step by x: 100.0 % found" >&2
row() { printf ' {\n  "what": "%s",\n  "by": "%s",\n  "p50_us": %s,\n  "p99_us": %s,\n  "max_us": 9\n },\n' "$@"; }
echo '['
row describe seqloop-built-in 5120.4 6000
row step seqloop-int8-exhaustive 2340.5 2990
row step seqloop-int8-o-relocalising 410 812.6
echo ']'
END
chmod +x "$folder/seqloop"

run() { BOARD_ROOT=$board "$report" "$folder/seqloop" >"$folder/out" 2>"$folder/err"; }
run
expect "the row" grep -qxF '| Raspberry Pi 4 Model B Rev 1.5 | 5.12 | 6.00 | 2.34 | 2.99 | 0.41 | 0.81 |' "$folder/out"
expect "the conditions" grep -q 'OpenCV 4.6.0; .*(abc); .*governor performance; temperature 48 °C before' "$folder/out"
expect "no warning" [ ! -s "$folder/err" ]

echo ondemand >"$board/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor"
run
expect "another governor is warned of" grep -q 'governor is ondemand, not performance' "$folder/err"
expect "and stands in the conditions" grep -q 'Conditions: .*ondemand, not performance' "$folder/out"
echo performance >"$board/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor"
echo 2 >"$board/sys/class/thermal/cooling_device0/cur_state"
run
expect "throttling is warned of" grep -q 'slowed down' "$folder/err"

expect "a missing program" refused 'no such file' "$folder/missing"
expect "two arguments" refused 'takes the program alone' a b
echo 'not a program' >"$folder/text"
expect "a file that is no program" refused 'does not run here' "$folder/text"
printf '#!/bin/sh\n[ "$1" = --version ] || { echo "seqloop: no memory" >&2; exit 1; }\n' >"$folder/failing"
chmod +x "$folder/failing"
expect "a benchmark that fails" refused 'seqloop: no memory' "$folder/failing"

expect "a row of this machine" sh -c '"$1" "$2" 2>/dev/null | grep -Ec "^[|] .* [|]( [0-9]+[.][0-9][0-9] [|]){6}$"' - "$report" "$seqloop"
exit $failed
