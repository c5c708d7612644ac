#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Engram authors
# SPDX-License-Identifier: BSD-3-Clause
#
# seven_scenes.sh SEQUENCE OUT: a sequence of 7-Scenes (Shotton et al. 2013), its colour images, as OUT/drive.rawlog,
# OUT/camera.yaml and OUT/truth.txt with OUT/times.txt (its 4x4 matrices as lines of KITTI). It has no stamps: images are
# taken to be a thirtieth of a second apart, and the camera to be that of its page (585, 585, 320, 240).
source "$(dirname "$0")/common.sh"
page=https://www.microsoft.com/en-us/research/project/rgb-d-dataset-7-scenes/
[ $# -eq 2 ] || usage "chess/seq-01 OUT"
need "$1/frame-000000.color.png" "$1/frame-000000.pose.txt"
make_folder "$2"
pinhole 585.0 585.0 320.0 240.0 0.0 0.0 0.0 0.0 0.0 >"$2/camera.yaml"
echo "image,stamp" >"$2/frames.csv"
n=0
for image in "$1"/frame-*.color.png; do
  need "${image%.color.png}.pose.txt"
  stamp=$(awk -v n=$n 'BEGIN { printf "%.6f", n / 30 }')
  echo "$(basename "$image"),$stamp" >>"$2/frames.csv"
  echo "$stamp" >>"$2/times.txt"
  # The first three rows in one line.
  head -n 3 "${image%.color.png}.pose.txt" | tr -s '\t\r\n ' ' ' | sed 's/^ //; s/ $/\n/' >>"$2/truth.txt"
  n=$((n + 1))
done
same_number "$n" "$(grep -c . "$2/truth.txt")" "$1"
"$rawlog" pack --images "$1" --csv "$2/frames.csv" --stamp-unit s --camera "$2/camera.yaml" --out "$2/drive.rawlog" -q
