#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Times how long the program takes from its start to its first line, with a map of a million places, beside `dd`
of the same file. No test: run it where nothing else runs.

Usage: opening.py SEQLOOP FOLDER [ROUNDS]    FOLDER keeps the map, 760 MB; 6 rounds
Once with the map dropped from the page cache and, as root, once with all else dropped, too.
"""
import math
import os
import pathlib
import random
import resource
import shutil
import sqlite3
import struct
import subprocess
import sys
import time
import zlib
from array import array

VALUES, PLACES, A_BLOCK, SMALL = 735, 1_000_000, 250, 600


def save_rows(file: pathlib.Path, rows: list[list[float]]) -> None:
    header = f"{{'descr': '<f4', 'fortran_order': False, 'shape': ({len(rows)}, {VALUES}), }}".ljust(117) + "\n"
    unit = [[value / math.hypot(*row) for value in row] for row in rows]
    file.write_bytes(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode()
                     + b"".join(array("f", row).tobytes() for row in unit))


def checksum(table: str, *columns: object) -> int:
    """As platform/sqlite/README.md has it."""
    def coded(value: object) -> bytes:
        if isinstance(value, int):
            return struct.pack("<q", value)
        blob = value.encode() if isinstance(value, str) else value
        return struct.pack("<q", len(blob)) + blob
    return zlib.crc32(table.encode() + b"".join(coded(column) for column in columns))


def make(seqloop: str, folder: pathlib.Path) -> None:
    """A map that the program began, and that goes on with places made up."""
    folder.mkdir(parents=True, exist_ok=True)
    random.seed(5)
    save_rows(folder / "small.npy", [[random.gauss(0, 1) for _ in range(VALUES)] for _ in range(SMALL)])
    part = folder / "part.seqloop"
    part.unlink(missing_ok=True)
    subprocess.run([seqloop, "match", "--map", part, "--query", folder / "small.npy", "--out", folder / "small.csv",
                    "--grow", "all"], check=True, stderr=subprocess.DEVNULL)
    database = sqlite3.connect(part)
    about = list(database.execute("SELECT * FROM map").fetchone())
    session = list(database.execute("SELECT * FROM session").fetchone())
    no_minus_128 = bytes(0x7f if byte == 0x80 else byte for byte in range(256))
    seen = b""
    for first in range(SMALL, PLACES, A_BLOCK):
        count = min(A_BLOCK, PLACES - first)
        records = b"".join(struct.pack("<qqq", place, place, 0) for place in range(first, first + count))
        places = random.randbytes(count * VALUES).translate(no_minus_128)
        seen = seen or places
        database.execute("INSERT INTO block VALUES(?, ?, ?, ?, ?, ?)",
                         (first, 1, count, checksum("block", first, 1, count, records, places), records, places))
    about[5] = session[4] = session[5] = PLACES
    database.execute("UPDATE map SET next_place = ?, checksum = ?", (PLACES, checksum("map", *about[1:-1])))
    database.execute("UPDATE session SET frames = ?, places = ?, checksum = ?",
                     (PLACES, PLACES, checksum("session", *session[:-1])))
    database.commit()
    database.close()
    save_rows(folder / "query.npy", [[value + random.gauss(0, 20) for value in array("b", row)] for row in (
        seen[i * VALUES:(i + 1) * VALUES] for i in range(60))])
    shutil.move(part, folder / "map.seqloop")


def drop(file: pathlib.Path, everything: bool) -> None:
    os.sync()
    if everything:
        pathlib.Path("/proc/sys/vm/drop_caches").write_text("3")
    with file.open("rb") as stream:
        os.posix_fadvise(stream.fileno(), 0, 0, os.POSIX_FADV_DONTNEED)


def first_line(command: list, wait_for_line: bool) -> tuple[float, float, float]:
    """@return seconds to the first line, or to the end; of the processor; of the system"""
    before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    if wait_for_line:
        process.stdout.readline()
        took = time.perf_counter() - begin
    process.communicate()
    if process.returncode != 0:
        sys.exit(f"{command}: exit code {process.returncode}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return (took if wait_for_line else time.perf_counter() - begin, after.ru_utime - before.ru_utime,
            after.ru_stime - before.ru_stime)


def main() -> None:
    seqloop, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    rounds = int(sys.argv[3]) if len(sys.argv) > 3 else 6
    file = folder / "map.seqloop"
    if not file.exists():
        make(seqloop, folder)
    for everything in (False, True) if os.geteuid() == 0 else (False,):
        print("all caches dropped" if everything else "the map dropped, the program's libraries not")
        for _ in range(rounds):
            drop(file, everything)
            plain = first_line(["dd", f"if={file}", "of=/dev/null", "bs=1M"], False)[0]
            drop(file, everything)
            took, user, system = first_line([seqloop, "run", "--map", file, "--read-only", "--source",
                                             folder / "query.npy"], True)
            print(f"  dd {plain:.2f} s, first line after {took:.2f} s: {plain / took:.2f}; processor {user:.2f} s "
                  f"and {system:.2f} s of the system's", flush=True)


if __name__ == "__main__":
    main()
