// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "gige_camera.h"

#include "engram/base/error.h"
#include "engram/capture/discovery.h"
#include "pixel_format.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <netinet/in.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

namespace engram::capture {
namespace {

std::string shortNumber(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

std::string textOf(const char* s) { return s ? s : ""; }

std::string seenCameras() {
  std::string list;
  for (const auto& camera : discover())
    list += (list.empty() ? "" : ", ") + camera.id + " (" + camera.address + ")";
  if (!list.empty()) return "; cameras that answer: " + list;
  return "; no camera answers: is it switched on, is its address in the network of this computer's "
         "interface, and "
         "does a firewall let UDP port 3956 through?";
}

/// The only camera there is.
std::string onlyCamera() {
  const auto cameras = discover();
  if (cameras.size() == 1) return cameras.front().id;
  if (cameras.empty()) throw base::Error("no camera was found" + seenCameras());
  throw base::Error("several cameras answer; name one of them as camera" + seenCameras());
}

std::size_t socketLimit() {
  std::size_t limit = 0;
  std::ifstream("/proc/sys/net/core/rmem_max") >> limit;
  return limit;
}

bool isLoopback(ArvDevice* device) {
  GSocketAddress* address = arv_gv_device_get_device_address(ARV_GV_DEVICE(device));
  const bool result =
      G_IS_INET_SOCKET_ADDRESS(address) &&
      g_inet_address_get_is_loopback(g_inet_socket_address_get_address(G_INET_SOCKET_ADDRESS(address)));
  return result;
}

std::string addressOf(ArvDevice* device) {
  if (!ARV_IS_GV_DEVICE(device)) return {};
  GSocketAddress* address = arv_gv_device_get_device_address(ARV_GV_DEVICE(device));
  if (!G_IS_INET_SOCKET_ADDRESS(address)) return {};
  char* text = g_inet_address_to_string(g_inet_socket_address_get_address(G_INET_SOCKET_ADDRESS(address)));
  std::string result = textOf(text);
  g_free(text);
  return result;
}

/// Aravis enlarges the buffer of the socket when the first packet is there, and loses much of the first
/// image.
void enlargeSocket(std::uint16_t port, int bytes) {
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", ignored)) {
    const int descriptor = std::atoi(entry.path().filename().c_str());
    sockaddr_in address{};
    socklen_t size = sizeof address;
    int type = 0;
    socklen_t typeSize = sizeof type;
    if (::getsockname(descriptor, reinterpret_cast<sockaddr*>(&address), &size) == 0 &&
        address.sin_family == AF_INET && ntohs(address.sin_port) == port &&
        ::getsockopt(descriptor, SOL_SOCKET, SO_TYPE, &type, &typeSize) == 0 && type == SOCK_DGRAM)
      ::setsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes);
  }
}

void onControlLost(ArvDevice*, std::atomic<bool>* lost) { *lost = true; }

/// Runs in the receiving thread: it must empty the socket in time even when all processors are busy. Without
/// the right to do so it stays as it is.
void onStreamEvent(void*, ArvStreamCallbackType type, ArvBuffer*) {
  if (type == ARV_STREAM_CALLBACK_TYPE_INIT) setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), -10);
}

}  // namespace

GigeCamera::GigeCamera(const GigeParams& params, const std::string& id) {
  open(id.empty() ? onlyCamera() : id);
  requireControl();
  configure(params);
  requireFormat();
  readSettings();
  startStream(params);
}

GigeCamera::~GigeCamera() {
  GErrorBox ignored;
  if (stream_ && !controlLost_ && !abandoned_) arv_camera_stop_acquisition(camera_.get(), ignored.out());
  if (controlLostHandler_ != 0) g_signal_handler_disconnect(device_, controlLostHandler_);
}

