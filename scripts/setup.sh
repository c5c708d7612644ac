# SPDX-FileCopyrightText: 2026 The Engram authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Sourced by demo.sh and test.sh: installs what is missing and builds. Debian 12 and 13 (the packages have the same names), as
# root or with sudo.

ENGRAM_PACKAGES=(
  build-essential cmake ninja-build ccache pkg-config git
  libmrpt-dev mrpt-common libopencv-dev libeigen3-dev libceres-dev libsqlite3-dev zlib1g-dev libdeflate-dev libzstd-dev liblz4-dev libbz2-dev libjpeg-dev
  libcli11-dev nlohmann-json3-dev libgtest-dev libgmock-dev libbenchmark-dev libdlib-dev
  libpqxx-dev libmosquitto-dev
  libaravis-dev libusb-1.0-0-dev aravis-tools libglfw3-dev xvfb help2man python3
)
# Servers that tests start for themselves; the demonstration needs none.
ENGRAM_TEST_PACKAGES=(postgresql mosquitto)

# engram_install_packages [PACKAGE …]: those that all need, and these.
engram_install_packages() {
  local missing=() package
  for package in "${ENGRAM_PACKAGES[@]}" "$@"; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || { echo "Not root and no sudo; install by hand: ${missing[*]}" >&2; return 1; }
    as_root=(sudo)
  fi
  echo "Installing ${#missing[@]} packages: ${missing[*]}"
  "${as_root[@]}" apt-get update -qq
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends \
    "${missing[@]}" >/dev/null
}

# engram_build PRESET [TARGET …]: configures and builds; extra CMake options in ENGRAM_CMAKE_OPTIONS.
engram_build() {
  local preset=$1
  shift
  # shellcheck disable=SC2086
  cmake --preset "$preset" ${ENGRAM_CMAKE_OPTIONS:-} >"build-$preset.log" 2>&1 ||
    { cat "build-$preset.log"; echo "CMake failed; its output is above." >&2; return 1; }
  rm -f "build-$preset.log"
  if [ $# -gt 0 ]; then cmake --build --preset "$preset" --target "$@"; else cmake --build --preset "$preset"; fi
}
