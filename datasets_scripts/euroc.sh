#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Engram authors
# SPDX-License-Identifier: BSD-3-Clause
#
# euroc.sh SEQUENCE OUT: a sequence of EuRoC MAV (Burri et al. 2016) in ASL layout, as OUT/drive.rawlog (stereo pairs, the
# body is the robot) and OUT/truth.csv.
source "$(dirname "$0")/common.sh"
page=https://projects.asl.ethz.ch/datasets/euroc-mav/
[ $# -eq 2 ] || usage "MH_01_easy OUT"
mav=$1/mav0
need "$mav"/cam{0,1}/{data,sensor.yaml} "$mav/state_groundtruth_estimate0/data.csv"
make_folder "$2"
"$rawlog" pack --images "$mav/cam0/data" --right "$mav/cam1/data" --stamps names \
  --camera "$mav/cam0/sensor.yaml,$mav/cam1/sensor.yaml" --out "$2/drive.rawlog" -q
cp "$mav/state_groundtruth_estimate0/data.csv" "$2/truth.csv"
