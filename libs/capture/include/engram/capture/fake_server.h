// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include <functional>
#include <memory>
#include <string>

namespace engram::capture {

struct FakeServerParams {
  std::string interface = "127.0.0.1";  ///< name or address of the network interface
  std::string serial = "GV01";          ///< the id becomes Aravis-Fake-<serial>
  double rate = 10.0;                   ///< images per second, unless the client sets another
  double loss = 0.0;                    ///< share of the packets that are not sent
};

/// A simulated GigE Vision camera on the network that shows our images: the real protocol without a camera.
class FakeServer {
 public:
  /// The next image, of the size and type of the first. Called from the thread of the camera, when it takes
  /// an image. An empty one repeats the last.
  using Next = std::function<cv::Mat()>;

  /// @param first sets size and pixel format (Mono8 or RGB8) that a client finds
  /// Throws base::Error when the interface is not there or the image does not fit the simulated sensor.
  FakeServer(const FakeServerParams& params, const cv::Mat& first, Next next);
  ~FakeServer();
  FakeServer(const FakeServer&) = delete;
  FakeServer& operator=(const FakeServer&) = delete;

  std::size_t sent() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace engram::capture
