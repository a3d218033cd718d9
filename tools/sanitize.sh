#!/bin/bash
# The whole test suite under the sanitizers: `tools/sanitize.sh [asan|tsan] [ctest arguments]`; both without a name.
set -euo pipefail
cd "$(dirname "$0")/.."
. tools/packages.sh
install_packages $PELAGE_BUILD_PACKAGES $PELAGE_TEST_PACKAGES

presets=(asan tsan)
case "${1:-}" in asan | tsan) presets=("$1") && shift ;; esac
export ASAN_OPTIONS=detect_stack_use_after_return=1:strict_string_checks=1
export UBSAN_OPTIONS=print_stacktrace=1
export TSAN_OPTIONS="halt_on_error=1 second_deadlock_stack=1 suppressions=$PWD/tools/tsan.supp"
for preset in "${presets[@]}"; do
  cmake --preset "$preset"
  cmake --build --preset "$preset"
  ctest --preset "$preset" -E '^lint' "$@"
done
