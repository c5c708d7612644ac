// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "capture_command.h"
#include "engram/apps/checks.h"
#include "engram/base/error.h"
#include "engram/base/interrupt.h"
#include "engram/base/progress.h"
#include "engram/base/text.h"
#include "engram/capture/gige_grabber.h"
#include "engram/capture/live_source.h"
#include "engram/capture/recorder.h"
#include "engram/capture/sensor_reader.h"
#include "engram/capture/stamp_statistics.h"
#include "stamp_figures.h"

#include <mrpt/obs/CObservationComment.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <optional>
#include <ostream>
#include <thread>

namespace engram::apps {
namespace {

double steadyNow() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// One thing to be recorded.
struct Item {
  std::optional<types::Frame> frame;
  capture::SensorReader::Object object;
};
using Queue = capture::BoundedQueue<Item>;

class RecordCommand final : public Program {
 public:
  std::string name() const override { return "record"; }
  std::string description() const override {
    return "Records a camera, and odometry if there is any, to a rawlog";
  }
  std::string examples() const override;
  void declare(CLI::App& app) override;
  int run(std::ostream& out, std::ostream& err) override;

 private:
  struct Session;
  void record(Session& session, std::ostream& err) const;
  bool isOver(const Session& session, double now) const;
  void take(Session& session, Item&& item) const;
  static void passOn(Session& session, std::ostream& err);
  int conclude(Session& session, std::ostream& out, std::ostream& err) const;
  nlohmann::json figures(const Session& session) const;

  CameraOptions camera_;
  std::string out_, json_;
  double seconds_ = 0.0;
  std::size_t images_ = 0;
  bool quiet_ = false;
  capture::RecorderParams recorder_;
};

/// A recording under way.
struct RecordCommand::Session {
  Session(const std::string& path, const capture::RecorderParams& params, const capture::QueueChoice& choice)
      : recorder(path, params), queue(choice.capacity, choice.whenFull) {}

  capture::Recorder recorder;
  Queue queue;
  std::unique_ptr<capture::GigeGrabber> grabber;
  std::unique_ptr<capture::SensorReader> odometry;
  capture::StampStatistics stamps;
  std::size_t frames = 0, objects = 0;
  double began = 0.0;                ///< the steady clock at the start, then at the first image
  std::optional<double> firstStamp;  ///< [s]
  cv::Size size;
  bool stereo = false, enough = false;
  std::string odometryFailure, failure;

  ~Session() {
    queue.close();  // a thread may wait for room in it
    end();
    if (stopper.joinable()) stopper.join();
  }

