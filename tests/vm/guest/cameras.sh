# All cases in one machine: a boot costs seconds.
failed=0
for cases in camera faults loopback; do
  echo "== $cases"
  bash "$(dirname "$0")/$cases.sh" || failed=1
done
exit $failed
