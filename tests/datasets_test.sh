#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Engram authors
# SPDX-License-Identifier: BSD-3-Clause
#
# datasets_test.sh SOURCES BIN: the scripts of datasets_scripts/ on miniatures in the layouts of the data sets; what they
# write is read by the programs.
set -euo pipefail
scripts=$1/datasets_scripts bin=$2
export ENGRAM_RAWLOG=$bin/engram-rawlog
work=$(mktemp -d)
trap "rm -rf $work" EXIT
cd "$work"
fail() { echo "$*"; exit 1; }

# image FILE WIDTH HEIGHT: grey noise; readers go by what is in a file, not by its name.
image() { mkdir -p "$(dirname "$1")"; { printf 'P5\n%d %d\n255\n' "$2" "$3"; head -c "$(($2 * $3))" /dev/urandom; } >"$1"; }
# holds NAME IMAGES PATTERN …: the rawlog has that many images, and info says so.
holds() {
  local name=$1 n=$2 text
  shift 2
  text=$("$ENGRAM_RAWLOG" info -q "$name/drive.rawlog" 2>&1) || true  # eyes that see noise are not in order
  grep -q "images: $n, $1" <<<"$text" || fail "$name: $text"
}
# fits NAME TRUTH: the programs take it for a truth of this drive.
fits() {
  "$bin/engram-slam" fsh_mono --rawlog "$1/drive.rawlog" --truth "$1/$2" --map "$1/map.engram" --json "$1/run.json" -q \
    2>said || fail "$1: $(cat said)"
  grep -q '"ate_m"' "$1/run.json" || fail "$1: no poses in $2"
}

# TUM RGB-D
tum=rgbd_dataset_freiburg1_mini
for s in 1305031102.175304 1305031102.211214 1305031102.243211; do
  image "$tum/rgb/$s.png" 640 480
  echo "$s rgb/$s.png" >>"$tum/lines"
  echo "$s 1.3563 0.6305 1.6380 0.6132 0.5962 -0.3311 -0.3986" >>"$tum/poses"
done
{ printf '# color images\n# file\n# timestamp filename\n'; cat "$tum/lines"; } >"$tum/rgb.txt"
{ printf '# ground truth trajectory\n# timestamp tx ty tz qx qy qz qw\n'; cat "$tum/poses"; } >"$tum/groundtruth.txt"
"$scripts/tum_rgbd.sh" "$tum" tum >/dev/null
holds tum 3 640x480
fits tum truth.tum
! "$scripts/tum_rgbd.sh" "$tum" tum 2>said || fail "tum_rgbd.sh overwrites"
grep -q "exists already" said || fail "$(cat said)"
rm "$tum/rgb/1305031102.243211.png"
! "$scripts/tum_rgbd.sh" "$tum" again 2>said || fail "tum_rgbd.sh takes half a download"
grep -q "2 images, but 3 lines" said || fail "$(cat said)"

# KITTI odometry
for i in 0 1 2; do
  for eye in 0 1; do image "kitti_set/sequences/00/image_$eye/00000$i.png" 64 48; done
  echo "$i.0e-01" >>kitti_set/sequences/00/times.txt
  mkdir -p kitti_set/poses
  echo "1 0 0 0 0 1 0 0 0 0 1 $i" >>kitti_set/poses/00.txt
done
printf 'P0: 40 0 32 0 0 40 24 0 0 0 1 0\nP1: 40 0 32 -20 0 40 24 0 0 0 1 0\n' >kitti_set/sequences/00/calib.txt
"$scripts/kitti_odometry.sh" kitti_set 00 kitti >/dev/null
holds kitti 3 "64x48, stereo"
fits kitti truth.txt

# EuRoC
for eye in 0 1; do
  for s in 1403636579763555584 1403636579813555456 1403636579863555584; do
    image "euroc_set/mav0/cam$eye/data/$s.png" 752 480
  done
  cat >"euroc_set/mav0/cam$eye/sensor.yaml" <<YAML
sensor_type: camera
T_BS:
  cols: 4
  rows: 4
  data: [0.0, -1.0, 0.0, -0.02,
         1.0, 0.0, 0.0, $((eye * 11 - 6))e-2,
         0.0, 0.0, 1.0, 0.01,
         0.0, 0.0, 0.0, 1.0]
resolution: [752, 480]
camera_model: pinhole
intrinsics: [458.654, 457.296, 367.215, 248.375]
distortion_model: radial-tangential
distortion_coefficients: [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05]
YAML
done
mkdir euroc_set/mav0/state_groundtruth_estimate0
{
  echo '#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []'
  for s in 1403636579763555584 1403636579813555456 1403636579863555584; do echo "$s,4.6,-1.7,0.78,0.53,-0.15,-0.82,-0.08"; done
} >euroc_set/mav0/state_groundtruth_estimate0/data.csv
"$scripts/euroc.sh" euroc_set euroc >/dev/null
holds euroc 3 "752x480, stereo"
fits euroc truth.csv

# 7-Scenes
for i in 0 1 2; do
  image "chess/seq-01/frame-00000$i.color.png" 640 480
  printf ' 1.0e+000\t 0.0\t 0.0\t %d.5e-001\t\r\n 0.0\t 1.0\t 0.0\t 0.0\t\r\n 0.0\t 0.0\t 1.0\t 0.0\t\r\n 0\t 0\t 0\t 1\t\r\n' $i \
    >"chess/seq-01/frame-00000$i.pose.txt"
done
"$scripts/seven_scenes.sh" chess/seq-01 scenes >/dev/null
holds scenes 3 640x480
fits scenes truth.txt
[ "$(awk 'NF != 12' scenes/truth.txt | wc -l)" -eq 0 ] || fail "7-Scenes: $(cat scenes/truth.txt)"
! "$scripts/seven_scenes.sh" nowhere out 2>said || fail "seven_scenes.sh runs on nothing"
grep -q "Unpack the data set first: https" said || fail "$(cat said)"
echo "4 passed, 0 failed"