  /// Ends all threads. The queue is to be emptied meanwhile: nothing that was received is lost.
  void end() {
    if (stopper.joinable()) return;
    stopper = std::thread([this] {
      if (grabber) grabber->stop();
      if (odometry) odometry->stop();
      queue.close();
    });
  }
  std::thread stopper;
};

std::string RecordCommand::examples() const {
  return "  engram-capture record --camera Basler-21234567 --seconds 60 --out walk.rawlog\n"
         "  engram-capture record --camera 192.168.5.10 --set frame_rate=10 --feature GainAuto=Off --out "
         "walk.rawlog\n"
         "  engram-capture record robot.ini --section front --rotate-minutes 10 --out day.rawlog\n";
}

void RecordCommand::declare(CLI::App& app) {
  camera_.declare(app);
  app.add_option("--out", out_, "Rawlog to write")->required()->type_name("FILE");
  app.add_option("--seconds", seconds_, "Stop after so long; default: at Ctrl-C")->check(positive());
  app.add_option("--images", images_, "Stop after so many images")->check(wholeFrom(1));
  app.add_flag("--external", recorder_.writer.external_images,
               "Images as files beside the rawlog instead of inside");
  app.add_option("--quality", recorder_.writer.jpeg_quality, "JPEG quality")
      ->check(wholeBetween(1, 100))
      ->capture_default_str();
  app.add_option("--rotate-mb", recorder_.rotate_mb, "Begin a new file, FILE_001 …, after so many megabytes")
      ->check(positive());
  app.add_option_function<double>(
         "--rotate-minutes", [this](double minutes) { recorder_.rotate_s = 60.0 * minutes; },
         "Begin a new file after so long")
      ->check(positive());
  app.add_flag("--overwrite", recorder_.writer.overwrite, "Replace the rawlog if it exists");
  app.add_option("--json", json_, "Write the figures to this file")->type_name("FILE");
  app.add_flag("-q,--quiet", quiet_, "No progress on the terminal");
}

int RecordCommand::run(std::ostream& out, std::ostream& err) {
  const capture::LiveConfig live = camera_.load();
  base::requireWritable(json_);
  capture::RecorderParams params = recorder_;
  params.writer.sensor_label = live.camera.sensor_label;
  Session session(out_, params, capture::queueFor(live.camera, true));
  Queue& queue = session.queue;
  session.grabber = std::make_unique<capture::GigeGrabber>(live.camera, [&queue](types::Frame&& frame) {
    queue.push({std::move(frame), nullptr});
  });
  if (!live.odometry.empty())
    session.odometry = std::make_unique<capture::SensorReader>(
        live.camera.odometry, live.odometry, [&queue](const capture::SensorReader::Object& object) {
          queue.push({std::nullopt, object});
        });
  if (!quiet_)
    for (const auto& camera : session.grabber->stats().cameras)
      err << "engram-capture: " << describe(camera.settings) << "\n";
  record(session, err);
  return conclude(session, out, err);
}

void RecordCommand::record(Session& session, std::ostream& err) const {
  base::Progress progress(quiet_ ? nullptr : &err, "recording");
  session.began = steadyNow();
  try {
    while (!session.queue.finished()) {
      if (auto item = session.queue.pop(std::chrono::milliseconds(100))) take(session, std::move(*item));
      const double now = steadyNow();
      session.recorder.tick(now);
      passOn(session, err);
      progress.update(seconds_ > 0 && session.firstStamp ? (now - session.began) / seconds_ : -1.0,
                      session.frames);
      if (isOver(session, now)) session.end();
    }
    session.recorder.close();
  } catch (const base::Error& e) {  // the disk is full: what is safe stays
    session.failure = e.what();
    session.queue.close();
    session.end();
  }
  session.stopper.join();
}

bool RecordCommand::isOver(const Session& session, double now) const {
  if (base::interrupted() || session.enough || !session.grabber->failure().empty()) return true;
  return seconds_ > 0 && now - session.began >= seconds_ + (session.firstStamp ? 1.0 : 5.0);
}

void RecordCommand::take(Session& session, Item&& item) const {
  if (item.object) {
    session.recorder.addObject(*item.object);
    ++session.objects;
    return;
  }
  const types::Frame& frame = *item.frame;
  if (session.enough) return;
  if (!session.firstStamp) {
    session.firstStamp = frame.stamp;
    session.began = steadyNow();
    session.size = frame.image.size();
    session.stereo = !frame.right.empty();
  }
  session.enough = (seconds_ > 0 && frame.stamp - *session.firstStamp >= seconds_) ||
                   (images_ > 0 && session.frames >= images_);
  if (session.enough) return;
  session.recorder.add(frame);
  session.stamps.add(frame.stamp);
  ++session.frames;
  if (images_ > 0 && session.frames >= images_) session.enough = true;
}

/// What happened to the camera goes to the user and, as a comment, into the rawlog.
void RecordCommand::passOn(Session& session, std::ostream& err) {
  for (const auto& notice : session.grabber->takeNotices()) {
    err << "engram-capture: " << notice << "\n" << std::flush;
    mrpt::obs::CObservationComment comment;
    comment.sensorLabel = "ENGRAM_CAPTURE";
    comment.text = notice;
    comment.timestamp = mrpt::Clock::now();
    session.recorder.addObject(comment);
  }
  if (!session.odometry || !session.odometryFailure.empty()) return;
  session.odometryFailure = session.odometry->failure();
  if (!session.odometryFailure.empty())
    err << "engram-capture: " << session.odometryFailure << "\n" << std::flush;
}

int RecordCommand::conclude(Session& session, std::ostream& out, std::ostream& err) const {
  const auto stats = session.grabber->stats();
  const std::string lostCamera = session.grabber->failure();
  const std::size_t safe = session.recorder.framesSafe();
  writeJson(json_, figures(session));
  if (!session.failure.empty()) err << "engram-capture: " << session.failure << "\n";
  if (!lostCamera.empty()) err << "engram-capture: " << lostCamera << "\n";
  if (safe == 0 && base::interrupted()) return kPartial;
  if (safe == 0 && session.failure.empty() && lostCamera.empty())
    throw base::Error("no image came. " + (stats.lost() > 0
                                               ? capture::adviceOnLoss(stats)
                                               : "Does the camera wait for a trigger (trigger = off)? Does a "
                                                 "firewall hold back UDP from the camera?"));
  if (safe == 0) return kError;

  for (const auto& file : session.recorder.files())
    out << file.path << ": " << base::counted(file.frames, "image") << ", " << file.bytes / 1000 << " KB\n";
  const auto summary = session.stamps.summary();
  printStamps(out, summary);
  const std::size_t dropped = session.queue.counters().dropped;
  if (const std::size_t lost = stats.lost() + dropped; lost > 0) {
    err << "engram-capture: lost: " << base::counted(lost, "image") << ", " << stats.incomplete()
        << " incomplete, " << stats.missed() << " never seen, " << stats.unpaired << " without a partner, "
        << dropped << " dropped by the queue\n";
    const std::string advice = capture::adviceOnLoss(stats);
    if (!advice.empty()) err << "engram-capture: " << advice << "\n";
  }
  const bool asWished = session.failure.empty() && lostCamera.empty() && session.odometryFailure.empty();
  const bool cutShort = base::interrupted() && (seconds_ > 0 || images_ > 0);
  return asWished && !cutShort ? kOk : kPartial;
}

nlohmann::json RecordCommand::figures(const Session& session) const {
  const auto stats = session.grabber->stats();
  const auto queue = session.queue.counters();
  nlohmann::json j = stampsJson(session.stamps.summary());
  j["frames"] = session.recorder.framesSafe();
  j["fps"] = session.stamps.summary().rate;
  j["incomplete"] = stats.incomplete();
  j["missed"] = stats.missed();
  j["unpaired"] = stats.unpaired;
  j["dropped"] = queue.dropped;
  j["queue"] = {{"longest", queue.longest}, {"waits", queue.waits}};
  j["reconnects"] = stats.reconnects();
  j["objects"] = session.objects;
  j["width"] = session.size.width;
  j["height"] = session.size.height;
  j["stereo"] = session.stereo;
  j["problem"] = session.failure.empty() ? session.grabber->failure() : session.failure;
  j["files"] = nlohmann::json::array();
  for (const auto& file : session.recorder.files())
    j["files"].push_back({{"path", file.path}, {"frames", file.frames}, {"bytes", file.bytes}});
  j["cameras"] = nlohmann::json::array();
  for (const auto& camera : stats.cameras) j["cameras"].push_back(cameraJson(camera));
  return j;
}

}  // namespace

std::unique_ptr<Program> makeRecordCommand() { return std::make_unique<RecordCommand>(); }

}  // namespace engram::apps
