#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The program on ROS 2's wire, with Fast DDS at the other ends.

Usage: ends.py short SEQLOOP STREET FAST_END          some seconds; nothing depends on how fast the machine is
       ends.py long  SEQLOOP STREET FAST_END SHARED [PART...]   npm's decoder, a pose graph, 100 restarts, and
                                                      Gardens Point at 30 frames a second, with real-time
                                                      priority where that is granted: otherwise it needs an
                                                      idle machine. PARTs: decoder pose_graph restarts gardens
Exit code 77 where something is missing; with SEQLOOP_REQUIRE_DATA set, that fails.
"""
import json
import os
import pathlib
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from dds import ros  # noqa: E402
from dds.live_run import (COMPRESSED, SECOND, TOPIC, Run, accepted, drive, expect, frames_of, heard,  # noqa: E402
                          stamp)

HERE = pathlib.Path(__file__).resolve().parent
IMAGE = "sensor_msgs/msg/Image"


def skip(why: str) -> None:
    print(why)
    sys.exit(1 if os.environ.get("SEQLOOP_REQUIRE_DATA") else 77)


def street(program: str, work: pathlib.Path, frames: int) -> tuple[pathlib.Path, list[pathlib.Path]]:
    """A street that is driven along twice. @return the places' folder, and the pictures of the second drive"""
    subprocess.run([program, "--out", work / "street", "--frames", str(frames), "--quiet"], check=True)
    return work / "street/reference", sorted((work / "street/query").glob("*.jpg"))


def places_of_a_map(seqloop: str, drive: pathlib.Path, saved: pathlib.Path) -> int:
    """How many frames of a drive become places: those that show what was not seen just before."""
    subprocess.run([seqloop, "run", "--source", drive, "--map", saved, "--out", os.devnull], check=True,
                   capture_output=True)
    info = subprocess.run([seqloop, "map", "info", saved, "--json"], check=True, capture_output=True, text=True)
    return json.loads(info.stdout)["places"]


def read_closure(message: bytes) -> dict:
    """A LoopClosure, value by value."""
    assert message[:4] == b"\0\1\0\0", message[:4]
    body, at, values = message[4:], 0, []
    for kind in ("i", "I", "s", "i", "I", "Q", "Q", "s", "s", "d", "d", "d", "d", "I"):
        size = 4 if kind == "s" else struct.calcsize(kind)
        at += -at % size
        value = struct.unpack_from("<I" if kind == "s" else "<" + kind, body, at)[0]
        at += size
        if kind == "s":
            at += value
            value = body[at - value:at - 1].decode()
        values.append(value)
    assert len(body) - at < 4, (len(body), at)
    return {"stamp": values[0] * SECOND + values[1], "match_stamp": values[3] * SECOND + values[4],
            "frame": values[5], "match": values[6], "session": values[7], "robot": values[8], "probability": values[9]}


