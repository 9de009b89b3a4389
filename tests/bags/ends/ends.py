#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Bags that others wrote give what their pictures give in a folder; others read the bags we write.

Others are @mcap/core and @foxglove/rosmsg2-serialization (npm) and SQLite in Python.

Usage: ends.py SEQLOOP STREET SHARED
Exit code 77 where npm is missing, or its packages cannot be had; with SEQLOOP_REQUIRE_DATA set, that fails.
"""
import json
import os
import pathlib
import shutil
import sqlite3
import struct
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
# What differs from run to run, or between clocks.
NOT_COMPARED = ("time_s", "latency_ms", "deadline_missed", "missed", "overloaded")


def skip(why: str) -> None:
    print(why)
    sys.exit(1 if os.environ.get("SEQLOOP_REQUIRE_DATA") else 77)


def call(*command: object) -> str:
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"failed: {command}\n{done.stdout}{done.stderr}")
    return done.stdout


def expect(what: bool, told: str) -> None:
    if not what:
        sys.exit("not so: " + told)
    print(told)


def compressed_image(seconds: int, nanoseconds: int, jpeg: bytes) -> bytes:
    """CDR as the OMG's document has it: little-endian, values at multiples of their size."""
    def text(word: bytes) -> bytes:
        padded = word + b"\0"
        return struct.pack("<I", len(padded)) + padded + b"\0" * (-len(padded) % 4)
    return (b"\0\1\0\0" + struct.pack("<iI", seconds, nanoseconds) + text(b"camera") + text(b"jpeg")
            + struct.pack("<I", len(jpeg)) + jpeg)


def write_db3(file: pathlib.Path, pictures: list[pathlib.Path]) -> None:
    database = sqlite3.connect(file)
    database.executescript("""
        CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);
        CREATE TABLE metadata(id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL, metadata TEXT NOT NULL);
        CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
          serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL, type_description_hash TEXT NOT NULL);
        CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, encoding TEXT NOT NULL,
          encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL);
        CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL,
          data BLOB NOT NULL);
        CREATE INDEX timestamp_idx ON messages (timestamp ASC);
        INSERT INTO schema VALUES(4, 'jazzy');
        INSERT INTO topics VALUES(1, '/camera/compressed', 'sensor_msgs/msg/CompressedImage', 'cdr', '', '');
        """)
    for i, picture in enumerate(pictures):
        message = compressed_image(1_700_000_000 + i // 10, i % 10 * 100_000_000, picture.read_bytes())
        database.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES(1, ?, ?)",
                         (1_700_000_000_000_000_000 + i * 100_000_000, message))
    database.commit()
    database.close()


def main() -> None:
    seqloop, street, shared = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
    if not shutil.which("npm") or not shutil.which("node"):
        skip("npm and node are not installed")
    with tempfile.TemporaryDirectory() as name:
        work = pathlib.Path(name)
        for file in ("package.json", "read.mjs", "write.mjs"):
            shutil.copy(HERE / file, work)
        install = subprocess.run(["npm", "install", "--no-audit", "--no-fund"], cwd=work, capture_output=True, text=True)
        if install.returncode != 0:
            skip("npm cannot install @mcap/core: " + install.stderr.strip()[-500:])
        places, drive = shared / "data/gardens_point/day_left", shared / "data/gardens_point/night_right"
        if not places.is_dir():
            call(street, "--out", work / "street", "--frames", 300, "--quiet")
            places, drive = work / "street/reference", work / "street/query"
        pictures = sorted(drive.glob("*.jpg"))
        print(f"{len(pictures)} pictures of {drive.parent.name}")

        bags = {}
        for compression in ("none", "lz4", "zstd"):
            if compression != "none" and not shutil.which(compression):
                skip(f"the command {compression} is not installed")
            bags[compression] = work / f"{compression}.mcap"
            call("node", work / "write.mjs", "pictures", drive, bags[compression], compression)
        bags["db3"] = work / "bag.db3"
        write_db3(bags["db3"], pictures)

        call(seqloop, "describe", "--source", drive, "--out", work / "folder.npy")
        for kind, bag in bags.items():
            call(seqloop, "describe", "--source", bag, "--out", work / "bag.npy")
            expect((work / "bag.npy").read_bytes() == (work / "folder.npy").read_bytes(),
                   f"{kind}: the descriptors are the folder's, byte by byte")
            facts = json.loads(call(seqloop, "bag", "info", bag, "--json"))
            topics = {topic["name"]: topic["messages"] for topic in facts["topics"]}
            expect(topics["/camera/compressed"] == len(pictures) and not facts["notes"],
                   f"{kind}: bag info counts {len(pictures)} pictures")

        def answers(source: pathlib.Path, *more: object) -> list[dict]:
            out = call(seqloop, "run", "--source", source, "--reference", places, *more)
            lines = [json.loads(line) for line in out.splitlines()]
            return [{key: value for key, value in line.items() if key not in NOT_COMPARED} for line in lines]

        loops = work / "loops.mcap"
        of_folder, of_bag = answers(drive), answers(bags["zstd"], "--out-bag", loops)
        expect(of_bag == of_folder, f"run: {len(of_bag)} lines of the bag are the folder's")

        cut = work / "cut.mcap"
        cut.write_bytes(bags["zstd"].read_bytes()[:bags["zstd"].stat().st_size * 2 // 3])
        rows = len(answers(cut))
        expect(len(pictures) // 2 < rows < len(pictures), f"cut off after two thirds: {rows} frames are read")

        written = [json.loads(line) for line in call("node", work / "read.mjs", loops).splitlines()]
        accepted = [answer for line in of_bag for answer in line["answers"] if answer["status"] == "match"]
        expect(len(accepted) > 20 and len(written) == len(accepted),
               f"@mcap/core reads all {len(accepted)} loop closures of ours")
        for message, answer in zip(written, accepted):
            stamp = message["header"]["stamp"]["sec"] * 10 + message["header"]["stamp"]["nanosec"] // 100_000_000
            told = (message["type"], stamp - 17_000_000_000, message["frame"], message["match"], message["relative_pose"])
            wanted = ("seqloop_msgs/msg/LoopClosure", answer["frame"], answer["frame"], answer["match"], [])
            same = told == wanted and abs(message["probability"] - answer["probability"]) < 1e-6
            if not same:
                sys.exit(f"{message} is not {answer}")
        print("their stamps, frames, places and probabilities are those of run's lines")

        encodings = work / "encodings.mcap"
        call("node", work / "write.mjs", "encodings", "-", encodings, "none")
        stills = {}
        for encoding in ("mono8", "mono16", "rgb8", "bgr8", "rgba8", "bgra8"):
            call(seqloop, "stills", "--source", encodings, "--topic", "/" + encoding, "--gray", "--out", work / encoding)
            stills[encoding] = (work / encoding / "000000.png").read_bytes()
        expect(len(set(stills.values())) == 1, f"one picture in {len(stills)} encodings gives one picture")


if __name__ == "__main__":
    main()
