# SPDX-License-Identifier: MIT
# A real drive through a real camera's kernel side: NIGHT played as MJPG, to be found in DAY.
# Its answers are compared on the host, by tests/vm/places.
. "$(dirname "$0")/lib.sh"

recognises_places() {
  local frames
  frames=$(ls "$NIGHT" | wc -l)
  insert v4l2loopback video_nr=5
  "$FEEDER" --device /dev/video5 --folder "$NIGHT" --fps 4 --wait-for go >feeder.log 2>&1 &
  expect "the feeder is ready" within 15 grep -q ready feeder.log
  live --source /dev/video5 --reference "$DAY" --frames "$frames"
  # The camera is opened last, after the reference has been described.
  expect "the camera is waited for" within 90 grep -q no_frame "$lines"
  touch go
  within 90 is_over
  expect "it ends" ends 0
  expect "every frame is good" is "$frames" good_lines
  expect "nothing lost" [ "$(most lost)" = 0 ]
  grep -v '"status":"no_frame"' "$lines" >"$OUT/live.jsonl"
  cp "$log" "$OUT/live.log"
}
run_cases recognises_places