def short(seqloop: str, street_program: str, fast_end: pathlib.Path, work: pathlib.Path) -> None:
    places, pictures = street(street_program, work, 120)
    listeners = {name: ros.Listener(fast_end, name, kind) for name, kind in (
        ("/seqloop/loop_closures", "seqloop_msgs/msg/LoopClosure"),
        ("/seqloop/status", "seqloop_msgs/msg/Status"),
        ("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray"),
        ("/seqloop/matched_pair/compressed", COMPRESSED))}
    run = Run(seqloop, work, "--reference", places, "--ros")
    for listener in listeners.values():
        listener.wait_until_heard()
    publisher, delay = heard(run, fast_end, COMPRESSED)
    sent = 0

    def send(message: bytes) -> None:
        nonlocal sent
        publisher.send(message, delay + sent / 20)
        sent += 1

    for i, picture in enumerate(pictures):
        send(ros.compressed_image(stamp(i, 20), picture.read_bytes()))
    # Sizes that do not fit, sequences larger than the message, and the middle of nowhere.
    whole = ros.compressed_image(stamp(len(pictures), 20), b"\xff\xd8\xff\xe0" + b"x" * 40)
    hostile = [whole, whole[:30], whole[:4] + b"\xff" * 60, whole[:-48] + b"\xff\xff\xff\x7f" + b"y" * 44]
    for message in hostile:
        send(message)
    send(ros.compressed_image(stamp(len(pictures) + 1, 20), pictures[-1].read_bytes()))
    expect(publisher.end() == "", "Fast DDS published all")
    run.wait_until_taken(sent)
    lines = run.end()
    frames, counts = frames_of(lines), run.captured()
    # What came before the first that was taken counts for nothing.
    counted = sent - frames[0]["sequence"]
    expect(counts["grabbed"] == counts["taken"] + counts["dropped"] and counts["grabbed"] + counts["lost"] == counted,
           f"{counted} messages: {counts['taken']} taken, {counts['dropped']} dropped, {counts['lost']} lost")
    bad = [line for line in frames if line["status"] == "frame_error" or "error" in line]
    expect(len(bad) <= len(hostile) and counts["failed"] <= len(hostile), f"{len(bad)} of them hostile")
    loops = [read_closure(message) for message in listeners["/seqloop/loop_closures"].messages()]
    answers = accepted(lines)
    expect([loop["frame"] for loop in loops] == [answer["frame"] for answer in answers]
           and [loop["match"] for loop in loops] == [answer["match"] for answer in answers] and len(loops) > 10,
           f"Fast DDS got all {len(loops)} loop closures")
    wrong = [loop for loop in loops if loop["match_stamp"] != 0 or loop["session"] != ""
             or (loop["stamp"] - ros.START_S * SECOND) % (SECOND // 20) != 0]
    expect(not wrong, "their stamps are the headers', to the nanosecond")
    for name, least in (("/seqloop/status", 3), ("/diagnostics", 3), ("/seqloop/matched_pair/compressed", 1)):
        expect(len(listeners[name].messages()) >= least, f"{name} came too")
    sessions(seqloop, places, pictures[:80], fast_end, work / "sessions")
    begun_again(seqloop, pictures, fast_end, work / "again")
    broken(seqloop, fast_end, work / "broken")
    unheard(seqloop, work / "unheard")


def unheard(seqloop: str, work: pathlib.Path) -> None:
    """What was there stays where a run is interrupted before its first frame."""
    work.mkdir()
    (work / "lines.jsonl").write_text("old")
    run = Run(seqloop, work)
    run.process.send_signal(signal.SIGINT)
    code = run.process.wait()
    expect(code == 1 and "interrupted: nothing has been written" in run.said.read_text()
           and sorted(file.name for file in work.iterdir()) == ["lines.jsonl", "said"]
           and (work / "lines.jsonl").read_text() == "old", "nothing came, and nothing was written")


def broken(seqloop: str, fast_end: pathlib.Path, work: pathlib.Path) -> None:
    """A camera of which no picture can be read has failed, though its frames came."""
    work.mkdir()
    run = Run(seqloop, work)
    publisher, delay = heard(run, fast_end, COMPRESSED)
    for i in range(5):
        publisher.send(ros.compressed_image(stamp(i, 20), b"\xff\xd8\xff\xe0" + b"x" * 40), delay + i / 20)
    expect(publisher.end() == "", "Fast DDS published all")
    run.wait_until(lambda lines: len(frames_of(lines)) >= 3)
    frames = frames_of(run.end(expected=1))
    expect(all(frame["status"] == "frame_error" for frame in frames)
           and "none of its frames could be read" in run.said.read_text(), f"{len(frames)} broken frames, and said so")


def sessions(seqloop: str, places: pathlib.Path, pictures: list[pathlib.Path], fast_end: pathlib.Path,
             work: pathlib.Path) -> None:
    """Loop closures say of which session of a map their places are, and there are pictures of these."""
    work.mkdir()
    begun = subprocess.run([seqloop, "run", "--source", places, "--map", work / "m.seqloop", "--session", "monday",
                            "--out", os.devnull], capture_output=True, text=True)
    if "made without SQLite" in begun.stderr:
        return
    expect(begun.returncode == 0, "a map of one session")
    listener = ros.Listener(fast_end, "/seqloop/loop_closures", "seqloop_msgs/msg/LoopClosure")
    pairs = ros.Listener(fast_end, "/seqloop/matched_pair/compressed", COMPRESSED)
    run = Run(seqloop, work, "--map", work / "m.seqloop", "--session", "tuesday", "--ros", "--decide-by",
              "uniqueness")
    listener.wait_until_heard()
    pairs.wait_until_heard()
    answers = accepted(drive(run, fast_end, pictures))
    loops = [read_closure(message) for message in listener.messages()]
    found = pairs.messages()
    expect(found and all(b"jpeg\0" in pair[:40] and b"\xff\xd8\xff" in pair[:60] for pair in found),
           f"{len(found)} pairs with a place of monday's")
    expect([(loop["frame"], loop["match"], loop["session"]) for loop in loops]
           == [(answer["frame"], answer["match"], answer["session"]) for answer in answers] and loops
           and all(loop["session"] == "monday" for loop in loops), f"{len(loops)} places are monday's")


def begun_again(seqloop: str, pictures: list[pathlib.Path], fast_end: pathlib.Path, work: pathlib.Path) -> None:
    """A simulation that begins again, where the robot comes by what it saw before: places keep their headers' stamps."""
    work.mkdir()
    listener = ros.Listener(fast_end, "/seqloop/loop_closures", "seqloop_msgs/msg/LoopClosure")
    run = Run(seqloop, work, "--ros")
    listener.wait_until_heard()
    publisher, delay = heard(run, fast_end, COMPRESSED)
    stamps = [SECOND + i * SECOND // 20 for i in range(len(pictures))]
    for i, picture in enumerate(2 * pictures):
        message = ros.compressed_image(stamps[i % len(stamps)], picture.read_bytes())
        publisher.send(message, delay + i / 20)
    expect(publisher.end() == "", "Fast DDS published all")
    run.wait_until_taken(2 * len(pictures))
    run.end()
    loops = [read_closure(message) for message in listener.messages()]
    # Of a frame that a busy machine dropped nobody knows the stamp.
    odd = [loop for loop in loops if not {loop["stamp"], loop["match_stamp"]} <= {0, *stamps}]
    known = [loop for loop in loops if loop["stamp"] and loop["match_stamp"]]
    expect(len(known) > 10 and not odd, f"stamps of {len(known)} loops across it are the headers': {odd[:3]}")


def parse_ms(said: str) -> dict:
    """The table of `run`: stage -> (p50, p99, p99.9, max)"""
    return {match[1]: tuple(float(value) for value in match[2].split())
            for match in re.finditer(r"^  (\w+) +((?:[\d.]+ *){4})$", said, re.M)}


def first_of_all() -> tuple:
    """Takes real-time priority for what plays the camera, where that is granted. @return what starts its programs"""
    try:
        # A camera does not wait for a processor either. What is under test takes its own priority.
        os.sched_setscheduler(0, os.SCHED_FIFO | os.SCHED_RESET_ON_FORK, os.sched_param(30))
    except (PermissionError, OSError):
        print("no real-time priority is granted here: a busy machine may drop frames")
        return ()
    return ("chrt", "-f", "30")


def gardens(seqloop: str, fast_end: pathlib.Path, shared: pathlib.Path, work: pathlib.Path) -> None:
    """30 frames a second of 640x480 pictures, raw and compressed: nothing is lost, and the matches are
    those of the same pictures in a folder, and come as soon as those of a recording played at that rate."""
    from PIL import Image
    rate = 30
    folders = {}
    for name in ("day_left", "night_right"):
        for kind in ("png", "jpg"):
            folder = folders[name, kind] = work / f"{name}_{kind}"
            folder.mkdir()
            for file in sorted((shared / "data/gardens_point" / name).glob("*.jpg")):
                Image.open(file).resize((640, 480)).save(folder / f"{file.stem}.{kind}")
    before = first_of_all()
    flags = ("--realtime-priority", 10) if before else ()
    for kind, message_type, reliable in (("png", IMAGE, True), ("jpg", COMPRESSED, True), ("png", IMAGE, False)):
        places, query = folders["day_left", kind], folders["night_right", kind]
        what = f"{message_type.split('/')[-1]}, {'reliable' if reliable else 'best effort'}"
        alone = subprocess.run([seqloop, "run", "--source", query, "--reference", places], check=True,
                               capture_output=True, text=True).stdout
        of_folder = [json.loads(line) for line in alone.splitlines()]
        played = subprocess.run(
            [str(word) for word in (seqloop, "run", "--source", query, "--reference", places, "--pace", "live",
                                    "--fps", rate, "--out", os.devnull, *flags)],
            check=True, capture_output=True, text=True).stderr
        raw = [Image.open(file).convert("RGB").tobytes() if kind == "png" else file.read_bytes()
               for file in sorted(query.iterdir())]
        run = Run(seqloop, work, "--reference", places, *flags)
        publisher, delay = heard(run, fast_end, message_type, reliable, before)
        # Stamped with when they are due, so that their ages are those of a camera's.
        for i, data in enumerate(raw):
            at = publisher.start_ns + int((delay + i / rate) * SECOND)
            publisher.send(ros.image(at, 640, 480, "rgb8", 1920, data) if kind == "png"
                           else ros.compressed_image(at, data), delay + i / rate)
        expect(publisher.end() == "", "Fast DDS published all")
        run.wait_until_taken(len(raw))
        lines, counts = run.end(), run.captured()
        for name, said in (("topic", run.said.read_text()), ("folder at its pace", played)):
            times = parse_ms(said)
            print(f"{what}, {name}: ms p50 p99 p99.9 max: age {times['age']}, stamp to answer {times['answer']}",
                  flush=True)
        expect(counts["taken"] == len(raw) and counts["lost"] == 0 and counts["dropped"] == 0,
               f"{what}: {counts}; all {len(raw)} pictures came, 0 lost, 0 dropped")
        keys = ("frame", "match", "probability", "uniqueness")
        of = [[{key: answer[key] for key in keys} for line in some for answer in line["answers"]]
              for some in (of_folder, lines)]
        expect(of[0] == of[1], f"{what}: the answers are the folder's, {len(accepted(lines))} of them accepted")


def resident_kb(process: subprocess.Popen) -> int:
    return int(re.search(r"VmRSS:\s+(\d+)", pathlib.Path(f"/proc/{process.pid}/status").read_text())[1])


def restarts(seqloop: str, fast_end: pathlib.Path, work: pathlib.Path, pictures: list[pathlib.Path]) -> None:
    """A publisher that is killed and comes again 100 times."""
    run = Run(seqloop, work, "--max-places", 2000)
    resident, pieces = [], 5
    data = pictures[0].read_bytes()
    for i in range(100):
        publisher, delay = heard(run, fast_end, COMPRESSED, i % 2 == 0)
        for k in range(pieces):
            publisher.send(ros.compressed_image(stamp(i * pieces + k, 20), data), delay + k / 20)
        run.wait_until_taken((i + 1) * pieces)
        publisher.kill()
        resident.append(resident_kb(run.process))
    open_files = len(list(pathlib.Path(f"/proc/{run.process.pid}/fd").iterdir()))
    threads = len(list(pathlib.Path(f"/proc/{run.process.pid}/task").iterdir()))
    lines, counts = run.end(), run.captured()
    # Every second one sends nothing again.
    expect(counts["grabbed"] >= 100 * pieces * 0.98,
           f"100 publishers were killed: {counts['grabbed']} of {100 * pieces} messages came, {counts}")
    growth = resident[-1] - resident[19]
    expect(growth < 20_000, f"resident after 20 of them {resident[19]} kB, after 100 {resident[-1]} kB; "
                            f"{open_files} files, {threads} threads")
    expect(frames_of(lines)[-1]["newest"] == counts["taken"] - 1, "frames are counted on")


def decoded(work: pathlib.Path, kind: str, messages: list[bytes]) -> list[dict]:
    sys.path.insert(0, str(HERE.parent / "ros"))
    import types as _  # noqa: F401  the library's, so that ours is loaded by its file
    import importlib.util
    spec = importlib.util.spec_from_file_location("ros_types", HERE.parent / "ros/types.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    root = HERE.parents[1]
    definitions = dict(module.STANDARD)
    for file in (root / "platform/ros/msg").glob("*.msg"):
        definitions[f"seqloop_msgs/msg/{file.stem}"] = file.read_text()
    used: dict = {}
    module.described(kind, definitions, used)
    text = definitions[kind] + "".join(
        f"\n{'=' * 80}\nMSG: {name.replace('/msg/', '/')}\n{definitions[name]}\n" for name in used)
    job = json.dumps({"definition": text, "messages": [message.hex() for message in messages]})
    done = subprocess.run(["node", work / "decode.mjs"], input=job, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"npm's decoder refuses {kind}: {done.stderr}")
    return json.loads(done.stdout)


def decoder(seqloop: str, street_program: str, fast_end: pathlib.Path, work: pathlib.Path) -> None:
    """What Fast DDS gets of us, decoded by npm's @foxglove/rosmsg2-serialization."""
    if not shutil.which("npm") or not shutil.which("node"):
        skip("npm and node are not installed")
    shutil.copy(HERE / "decode.mjs", work)
    shutil.copy(HERE.parent / "bags/ends/package.json", work)
    install = subprocess.run(["npm", "install", "--no-audit", "--no-fund"], cwd=work, capture_output=True, text=True)
    if install.returncode != 0:
        skip("npm cannot install its packages: " + install.stderr.strip()[-500:])
    places, pictures = street(street_program, work, 120)
    kinds = {"/seqloop/loop_closures": "seqloop_msgs/msg/LoopClosure", "/seqloop/status": "seqloop_msgs/msg/Status",
             "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray", "/seqloop/matched_pair/compressed": COMPRESSED}
    listeners = {name: ros.Listener(fast_end, name, kind) for name, kind in kinds.items()}
    run = Run(seqloop, work, "--reference", places, "--ros")
    for listener in listeners.values():
        listener.wait_until_heard()
    answers = accepted(drive(run, fast_end, pictures))
    of = {name: decoded(work, kinds[name], listener.messages()) for name, listener in listeners.items()}
    loops = of["/seqloop/loop_closures"]
    expect([(loop["frame"], loop["match"]) for loop in loops] == [(a["frame"], a["match"]) for a in answers]
           and all(abs(loop["probability"] - a["probability"]) < 1e-6 for loop, a in zip(loops, answers)) and loops,
           f"npm decodes {len(loops)} loop closures, as in run's lines")
    last = of["/seqloop/status"][-1]
    kept = places_of_a_map(seqloop, places, work / "places.seqloop")
    expect(last["matches"] == len(answers) and last["places"] == kept, f"of {kept} places, status: {last}")
    print(json.dumps(of["/diagnostics"][-1]["status"]))
    names = [part["name"] for part in of["/diagnostics"][-1]["status"]]
    expect(names == ["seqloop: camera", "seqloop: loop", "seqloop: map"], "diagnostics of three parts")
    pairs = of["/seqloop/matched_pair/compressed"]
    expect(all(pair["format"] == "jpeg" and pair["data"].startswith("ffd8ff") for pair in pairs) and pairs,
           f"{len(pairs)} matched pairs are JPEG")


def pose_graph(seqloop: str, street_program: str, fast_end: pathlib.Path, work: pathlib.Path) -> None:
    """A live drive along a street, twice, with odometry on a topic, whose publisher comes late."""
    rate, odometry_rate = 20, 50
    places, pictures = street(street_program, work, 120)
    pictures = sorted(places.glob("*.jpg")) + pictures
    graph = work / "graph.g2o"
    run = Run(seqloop, work, "--odometry", "/odom", "--pose-graph", graph, "--exclude", 40,
              "--decide-by", "uniqueness")
    camera, _ = heard(run, fast_end, COMPRESSED)
    odometry = ros.Publisher(fast_end, "/odom", "nav_msgs/msg/Odometry", False)
    odometry.wait_until_heard()
    events = [(i / rate, camera, ros.compressed_image(stamp(i, rate), picture.read_bytes()))
              for i, picture in enumerate(pictures)]
    events += [(i / odometry_rate, odometry, ros.odometry(stamp(i, odometry_rate), i / odometry_rate, 2.0, (0, 0, 0, 1)))
               for i in range(-5, len(pictures) * odometry_rate // rate + 5)]
    for due, publisher, message in sorted(events, key=lambda event: event[0]):
        publisher.send(message, (odometry.start_ns - camera.start_ns) / SECOND * (publisher is camera) + 2.0 + due)
    expect(camera.end() == odometry.end() == "", "Fast DDS published pictures and odometry")
    run.wait_until_taken(len(pictures))
    lines = run.end()
    taken = {line["sequence"] for line in frames_of(lines)}
    rows = [line.split() for line in graph.read_text().splitlines()]
    vertices = {int(row[1]): [float(value) for value in row[2:5]] for row in rows if row[0] == "VERTEX_SE3:QUAT"}
    first = min(taken)
    off = max(abs(place[0] - (number + first) / rate) for number, place in vertices.items())
    expect(len(vertices) == len(taken) and off < 1e-6, f"{len(vertices)} poses, each where the odometry has it")
    edges = [row for row in rows if row[0] == "EDGE_SE3:QUAT"]
    loops = len(edges) - (len(vertices) - 1)
    expect(loops == len(accepted(lines)) > 0, f"{loops} loops")


def main() -> None:
    mode, seqloop, street_program, fast_end = sys.argv[1], sys.argv[2], sys.argv[3], pathlib.Path(sys.argv[4])
    if not fast_end.is_file():
        skip("Fast DDS is not installed (Debian: libfastrtps-dev)")
    print("domain", ros.environment()["ROS_DOMAIN_ID"])
    with tempfile.TemporaryDirectory() as name:
        work = pathlib.Path(name)
        if mode == "short":
            short(seqloop, street_program, fast_end, work)
            return
        shared = pathlib.Path(sys.argv[5])
        parts = sys.argv[6:] or ["decoder", "pose_graph", "restarts", "gardens"]
        if "decoder" in parts:
            (work / "decoder").mkdir()
            decoder(seqloop, street_program, fast_end, work / "decoder")
        if "pose_graph" in parts:
            (work / "pose_graph").mkdir()
            pose_graph(seqloop, street_program, fast_end, work / "pose_graph")
        if "restarts" in parts:
            (work / "restarts").mkdir()
            restarts(seqloop, fast_end, work / "restarts", street(street_program, work / "restarts", 20)[1])
        if "gardens" in parts:
            if not (shared / "data/gardens_point").is_dir():
                skip("Gardens Point is not there")
            gardens(seqloop, fast_end, shared, work)


if __name__ == "__main__":
    main()
