// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/capture/discovery.h"

#include <arv.h>
#include <mutex>

namespace engram::capture {
namespace {

std::string text(const char* s) { return s ? s : ""; }

}  // namespace

std::vector<CameraInfo> discover() {
  static std::mutex oneAtATime;  // the list is a global of Aravis, read by index
  const std::lock_guard lock(oneAtATime);
  arv_update_device_list();
  std::vector<CameraInfo> cameras;
  for (unsigned i = 0; i < arv_get_n_devices(); ++i)
    cameras.push_back({text(arv_get_device_id(i)), text(arv_get_device_vendor(i)),
                       text(arv_get_device_model(i)), text(arv_get_device_serial_nbr(i)),
                       text(arv_get_device_address(i)), text(arv_get_device_protocol(i))});
  return cameras;
}

void enableFakeCamera() { arv_enable_interface("Fake"); }

}  // namespace engram::capture
