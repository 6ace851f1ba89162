#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mapping/base/math/pose.h"
#include "mapping/base/time.h"
#include "mapping/sensor/frame.h"
#include "perception/detection/lift.h"

namespace loci::memory {

/// An object that another system detected. What is not given is unset.
struct Detection {
  Vector3d position = Vector3d::Zero();                 ///< centre, map frame
  bool has_position = true;                             ///< otherwise it has a region
  std::optional<double> position_sigma;                 ///< metres per axis
  std::optional<Vector3d> size;                         ///< along the axes of the map, metres
  std::vector<std::pair<std::string, double>> classes;  ///< with probabilities, most probable first
  std::optional<Vector3d> color;                        ///< hue 0 to 360, saturation and value 0 to 1
  std::vector<std::string> texts;
  std::vector<std::pair<std::string, std::vector<float>>> features;
  std::optional<double> score;                     ///< uncalibrated, 0 to 1
  std::string place;                               ///< empty = not given
  std::optional<perception::ImageRegion> region;   ///< in the colour image
  std::vector<perception::KeyPoint2D> key_points;  ///< likewise
  std::vector<int32_t> pixels;                     ///< of the depth image, once lifted: row · width + column
  std::vector<perception::KeyPoint3D> lifted_points;  ///< in the map frame
  bool at_image_border = false;
};

/// One line of a file of detections: one scene.
struct DetectedScene {
  struct Camera {
    std::optional<Isometry3d> map_from_camera;
    std::optional<mapping::PinholeCamera> lens;
    std::optional<double> near_m, far_m;
  };
  TimeNs time = 0;
  std::optional<Camera> camera;
  std::optional<std::vector<std::pair<std::string, double>>> observed;  ///< places and seen fractions
  std::vector<Detection> detections;
  std::optional<mapping::RgbdFrame> frame;  ///< of the recording, once lifted
  cv::Mat map_depth;                        ///< of the map alone in that frame; empty without a map
  std::vector<std::string> unknown_keys;    ///< that are not part of the format: "detections.colour"
};

/// Reads one line (docs/file-formats.md); images of masks lie below `folder`. Error has the key as its place;
/// the caller adds file and line.
DetectedScene parse_detections(std::string_view line, const std::filesystem::path& folder = {});

/// Reads a file line by line with bounded memory: lines that are too long are skipped.
class LineReader {
 public:
  enum class Status { line, too_long, end };

  /// Error when the file cannot be read. `limit` in bytes.
  explicit LineReader(const std::filesystem::path& path, size_t limit = kDefaultLimit);

  /// The next line without its end.
  Status next(std::string& line);
  int64_t number() const { return number_; }  ///< of the line read last, from 1
  double fraction() const;                    ///< of the file that was read

  static constexpr size_t kDefaultLimit = size_t{16} << 20;

 private:
  bool fill();

  std::filesystem::path path_;
  std::ifstream file_;
  size_t limit_;
  std::string buffer_;
  size_t at_ = 0;
  int64_t number_ = 0;
  uint64_t read_ = 0, size_ = 0;
};

/// Estimates the noise of detected positions from consecutive scenes: most objects do not move in between, so
/// that the median distance of nearest detections is noise. Robust against moved and missing objects.
class PositionNoise {
 public:
  void add(const DetectedScene& scene);
  /// Standard deviation per axis, metres; unset with too few pairs.
  std::optional<double> sigma_m() const;

  static constexpr double kDefault_m = 0.02;  ///< without an estimate

 private:
  std::vector<Detection> before_;
  std::vector<double> differences_;  ///< per axis, of what is probably one object
};

}  // namespace loci::memory
