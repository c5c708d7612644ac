# SPDX-FileCopyrightText: 2026 The Engram authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Sourced by the scripts of this folder. The license of a data set is that of its authors: each script names their page,
# and converts what was downloaded and unpacked there.
set -euo pipefail

fail() { echo "$(basename "$0"): $*" >&2; exit 1; }
usage() { echo "Usage: $(basename "$0") $1" >&2; exit 2; }

# need FILE …: ends with what is missing and where to get it ($page).
need() {
  local file
  for file; do [ -e "$file" ] || fail "$file: is missing. Unpack the data set first: $page"; done
}

# make_folder OUT: for the results; nothing is overwritten.
make_folder() {
  [ ! -e "$1" ] || fail "$1: exists already; choose another name"
  mkdir -p "$1"
}

# same_number A B WHAT: verifies that a list has a line for every image.
same_number() { [ "$1" -eq "$2" ] || fail "$3: $1 images, but $2 lines; is the download whole?"; }

# pinhole FX FY CX CY K1 K2 P1 P2 K3 >FILE.yaml: of images of 640x480.
pinhole() {
  cat <<YAML
image_width: 640
image_height: 480
camera_matrix: { rows: 3, cols: 3, data: [$1, 0.0, $3, 0.0, $2, $4, 0.0, 0.0, 1.0] }
distortion_model: plumb_bob
distortion_coefficients: { rows: 1, cols: 5, data: [$5, $6, $7, $8, $9] }
YAML
}

rawlog=${ENGRAM_RAWLOG:-engram-rawlog}
