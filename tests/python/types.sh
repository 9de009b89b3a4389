#!/bin/sh
# SPDX-License-Identifier: MIT
# mypy --strict is content with the package and with code that uses it, and finds a mistake in it.
# Usage: types.sh SOURCE PYTHON    exit code 77 where mypy is missing
set -eu
source=$1 python=$2
command -v mypy >/dev/null || { echo "not installed: mypy"; [ -z "${SEQLOOP_REQUIRE_DATA:-}" ] && exit 77; exit 1; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cat >"$work/good.py" <<'END'
import numpy
import seqloop

describer = seqloop.Describer(model="net.onnx", input_size=(320, 180))
drive = describer.describe_drive("drive")
matches = seqloop.match(None, drive, ds=20, full_map="thin", standardise=False)
where: list[int] = matches.match[matches.accepted].tolist()
places = seqloop.PlaceMap(max_places=100, descriptor_size=describer.size, close_loops=True, patience=30)
detector = seqloop.Detector(places)
for answer in detector.step(drive[0]).answers + detector.finish():
    if answer.gate == "match" and answer.match is not None:
        print(answer.match.place + 1, answer.probability)
measures = seqloop.evaluate(matches, numpy.array([[1, 2]]), tolerance=2)
with seqloop.PlaceMap.open("map.seqloop", describer.size, describer=describer.fingerprint, read_only=True,
                           ds=20) as lasting:
    session, frame = lasting.where(3)
    print(session.upper(), None if frame is None else frame + 1, lasting.saved + 1)
    seqloop.Detector(lasting).step(drive[0], time_s=1.5)
print(seqloop.map_info("map.seqloop").sessions[0].began_ns + seqloop.merge_maps(["a", "b"], "c")[1])
print(seqloop.__version__.upper(), measures.recall.hex(), seqloop.differences(drive, drive).shape)
END
cat >"$work/bad.py" <<'END'
import numpy
import seqloop

detector = seqloop.Detector(seqloop.PlaceMap(9, 4))
wrong = numpy.zeros(4, numpy.float64)
detector.step(wrong)
report = detector.step(None)
report.gate == "matched"
report.answers[0].match.place
seqloop.map_info("map.seqloop").sessions[0].places = 3
END
# The page's examples and those of help(seqloop), each as one program, with what they take as given.
given='import numpy
from numpy.typing import NDArray
truth: NDArray[numpy.int64]'
{
  printf '%s\ncamera: list[tuple[NDArray[numpy.uint8], float]]\n' "$given"
  sed -n '/^```python/,/^```/{/^```/!p}' "$source/tools/python/README.md"
} >"$work/page.py"
{
  printf '%s\ncamera: list[NDArray[numpy.uint8]]\n' "$given"
  "$python" -c 'import ast, sys
print(ast.get_docstring(ast.parse(open(sys.argv[1]).read())))' "$source/tools/python/seqloop/__init__.py" |
    sed -n 's/^    //p; s/^$//p'
} >"$work/help.py"
for example in page help; do
  grep -q '^ *tell(detector.finish())' "$work/$example.py" || { echo "$example: what finish() gives is lost"; exit 1; }
done
MYPYPATH=$source/tools/python mypy --strict --python-executable "$python" --cache-dir "$work/cache" \
  "$source/tools/python/seqloop" "$work/good.py" "$work/page.py" "$work/help.py"
if MYPYPATH=$source/tools/python mypy --strict --python-executable "$python" --cache-dir "$work/cache" \
  "$work/bad.py" >"$work/found"; then
  echo "mypy found nothing wrong"
  exit 1
fi
cat "$work/found"
[ "$(grep -c 'error:' "$work/found")" = 4 ]
