// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/sources/mrpt_camera.h"

#include "engram/cameras/pinhole.h"

namespace engram::sources {

mrpt::img::TCamera toMrptCamera(const cameras::CameraRig& rig) {
  mrpt::img::TCamera camera;
  camera.ncols = static_cast<std::uint32_t>(rig.camera->imageSize().width);
  camera.nrows = static_cast<std::uint32_t>(rig.camera->imageSize().height);
  const auto* pinhole = dynamic_cast<const cameras::Pinhole*>(rig.camera.get());
  if (!pinhole || pinhole->plane().skew != 0) return camera;
  const auto& p = pinhole->plane();
  camera.setIntrinsicParamsFromValues(p.fx, p.fy, p.cx, p.cy);
  if (p.k1 != 0 || p.k2 != 0 || p.p1 != 0 || p.p2 != 0 || p.k3 != 0)
    camera.setDistortionPlumbBob(p.k1, p.k2, p.p1, p.p2, p.k3);
  return camera;
}

}  // namespace engram::sources
