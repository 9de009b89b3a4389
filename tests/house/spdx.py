#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks that every source, script and CMake file names its licence in its first line, or in its
second after a #! line; and that the check can fail.

Usage: spdx.py ROOT          exit code 1 and a line a fault
       spdx.py --add ROOT    writes the line where it is missing
"""
import pathlib
import subprocess
import sys
import tempfile

TAG = "SPDX-License-Identifier: MIT"
SLASHES = {".cpp", ".hpp"}
HASHES = {".py", ".sh", ".cmake"}


def comment(path: pathlib.Path, text: str) -> str | None:
    """How the file's comments begin; none where it needs no line."""
    if path.suffix in SLASHES:
        return "//"
    names_cmake = path.name == "CMakeLists.txt" or path.name.endswith(".cmake.in")
    return "#" if names_cmake or path.suffix in HASHES or text.startswith("#!") else None


def missing(root: pathlib.Path, names: list[str]) -> list[tuple[pathlib.Path, str]]:
    """The files without the line, and the line."""
    found = []
    for name in names:
        path = root / name
        if not path.is_file():
            continue
        text = path.read_text(encoding="utf-8", errors="replace")
        mark = comment(path, text)
        lines = text.splitlines()[1:] if text.startswith("#!") else text.splitlines()
        if mark and lines[:1] != [f"{mark} {TAG}"]:
            found.append((path, f"{mark} {TAG}"))
    return found


def add(path: pathlib.Path, line: str) -> None:
    lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    lines.insert(1 if lines and lines[0].startswith("#!") else 0, line + "\n")
    path.write_text("".join(lines), encoding="utf-8")


def prove_that_it_can_fail() -> None:
    bad = {"a.cpp": "int a;\n", "b.hpp": "// Words\n", "c": "#!/bin/sh\ntrue\n", "CMakeLists.txt": "",
           "d.py": f"// {TAG}\n", "e.hpp": f"\n// {TAG}\n"}
    good = {"f.cpp": f"// {TAG}\n", "g": f"#!/bin/sh\n# {TAG}\n", "h.txt": "text\n", "i.cmake": f"# {TAG}\n"}
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name, text in {**bad, **good}.items():
            (root / name).write_text(text, encoding="utf-8")
        found = missing(root, list({**bad, **good}))
        assert [path.name for path, _ in found] == list(bad), found
        for path, line in found:
            add(path, line)
        assert not missing(root, list(bad))


if __name__ == "__main__":
    prove_that_it_can_fail()
    *adding, at = sys.argv[1:]
    files = subprocess.run(["git", "-C", at, "ls-files", "-z"], capture_output=True, text=True, check=True)
    found = missing(pathlib.Path(at), files.stdout.split("\0"))
    for path, line in found:
        if adding == ["--add"]:
            add(path, line)
        else:
            print(f"{path}: does not begin with: {line}")
    sys.exit(1 if found and not adding else 0)
