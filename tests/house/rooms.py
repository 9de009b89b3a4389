#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks which room includes what (see the table in CONTRIBUTING.md), and that the check can fail.

Usage: rooms.py ROOT    exit code 1 and a line a fault where a file looks into a room it must not.
"""
import pathlib
import re
import sys
import tempfile

# Of the C++ library, what the algorithm has no business with: files, threads, the terminal.
OUTSIDE = {"fstream", "iostream", "filesystem", "thread", "mutex", "condition_variable", "future",
           "semaphore", "stop_token", "shared_mutex", "random", "csignal"}

# The outside worlds, and our own rooms that none of them may look into.
WORLDS = {"bags", "dds", "files", "http", "linux", "opencv", "ros", "sqlite", "turbojpeg"}
# What ROS 2's messages are as bytes is no world by itself: those that carry them look into it.
BELOW = {"bags": ("ros",), "dds": ("ros",)}
OURS = {"seqloop", "evaluation", "experiment", "program", "python", "street", "synthetic"}

# Rooms of tools/, and the others that each looks into.
TOOLS = {"evaluation": (), "synthetic": (), "program": ("evaluation", "synthetic"),
         "experiment": ("evaluation", "program"), "peer_bench": ("program",),
         "cost": ("program", "synthetic"), "street": (), "python": ("evaluation", "program")}

# Which instructions the processor has, and their names: for kernels alone.
INSTRUCTIONS = {"arm_neon.h", "cpuid.h", "immintrin.h", "sys/auxv.h"}

# All that needs Eigen; the rest of the algorithm is built without it.
EIGENVECTORS = ("src", "principal_components.cpp")

# Libraries, and the outside worlds that they belong to.
LIBRARIES = {"httplib.h": {"http"}, "lz4frame.h": {"bags"}, "opencv2": {"opencv"},
             "sqlite3.h": {"bags", "sqlite"}, "turbojpeg.h": {"turbojpeg"}, "zstd.h": {"bags"}}


def allowed(file: pathlib.PurePath, include: str, quoted: bool) -> bool:
    room = file.parts[0]
    # <seqloop/opencv/…> is the public half of a world, "opencv/…" its private one.
    path = include.split("/")
    world = path[1] if path[0] == "seqloop" and path[1] in WORLDS else path[0]
    library_header = "/" not in include and "." not in include
    if room in ("include", "src"):
        if library_header:
            return not quoted and include not in OUTSIDE
        if room == "src" and world == "kernels" and quoted:
            return True
        if world == "Eigen":
            return file.parts == EIGENVECTORS
        if file.parts[1] == "kernels" and (world == "hwy" or include in INSTRUCTIONS):
            return not quoted
        return world == "seqloop" and quoted
    if room == "platform":
        # A public header reaches public ones only: the others are not installed.
        if "include" in file.parts and quoted and path[0] != "seqloop":
            return False
        if quoted or world in WORLDS or world in OURS:
            return world in ("seqloop", file.parts[1], *BELOW.get(file.parts[1], ()))
        return world not in LIBRARIES or file.parts[1] in LIBRARIES[world]
    if room == "tools" and file.parts[1] in TOOLS and path[0] in TOOLS:
        return path[0] == file.parts[1] or path[0] in TOOLS[file.parts[1]]
    return True


def faults(root: pathlib.Path) -> list[str]:
    found = []
    for room in ("include", "src", "platform", "tools"):
        for path in sorted((root / room).rglob("*.[ch]pp")):
            file = path.relative_to(root)
            for line in path.read_text(encoding="utf-8").splitlines():
                match = re.match(r'\s*#\s*include\s*([<"])([^>"]+)[>"]', line)
                if match and not allowed(file, match[2], match[1] == '"'):
                    found.append(f"{file} must not include {match[2]}")
    return found


def prove_that_it_can_fail() -> None:
    bad = {"include/seqloop/a.hpp": "#include <opencv2/core.hpp>",
           "include/seqloop/b.hpp": "#include <Eigen/Core>",
           "src/c.cpp": "#include <thread>",
           "src/s.cpp": "#include <Eigen/Core>",
           "src/d.cpp": "  #  include <unistd.h>",
           "src/n.cpp": "#include <immintrin.h>",
           "src/kernels/o.cpp": "#include <sys/mman.h>",
           "src/p.cpp": "#include <hwy/highway.h>",
           "include/seqloop/q.hpp": '#include "kernels/blocks.hpp"',
           "src/e.cpp": '#include "seqloop/opencv/dnn_describer.hpp"',
           "platform/opencv/f.cpp": '#include "seqloop/files/npy_file.hpp"',
           "platform/opencv/k.cpp": "#include <seqloop/files/npy_file.hpp>",
           "platform/files/l.cpp": "#include <opencv2/core.hpp>",
           "platform/ros/w.cpp": '#include "bags/mcap_bag.hpp"',
           "platform/bags/y.cpp": "#include <dds/dds.h>",
           "platform/opencv/m.cpp": "#include <turbojpeg.h>",
           "platform/files/g.hpp": '#include "evaluation/csv.hpp"',
           "platform/files/include/seqloop/files/t.hpp": '#include "files/npy_header.hpp"',
           "tools/program/verbs/x.cpp": '#include "experiment/run/runner.hpp"',
           "include/seqloop/u.hpp": '#include "seqloop/linux/camera.hpp"'}
    good = {"platform/bags/z.cpp": '#include "ros/cdr.hpp"',
            "src/principal_components.cpp": "#include <Eigen/Core>",
            "src/h.cpp": '#include <vector>\n#include "seqloop/frame.hpp"',
            "src/kernels/r.cpp": '#include <immintrin.h>\n#include <hwy/highway.h>\n'
                                 '#include "kernels/blocks.hpp"',
            "platform/opencv/include/seqloop/opencv/v.hpp": '#include "seqloop/opencv/w.hpp"\n'
                                                            '#include "seqloop/frame.hpp"',
            "platform/opencv/i.cpp": '#include <opencv2/core.hpp>\n#include "opencv/detail/j.hpp"'}
    with tempfile.TemporaryDirectory() as folder:
        for name, text in {**bad, **good}.items():
            path = pathlib.Path(folder, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        found = [fault.split()[0] for fault in faults(pathlib.Path(folder))]
        assert sorted(found) == sorted(bad), found


if __name__ == "__main__":
    prove_that_it_can_fail()
    found = faults(pathlib.Path(sys.argv[1]))
    print("\n".join(found) if found else "every room keeps to itself")
    sys.exit(1 if found else 0)
