#include "apps/evaluate/tracking/trajectories.h"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <cmath>
#include <filesystem>

#include "apps/evaluate/tracking/frame_odometry.h"
#include "mapping/base/math/math.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/text/json.h"
#include "mapping/tracking/tracking.h"

namespace loci::apps::tracking_evaluation {
namespace {

constexpr double kFalseGood = 0.1;  ///< m

/// A part of a recording.
class Part : public mapping::Recording {
 public:
  Part(const mapping::Recording& whole, const FrameRange& range) : whole_(whole), range_(range) {
    const size_t last = std::min(range.last, whole.size());
    size_ = last > range.first ? (last - range.first + range.every - 1) / range.every : 0;
  }
  const mapping::RecordingInfo& info() const override { return whole_.info(); }
  size_t size() const override { return size_; }
  mapping::RgbdFrame frame(size_t i) const override { return whole_.frame(number(i)); }
  TimeNs time_of(size_t i) const override { return whole_.time_of(number(i)); }
  int64_t index_of(size_t i) const override { return whole_.index_of(number(i)); }
  std::optional<Isometry3d> pose_of(size_t i) const override { return whole_.pose_of(number(i)); }

 private:
  size_t number(size_t i) const { return range_.first + i * range_.every; }

  const mapping::Recording& whole_;
  FrameRange range_;
  size_t size_ = 0;
};

/// The rigid motion that brings estimated poses onto the reference; orientations decide where positions do
/// not.
Isometry3d alignment_of(const Trajectory& estimate, const Trajectory& reference) {
  constexpr double kOrientation = 1e-3;  // m²
  Vector3d from = Vector3d::Zero(), to = Vector3d::Zero();
  for (const auto& [i, pose] : estimate) {
    from += pose.translation() / static_cast<double>(estimate.size());
    to += reference.at(i).translation() / static_cast<double>(estimate.size());
  }
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const auto& [i, pose] : estimate)
    covariance += (reference.at(i).translation() - to) * (pose.translation() - from).transpose() +
                  kOrientation * reference.at(i).linear() * pose.linear().transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d sign = Eigen::Matrix3d::Identity();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0) sign(2, 2) = -1;
  Isometry3d motion = Isometry3d::Identity();
  motion.linear() = svd.matrixU() * sign * svd.matrixV().transpose();
  motion.translation() = to - motion.linear() * from;
  return motion;
}

void add_absolute_errors(const Trajectory& estimate, const Trajectory& reference, Row& row) {
  if (estimate.empty()) return;
  const Isometry3d motion = alignment_of(estimate, reference);
  double squares = 0;
  for (const auto& [i, pose] : estimate) {
    const double error = (motion * pose.translation() - reference.at(i).translation()).norm();
    squares += error * error;
    row.ate_max_m = std::max(row.ate_max_m, error);
    if (error > kFalseGood) ++row.false_good;
  }
  row.ate_rmse_m = std::sqrt(squares / static_cast<double>(estimate.size()));
}

/// Errors of the motion within a second; frames that are not there are passed over.
void add_relative_errors(const Trajectory& estimate, const Trajectory& reference, const Part& part,
                         Row& row) {
  double metres = 0, degrees = 0;
  for (auto from = estimate.begin(), to = from; from != estimate.end(); ++from) {
    while (to != estimate.end() &&
           part.time_of(to->first) - part.time_of(from->first) < kSecond - kSecond / 100)
      ++to;
    if (to == estimate.end()) break;
    if (part.time_of(to->first) - part.time_of(from->first) > kSecond + kSecond / 5) continue;
    const Isometry3d truth = reference.at(from->first).inverse() * reference.at(to->first);
    const Isometry3d error = truth.inverse() * (from->second.inverse() * to->second);
    metres += error.translation().squaredNorm();
    degrees += std::pow(Eigen::AngleAxisd(error.linear()).angle() / kDegree, 2);
    ++row.relative_pairs;
  }
  if (row.relative_pairs == 0) return;
  row.relative_m = std::sqrt(metres / static_cast<double>(row.relative_pairs));
  row.relative_deg = std::sqrt(degrees / static_cast<double>(row.relative_pairs));
}

/// Sum of squared depth differences of two images under a motion, up to 10 cm: farther ones are other
/// surfaces.
std::pair<double, size_t> depth_difference(const mapping::RgbdFrame& a, const mapping::RgbdFrame& b,
                                           const Isometry3d& b_from_a) {
  double squares = 0;
  size_t count = 0;
  for (int v = 4; v < a.depth.rows; v += 8) {
    for (int u = 4; u < a.depth.cols; u += 8) {
      const auto z = static_cast<double>(a.depth.at<float>(v, u));
      if (!(z > 0)) continue;
      const Vector3d point = b_from_a * a.camera.depth.unproject(u, v, z);
      if (point.z() < 0.1) continue;
      const Vector2d pixel = b.camera.depth.project(point);
      if (!b.camera.depth.contains(pixel)) continue;
      const double difference =
          static_cast<double>(b.depth.at<float>(static_cast<int>(std::lround(pixel.y())),
                                                static_cast<int>(std::lround(pixel.x())))) -
          point.z();
      if (!(std::abs(difference) < 0.1)) continue;
      squares += difference * difference;
      ++count;
    }
  }
  return {squares, count};
}

