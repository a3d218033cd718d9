#!/bin/bash
# Renders the golden images anew (or the one named) and says which changed. Look at them before you commit.
set -euo pipefail
cd "$(dirname "$0")/.."
cmake --build --preset release --target golden_test
PELAGE_UPDATE_GOLDEN=${1:-} build/release/tests/golden/golden_test --gtest_filter="*LooksAsBlessed*" --gtest_brief=1
git status --short tests/golden
