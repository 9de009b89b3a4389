#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks the pages, and what files of all kinds cite; and that the check can fail.

Usage: pages.py ROOT    exit code 1 and a line a fault

- The top README has at most 150 lines; no line of a page is longer than 120 characters.
- Every relative link leads to a file or folder of the repository, and to a heading of that page.
- `src/README.md, section N` leads to a section that is there.
- Nothing cites documents that a clone does not hold.
"""
import pathlib
import re
import subprocess
import sys
import tempfile

MOST_LINES, MOST_CHARACTERS = 150, 120
# Documents of those who plan the work. A clone has none of them.
FOREIGN = re.compile(r"\b(?:ALGORITHMS|DESIGN|CLI|MEASUREMENTS|PLATFORM|CONFIDENCE|ECOSYSTEM)\.md\b"
                     r"|\bALGORITHMS\b|§")
LINK = re.compile(r"\]\(([^)\s]+)\)")
NUMBER = r"(\d+(?:\.\d+)?)"
BETWEEN = r"[\s/#*]+"  # a comment may go on in the next line
SECTION = re.compile(rf"src/README\.md,?{BETWEEN}sections?{BETWEEN}{NUMBER}(?:(?:{BETWEEN}(?:and|to)|,){BETWEEN}{NUMBER})?")
TEXT = {".md", ".cpp", ".hpp", ".py", ".sh", ".txt", ".cmake", ".toml", ".in", ".json", ".cff", ""}


def anchors(text: str) -> set[str]:
    """The headings of a page, as GitHub links to them."""
    text = re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)
    headings = re.findall(r"^#+ +(.*)$", text, flags=re.M)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def link_faults(page: pathlib.Path, text: str) -> list[str]:
    found = []
    for target in LINK.findall(re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)):
        if re.match(r"[a-z]+:", target):
            continue
        name, _, anchor = target.partition("#")
        file = page.parent / name if name else page
        file = file / "README.md" if file.is_dir() and anchor else file
        if not file.exists():
            found.append(f"links to {target}, which is not there")
        elif anchor and anchor not in anchors(file.read_text(encoding="utf-8")):
            found.append(f"links to {target}, where no heading is called so")
    return found


def page_faults(root: pathlib.Path, page: pathlib.Path, text: str) -> list[str]:
    lines = text.splitlines()
    found = [f"line {number} has {len(line)} characters, {MOST_CHARACTERS} at most"
             for number, line in enumerate(lines, 1) if len(line) > MOST_CHARACTERS]
    if page == root / "README.md" and len(lines) > MOST_LINES:
        found.append(f"has {len(lines)} lines, {MOST_LINES} at most")
    return found + link_faults(page, text)


def sections(root: pathlib.Path) -> set[str]:
    """The numbers of the algorithm's page, those of its decisions too: 4.2 is the second of 4."""
    found, at = set(), None
    file = root / "src/README.md"
    for line in file.read_text(encoding="utf-8").splitlines() if file.exists() else []:
        if heading := re.match(r"#+ (\d+(?:\.\d+)?)\.? ", line):
            at = heading[1]
            found.add(at)
        elif at and (item := re.match(r"(\d+)\. ", line)):
            found.add(f"{at}.{item[1]}")
    return found


def faults(root: pathlib.Path, files: list[str]) -> list[str]:
    found = []
    known = sections(root)
    for name in files:
        path = root / name
        if path.suffix not in TEXT or not path.is_file() or path == pathlib.Path(__file__).resolve():
            continue
        text = path.read_text(encoding="utf-8")
        here = [f"cites {cited}, which a clone does not hold" for cited in FOREIGN.findall(text)]
        here += [f"cites section {number} of src/README.md, which is not there"
                 for numbers in SECTION.findall(text) for number in numbers if number and number not in known]
        if path.suffix == ".md":
            here += page_faults(root, path, text)
        found += [f"{name}: {fault}" for fault in here]
    return found


def prove_that_it_can_fail() -> None:
    pages = {"README.md": "x\n" * 151 + "y" * 121 + "\n[a](gone.md) [b](src/README.md#2-word) "
                          "[c](src/README.md#2-words--things) [d](https://e.f/g)\n```\n[h](gone)\n```\n",
             "src/README.md": "## 2. Words & things\n1. one\n### 2.1 More\n",
             "a.cpp": "// src/README.md, sections 2.1 and 2\n// (src/README.md, sections 2.1\n// and 2.2)\n",
             "b.hpp": "// src/README.md,\n/// section 3. See ALGORITHMS\n",
             "c.py": "# DESIGN.md, § 2\n"}
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name, text in pages.items():
            (root / name).parent.mkdir(exist_ok=True)
            (root / name).write_text(text, encoding="utf-8")
        found = [fault.split(",")[0] for fault in faults(root, list(pages))]
    assert found == ["README.md: line 152 has 121 characters", "README.md: has 156 lines",
                     "README.md: links to gone.md", "README.md: links to src/README.md#2-word",
                     "a.cpp: cites section 2.2 of src/README.md", "b.hpp: cites ALGORITHMS",
                     "b.hpp: cites section 3 of src/README.md", "c.py: cites DESIGN.md",
                     "c.py: cites §"], found


if __name__ == "__main__":
    prove_that_it_can_fail()
    here = pathlib.Path(sys.argv[1]).resolve()
    listed = subprocess.run(["git", "-C", here, "ls-files", "-z"], capture_output=True, text=True, check=True)
    found = faults(here, [name for name in listed.stdout.split("\0") if name])
    print("\n".join(found) if found else "pages hold what they promise")
    sys.exit(1 if found else 0)
