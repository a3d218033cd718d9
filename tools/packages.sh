# The Debian 12 packages that Pelage is built, tested and linted with: the one list, sourced by test.sh and demo.sh.
# `bash tools/packages.sh` prints it; `install_packages LIST…` installs what is missing.

# To build the library and the command.
PELAGE_BUILD_PACKAGES="g++ cmake ninja-build
  libtbb-dev libhwy-dev libfmt-dev libembree-dev libopenexr-dev libpng-dev libjpeg-dev nlohmann-json3-dev libcli11-dev zlib1g-dev"

# To run the tests: test frameworks, lints, the software Vulkan driver that stands in for a GPU, a browser.
PELAGE_TEST_PACKAGES="libgtest-dev libgmock-dev python3 clang-format
  libvulkan-dev glslc mesa-vulkan-drivers vulkan-validationlayers chromium-headless-shell"

# install_packages PACKAGE…: nothing happens, and no right is asked for, where all are there already.
install_packages() {
  local missing=() package root=()
  for package in "$@"; do
    [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return 0
  echo "Installing ${missing[*]}"
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || { echo "Run as root, or install these Debian packages: ${missing[*]}" >&2; return 1; }
    root=(sudo)
  fi
  "${root[@]}" apt-get -q update >/dev/null &&
    "${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq install -y --no-install-recommends "${missing[@]}" >/dev/null
}

if [ "${BASH_SOURCE[0]}" = "$0" ]; then
  echo $PELAGE_BUILD_PACKAGES $PELAGE_TEST_PACKAGES
fi