double surface_distance(const Trajectory& poses, const Part& part) {
  double squares = 0;
  size_t count = 0;
  const size_t step = std::max<size_t>(1, poses.size() / 40);
  size_t position = 0;
  for (auto from = poses.begin(); from != poses.end(); ++from) {
    if (position++ % step != 0) continue;
    auto to = from;
    while (to != poses.end() && part.time_of(to->first) - part.time_of(from->first) < kSecond / 2) ++to;
    if (to == poses.end()) break;
    const auto [sum, pixels] =
        depth_difference(part.frame(from->first), part.frame(to->first), to->second.inverse() * from->second);
    squares += sum;
    count += pixels;
  }
  return count == 0 ? 0 : std::sqrt(squares / static_cast<double>(count));
}

void finish(Row& row, const Trajectory& estimate, const Trajectory& reference, const Part& part) {
  row.frames = part.size();
  row.good = estimate.size();
  Trajectory judged;
  for (const auto& [i, pose] : estimate)
    if (reference.contains(i)) judged.emplace(i, pose);
  add_absolute_errors(judged, reference, row);
  add_relative_errors(judged, reference, part, row);
  row.surface_m = surface_distance(estimate, part);
}

Row our_row(const Part& part, const Trajectory& reference, int threads, Progress& progress) {
  mapping::TrackingOptions options;
  options.threads = threads;
  const mapping::TrackingResult result = track(part, options, progress);
  Trajectory estimate;
  for (const mapping::TrackedFrame& frame : result.frames)
    if (frame.map_from_camera) estimate[frame.number] = *frame.map_from_camera;
  Row row;
  row.method = "loci";
  row.cpu_ms = 1e3 * result.cpu_seconds / static_cast<double>(part.size());
  row.frames_per_second = static_cast<double>(part.size()) / result.seconds;
  finish(row, estimate, reference, part);
  return row;
}

/// Motions from frame to frame, chained; a frame that is refused is lost, and the next goes on from it.
Row peer_row(const std::string& method, FrameOdometry& odometry, const Part& part,
             const Trajectory& reference, Progress& progress) {
  const Stopwatch watch;
  Trajectory estimate;
  Isometry3d pose = Isometry3d::Identity();
  for (size_t i = 0; i < part.size(); ++i) {
    progress.check(static_cast<double>(i) / static_cast<double>(part.size()), method);
    const auto motion = odometry.add(part.frame(i));
    if (!motion) continue;
    pose = pose * *motion;
    estimate[i] = pose;
  }
  Row row;
  row.method = method;
  row.cpu_ms = 1e3 * watch.cpu_seconds() / static_cast<double>(part.size());
  row.frames_per_second = static_cast<double>(part.size()) / watch.seconds();
  finish(row, estimate, reference, part);
  return row;
}

}  // namespace

std::vector<Row> compare_trackers(const std::string& recording, const FrameRange& range, const Peers& peers,
                                  int threads, Progress& progress) {
  const auto whole = mapping::open_recording(recording);
  const Part part(*whole, range);
  if (part.size() < 2)
    throw Error("there are fewer than two frames", {recording, 0, {}}, "check --first and --last");
  Trajectory reference;
  for (size_t i = 0; i < part.size(); ++i)
    if (const auto pose = part.pose_of(i)) reference[i] = *pose;
  if (reference.empty()) throw Error("the recording has no reference poses", {recording, 0, {}});
  std::vector<Row> rows = {our_row(part, reference, threads, progress)};
  const mapping::PinholeCamera& camera = part.info().camera.depth;
  if (peers.opencv)
    rows.push_back(peer_row("OpenCV RgbdICPOdometry", *opencv_odometry(camera), part, reference, progress));
  if (const auto odometry = peers.open3d ? open3d_odometry(camera) : nullptr)
    rows.push_back(peer_row("Open3D RGB-D odometry", *odometry, part, reference, progress));
  else if (peers.open3d)
    throw Error("loci was built without Open3D", {}, "install libopen3d-dev and build loci-evaluate again");
  Row own;
  own.method = "reference";
  finish(own, reference, reference, part);
  rows.push_back(own);
  for (Row& row : rows) row.recording = fmt::format("{}, every {}", recording, range.every);
  return rows;
}

std::string to_text(const std::vector<Row>& rows) {
  std::string text, recording;
  for (const Row& row : rows) {
    if (row.recording != recording) {
      text += row.recording + "\n";
      text += fmt::format("  {:24} {:>9} {:>8} {:>8} {:>9} {:>9} {:>9} {:>10} {:>9} {:>8}\n", "method",
                          "good", "ATE cm", "max cm", "mm per s", "deg per s", "> 10 cm", "surface mm",
                          "CPU ms", "frames/s");
    }
    recording = row.recording;
    text += fmt::format("  {:24} {:>9} {:8.2f} {:8.2f} {:9.1f} {:9.2f} {:9} {:10.1f} {:9.1f} {:8.1f}\n",
                        row.method, fmt::format("{}/{}", row.good, row.frames), 100 * row.ate_rmse_m,
                        100 * row.ate_max_m, 1000 * row.relative_m, row.relative_deg, row.false_good,
                        1000 * row.surface_m, row.cpu_ms, row.frames_per_second);
  }
  return text;
}

Json to_json(const std::vector<Row>& rows) {
  Json json = Json::array();
  for (const Row& row : rows)
    json.push_back({{"recording", row.recording},
                    {"method", row.method},
                    {"frames", row.frames},
                    {"good", row.good},
                    {"ate_rmse_m", row.ate_rmse_m},
                    {"ate_max_m", row.ate_max_m},
                    {"relative_m_per_s", row.relative_m},
                    {"relative_deg_per_s", row.relative_deg},
                    {"false_good", row.false_good},
                    {"surface_m", row.surface_m},
                    {"cpu_ms_per_frame", row.cpu_ms},
                    {"frames_per_second", row.frames_per_second}});
  return json;
}

}  // namespace loci::apps::tracking_evaluation
