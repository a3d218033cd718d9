#!/bin/bash
# clang-format over the C++ of the tree; with --check it changes nothing and fails where something is to be changed.
set -euo pipefail
cd "$(dirname "$0")/.."
mode=-i
[ "${1:-}" = --check ] && mode="--dry-run --Werror"
find include src apps bench tests \( -name '*.h' -o -name '*.cpp' \) -print0 | xargs -0 -n 40 -P "$(nproc)" "${CLANG_FORMAT:-clang-format}" $mode
