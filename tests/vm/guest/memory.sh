# SPDX-License-Identifier: MIT
# How much memory the live program has, with room for 3,476 places, once it runs.
. "$(dirname "$0")/lib.sh"

needs_little_memory() {
  camera
  live --source /dev/video0 --format YUYV --size 640x480 --fps 10 --max-places 3476
  expect "frames" within 40 has 30 good_lines
  local what
  for what in VmHWM VmRSS RssAnon RssFile; do
    echo "memory $what $(awk -v what="$what:" '$1 == what { print $2 }' "/proc/$live/status") kB"
  done | tee memory
  expect "less than 100 MB" below "$(awk '/VmHWM/ { print $3 }' memory)" 102400
}
run_cases needs_little_memory
