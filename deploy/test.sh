#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs, builds and runs every test: `bash deploy/test.sh`. What continuous integration runs.
#
#   release   everything, with a virtual screen for the window
#   dev       the core under AddressSanitizer and UndefinedBehaviorSanitizer, every decoder's fuzz corpus included
#   tsan      what is shared between threads, under ThreadSanitizer
#
# FARFIELD_TEST_PRESETS="release dev tsan" chooses among them. The last line says "N passed, N failed"; the exit code
# is 0 only if nothing failed. A test that could not be built counts as failed.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit 1

presets=${FARFIELD_TEST_PRESETS:-release dev tsan}
logs=build/logs
passed=0
failed=0

# The tests that a preset builds and runs, as a regular expression over their names.
tests_of() {
  case $1 in
    release) echo '.' ;;
    dev) echo '^(fuzz_.*|test_unit_common_(base|cells|codec|geometry|image|impostor|math|net|predict|shading|trace)|test_unit_server_(model|schedule|session|store)|test_unit_client_(decode|near_cpu|session|store|warp))$' ;;
    tsan) echo '^(test_unit_server_(schedule|session|store)|test_unit_client_(session|store))$' ;;
    *) echo "test.sh: unknown preset $1: use release, dev or tsan" >&2; return 1 ;;
  esac
}

finish() {
  echo "$passed passed, $failed failed"
  [[ $failed -eq 0 && $passed -gt 0 ]]
  exit
}

# A step that must work before any test of it can run: one failure if it does not.
stop_at() {
  echo "test.sh: $1" >&2
  failed=$((failed + 1))
  finish
}

# build_preset NAME REGEX: the targets of the tests that match; a broken one does not keep the others from being built.
build_preset() {
  local build=build/$1 targets=()
  cmake --preset "$1" || return 1
  if [[ $2 != . ]]; then
    mapfile -t targets < <(ctest --test-dir "$build" -N -R "$2" | sed -n 's/^ *Test *#[0-9]*: *//p')
    [[ ${#targets[@]} -gt 0 ]] || return 1
  fi
  ninja -C "$build" -k 0 "${targets[@]}"
  return 0
}

# run_preset NAME REGEX: runs them and adds up what ctest counted.
run_preset() {
  local log=$logs/$1.log around=()
  if [[ $1 == release ]]; then
    around=(xvfb-run -a -s "-screen 0 1280x1024x24")
  elif setarch -R true 2>/dev/null; then
    # GCC 12's sanitizers do not know the address layouts that newer kernels may choose.
    around=(setarch -R)
  fi
  # ThreadSanitizer cannot see into TBB, which orders the work behind these tests: it would report what is no race.
  if [[ $1 == tsan ]]; then around+=(env "GTEST_FILTER=-SceneGeometry*"); fi
  "${around[@]}" ctest --test-dir "build/$1" -R "$2" --output-on-failure --no-tests=error 2>&1 | tee "$log"
  # "98% tests passed, 1 tests failed out of 52"
  local summary lost total
  summary=$(sed -n 's/^[0-9]*% tests passed, \([0-9]*\) tests failed out of \([0-9]*\)$/\1 \2/p' "$log" | tail -n 1)
  read -r lost total <<<"$summary"
  if [[ -z ${total:-} ]]; then
    echo "test.sh: ctest of preset $1 did not finish" >&2
    failed=$((failed + 1))
    return
  fi
  passed=$((passed + total - lost))
  failed=$((failed + lost))
}

bash deploy/install_packages.sh || stop_at "packages are missing"
mkdir -p "$logs"
for preset in $presets; do
  regex=$(tests_of "$preset") || stop_at "nothing is known about preset $preset"
  echo "== $preset: build ($(date -u +%H:%M:%S))"
  build_preset "$preset" "$regex" || stop_at "preset $preset cannot be configured"
  echo "== $preset: tests ($(date -u +%H:%M:%S))"
  run_preset "$preset" "$regex"
done
finish
