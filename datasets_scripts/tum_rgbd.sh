#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Engram authors
# SPDX-License-Identifier: BSD-3-Clause
#
# tum_rgbd.sh SEQUENCE OUT: a sequence of the TUM RGB-D data set (Sturm et al. 2012), its colour images alone, as
# OUT/drive.rawlog, OUT/camera.yaml and OUT/truth.tum. Cameras are those of its page, told by freiburg1 … 3 in the name.
source "$(dirname "$0")/common.sh"
page=https://cvg.cit.tum.de/data/datasets/rgbd-dataset/download
[ $# -eq 2 ] || usage "rgbd_dataset_freiburg1_desk OUT"
need "$1/rgb.txt" "$1/rgb" "$1/groundtruth.txt"
make_folder "$2"
case $(basename "$(realpath "$1")") in
  *freiburg1*) pinhole 517.3 516.5 318.6 255.3 0.2624 -0.9531 -0.0054 0.0026 1.1633 ;;
  *freiburg2*) pinhole 520.9 521.0 325.1 249.7 0.2312 -0.7849 -0.0033 -0.0001 0.9172 ;;
  *freiburg3*) pinhole 535.4 539.2 320.1 247.6 0.0 0.0 0.0 0.0 0.0 ;;
  *) fail "$1: freiburg1, 2 or 3 in the name tells the camera" ;;
esac >"$2/camera.yaml"
# "stamp file" a line to Engram's "image,stamp".
awk 'BEGIN { print "image,stamp" } !/^#/ && NF == 2 { sub(/^rgb\//, "", $2); print $2 "," $1 }' "$1/rgb.txt" >"$2/frames.csv"
same_number "$(find "$1/rgb" -name '*.png' | wc -l)" "$(($(wc -l <"$2/frames.csv") - 1))" "$1/rgb.txt"
"$rawlog" pack --images "$1/rgb" --csv "$2/frames.csv" --stamp-unit s --camera "$2/camera.yaml" --out "$2/drive.rawlog" -q
cp "$1/groundtruth.txt" "$2/truth.tum"
