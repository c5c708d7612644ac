// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/capture/gige_params.h"

#include "engram/base/error.h"

namespace engram::capture {

void GigeParams::describe(base::Params& p) {
  p.addChoice("driver", driver, "marks the section as a camera, for MRPT's rawlog-grabber too",
              {kGigeDriver});
  p.add("camera", camera, "id or address of the camera (engram-capture list); empty: the only one there is");
  p.add("right_camera", right_camera, "the same of the right camera of a stereo pair; empty: one camera");
  p.add("sensor_label", sensor_label, "label of the images in a rawlog");
  p.add("pixel_format", pixel_format,
        "GenICam name, for example Mono8 or BayerRG8; empty: as the camera is set");
  p.add("exposure_us", exposure_us, "exposure time [us]; 0: as the camera is set", {0, 1e7});
  p.add("gain", gain, "gain, in the unit of the camera (mostly dB); -1: as the camera is set", {-1, 1e4});
  p.add("frame_rate", frame_rate, "images per second; of software triggers too; 0: as the camera is set",
        {0, 1e4});
  p.add("offset_x", offset_x, "left edge of the region that is read out [px]", {0, 1 << 15});
  p.add("offset_y", offset_y, "upper edge of the region that is read out [px]", {0, 1 << 15});
  p.add("width", width, "width of the region that is read out [px]; 0: as the camera is set", {0, 1 << 15});
  p.add("height", height, "height of the region that is read out [px]; 0: as the camera is set",
        {0, 1 << 15});
  p.add(
      "trigger", trigger,
      "off: the camera runs freely; software: Engram triggers it; else the camera's name of the source, for "
      "example Line1; empty: as the camera is set");
  p.add("packet_size", packet_size, "bytes of a network packet, headers included; 0: as the camera is set",
        {0, 65535});
  p.add("packet_delay_us", packet_delay_us, "pause between the packets of an image [us]", {0, 1e6});
  p.add("packet_socket", packet_socket,
        "receive by a packet socket where the rights allow it (never from this computer itself)");
  p.add("resend", resend, "ask the camera for lost packets again");
  p.add("socket_buffer_mb", socket_buffer_mb,
        "buffer of the socket [MB]; the system allows no more than net.core.rmem_max", {0.1, 1024});
  p.add("buffers", buffers, "images being received at most", {2, 1000});
  p.add("queue", queue, "received images that may wait to be processed; 0: 2 for live work, 32 for recording",
        {0, 1000});
  p.addChoice(
      "when_full", when_full,
      "what a full queue does with the next image; auto: drop_oldest for live work, block for recording",
      {"auto", "drop_oldest", "block"});
  p.add("stereo_tolerance_ms", stereo_tolerance_ms,
        "greatest difference of the stamps of a stereo pair [ms]; less than half the time between images",
        {0.001, 1000});
  p.add(
      "silence_s", silence_s,
      "without an image for so long the camera counts as lost and is connected anew [s]; 0: never, for rare "
      "triggers",
      {0, 3600});
  p.add("give_up_s", give_up_s,
        "a camera that is lost for so long is not tried again [s]; 0: it is, for ever", {0, 86400});
  p.add("odometry", odometry, "section of the MRPT sensor that gives odometry; empty: none");
  p.add("odometry_wait_ms", odometry_wait_ms, "longest wait for odometry that is later than the image [ms]",
        {0, 10000});
  p.add("odometry_hold", odometry_hold, "time that the last odometry stands for later images [s]", {0, 3600});
  p.add("process_rate", process_rate, "for rawlog-grabber alone: how often it looks for images [Hz]",
        {0.01, 10000});
  p.add("max_queue_len", max_queue_len, "for rawlog-grabber alone: longest queue of images", {1, 100000});
  p.add("grab_decimation", grab_decimation, "for rawlog-grabber alone: one of so many images is taken",
        {0, 100000});
}

void requireTwoCameras(const GigeParams& params) {
  if (!params.right_camera.empty() && params.right_camera == params.camera)
    throw base::ConfigError("right_camera: '" + params.right_camera +
                            "' is the left camera too; name another one, or none for a single camera");
}

}  // namespace engram::capture
