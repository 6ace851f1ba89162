#include "memory/ingest/detections.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "mapping/base/error.h"
#include "mapping/base/files.h"
#include "mapping/base/math/math.h"
#include "mapping/base/text/json.h"
#include "perception/detection/detection_values.h"

namespace loci::memory {
namespace {

/// No home reaches farther from the origin: such a number has another unit.
constexpr double kFarthest_m = 1e5;
constexpr double kMaxSize_m = 100;
constexpr size_t kMaxDetections = 1000;

/// With sorted keys: a line of millions of keys must not take hours.
using Parsed = nlohmann::json;

using perception::bounded_number;
using perception::finite_number;
using perception::require_list;
using perception::require_object;
using perception::text_of;

[[noreturn]] void refuse(const std::string& key, const std::string& what, const std::string& hint = {}) {
  throw Error(what, {{}, 0, key}, hint);
}

std::string name(const Parsed& json, const std::string& key) {
  std::string value = text_of(json, key);
  if (value.empty()) refuse(key, "must not be empty");
  return value;
}

template <size_t N>
std::array<double, N> numbers(const Parsed& json, const std::string& key) {
  if (!json.is_array() || json.size() != N) refuse(key, fmt::format("must be {} numbers", N));
  std::array<double, N> values{};
  for (size_t i = 0; i < N; ++i) values[i] = finite_number(json[i], key);
  return values;
}

Vector3d vector(const Parsed& json, const std::string& key) {
  const auto values = numbers<3>(json, key);
  return {values[0], values[1], values[2]};
}

DetectedScene::Camera read_camera(const Parsed& json) {
  DetectedScene::Camera camera;
  mapping::PinholeCamera lens;
  int given = 0;
  for (const auto& [key, value] : require_object(json, "camera").items()) {
    const std::string where = "camera." + key;
    if (key == "pose") {
      camera.map_from_camera = pose_from_values(numbers<7>(value, where), {{}, 0, where});
    } else if (key == "range") {
      const auto range = numbers<2>(value, where);
      if (range[0] < 0 || range[1] <= range[0]) refuse(where, "must be [nearest, farthest] in metres");
      camera.near_m = range[0];
      camera.far_m = range[1];
    } else if (key == "width" || key == "height") {
      (key == "width" ? lens.width : lens.height) = static_cast<int>(bounded_number(value, where, 1, 100000));
      ++given;
    } else if (key == "fx" || key == "fy") {
      (key == "fx" ? lens.fx : lens.fy) = bounded_number(value, where, 1e-3, 1e7);
      ++given;
    } else if (key == "cx" || key == "cy") {
      (key == "cx" ? lens.cx : lens.cy) = bounded_number(value, where, -1e6, 1e6);
      ++given;
    }
  }
  if (given == 6) camera.lens = lens;
  if (given != 6 && given != 0)
    refuse("camera", "has some of width, height, fx, fy, cx, cy: give all or none");
  return camera;
}

Vector3d read_color(const Parsed& json, const std::string& where) {
  Vector3d color = vector(json, where);
  const bool fits = color.minCoeff() >= 0 && color[0] <= 360 && color.tail<2>().maxCoeff() <= 1;
  // No conversion makes a black with a hue or saturation; red in RGB would be one.
  const bool is_rgb = color[2] == 0 && color.head<2>().maxCoeff() > 0;
  if (!fits || is_rgb)
    refuse(where, "must be [hue 0 to 360, saturation 0 to 1, value 0 to 1]",
           is_rgb ? "as such it is black: convert RGB to HSV" : "convert RGB to HSV");
  return color;
}

std::vector<float> read_feature(const Parsed& json, const std::string& where) {
  std::vector<float> values;
  constexpr double kMax = std::numeric_limits<float>::max();
  for (const Parsed& value : require_list(json, where))
    values.push_back(static_cast<float>(bounded_number(value, where, -kMax, kMax)));
  return values;
}

Detection read_detection(const Parsed& json, const std::string& where, const std::filesystem::path& folder,
                         std::vector<std::string>& unknown) {
  Detection detection;
  detection.has_position = json.contains("position");
  for (const auto& [key, value] : require_object(json, where).items()) {
    const std::string here = where + "." + key;
    if (key == "position") {
      detection.position = vector(value, here);
      if (detection.position.cwiseAbs().maxCoeff() > kFarthest_m)
        refuse(here, "lies more than 100 km away", "positions are in metres");
    } else if (value.is_null()) {
      continue;  // unset
    } else if (key == "position_sigma") {
      detection.position_sigma = bounded_number(value, here, 1e-5, 100);
    } else if (key == "size") {
      detection.size = vector(value, here);
      if (detection.size->minCoeff() <= 0 || detection.size->maxCoeff() > kMaxSize_m)
        refuse(here, fmt::format("must be above 0 and up to {} m", kMaxSize_m),
               "leave it out when it is unknown");
    } else if (key == "class") {
      detection.classes = perception::classes_of(value, here);
    } else if (key == "color") {
      detection.color = read_color(value, here);
    } else if (key == "text") {
      if (value.is_string())
        detection.texts.push_back(text_of(value, here));
      else
        for (const Parsed& one : require_list(value, here)) detection.texts.push_back(text_of(one, here));
      std::erase(detection.texts, "");
    } else if (key == "features") {
      for (const auto& [feature, numbers] : require_object(value, here).items())
        detection.features.emplace_back(feature, read_feature(numbers, here + "." + feature));
    } else if (key == "score") {
      detection.score = bounded_number(value, here, 0, 1);
    } else if (key == "place") {
      detection.place = name(value, here);
    } else if (key == "bbox") {
      if (!detection.region) detection.region = perception::region_from_box(value, here);
    } else if (key == "mask") {  // after bbox, which it makes more precise
      detection.region = perception::region_from_mask(value, here, folder);
    } else if (key == "key_points") {
      detection.key_points = perception::key_points_of(value, here);
    } else {
      unknown.push_back("detections." + key);
    }
  }
  if (!detection.has_position && !detection.region) refuse(where, "has no position, bbox or mask");
  return detection;
}

std::vector<std::pair<std::string, double>> read_observed(const Parsed& json) {
  std::vector<std::pair<std::string, double>> observed;
  for (const Parsed& one : require_list(json, "observed")) {
    require_object(one, "observed");
    if (!one.contains("place")) refuse("observed", "has an entry without place");
    const double fraction =
        one.contains("fraction") ? bounded_number(one["fraction"], "observed.fraction", 0, 1) : 1.0;
    observed.emplace_back(name(one["place"], "observed.place"), fraction);
  }
  return observed;
}

void check_masks(const DetectedScene& scene) {
  size_t pixels = 0;
  for (const Detection& detection : scene.detections)
    if (detection.region) pixels += detection.region->mask.total();
  if (pixels > perception::kMaxMaskPixelsPerImage)
    refuse("detections", fmt::format("have masks of more than {} million pixels",
                                     perception::kMaxMaskPixelsPerImage / 1'000'000));
}

}  // namespace

DetectedScene parse_detections(std::string_view line, const std::filesystem::path& folder) {
  const Parsed json = perception::parse_values(line);
  DetectedScene scene;
  if (!json.is_object()) throw Error("is not a JSON object");
  if (!json.contains("time")) throw Error("has no time");
  perception::detections_of(json);
  for (const auto& [key, value] : json.items()) {
    if (key == "time") {
      scene.time = parse_time(text_of(value, "time"));
    } else if (value.is_null()) {
      continue;  // unset
    } else if (key == "camera") {
      scene.camera = read_camera(value);
    } else if (key == "observed") {
      scene.observed = read_observed(value);
    } else if (key == "detections") {
      if (require_list(value, "detections").size() > kMaxDetections)
        refuse("detections", fmt::format("has more than {} entries", kMaxDetections));
      size_t index = 0;
      for (const Parsed& detection : value)
        scene.detections.push_back(
            read_detection(detection, fmt::format("detections[{}]", index++), folder, scene.unknown_keys));
      check_masks(scene);
    } else {
      scene.unknown_keys.push_back(key);
    }
  }
  return scene;
}

LineReader::LineReader(const std::filesystem::path& path, size_t limit) : path_(path), limit_(limit) {
  require_regular_file(path);
  file_.open(path, std::ios::binary);
  if (!file_) throw Error("cannot be read", {path.string(), 0, {}}, "give a file of detections, *.jsonl");
  size_ = std::filesystem::file_size(path);
}

bool LineReader::fill() {
  buffer_.resize(size_t{1} << 16);
  file_.read(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
  buffer_.resize(static_cast<size_t>(file_.gcount()));
  if (file_.bad()) throw Error("cannot be read to its end", {path_.string(), static_cast<int>(number_), {}});
  read_ += buffer_.size();
  at_ = 0;
  return !buffer_.empty();
}

LineReader::Status LineReader::next(std::string& line) {
  line.clear();
  bool any = false, too_long = false;
  while (at_ < buffer_.size() || fill()) {
    if (!any) ++number_;
    any = true;
    const size_t end = std::min(buffer_.find('\n', at_), buffer_.size());
    if (!too_long && line.size() + (end - at_) > limit_) {
      too_long = true;
      std::string().swap(line);
    }
    if (!too_long) line.append(buffer_, at_, end - at_);
    at_ = end + 1;
    if (end < buffer_.size()) break;
  }
  if (!any) return Status::end;
  if (!line.empty() && line.back() == '\r') line.pop_back();
  return too_long ? Status::too_long : Status::line;
}

double LineReader::fraction() const {
  return size_ == 0 ? 0.0 : std::min(1.0, static_cast<double>(read_) / static_cast<double>(size_));
}

namespace {

/// A detection farther than this from all earlier ones is of another object.
constexpr double kNear_m = 0.3;
constexpr size_t kMinDifferences = 60;  ///< differences: twenty pairs
constexpr size_t kMaxDifferences = 200'000;
constexpr double kMinSigma_m = 0.002, kMaxSigma_m = 0.2;

size_t nearest(const Vector3d& position, const std::vector<Detection>& among) {
  size_t best = 0;
  for (size_t i = 1; i < among.size(); ++i)
    if ((among[i].position - position).squaredNorm() < (among[best].position - position).squaredNorm())
      best = i;
  return best;
}

}  // namespace

void PositionNoise::add(const DetectedScene& scene) {
  if (!before_.empty() && !scene.detections.empty() && differences_.size() < kMaxDifferences) {
    for (size_t i = 0; i < scene.detections.size(); ++i) {
      if (!scene.detections[i].has_position) continue;
      const Vector3d& position = scene.detections[i].position;
      const Vector3d& earlier = before_[nearest(position, before_)].position;
      if ((position - earlier).norm() > kNear_m || nearest(earlier, scene.detections) != i) continue;
      for (int axis = 0; axis < 3; ++axis) differences_.push_back(std::abs(position[axis] - earlier[axis]));
    }
  }
  before_.clear();
  std::ranges::copy_if(scene.detections, std::back_inserter(before_), &Detection::has_position);
}

std::optional<double> PositionNoise::sigma_m() const {
  if (differences_.size() < kMinDifferences) return std::nullopt;
  // The median of |d| is 0.6745 standard deviations, and both positions are noisy.
  return std::clamp(median(differences_) / 0.6745 / std::numbers::sqrt2, kMinSigma_m, kMaxSigma_m);
}

}  // namespace loci::memory