void GigeCamera::open(const std::string& id) {
  if (id.rfind("Fake_", 0) == 0) enableFakeCamera();
  settings_.id = id;
  GErrorBox error;
  camera_.reset(arv_camera_new(id.c_str(), error.out()));
  if (!camera_ && error.is(ARV_DEVICE_ERROR_NOT_FOUND))
    throw base::Error("camera '" + id + "' was not found" + seenCameras());
  if (!camera_) throw base::Error("camera '" + id + "' cannot be opened: " + error.message());
  device_ = arv_camera_get_device(camera_.get());
  controlLostHandler_ =
      g_signal_connect(device_, "control-lost", G_CALLBACK(onControlLost), static_cast<void*>(&controlLost_));
}

void GigeCamera::requireControl() const {
  if (!ARV_IS_GV_DEVICE(device_) || arv_gv_device_is_controller(ARV_GV_DEVICE(device_))) return;
  throw base::Error(
      "camera '" + settings_.id +
      "' is in use by another program; end that program, or wait some seconds if it has crashed");
}

void GigeCamera::check(const GErrorBox& error, const std::string& key, const std::string& value) const {
  if (error)
    throw base::Error("camera '" + settings_.id + "': " + key + " = " + value +
                      " is refused: " + error.message());
}

void GigeCamera::configure(const GigeParams& params) {
  ArvCamera* camera = camera_.get();
  GErrorBox error;
  arv_camera_stop_acquisition(camera, error.out());  // another program may have left it running
  arv_camera_set_range_check_policy(camera, ARV_RANGE_CHECK_POLICY_ENABLE);
  configureRegion(params);
  if (!params.pixel_format.empty()) {
    arv_camera_set_pixel_format_from_string(camera, params.pixel_format.c_str(), error.out());
    if (error)
      throw base::Error("camera '" + settings_.id + "': pixel_format = " + params.pixel_format +
                        " is refused; " + formats());
  }
  if (params.frame_rate > 0) {
    arv_camera_set_frame_rate(camera, params.frame_rate, error.out());
    check(error, "frame_rate", shortNumber(params.frame_rate));
  }
  if (params.exposure_us > 0) {
    arv_camera_set_exposure_time(camera, params.exposure_us, error.out());
    check(error, "exposure_us", shortNumber(params.exposure_us));
  }
  if (params.gain >= 0) {
    arv_camera_set_gain(camera, params.gain, error.out());
    check(error, "gain", shortNumber(params.gain));
  }
  configureTrigger(params);
  for (const auto& [name, value] : params.features) {
    arv_device_set_features_from_string(device_, (name + "=" + value).c_str(), error.out());
    check(error, "feature " + name, value);
  }
  if (ARV_IS_GV_DEVICE(device_)) configureNetwork(params);
}

void GigeCamera::configureRegion(const GigeParams& params) {
  ArvCamera* camera = camera_.get();
  GErrorBox error;
  const auto set = [&](const char* key, const char* feature, int value) {
    arv_camera_set_integer(camera, feature, value, error.out());
    check(error, key, std::to_string(value));
  };
  const bool movable = arv_camera_is_region_offset_available(camera, nullptr);
  if (movable && (params.width > 0 || params.height > 0)) {  // an offset may leave no room for the new size
    set("offset_x", "OffsetX", 0);
    set("offset_y", "OffsetY", 0);
  }
  if (params.width > 0) set("width", "Width", params.width);
  if (params.height > 0) set("height", "Height", params.height);
  if (params.offset_x > 0) set("offset_x", "OffsetX", params.offset_x);
  if (params.offset_y > 0) set("offset_y", "OffsetY", params.offset_y);
}

void GigeCamera::configureTrigger(const GigeParams& params) {
  if (params.trigger.empty()) return;
  ArvCamera* camera = camera_.get();
  GErrorBox error;
  if (params.trigger == "off") {
    arv_camera_clear_triggers(camera, error.out());
  } else if (params.trigger == "software") {
    if (params.frame_rate <= 0)
      throw base::Error("camera '" + settings_.id + "': trigger = software needs frame_rate > 0");
    arv_camera_set_trigger(camera, "Software", error.out());
    triggerPeriod_ = std::chrono::duration_cast<std::chrono::steady_clock::duration>(
        std::chrono::duration<double>(1.0 / params.frame_rate));
  } else {
    arv_camera_set_trigger(camera, params.trigger.c_str(), error.out());
  }
  check(error, "trigger", params.trigger);
}

