#!/bin/bash
# Line coverage of src/ by the whole test suite; fails below the percentage given (default 85).
# The report by line is build/coverage/report/index.html.
set -euo pipefail
cd "$(dirname "$0")/.."
. tools/packages.sh
install_packages $PELAGE_BUILD_PACKAGES $PELAGE_TEST_PACKAGES gcovr

cmake --preset coverage
cmake --build --preset coverage
find build/coverage -name '*.gcda' -delete
ctest --preset coverage -E '^(lint|install)'
mkdir -p build/coverage/report
gcovr --root . --filter 'src/' --filter 'include/' --exclude '.*_test\.cpp' --exclude-throw-branches -j "$(nproc)" \
  --html-details build/coverage/report/index.html --fail-under-line "${1:-85}" --print-summary build/coverage
