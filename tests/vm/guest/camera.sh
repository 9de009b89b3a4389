# SPDX-License-Identifier: MIT
# A camera that works: formats, rates, other owners, interruptions.
. "$(dirname "$0")/lib.sh"
small="--format YUYV --size 320x180 --fps 10"

lists_the_camera() {
  camera
  log=$WORK/list.log
  "$SEQLOOP" camera >"$log" 2>&1
  for text in /dev/video0 vivid YUYV 640x480 25; do expect "$text is listed" grep -q "$text" "$log"; done
}

captures_at_full_rate() {
  camera
  log=$WORK/capture.log
  timeout $((60 * PATIENCE)) "$SEQLOOP" camera --device /dev/video0 --frames 50 --format YUYV --size 640x480 --fps 25 >"$log" 2>&1
  expect "the capture ends well" [ $? = 0 ]
  cp "$log" "$OUT/capture.txt"
}

# Where this machine is busy with something else, or its host is, frames are missed: one of six goes
# has to be whole.
runs_at_full_rate() {
  for go in 1 2 3 4 5 6; do
    camera
    control timestamp_source=1
    live --source /dev/video0 --format YUYV --size 320x180 --fps 25 --frames 75
    expect "it ends" ends 0
    expect "75 lines" is 75 all_lines
    expect "every frame is good" is 75 good_lines
    cp "$lines" "$OUT/full_rate.jsonl"
    cp "$log" "$OUT/full_rate.log"
    [ "$(most lost)" = 0 ] && return
  done
  expect "a go in which nothing is lost" false
}

# All at once, each from a camera of its own: starting the program takes these processors seconds.
reads_every_format() {
  camera n_devs=7 node_types=0x1,0x1,0x1,0x1,0x1,0x1,0x1 num_inputs=1,1,1,1,1,1,1 \
    input_types=0,0,0,0,0,0,0
  local number=0 format
  for format in YUYV UYVY NV12 YU12 GREY RGB3 BGR3; do
    "$SEQLOOP" run --source "/dev/video$number" --format "$format" --size 320x180 --fps 10 \
      --frames 10 --out "$WORK/$format.jsonl" 2>"$WORK/$format.log" &
    number=$((number + 1))
  done
  wait
  for format in YUYV UYVY NV12 YU12 GREY RGB3 BGR3; do
    log=$WORK/$format.log
    expect "10 frames of $format" is 10 good_lines "$WORK/$format.jsonl"
    expect "$format is what was taken" grep -q "vivid, $format 320x180" "$log"
  done
}

reads_a_multiplanar_camera() {
  camera multiplanar=2
  live --source /dev/video0 $small --frames 10
  expect "it ends" ends 0
  expect "10 frames" is 10 good_lines
}

refuses_what_it_cannot_open() {
  camera
  expect "a missing device" refused 2 /dev/video7 --source /dev/video7
  expect "no camera" refused 2 /dev/null --source /dev/null
  expect "a format that it has not" refused 2 "not offer" --source /dev/video0 --format MJPG
}

says_who_is_not_permitted() {
  camera
  log=$WORK/permission.log
  setpriv --reuid=65534 --regid=65534 --clear-groups "$SEQLOOP" run --source /dev/video0 --frames 5 \
    >/dev/null 2>"$log"
  expect "exit code 2" [ $? = 2 ]
  expect "it says why" grep -qi '/dev/video0.*permission' "$log"
}

says_that_the_camera_is_busy() {
  camera
  v4l2-ctl --stream-mmap --stream-count=0 >/dev/null 2>&1 &
  local other=$!
  expect "the other one has it" within 15 streams /dev/video0 "$other"
  expect "it says why" refused 2 busy --source /dev/video0 $small
  kill "$other"
  wait "$other" 2>/dev/null
}

# ends_whole SIGNAL: interrupted in the middle, the output is there and whole
ends_whole() {
  camera
  local out=$WORK/whole-$1.jsonl
  live --source /dev/video0 $small --out "$out"
  expect "frames come" within 20 has_written 5 "$out"
  kill -"$1" "$live"
  expect "exit code 0" ends 0
  expect "the output is there" [ -s "$out" ]
  expect "some frames" has 5 good_lines "$out"
  expect "every line is whole" is "$(wc -l <"$out")" grep -c '^{.*}$' "$out"
  expect "a summary" grep -q 'frames' "$log"
}
ends_whole_at_sigterm() { ends_whole TERM; }
ends_whole_at_sigint() { ends_whole INT; }

# The driver starts 128 numbers before 2^32.
counts_on_when_the_sequence_number_wraps() {
  camera
  control wrap_sequence_number=1
  live --source /dev/video0 --format YUYV --size 320x180 --fps 25 --frames 140
  expect "it ends" ends 0
  expect "140 lines" is 140 all_lines
  expect "the wrap loses nothing" below "$(most lost)" 20
}

# Stamps start 16 s before 2^63 ns, or before 2^31 s: centuries ahead.
does_not_believe_stamps_from_the_future() {
  for wrap in 1 2; do
    camera
    control wrap_timestamp=$wrap
    live --source /dev/video0 $small --frames 15
    expect "it ends" ends 0
    expect "15 frames" is 15 good_lines
    expect "ages of milliseconds" below "$(most age_ms)" 5000
  done
}

run_cases lists_the_camera captures_at_full_rate runs_at_full_rate reads_every_format \
  reads_a_multiplanar_camera refuses_what_it_cannot_open says_who_is_not_permitted \
  says_that_the_camera_is_busy ends_whole_at_sigterm ends_whole_at_sigint \
  counts_on_when_the_sequence_number_wraps does_not_believe_stamps_from_the_future
