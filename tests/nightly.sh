#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The whole list of tests, the slow ones too, in two builds that are too slow for every day: under AddressSanitizer and
# UndefinedBehaviorSanitizer, and without CHOLMOD (KLU2).  Once a week.  On two cores with ten processes for them the tests that are
# not slow took 45 minutes without CHOLMOD, the slow ones another hour; sanitizers take twice to ten times as long.
#
#     tests/nightly.sh [--jobs N] [--build-only] [sanitize|klu2]... [-- ctest's arguments]
#
# Logs are build/<name>/nightly.log.  Exit status 1 if a build or a test fails.
set -euo pipefail
cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.."

jobs=1
names=()
build_only=0
while (($#)); do
  case $1 in
    --jobs) jobs=${2:?--jobs needs a number}; shift 2 ;;
    --build-only) build_only=1; shift ;;
    sanitize|klu2) names+=("$1"); shift ;;
    --) shift; break ;;
    *) sed -n '3,9s/^# \?//p' "$0" >&2; exit 1 ;;
  esac
done
((${#names[@]})) || names=(sanitize klu2)
[[ ! -x build/venv/bin/python ]] || export PATH=$PWD/build/venv/bin:$PATH

# Programs of both take longer, so do the limits of their tests (of sanitizers: in the preset).
run_one() {
  local name=$1 build=build/$1
  shift
  case $name in
    sanitize) cmake --preset sanitize ;;
    klu2) cmake --preset release -B "$build" -DHAPTOS_CHOLMOD=OFF -DHAPTOS_PRECOMPILE=OFF -DCMAKE_UNITY_BUILD=OFF -DHAPTOS_TIMEOUT_SCALE=4 ;;
  esac
  nice -n 19 cmake --build "$build" --parallel "$jobs"
  ((build_only)) || nice -n 19 ctest --test-dir "$build" -j "$jobs" --output-on-failure --no-tests=error "$@"
}

failed=()
for name in "${names[@]}"; do
  mkdir -p "build/$name"
  # The shell forgets -e in a condition, so the run is a process of its own.
  status=0
  export -f run_one
  export jobs build_only
  bash -euo pipefail -c 'run_one "$@"' run_one "$name" "$@" >"build/$name/nightly.log" 2>&1 || status=$?
  echo "$name: $( ((status == 0)) && echo "all passed" || echo "FAILED ($status)"), see build/$name/nightly.log"
  sed -n '/tests passed, .* failed out of/,$p' "build/$name/nightly.log"
  ((status == 0)) || failed+=("$name")
done
((${#failed[@]} == 0))
