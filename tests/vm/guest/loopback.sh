# SPDX-License-Identifier: MIT
# Recorded pictures played into v4l2loopback, as MJPG and YUYV: a camera that sends damaged frames,
# stops, dies and returns. PICTURES is a folder of 320x180 JPEG files. The driver keeps two frames for a
# slow reader: at five a second, it may sleep for 400 ms.
. "$(dirname "$0")/lib.sh"

# feed FLAGS...: the feeder in the background, ready; it plays once the file `go` is there
feed() {
  rm -f go
  "$FEEDER" --device /dev/video5 --folder "$PICTURES" --fps 5 --wait-for go "$@" >feeder.log 2>&1 &
  feeder=$!
  expect "the feeder is ready" within 15 grep -q ready feeder.log
}
# The moment is for the last step, which nothing outside the reader shows.
reader_waits() {
  expect "the reader has its buffers" within 15 streams /dev/video5
  sleep 0.5
}

# plays FRAMES FEEDER_FLAGS...: all lines of a run that ends after FRAMES
plays() {
  local frames=$1
  shift
  insert v4l2loopback video_nr=5
  feed --frames "$frames" "$@"
  live --source /dev/video5 --frames "$frames"
  reader_waits
  touch go
  expect "it ends" ends 0
  wait "$feeder"
  expect "nothing lost" [ "$(most lost)" = 0 ]
}

plays_mjpg() {
  plays 15
  expect "every frame is good" is 15 good_lines
}

plays_yuyv() {
  plays 10 --yuyv
  expect "every frame is good" is 10 good_lines
}

names_truncated_frames() {
  plays 10 --truncate-every 5
  expect "2 frame errors" is 2 count_of frame_error
  expect "8 good" is 8 good_lines
}

names_corrupt_frames() {
  plays 10 --corrupt-every 5
  expect "2 frame errors" is 2 count_of frame_error
  expect "8 good" is 8 good_lines
}

waits_for_a_feeder_that_stops() {
  insert v4l2loopback video_nr=5
  feed --frames 10 --stop-at 5 --stop-s 4
  live --source /dev/video5
  reader_waits
  touch go
  expect "no_frame" within 15 has 1 count_of no_frame
  expect "the rest comes" within 15 has 10 good_lines
}

# returns FEEDER_FLAGS...: the feeder exits after five frames; another one starts
returns() {
  insert v4l2loopback video_nr=5
  feed --frames 5
  live --source /dev/video5
  reader_waits
  touch go
  wait "$feeder"
  expect "no_frame" within 15 has 1 count_of no_frame
  # The device takes another format only once the reader has let go of it.
  expect "the feeder can start again" within 20 feed_again "$@"
  expect "good again" good_again
  kill "$feeder" 2>/dev/null
  wait "$feeder" 2>/dev/null
}
feed_again() {
  "$FEEDER" --device /dev/video5 --folder "$PICTURES" --fps 5 --frames 100 "$@" >feeder.log 2>&1 &
  feeder=$!
  within 5 eval 'grep -q ready feeder.log || ! kill -0 "$feeder" 2>/dev/null'
  grep -q ready feeder.log
}
goes_on_when_the_feeder_returns() { returns; }
goes_on_when_it_returns_with_another_format() { returns --yuyv; }

run_cases plays_mjpg plays_yuyv names_truncated_frames names_corrupt_frames \
  waits_for_a_feeder_that_stops goes_on_when_the_feeder_returns \
  goes_on_when_it_returns_with_another_format
