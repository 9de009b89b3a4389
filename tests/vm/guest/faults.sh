# SPDX-License-Identifier: MIT
# A camera that fails while `seqloop run` uses it: what its lines say, and that it comes back.
. "$(dirname "$0")/lib.sh"

start() {
  camera "$@"
  live --source /dev/video0 --format YUYV --size 320x180 --fps 10
  expect "frames at first" within 40 has 5 good_lines
}
unplug() { echo vivid.0 >/sys/bus/platform/drivers/vivid/unbind; }
plug() { echo vivid.0 >/sys/bus/platform/drivers/vivid/bind; }

names_a_damaged_frame() {
  start
  control inject_v4l2_buf_flag_error=1
  expect "one frame_error" within 10 is 1 count_of frame_error
  expect "good again" good_again
  expect "still one" is 1 count_of frame_error
}

any_lost() { below 0 "$(most lost)"; }
counts_frames_that_the_driver_drops() {
  start
  control percentage_of_dropped_buffers=50
  expect "lost frames are counted" within 15 any_lost
  control percentage_of_dropped_buffers=0
  expect "good again" good_again
}

tells_a_silent_camera() {
  start
  control percentage_of_dropped_buffers=100
  expect "no_frame" within 15 has 1 count_of no_frame
  control percentage_of_dropped_buffers=0
  expect "good again" good_again
}

survives_a_fatal_streaming_error() {
  start
  control inject_fatal_streaming_error=1
  expect "good again" good_again
}

survives_a_refused_buffer() {
  start
  control inject_vidioc_qbuf_error=1
  expect "good again" good_again
}

survives_a_disconnect() {
  start
  control disconnect=1
  expect "no_frame" within 15 has 1 count_of no_frame
  expect "good again" good_again
}

# What comes back may stumble at first.
tries_again_when_it_cannot_start_at_once() {
  start
  control inject_vidioc_reqbufs_error=1
  control inject_vidioc_streamon_error=1
  control disconnect=1
  expect "no_frame" within 15 has 1 count_of no_frame
  expect "good again" good_again
}

finds_the_camera_again() {
  start
  unplug
  expect "no_frame" within 15 has 1 count_of no_frame
  sleep 3
  plug
  expect "good again" good_again
  expect "what would have come counts as lost" below 15 "$(most lost)"
}

gives_up_when_told_to() {
  camera
  local out=$WORK/given-up.jsonl
  live --source /dev/video0 --format YUYV --size 320x180 --fps 10 --give-up-s 3 --out "$out"
  expect "frames come" within 20 has_written 5 "$out"
  unplug
  expect "exit code 1" ends 1
  expect "the answers are there" has 5 good_lines "$out"
  expect "it says why" grep -q 'given up' "$log"
  plug
}

# Meanwhile another camera took its name: the loopback device, which has no pictures.
finds_the_camera_under_another_name() {
  start
  unplug
  expect "no_frame" within 15 has 1 count_of no_frame
  insert v4l2loopback video_nr=0
  plug
  expect "it has another name" [ -e /dev/video1 ]
  expect "good again" good_again
}

# A second camera of the same make is not the one that was lost.
does_not_take_its_twin() {
  start n_devs=2 node_types=0x1,0x1 num_inputs=1,1 input_types=0,0
  expect "there are two" [ -e /dev/video1 ]
  unplug
  expect "no_frame" within 15 has 1 count_of no_frame
  local before
  before=$(good_lines)
  sleep 4
  expect "no frame of the other one" is "$before" good_lines
  plug
  expect "good again" good_again
}

# The driver goes only when nobody holds its device open.
lets_go_of_a_lost_camera() {
  start
  unplug
  expect "no_frame" within 15 has 1 count_of no_frame
  expect "the driver can be taken out" within 10 modprobe -q -d "$MODULES" -r vivid
  camera vid_cap_nr=3
  expect "it has another name" [ -e /dev/video3 ]
  expect "good again" good_again
}

ends_while_the_camera_is_lost() {
  start
  unplug
  expect "no_frame" within 15 has 1 count_of no_frame
  kill -TERM "$live"
  expect "exit code 0" ends 0
}

run_cases names_a_damaged_frame counts_frames_that_the_driver_drops tells_a_silent_camera \
  survives_a_fatal_streaming_error survives_a_refused_buffer survives_a_disconnect \
  tries_again_when_it_cannot_start_at_once finds_the_camera_again gives_up_when_told_to \
  finds_the_camera_under_another_name does_not_take_its_twin lets_go_of_a_lost_camera \
  ends_while_the_camera_is_lost
