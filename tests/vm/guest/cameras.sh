# SPDX-License-Identifier: MIT
# All cases in one machine: a boot costs seconds. CASES, if set, names those that are wanted.
here=$(dirname "$0")
failed=0
for name in ${CASES:-}; do
  grep -q "^$name()" "$here"/*.sh || { echo "FAIL $name: there is no such case"; failed=1; }
done
for cases in camera faults loopback; do
  echo "== $cases"
  bash "$here/$cases.sh" || failed=1
done
exit $failed
