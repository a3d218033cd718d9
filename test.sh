#!/bin/bash
# Proves Pelage on this machine: installs what is missing (Debian 12 package names), builds, runs every test.
# Arguments go on to ctest, e.g. `./test.sh -R raster`.
set -euo pipefail
cd "$(dirname "$0")"
. tools/packages.sh
install_packages $PELAGE_BUILD_PACKAGES $PELAGE_TEST_PACKAGES

cmake --preset release
cmake --build --preset release
exec ctest --preset release "$@"
