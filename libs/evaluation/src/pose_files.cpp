// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/text_file.h"
#include "engram/evaluation/trajectory.h"
#include "text_lines.h"

#include <cmath>
#include <filesystem>
#include <set>

namespace engram::evaluation {
namespace {

namespace fs = std::filesystem;

constexpr double kUnitTolerance = 1e-2;  // quaternions are written with some six digits
constexpr double kNanoseconds = 1e-9;

enum class Form { kNone, kTum, kEuroc, kMatrix };

/// Fields of a line, whatever separates them.
std::vector<std::string> fieldsOf(const std::string& line) {
  return splitFields(line, line.find(',') == std::string::npos ? ' ' : ',');
}

Form formOf(const std::string& line) {
  const std::size_t n = fieldsOf(line).size();
  const bool commas = line.find(',') != std::string::npos;
  if (commas) return n >= 8 ? Form::kEuroc : Form::kNone;
  return n == 8 ? Form::kTum : n == 12 || n == 16 ? Form::kMatrix : Form::kNone;
}

std::vector<double> numbers(const TextLine& line, std::size_t from, const std::vector<std::string>& names) {
  const auto fields = fieldsOf(line.text);
  std::vector<double> values;
  for (std::size_t i = 0; i < names.size(); ++i)
    values.push_back(parseReal(fields[from + i], line.origin, names[i]));
  return values;
}

Eigen::Matrix3d rotation(const Eigen::Quaterniond& q, const std::string& origin) {
  if (std::abs(q.norm() - 1.0) > kUnitTolerance) refuse(origin, "the quaternion is not of unit length");
  return q.normalized().toRotationMatrix();
}

StampedPose tumPose(const TextLine& line) {
  const std::size_t n = fieldsOf(line.text).size();
  if (n != 8) refuse(line.origin, "expected 8 numbers (stamp x y z qx qy qz qw), found " + std::to_string(n));
  const auto v = numbers(line, 0, {"stamp", "x", "y", "z", "qx", "qy", "qz", "qw"});
  StampedPose pose;
  pose.stamp = v[0];
  pose.T_world_body.linear() = rotation({v[7], v[4], v[5], v[6]}, line.origin);
  pose.T_world_body.translation() << v[1], v[2], v[3];
  return pose;
}

StampedPose eurocPose(const TextLine& line) {
  const auto fields = fieldsOf(line.text);
  if (fields.size() < 8)
    refuse(line.origin,
           "expected ns,x,y,z,qw,qx,qy,qz and more, found " + std::to_string(fields.size()) + " fields");
  const auto v = numbers(line, 1, {"x", "y", "z", "qw", "qx", "qy", "qz"});
  StampedPose pose;
  pose.stamp = kNanoseconds * static_cast<double>(parseInteger(fields[0], line.origin, "stamp [ns]"));
  pose.T_world_body.linear() = rotation({v[3], v[4], v[5], v[6]}, line.origin);
  pose.T_world_body.translation() << v[0], v[1], v[2];
  return pose;
}

StampedPose matrixPose(const TextLine& line, double stamp) {
  const std::size_t n = fieldsOf(line.text).size();
  if (n != 12 && n != 16)
    refuse(line.origin, "expected a matrix of 12 or 16 numbers, found " + std::to_string(n));
  const auto v = numbers(line, 0, std::vector<std::string>(12, "element"));
  const Eigen::Matrix<double, 3, 4> M =
      Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(v.data());
  const Eigen::Matrix3d R = M.leftCols<3>();
  if (!(R * R.transpose()).isIdentity(kUnitTolerance)) refuse(line.origin, "the matrix is not a pose");
  StampedPose pose;
  pose.stamp = stamp;
  pose.T_world_body.linear() = Eigen::Quaterniond(R).normalized().toRotationMatrix();
  pose.T_world_body.translation() = M.col(3);
  return pose;
}

/// Of `times.txt` beside the poses; empty when there is none.
std::vector<double> timesBeside(const std::string& name, std::size_t poses) {
  const std::string path = (fs::path(name).parent_path() / "times.txt").string();
  std::error_code status;
  if (!fs::is_regular_file(path, status)) return {};
  std::vector<double> times;
  for (const auto& line : contentLines(base::readTextFile(path), path))
    times.push_back(parseReal(line.text, line.origin, "stamp"));
  if (times.size() != poses)
    refuse(path, "has " + std::to_string(times.size()) + " stamps, " + name + " has " +
                     std::to_string(poses) + " poses");
  return times;
}

void requireRising(const Trajectory& trajectory, const std::string& origin) {
  const std::size_t n = trajectory.size();
  if (n > 1 && !(trajectory[n - 1].stamp > trajectory[n - 2].stamp))
    refuse(origin, "the stamp is not later than the one before");
}

Trajectory parseAs(Form form, const std::vector<TextLine>& lines, const std::string& name) {
  if (lines.empty()) refuse(name, "holds no poses");
  std::vector<double> times;
  if (form == Form::kMatrix) times = timesBeside(name, lines.size());
  Trajectory trajectory;
  for (const auto& line : lines) {
    const auto n = trajectory.size();
    if (form == Form::kMatrix)
      trajectory.push_back(matrixPose(line, times.empty() ? static_cast<double>(n) : times[n]));
    else
      trajectory.push_back(form == Form::kEuroc ? eurocPose(line) : tumPose(line));
    requireRising(trajectory, line.origin);
  }
  return trajectory;
}

}  // namespace

Trajectory parseTum(const std::string& text, const std::string& name) {
  return parseAs(Form::kTum, contentLines(text, name), name);
}

Trajectory readTum(const std::string& path) { return parseTum(base::readTextFile(path), path); }

bool isPoseLine(const std::string& line) { return formOf(line) != Form::kNone; }

Trajectory parsePoses(const std::string& text, const std::string& name) {
  const auto lines = contentLines(text, name);
  const Form form = lines.empty() ? Form::kTum : formOf(lines.front().text);
  return parseAs(form == Form::kNone ? Form::kTum : form, lines, name);
}

Trajectory readPoses(const std::string& path) { return parsePoses(base::readTextFile(path), path); }

}  // namespace engram::evaluation
