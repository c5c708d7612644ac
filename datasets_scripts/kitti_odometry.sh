#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Engram authors
# SPDX-License-Identifier: BSD-3-Clause
#
# kitti_odometry.sh DATASET NUMBER OUT: a sequence of KITTI odometry (Geiger et al. 2012), the grey stereo pairs, as
# OUT/drive.rawlog and, for 00 … 10, OUT/truth.txt (poses of the left camera) with OUT/times.txt.
source "$(dirname "$0")/common.sh"
page=https://www.cvlibs.net/datasets/kitti/eval_odometry.php
[ $# -eq 3 ] || usage "DATASET 00 OUT"
sequence=$1/sequences/$2
need "$sequence/image_0" "$sequence/image_1" "$sequence/times.txt" "$sequence/calib.txt"
make_folder "$3"
same_number "$(find "$sequence/image_0" -name '*.png' | wc -l)" "$(grep -c . "$sequence/times.txt")" "$sequence/times.txt"
"$rawlog" pack --images "$sequence/image_0" --right "$sequence/image_1" --stamps "$sequence/times.txt" --stamp-unit s \
  --camera "$sequence/calib.txt" --out "$3/drive.rawlog" -q
cp "$sequence/times.txt" "$3/times.txt"
[ ! -e "$1/poses/$2.txt" ] || cp "$1/poses/$2.txt" "$3/truth.txt"
