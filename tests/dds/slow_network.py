# SPDX-License-Identifier: MIT
"""A network that delays and loses packets, where the kernel has no netem: namespaces have TAP devices, and a process
hands what one sends to all others, late or not at all. All devices and addresses are in namespaces made here.
"""
import ctypes
import fcntl
import heapq
import multiprocessing
import os
import random
import select
import struct
import threading
import time

TUNSETIFF, IFF_TAP, IFF_NO_PI = 0x400454CA, 0x0002, 0x1000
CLONE_NEWNET = 0x40000000
MOST_WAITING = 100_000  # packets; what is more is lost
SEED = 5


def open_tap(namespace: str, device: str) -> int:
    """@return what reads and writes the Ethernet frames of a new device in a namespace"""
    made: list[int] = []

    def work() -> None:  # in a thread of its own: it stays in that namespace
        libc = ctypes.CDLL(None, use_errno=True)
        there = os.open(f"/var/run/netns/{namespace}", os.O_RDONLY)
        if libc.setns(there, CLONE_NEWNET) != 0:
            raise OSError(ctypes.get_errno(), "setns")
        os.close(there)
        tap = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK)
        fcntl.ioctl(tap, TUNSETIFF, struct.pack("16sH22x", device.encode(), IFF_TAP | IFF_NO_PI))
        made.append(tap)

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    if not made:
        raise OSError("no TAP device can be made")
    return made[0]


class Hub:
    """Hands on what comes from each of some TAP devices to all others. A process of its own."""

    def __init__(self, taps: list[int], delay_s: float, jitter_s: float, loss: float) -> None:
        self.cut = multiprocessing.Array("b", len(taps))
        self.lost = multiprocessing.Value("q", 0)
        self.handed_on = multiprocessing.Value("q", 0)
        self.process = multiprocessing.get_context("fork").Process(
            target=self.work, args=(taps, delay_s, jitter_s, loss), daemon=True)
        self.process.start()

    def work(self, taps: list[int], delay_s: float, jitter_s: float, loss: float) -> None:
        chance = random.Random(SEED)
        waiting: list[tuple[float, int, int, bytes]] = []  # when, number, to, packet
        number = 0
        poll = select.poll()
        for tap in taps:
            poll.register(tap, select.POLLIN)
        index = {tap: i for i, tap in enumerate(taps)}
        while True:
            patience = None if not waiting else max(0.0, (waiting[0][0] - time.monotonic()) * 1000)
            for tap, _ in poll.poll(patience):
                try:
                    packet = os.read(tap, 65536)
                except OSError:
                    continue
                sender, now = index[tap], time.monotonic()
                for to in range(len(taps)):
                    if to == sender:
                        continue
                    if (self.cut[sender] or self.cut[to] or chance.random() < loss or len(waiting) == MOST_WAITING):
                        self.lost.value += 1
                        continue
                    number += 1
                    heapq.heappush(waiting, (now + delay_s + chance.uniform(-jitter_s, jitter_s), number, to, packet))
            now = time.monotonic()
            while waiting and waiting[0][0] <= now:
                _, _, to, packet = heapq.heappop(waiting)
                self.handed_on.value += 1
                try:
                    os.write(taps[to], packet)
                except OSError:
                    pass  # it does not take it just now, as a radio that is busy

    def end(self) -> None:
        self.process.terminate()
        self.process.join()
