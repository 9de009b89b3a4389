#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Loops with other robots are in all that a run has to say: lines, bag, ROS 2, the browser's page, the summary.

Usage: fleet_outputs.py SEQLOOP FAST_END
"""
import http.client
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import time
import urllib.request

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from dds import ros  # noqa: E402
from dds.ends import read_closure  # noqa: E402
from dds.fleet import RATE, Robot, drive, expect, loops, way  # noqa: E402

FRAMES = 500


def ask(url: str) -> dict:
    with urllib.request.urlopen(url, timeout=5) as reply:
        return json.load(reply)


def main(seqloop: str, fast_end: str, work: pathlib.Path) -> None:
    seen = way(FRAMES)
    anna = Robot(seqloop, work, "anna", drive(work, "anna", seen, 1), "anna.seqloop")
    time.sleep(1.0)
    (work / "o.tum").write_text("".join(f"{n / RATE} {n} 0 0 0 0 0 1\n" for n in range(FRAMES + 1)))
    listener = ros.Listener(pathlib.Path(fast_end), "/seqloop/loop_closures", "seqloop_msgs/msg/LoopClosure")
    bert = Robot(seqloop, work, "bert", drive(work, "bert", seen, 2), "bert.seqloop", "--ros", "--serve", "127.0.0.1:0",
                 "--out-bag", work / "loops.mcap", "--odometry", work / "o.tum", "--pose-graph", work / "g.g2o")
    page, served = "", {}
    while bert.process.poll() is None:
        time.sleep(0.1)
        found = re.search(r"serving on (http://\S+)", bert.said.read_text())
        page = found[1] if found else ""
        try:
            if page and ask(page + "/api/loops")["count"] > 0:
                served = {"loops": ask(page + "/api/loops")["loops"], "status": ask(page + "/api/status")}
        except (OSError, http.client.HTTPException):
            break  # the run has ended meanwhile
    lines = bert.end()
    anna.end()
    words = bert.said.read_text()
    answers = loops(lines, "anna")
    expect(len(answers) > 100, f"bert finds loops with anna: {len(answers)}")
    wanted = sorted((answer["frame"], answer["session_frame"], answer["session"], "anna") for answer in answers)

    told = [read_closure(message) for message in listener.messages()]
    of_anna = sorted((one["frame"], one["match"], one["session"], one["robot"]) for one in told if one["robot"])
    # The first may have come before the listener was found.
    expect(set(of_anna) <= set(wanted) and len(of_anna) > 0.5 * len(wanted),
           f"ROS 2 hears of them, by robot and session: {len(of_anna)}")
    expect(all(one["match_stamp"] == 0 for one in told if one["robot"]), "not when anna was there: nobody knows")
    bag = json.loads(subprocess.run([seqloop, "bag", "info", work / "loops.mcap", "--json"], check=True,
                                    capture_output=True, text=True).stdout)
    own = sum(answer["status"] == "match" for line in lines for answer in line["answers"])
    expect(bag["topics"][0]["messages"] == len(answers) + own, "so has the bag")
    if page:
        expect(served["status"]["fleet"]["places"] > 0 and served["status"]["fleet"]["loops"] > 0,
               f"the page counts them: {served['status']['fleet']}")
        named = [loop for loop in served["loops"] if loop.get("robot") == "anna"]
        expect(named and all((loop["frame"], loop["match"], loop["session"], "anna") in wanted for loop in named),
               f"and names their robot: {len(named)}")
    graph = (work / "g.g2o").read_text()
    edges = [line.split()[1:3] for line in graph.splitlines() if line.startswith("EDGE")]
    frames = sum(line["newest"] is not None for line in lines)
    expect(len(edges) == frames - 1 + own and f"{len(answers)} loops with places of other robots are left out" in words,
           "the pose graph has none, and it is said")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        main(sys.argv[1], sys.argv[2], pathlib.Path(folder))
