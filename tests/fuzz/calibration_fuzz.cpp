// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause

// Calibrations: of one camera, of a stereo camera, MRPT's, and those of OpenCV, ROS, EuRoC and KITTI; and
// what is written of one is read again.
#include "engram/cameras/camera_import.h"
#include "engram/cameras/camera_rig.h"
#include "engram/cameras/stereo_rig.h"
#include "fuzz_input.h"

#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace engram;
  const std::string text = fuzz::text({data, size});
  fuzz::mayRefuse([&] { cameras::parseCamera(text, "fuzz.ini"); });
  fuzz::mayRefuse([&] {
    const std::string again = cameras::toText(cameras::parseStereoRig(text, "fuzz.ini"));
    try {
      cameras::parseStereoRig(again, "again.ini");
    } catch (const base::Error&) {
      std::abort();
    }
  });
  static const fuzz::InputFile yaml(".yaml"), table(".txt");
  for (const fuzz::InputFile* file : {&yaml, &table}) {
    const std::string path = file->holding({data, size});
    fuzz::mayRefuse([&] { cameras::importCamera(path, {640, 480}); });
    fuzz::mayRefuse([&] { cameras::importStereoRig(path, {640, 480}); });
  }
  return 0;
}
