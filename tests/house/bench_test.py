# SPDX-License-Identifier: MIT
"""tools/bench-table and tools/bench-compare on times that are known."""
import json
import pathlib
import subprocess
import sys
import tempfile
import textwrap

TOOLS = pathlib.Path(sys.argv[1]) / "tools"
FAULTS = []


def expect(holds, what):
    if not holds:
        FAULTS.append(what)


def row(what, by, p50):
    return {"what": what, "by": by, "n": 100, "d": 8, "ds": 20, "p50_us": p50, "p99_us": p50, "p999_us": p50,
            "max_us": p50, "rounds": 3, "bytes": 800}


def call(*arguments):
    return subprocess.run([str(part) for part in arguments], capture_output=True, text=True, check=False)


def table(folder):
    def write(name, ours):
        (folder / name).mkdir()
        rows = [row("matrix", "seqloop-int8-with-matches", ours), row("matrix", "openblas-sgemm", 100.0),
                row("column", "seqloop-float", 90.0), row("column", "eigen-gemv", 100.0)]
        (folder / name / "run.json").write_text(json.dumps(rows))
    write("old", 75.0)
    write("new", 150.0)
    run = call(TOOLS / "bench-table", "--was", folder / "old", folder / "new" / "run.json")
    lines = run.stdout.splitlines()
    expect(run.returncode == 0 and any("| 1.00 openblas-sgemm | **missed: 1.50** | 0.75 |" in x for x in lines),
           f"a limit that is missed: {run}")
    expect(any("seqloop-float" in x and "| 1.00 eigen-gemv | kept | 0.90 |" in x for x in lines),
           f"a limit that is kept: {run}")
    expect(call(TOOLS / "bench-table").returncode != 0, "no file is refused")
    expect(call(TOOLS / "bench-table", folder / "none.json").returncode != 0, "a missing file is refused")


def program(folder, name, times):
    """A program whose k-th run says times[k], forever round."""
    path = folder / name
    path.write_text(textwrap.dedent(f"""\
        #!/usr/bin/env python3
        import json, pathlib
        count = pathlib.Path(__file__ + ".count")
        k = int(count.read_text()) if count.exists() else 0
        count.write_text(str(k + 1))
        times = {times!r}
        row = {row("step", "ours", 0.0)!r}
        print(json.dumps([dict(row, p50_us=times[k % len(times)])]))
        """))
    path.chmod(0o755)
    return path


def compare(folder):
    steady = program(folder, "steady", [100.0])
    cases = [("slower", [110.0, 103.0], 1, "slower"), ("faster", [90.0, 97.0], 0, "faster"),
             ("noise", [120.0, 90.0], 0, "-"), ("little", [101.0], 0, "-")]
    for name, times, code, moved in cases:
        run = call(TOOLS / "bench-compare", "--pairs", "5", steady, program(folder, name, times), "--only", "step")
        expect(run.returncode == code and run.stdout.rstrip().endswith(f"| {moved} |"), f"{name}: {run}")
    few = call(TOOLS / "bench-compare", "--pairs", "2", steady, steady)
    expect(few.returncode != 0 and "Usage" in few.stderr, f"too few pairs are refused: {few}")
    expect(call(TOOLS / "bench-compare", steady, "/bin/false").returncode == 1, "a program that fails is told")


with tempfile.TemporaryDirectory() as made:
    table(pathlib.Path(made))
    compare(pathlib.Path(made))
print("\n".join(FAULTS) or "as they should be")
sys.exit(1 if FAULTS else 0)
