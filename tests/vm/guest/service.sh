# SPDX-License-Identifier: MIT
# The service on a robot with systemd. At the first start it is installed as its page says. Then its
# answers are shown to tests/vm/service, and what that orders is done.
cd /run/out || exit 1

# So that the camera is this machine's: a device that plays a drive, from its begin at every start.
install_camera() {
  mkdir /opt/camera
  cp -r feeder pictures /opt/camera/
  cat >/etc/systemd/system/camera.service <<'END'
[Unit]
Before=seqloop.service
[Service]
ExecStartPre=-/sbin/modprobe v4l2loopback video_nr=5 card_label=robot
ExecStart=/opt/camera/feeder --device /dev/video5 --folder /opt/camera/pictures --fps 5 --frames 1000000
[Install]
WantedBy=multi-user.target
END
  systemctl enable --now camera
}

install_service() {
  local examples=/usr/share/doc/seqloop/examples
  dpkg --install seqloop.deb
  sed 's/ATTRS{idVendor}.*, SYMLINK/ATTR{name}=="robot", SYMLINK/' $examples/70-seqloop-camera.rules \
    >/etc/udev/rules.d/70-seqloop-camera.rules
  cp $examples/seqloop.service /etc/systemd/system/
  systemctl daemon-reload
  udevadm control --reload
  udevadm trigger --subsystem-match=video4linux --settle
  systemctl enable --now seqloop
}

# How the service is: what systemd says, and what real-time settings the program has.
look() {
  local pid
  pid=$(systemctl show --property MainPID --value seqloop)
  systemctl show --property ActiveState,NRestarts,MainPID seqloop
  grep -E '^(VmLck|Uid)' "/proc/$pid/status"
  for task in "/proc/$pid/task/"*; do chrt --pid "${task##*/}"; done
}

answers=/var/lib/private/seqloop/answers.jsonl
size=$(stat --format %s $answers 2>/dev/null || echo 0)
[ -e /etc/systemd/system/seqloop.service ] || { install_camera; install_service; } >installed 2>&1
tail --follow=name --retry --bytes=+$((size + 1)) $answers >answers.jsonl 2>/dev/null &
journalctl --unit seqloop --follow --output short-monotonic --lines all >journal &

while :; do
  until [ -e order ]; do sleep 0.3; done
  order=$(cat order)
  rm order
  case $order in
    look) look >state.part 2>&1; mv state.part state ;;
    unplug) systemctl stop camera ;;
    plug) systemctl start camera ;;
    reboot) sync -f .; systemctl reboot; exit ;;
  esac
done
