// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/posegraph/relaxer.h"

namespace engram::posegraph {

std::unique_ptr<Relaxer> makeCeresRelaxer(const RelaxerParams& params);
std::unique_ptr<Relaxer> makeDuckettRelaxer(const RelaxerParams& params);
std::unique_ptr<Relaxer> makeMrptRelaxer(const RelaxerParams& params);

/// Heading of a place.
double yawOf(const Eigen::Isometry3d& T);

/// x, y and yaw as given; height, roll and pitch stay.
void setPlanar(Eigen::Isometry3d& T, double x, double y, double yaw);

/// Sum of the weighted squared residuals of the constraints with scale, without kernels; planar: of x, y,
/// yaw.
double chi2(const Graph& graph, const std::map<PlaceId, Eigen::Isometry3d>& poses, bool planar);

}  // namespace engram::posegraph