void GigeCamera::configureNetwork(const GigeParams& params) {
  ArvCamera* camera = camera_.get();
  GErrorBox error;
  if (params.packet_size > 0) {
    arv_camera_gv_set_packet_size_adjustment(camera, ARV_GV_PACKET_SIZE_ADJUSTMENT_NEVER);
    arv_camera_gv_set_packet_size(camera, params.packet_size, error.out());
    check(error, "packet_size", std::to_string(params.packet_size));
  }
  if (params.packet_delay_us > 0) {
    arv_camera_gv_set_packet_delay(camera, static_cast<gint64>(1e3 * params.packet_delay_us), error.out());
    check(error, "packet_delay_us", shortNumber(params.packet_delay_us));
  }
  // A packet socket sees nothing of the loopback interface.
  if (!params.packet_socket || isLoopback(device_))
    arv_camera_gv_set_stream_options(camera, ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
}

void GigeCamera::requireFormat() const {
  GErrorBox error;
  const ArvPixelFormat format = arv_camera_get_pixel_format(camera_.get(), error.out());
  check(error, "pixel_format", "?");
  if (isSupported(format)) return;
  throw base::Error("camera '" + settings_.id + "' sends " +
                    textOf(arv_camera_get_pixel_format_as_string(camera_.get(), nullptr)) +
                    ", which Engram does not read; set pixel_format to another: " + formats());
}

std::string GigeCamera::formats() const {
  std::string offered;
  guint n = 0;
  const char** names = arv_camera_dup_available_pixel_formats_as_strings(camera_.get(), &n, nullptr);
  for (guint i = 0; i < n; ++i) offered += (i == 0 ? "" : ", ") + textOf(names[i]);
  g_free(names);
  return "this camera offers " + offered + "; Engram reads " + supportedFormats();
}

void GigeCamera::readSettings() {
  ArvCamera* camera = camera_.get();
  GErrorBox error;
  CameraSettings& s = settings_;
  s.vendor = textOf(arv_camera_get_vendor_name(camera, nullptr));
  s.model = textOf(arv_camera_get_model_name(camera, nullptr));
  s.serial = textOf(arv_camera_get_device_serial_number(camera, nullptr));
  s.address = addressOf(device_);
  s.format = textOf(arv_camera_get_pixel_format_as_string(camera, nullptr));
  arv_camera_get_region(camera, nullptr, nullptr, &s.width, &s.height, error.out());
  check(error, "region", "?");
  s.payload = arv_camera_get_payload(camera, error.out());
  check(error, "payload", "?");
  const double rate = arv_camera_get_frame_rate(camera, error.out());
  s.frameRate = error ? 0.0 : rate;
  if (!ARV_IS_GV_DEVICE(device_)) return;
  s.packetSize = static_cast<int>(arv_camera_gv_get_packet_size(camera, nullptr));
  s.socketLimit = socketLimit();
}

void GigeCamera::startStream(const GigeParams& params) {
  GErrorBox error;
  stream_.reset(arv_camera_create_stream(camera_.get(), onStreamEvent, nullptr, error.out()));
  if (!stream_) throw base::Error("camera '" + settings_.id + "' cannot be received: " + error.message());
  if (ARV_IS_GV_STREAM(stream_.get())) {
    const int bytes = static_cast<int>(params.socket_buffer_mb * (1 << 20));
    settings_.socketBuffer = static_cast<std::size_t>(bytes);
    g_object_set(stream_.get(), "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_FIXED, "socket-buffer-size",
                 bytes, "packet-resend",
                 params.resend ? ARV_GV_STREAM_PACKET_RESEND_ALWAYS : ARV_GV_STREAM_PACKET_RESEND_NEVER,
                 nullptr);
    enlargeSocket(arv_gv_stream_get_port(ARV_GV_STREAM(stream_.get())), bytes);
  }
  // The default size of the payload was read before: the camera sends nothing larger while it runs.
  for (int i = 0; i < params.buffers; ++i)
    arv_stream_push_buffer(stream_.get(), arv_buffer_new_allocate(settings_.payload));
  arv_camera_set_acquisition_mode(camera_.get(), ARV_ACQUISITION_MODE_CONTINUOUS, error.out());
  check(error, "AcquisitionMode", "Continuous");
  arv_camera_start_acquisition(camera_.get(), error.out());
  if (error) throw base::Error("camera '" + settings_.id + "' does not start: " + error.message());
  nextTrigger_ = std::chrono::steady_clock::now();
}

void GigeCamera::triggerIfDue() {
  const auto now = std::chrono::steady_clock::now();
  if (triggerPeriod_.count() == 0 || now < nextTrigger_) return;
  arv_camera_software_trigger(camera_.get(),
                              nullptr);  // a camera that does not answer is found by its silence
  nextTrigger_ = std::max(nextTrigger_ + triggerPeriod_, now);
}

GigeCamera::Grabbed GigeCamera::grab(std::chrono::microseconds patience) {
  triggerIfDue();
  if (triggerPeriod_.count() > 0) {
    const auto untilTrigger = nextTrigger_ - std::chrono::steady_clock::now();
    patience = std::clamp(std::chrono::duration_cast<std::chrono::microseconds>(untilTrigger),
                          std::chrono::microseconds(0), patience);
  }
  Grabbed grabbed;
  ArvBuffer* buffer = arv_stream_timeout_pop_buffer(stream_.get(), static_cast<guint64>(patience.count()));
  if (!buffer) return grabbed;
  const ArvBufferStatus status = arv_buffer_get_status(buffer);
  grabbed.number = arv_buffer_get_frame_id(buffer);
  grabbed.device = static_cast<std::int64_t>(arv_buffer_get_timestamp(buffer));
  grabbed.arrival = static_cast<std::int64_t>(arv_buffer_get_system_timestamp(buffer));
  try {
    if (status == ARV_BUFFER_STATUS_SUCCESS) {
      std::size_t size = 0;
      const void* data = arv_buffer_get_image_data(buffer, &size);
      int padding = 0;
      arv_buffer_get_image_padding(buffer, &padding, nullptr);
      grabbed.image = toImage({static_cast<const std::uint8_t*>(data), size},
                              {arv_buffer_get_image_width(buffer), arv_buffer_get_image_height(buffer)},
                              arv_buffer_get_image_pixel_format(buffer), padding);
      grabbed.kind = Grabbed::Kind::kWhole;
    } else if (status != ARV_BUFFER_STATUS_CLEARED && status != ARV_BUFFER_STATUS_ABORTED) {
      grabbed.kind = Grabbed::Kind::kIncomplete;
    }
  } catch (...) {
    arv_stream_push_buffer(stream_.get(), buffer);
    throw;
  }
  arv_stream_push_buffer(stream_.get(), buffer);
  return grabbed;
}

PacketStats GigeCamera::packets() const {
  PacketStats stats;
  guint64 whole = 0, failures = 0, underruns = 0;
  arv_stream_get_statistics(stream_.get(), &whole, &failures, &underruns);
  stats.underruns = underruns;
  if (ARV_IS_GV_STREAM(stream_.get())) {
    guint64 resent = 0, missing = 0;
    arv_gv_stream_get_statistics(ARV_GV_STREAM(stream_.get()), &resent, &missing);
    stats.resent = resent;
    stats.missing = missing;
  }
  return stats;
}

}  // namespace engram::capture
