#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Engram authors
# SPDX-License-Identifier: BSD-3-Clause
#
# The main job end to end: makes a small world, maps it from a rawlog, learns from a second and third drive,
# localises a test drive, and writes everything a person may want to open. Usage: ./demo.sh [OUTPUT_FOLDER]
set -euo pipefail
cd "$(dirname "$0")"
source scripts/setup.sh
out=${1:-demo-out}

mark=.made-by-engram-demo
if [ -e "$out" ] && [ ! -e "$out/$mark" ] && [ -n "$(ls -A "$out" 2>/dev/null || echo file)" ]; then
  echo "$0: $out is there already, and no demo made it; name another folder, or remove it yourself" >&2
  exit 1
fi
echo "Takes about a minute; the first time also some 20 minutes of processor time to build, and 0.4 GB of disk beside the packages."
engram_install_packages
engram_build release engram_programs
bin=build/release/bin

rm -rf "$out"
mkdir -p "$out"
touch "$out/$mark"
echo; echo "== A building, three drives on different days, and a test drive"
"$bin/engram-world" make --preset tiny --camera omni --sessions 3 --seed 7 --test-drive --out "$out/world"

camera="$out/world/camera.ini"
map="$out/building.engram"
echo; echo "== Drive 1 makes the map, drives 2 and 3 teach it what is stable"
"$bin/engram-slam" config/fsh_omni.ini --camera "$camera" --rawlog "$out/world/session_01.rawlog" \
  --truth "$out/world/session_01.truth.tum" --map "$map"
for n in 2 3; do
  report=(); [ "$n" = 3 ] && report=(--report "$out/report")
  "$bin/engram-slam" config/fsh_omni.ini --camera "$camera" --rawlog "$out/world/session_0$n.rawlog" \
    --truth "$out/world/session_0$n.truth.tum" --map "$map" --extend "${report[@]}"
done

echo; echo "== The test drive, seen from other positions and headings"
"$bin/engram-localize" config/fsh_omni.ini --camera "$camera" --rawlog "$out/world/test.rawlog" --map "$map" \
  --truth "$out/world/test.truth.tum" --out "$out/localisation.csv" --json "$out/localisation.json"

cat <<TXT

Done. To look at:
  $map                    the map (engram-map info $map)
  $out/report/index.html              summary, opens in any browser
  $out/report/map.3Dscene             opens in MRPT's SceneViewer3D
  $out/report/map.graph               pose graph, opens in MRPT's graph-slam
  $out/report/trajectory.tum          the robot's path
  $out/report/images.jsonl            what was decided for every image, and why
  $out/localisation.csv               where each test image was recognised
  $out/world/plan.png                 the building

To use the programs by their names: export PATH="$PWD/$bin:\$PATH", or install them: sudo cmake --install build/release --component programs
TXT
