// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/capture/fake_server.h"

#include "engram/base/error.h"
#include "gobject_ptr.h"

#include <opencv2/imgproc.hpp>

#include <atomic>
#include <cmath>
#include <cstring>

namespace engram::capture {

class FakeServer::Impl {
 public:
  Impl(const FakeServerParams& params, const cv::Mat& first, Next next)
      : next_(std::move(next)),
        server_(ARV_GV_FAKE_CAMERA(
            g_object_new(ARV_TYPE_GV_FAKE_CAMERA, "interface-name", params.interface.c_str(), "serial-number",
                         params.serial.c_str(), "gvsp-lost-ratio", params.loss, nullptr))) {
    if (first.empty() || first.cols > ARV_FAKE_CAMERA_SENSOR_WIDTH ||
        first.rows > ARV_FAKE_CAMERA_SENSOR_HEIGHT)
      throw base::Error("images of " + std::to_string(first.cols) + "x" + std::to_string(first.rows) +
                        " do not fit the simulated sensor of 2048x2048 pixels");
    if (!arv_gv_fake_camera_is_running(server_.get()))
      throw base::Error(
          "'" + params.interface +
          "' is neither the name nor the address of an interface of this computer, or its UDP port "
          "3956 is taken");
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
