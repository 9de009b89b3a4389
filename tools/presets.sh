# SPDX-License-Identifier: MIT
# For tools/test and tools/check: builds presets and runs their tests, both cores at work.

# Paths inside the checkout do not count, so that a fresh clone finds what another one compiled. The
# sloppiness is what ccache asks for where headers are precompiled.
export CMAKE_CXX_COMPILER_LAUNCHER=ccache CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1
export CCACHE_SLOPPINESS=pch_defines,time_macros
jobs=$(nproc)

# build PRESET [TARGET...]
build() {
  local preset=$1
  shift
  echo "== build $preset"
  cmake --preset "$preset" >/dev/null || return 1
  if ! cmake --build --preset "$preset" --parallel "$jobs" ${1:+--target "$@"} >"build/$preset.log"; then
    cat "build/$preset.log"
    return 1
  fi
}

# run_tests PRESET [CTEST'S ARGUMENTS...]: one more at once than there are processors, because some wait
run_tests() {
  local preset=$1
  shift
  echo "== test $preset $*"
  # Labels go by names: of two tests called alike, both would have those of either.
  local twice
  twice=$(ctest --test-dir "build/$preset" --show-only | sed -n 's/^ *Test *#[0-9]*: //p' | sort | uniq -d)
  if [ -n "$twice" ]; then
    printf 'tests called alike: name one of each otherwise, in tests/CMakeLists.txt\n%s\n' "$twice"
    return 1
  fi
  ctest --test-dir "build/$preset" --parallel $((jobs + 1)) --output-on-failure --no-tests=error "$@" \
    >"build/$preset-tests.log" || { cat "build/$preset-tests.log"; return 1; }
  # Skipped tests say why in the log.
  grep -A99 '^100% tests passed\|^The following tests did not run' "build/$preset-tests.log"
  # Of those in suites ctest knows nothing.
  grep -a '^\[  SKIPPED \] .* ms)$' "build/$preset/Testing/Temporary/LastTest.log" |
    grep -vFf <(sed -n 's/^\t.* - \([^ ]*\) .*(Skipped)$/\1/p' "build/$preset-tests.log") || true
}
