// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/capture/fake_server.h"

#include "engram/base/error.h"
#include "gobject_ptr.h"

#include <opencv2/imgproc.hpp>

#include <arpa/inet.h>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <ifaddrs.h>
#include <netinet/in.h>
#include <optional>
#include <sys/socket.h>
#include <unistd.h>

namespace engram::capture {

namespace {

constexpr std::uint16_t kControlPort = 3956;  // GigE Vision's

/// The address of an interface that is given by its name or by that address.
std::optional<in_addr> addressOf(const std::string& interface) {
  in_addr numeric{};
  if (inet_pton(AF_INET, interface.c_str(), &numeric) == 1) return numeric;
  ifaddrs* all = nullptr;
  if (getifaddrs(&all) != 0) return std::nullopt;
  std::optional<in_addr> found;
  for (const ifaddrs* at = all; at != nullptr && !found; at = at->ifa_next)
    if (at->ifa_addr != nullptr && at->ifa_addr->sa_family == AF_INET && interface == at->ifa_name)
      found = reinterpret_cast<const sockaddr_in*>(at->ifa_addr)->sin_addr;
  freeifaddrs(all);
  return found;
}

/// Aravis shares the port with whoever has it, and then the client's commands reach one of the two.
void requireFreePort(const std::string& interface) {
  const auto address = addressOf(interface);
  if (!address) return;  // Aravis will say that it is none
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_port = htons(kControlPort);
  at.sin_addr = *address;
  const int probe = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const bool taken =
      ::bind(probe, reinterpret_cast<const sockaddr*>(&at), sizeof at) != 0 && errno == EADDRINUSE;
  ::close(probe);
  if (taken)
    throw base::Error("'" + interface + "': another program serves a camera there: UDP port " +
                      std::to_string(kControlPort) + " is taken; end it, or choose another interface");
}

ArvGvFakeCamera* startServer(const FakeServerParams& params) {
  requireFreePort(params.interface);
  return ARV_GV_FAKE_CAMERA(g_object_new(ARV_TYPE_GV_FAKE_CAMERA, "interface-name", params.interface.c_str(),
                                         "serial-number", params.serial.c_str(), "gvsp-lost-ratio",
                                         params.loss, nullptr));
}

}  // namespace

class FakeServer::Impl {
 public:
  Impl(const FakeServerParams& params, const cv::Mat& first, Next next)
      : next_(std::move(next)), server_(startServer(params)) {
    if (first.empty() || first.cols > ARV_FAKE_CAMERA_SENSOR_WIDTH ||
        first.rows > ARV_FAKE_CAMERA_SENSOR_HEIGHT)
      throw base::Error("images of " + std::to_string(first.cols) + "x" + std::to_string(first.rows) +
                        " do not fit the simulated sensor of 2048x2048 pixels");
    if (!arv_gv_fake_camera_is_running(server_.get()))
      throw base::Error("'" + params.interface +
                        "' is neither the name nor the address of an interface of this computer, or its UDP "
                        "port 3956 is taken");
    setImage(first);
    ArvFakeCamera* camera = arv_gv_fake_camera_get_fake_camera(server_.get());
    const auto set = [camera](guint32 address, double value) {
      arv_fake_camera_write_register(camera, address, static_cast<guint32>(std::lround(value)));
    };
    set(ARV_FAKE_CAMERA_REGISTER_WIDTH, first.cols);
    set(ARV_FAKE_CAMERA_REGISTER_HEIGHT, first.rows);
    set(ARV_FAKE_CAMERA_REGISTER_ACQUISITION_FRAME_PERIOD_US, 1e6 / params.rate);
    set(ARV_FAKE_CAMERA_REGISTER_PIXEL_FORMAT,
        first.channels() == 3 ? ARV_PIXEL_FORMAT_RGB_8_PACKED : ARV_PIXEL_FORMAT_MONO_8);
    arv_fake_camera_set_fill_pattern(camera, fill, this);
  }

  std::size_t sent() const { return sent_; }

 private:
  static void fill(ArvBuffer* buffer, void* self, guint32, guint32, ArvPixelFormat) {
    static_cast<Impl*>(self)->fill(buffer);
  }

  /// The buffer does not know its size here (Aravis says 0): it was allocated for the region of the client.
  void fill(ArvBuffer* buffer) {
    ++sent_;
    const cv::Mat image = next_();
    if (!image.empty()) setImage(image);
    const int width = arv_buffer_get_image_width(buffer), height = arv_buffer_get_image_height(buffer);
    const bool sameFormat =
        arv_buffer_get_image_pixel_format(buffer) ==
        (image_.channels() == 3 ? ARV_PIXEL_FORMAT_RGB_8_PACKED : ARV_PIXEL_FORMAT_MONO_8);
    if (width > image_.cols || height > image_.rows || !sameFormat)
      return;  // the client has set it otherwise
    std::size_t ignored = 0;
    auto* to = static_cast<std::uint8_t*>(const_cast<void*>(arv_buffer_get_data(buffer, &ignored)));
    const std::size_t row = static_cast<std::size_t>(width) * image_.elemSize();
    for (int y = 0; y < height; ++y) std::memcpy(to + static_cast<std::size_t>(y) * row, image_.ptr(y), row);
  }

  void setImage(const cv::Mat& image) {
    if (image.channels() == 3)
      cv::cvtColor(image, image_, cv::COLOR_BGR2RGB);
    else
      image.copyTo(image_);
  }

  Next next_;
  cv::Mat image_;  // in the order of the wire
  std::atomic<std::size_t> sent_{0};
  GObjectPtr<ArvGvFakeCamera> server_;  // last: its thread ends first
};

FakeServer::FakeServer(const FakeServerParams& params, const cv::Mat& first, Next next)
    : impl_(std::make_unique<Impl>(params, first, std::move(next))) {}
FakeServer::~FakeServer() = default;
std::size_t FakeServer::sent() const { return impl_->sent(); }

}  // namespace engram::capture
