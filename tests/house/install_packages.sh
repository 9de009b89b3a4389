#!/bin/sh
# SPDX-License-Identifier: MIT
# tools/install-packages waits for whoever else installs packages, and fails at once for other
# reasons. No package is touched: what it calls is stood in for.
# Usage: install_packages.sh SOURCE
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/bin"
stand_in() {
  cat >"$work/bin/$1"
  chmod +x "$work/bin/$1"
}
stand_in dpkg-query <<'END'
#!/bin/sh
exit 1
END
stand_in sudo <<'END'
#!/bin/sh
exec "$@"
END
stand_in sleep <<'END'
#!/bin/sh
echo "sleep $*" >>"$CALLS"
END
# Updates fail for the reason in REFUSED until there were UPDATES of them.
stand_in apt-get <<'END'
#!/bin/sh
echo "apt-get $*" >>"$CALLS"
case $* in
  *update*)
    [ "$(grep -c update "$CALLS")" -ge "$UPDATES" ] && exit 0
    echo "$REFUSED" >&2
    exit 100;;
esac
END
# installs UPDATES REFUSED: what was called is in $work/calls, the exit code in $code
installs() {
  : >"$work/calls"
  code=0
  PATH="$work/bin:$PATH" CALLS=$work/calls UPDATES=$1 REFUSED=$2 \
    "$source/tools/install-packages" build >"$work/out" 2>&1 || code=$?
}
check() {
  "$@" || { echo "not so: $*"; cat "$work/calls" "$work/out"; exit 1; }
}
source=$1
lock='E: Could not get lock /var/lib/apt/lists/lock. It is held by process 1 (apt-get)'

installs 1 ''
check [ "$code" = 0 ]
check grep -q '^apt-get .*DPkg::Lock::Timeout=600 .*install .* cmake' "$work/calls"
check [ "$(grep -c sleep "$work/calls")" = 0 ]

installs 3 "$lock"
check [ "$code" = 0 ]
check [ "$(grep -c update "$work/calls")" = 3 ]
check [ "$(grep -c sleep "$work/calls")" = 2 ]
check [ "$(grep -c waiting "$work/out")" = 1 ]

installs 1000 "$lock"
check [ "$code" != 0 ]
check grep -qF "$lock" "$work/out"
check [ "$(grep -c sleep "$work/calls")" = 60 ]

installs 1000 'E: The repository has no Release file.'
check [ "$code" != 0 ]
check grep -q 'Release' "$work/out"
check [ "$(grep -c update "$work/calls")" = 1 ]
check [ "$(grep -c sleep "$work/calls")" = 0 ]
