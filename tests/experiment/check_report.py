#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks a report's folder: well-formed XML, nothing from outside, labels apart and inside.

Usage: check_report.py FOLDER    exit code 1 and a line a fault where there is one.
"""
import pathlib
import sys
import xml.etree.ElementTree as ElementTree

SVG = "{http://www.w3.org/2000/svg}"
HTML = "{http://www.w3.org/1999/xhtml}"


def panel_faults(group, width: float, height: float) -> list[str]:
    """Of texts that begin at one x, as the names of lines do, and of everything that is drawn."""
    found = []
    rows: dict[tuple[str, str], list[float]] = {}
    for text in group.iter(SVG + "text"):
        x, y = float(text.get("x")), float(text.get("y"))
        if not (0 <= x <= width and 0 <= y <= height):
            found.append(f"'{text.text}' is outside at {x}, {y}")
        if text.get("class") == "name":
            rows.setdefault((text.get("class"), text.get("x")), []).append(y)
    for ys in rows.values():
        ys.sort()
        found += [f"names overlap at y {b}" for a, b in zip(ys, ys[1:]) if b - a < 14]
    return found


def svg_faults(svg) -> list[str]:
    _, _, width, height = map(float, svg.get("viewBox").split())
    groups = [g for g in svg.findall(SVG + "g") if g.get("transform")] or [svg]
    found = [] if svg.get("aria-label") else ["a picture without words"]
    for group in groups:
        found += panel_faults(group, width, height)
    return found


def page_faults(page) -> list[str]:
    found = [f"a <{tag}>" for tag in ("script", "link", "iframe") for _ in page.iter(HTML + tag)]
    for element in page.iter():
        source = element.get("src", "")
        if source and not source.startswith("data:"):
            found.append(f"needs {source}")
        if element.tag == HTML + "img" and not element.get("alt"):
            found.append("a picture without words")
        if element.tag == HTML + "table":
            found += table_faults(element)
    for svg in page.iter(SVG + "svg"):
        found += svg_faults(svg)
    return found


def table_faults(table) -> list[str]:
    """Rows that have another number of columns than the first, spans counted."""
    found = [] if table.find(HTML + "caption") is not None else ["a table without a caption"]
    open_rows: list[tuple[int, int]] = []  # rows left, columns
    widths = set()
    for row in table.iter(HTML + "tr"):
        open_rows = [(left - 1, width) for left, width in open_rows if left > 1]
        width = sum(columns for _, columns in open_rows)
        for cell in row:
            columns, rows = int(cell.get("colspan", 1)), int(cell.get("rowspan", 1))
            width += columns
            open_rows.append((rows, columns))
        widths.add(width)
    return found + ([] if len(widths) <= 1 else [f"rows of {sorted(widths)} columns"])


def main(folder: pathlib.Path) -> int:
    paths = sorted(folder.glob("*.svg")) + sorted(folder.glob("*.html"))
    found = [] if paths else [f"{folder}: no report is there"]
    for path in paths:
        try:
            root = ElementTree.fromstring(path.read_bytes())
        except ElementTree.ParseError as error:
            found.append(f"{path.name}: {error}")
            continue
        faults = svg_faults(root) if path.suffix == ".svg" else page_faults(root)
        found += [f"{path.name}: {fault}" for fault in faults]
    print("\n".join(found) if found else "no faults")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1])))
