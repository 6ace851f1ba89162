#include "perception/detection/detection_set.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "mapping/base/config.h"
#include "mapping/base/files.h"
#include "mapping/base/text/text.h"
#include "perception/detection/detection_values.h"

namespace loci::perception {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;  // sorted keys: a file of millions of them must not take hours

constexpr uintmax_t kMaxFileBytes = uintmax_t{512} << 20;

[[noreturn]] void refuse_at(const FileLocation& where, const std::string& what,
                            const std::string& hint = {}) {
  throw Error(what, where, hint);
}

/// Error with the file in its place.
template <class Function>
auto in_file(const fs::path& file, Function read) {
  try {
    return read();
  } catch (const Error& error) {
    throw Error(error.message(), {file.string(), error.location().line, error.location().key}, error.hint());
  }
}

/// What names an image: its file without folder, ending and the words that tell colour from depth.
std::string image_name(const std::string& file) {
  std::string name = lower_case(fs::path(file).stem().string());
  for (const char* word : {"color", "colour", "depth", "rgb", "image"}) {
    const size_t at = name.find(word);
    if (at != std::string::npos) name.erase(at, std::string_view(word).size());
  }
  const auto separator = [](char c) { return c == '.' || c == '_' || c == '-'; };
  while (!name.empty() && separator(name.back())) name.pop_back();
  while (!name.empty() && separator(name.front())) name.erase(name.begin());
  return name;
}

/// The number at the end of a name.
std::optional<int64_t> number_of(const std::string& name) {
  const size_t begin = name.find_last_not_of("0123456789") + 1;
  int64_t number = 0;
  const auto [end, code] = std::from_chars(name.data() + begin, name.data() + name.size(), number);
  return begin < name.size() && code == std::errc() ? std::optional(number) : std::nullopt;
}

/// Seconds with a fraction, "1305031102.175304", as nanoseconds.
std::optional<TimeNs> time_of(const std::string& name) {
  const size_t point = name.find('.');
  if (point == std::string::npos || point == 0 || name.size() - point > 10) return std::nullopt;
  if (name.find_first_not_of("0123456789.") != std::string::npos) return std::nullopt;
  int64_t seconds = 0, fraction = 0;
  const std::string digits = (name.substr(point + 1) + "000000000").substr(0, 9);
  if (std::from_chars(name.data(), name.data() + point, seconds).ec != std::errc() ||
      seconds > 9'000'000'000 ||
      std::from_chars(digits.data(), digits.data() + 9, fraction).ptr != digits.data() + 9)
    return std::nullopt;
  return seconds * kSecond + fraction;
}

// COCO.

const json& member(const json& object, const char* key, const std::string& where) {
  if (!object.is_object() || !object.contains(key))
    refuse_at({{}, 0, where}, fmt::format("has no '{}'", key));
  return object[key];
}

const json& list(const json& object, const char* key) {
  const json& value = member(object, key, "the file");
  if (!value.is_array()) refuse_at({{}, 0, key}, "must be a list [...]");
  return value;
}

/// A number or a text that identifies something.
std::string id_of(const json& value, const std::string& where) {
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_number_integer()) refuse_at({{}, 0, where}, "must be an integer or a text");
  return value.dump();
}

/// Often numbers are counted from another start than the names.
constexpr const char* kFirstNumber = "is the first class 0 or 1?";

struct Category {
  std::string name;
  std::vector<std::string> key_points;
};

std::map<std::string, Category> read_categories(const json& file) {
  std::map<std::string, Category> categories;
  for (const json& entry : list(file, "categories")) {
    const std::string id = id_of(member(entry, "id", "categories"), "categories.id");
    const json& name = member(entry, "name", "categories");
    if (!name.is_string() || name.get<std::string>().empty())
      refuse_at({{}, 0, "categories.name"}, "must be a text");
    const auto [known, added] = categories.emplace(id, Category{name.get<std::string>(), {}});
    Category& category = known->second;
    if (!added)
      refuse_at({{}, 0, "categories.id"},
                fmt::format("{} is the id of '{}' and of '{}'", id, category.name, name.get<std::string>()));
    if (!entry.contains("keypoints") || !entry["keypoints"].is_array()) continue;
    for (const json& point : entry["keypoints"])
      category.key_points.push_back(point.is_string() ? point.get<std::string>() : std::string());
  }
  return categories;
}

std::map<std::string, ImageDetections> read_images(const json& file, std::map<std::string, cv::Size>& sizes) {
  std::map<std::string, ImageDetections> images;
  for (const json& entry : list(file, "images")) {
    const std::string id = id_of(member(entry, "id", "images"), "images.id");
    const json& name = member(entry, "file_name", "images");
    if (!name.is_string()) refuse_at({{}, 0, "images.file_name"}, "must be a text");
    if (images.contains(id)) refuse_at({{}, 0, "images.id"}, fmt::format("{} stands twice", id));
    images[id].image = image_name(name.get<std::string>());
    images[id].time = time_of(images[id].image);
    if (!entry.contains("width") || !entry.contains("height")) continue;
    const auto side = [&](const char* key) {
      if (!entry[key].is_number_integer() || entry[key].get<int64_t>() < 1 ||
          entry[key].get<int64_t>() > kMaxImageSide)
        refuse_at({{}, 0, std::string("images.") + key}, fmt::format("must be from 1 to {}", kMaxImageSide));
      return entry[key].get<int>();
    };
    sizes[id] = {side("width"), side("height")};
  }
  return images;
}

std::vector<KeyPoint2D> read_key_points(const json& values, const Category& category,
                                        const std::string& where) {
  std::vector<KeyPoint2D> points;
  if (!values.is_array() || values.size() % 3 != 0 || values.size() > 3000)
    refuse_at({{}, 0, where}, "must be x, y, visibility for each point");
  for (size_t i = 0; i < values.size(); i += 3) {
    for (size_t k = i; k < i + 3; ++k)
      if (!values[k].is_number() || !(std::abs(values[k].get<double>()) <= kMaxImageSide))
        refuse_at({{}, 0, where}, "must be pixels of the image");
    if (!(values[i + 2].get<double>() > 0)) continue;  // not in the image
    const size_t number = i / 3;
    const bool named = number < category.key_points.size() && !category.key_points[number].empty();
    points.push_back({named ? category.key_points[number] : fmt::format("point_{}", number + 1),
                      values[i].get<double>(), values[i + 1].get<double>()});
  }
  return points;
}

/// The box around key points.
ImageRegion region_of(const std::vector<KeyPoint2D>& points, const std::string& where) {
  ImageRegion region;
  double left = points.front().x, right = left, top = points.front().y, bottom = top;
  for (const KeyPoint2D& point : points) {
    left = std::min(left, point.x);
    right = std::max(right, point.x);
    top = std::min(top, point.y);
    bottom = std::max(bottom, point.y);
  }
  if (right - left < 1 || bottom - top < 1) refuse_at({{}, 0, where}, "lie in a line, and there is no box");
  region.box = {left, top, right - left, bottom - top};
  return region;
}

Detection2D read_annotation(const json& entry, const std::map<std::string, Category>& categories,
                            const cv::Size& image, const std::string& where, const fs::path& folder) {
  Detection2D detection;
  const std::string id = id_of(member(entry, "category_id", where), where + ".category_id");
  const auto known = categories.find(id);
  if (known == categories.end() && !categories.empty())
    refuse_at({{}, 0, where + ".category_id"}, fmt::format("{} is none of the file's categories", id),
              kFirstNumber);
  const Category category = known != categories.end() ? known->second : Category{"class_" + id, {}};
  if (entry.contains("score") && !entry["score"].is_null()) {
    const json& score = entry["score"];
    if (!score.is_number() || !(score.get<double>() >= 0 && score.get<double>() <= 1))
      refuse_at({{}, 0, where + ".score"}, "must be from 0 to 1");
    detection.score = score.get<double>();
  }
  detection.classes = {{category.name, detection.score.value_or(1.0)}};
  const auto given = [&](const char* key) {
    return entry.contains(key) && !entry[key].is_null() && !(entry[key].is_array() && entry[key].empty());
  };
  if (given("keypoints"))
    detection.key_points = read_key_points(entry["keypoints"], category, where + ".keypoints");
  if (given("segmentation"))
    detection.region = region_from_mask(entry["segmentation"], where + ".segmentation", folder);
  else if (given("bbox"))
    detection.region = region_from_box(entry["bbox"], where + ".bbox");
  else if (!detection.key_points.empty())
    detection.region = region_of(detection.key_points, where + ".keypoints");
  else
    refuse_at({{}, 0, where}, "has neither segmentation, bbox nor keypoints");
  if (detection.region.image.empty()) detection.region.image = image;
  if (!image.empty() && detection.region.image != image)
    refuse_at({{}, 0, where + ".segmentation"}, "has another size than its image");
  return detection;
}

/// Whether an annotation is a region of several objects, of which none is told apart.
bool is_crowd(const json& entry, const std::string& where) {
  if (!entry.contains("iscrowd")) return false;
  const json& value = entry["iscrowd"];
  if (value != 0 && value != 1 && !value.is_boolean())
    refuse_at({{}, 0, where + ".iscrowd"}, "must be 0 or 1");
  return value == 1 || value == true;
}

/// Error for what is a scene, or a list of scenes, as JSON Lines have one in each line.
void refuse_scenes(const json& file) {
  const json& first = file.is_array() && !file.empty() ? file.front() : file;
  if (first.is_object() && first.contains("time") && first.contains("detections"))
    throw Error("has scenes, but not one per line", {}, kScenePerLine);
}

std::vector<ImageDetections> read_coco(const fs::path& path, Warnings& warnings) {
  if (fs::file_size(path) > kMaxFileBytes)
    refuse_at({path.string(), 0, {}}, fmt::format("is larger than {} MB", kMaxFileBytes >> 20));
  const json file = parse_values(read_file(path));
  refuse_scenes(file);
  std::map<std::string, ImageDetections> images;
  std::map<std::string, cv::Size> sizes;
  std::map<std::string, Category> categories;
  const bool results = file.is_array();  // of a run: images and categories by number alone
  if (!results) {
    images = read_images(file, sizes);
    categories = read_categories(file);
  }
  if (categories.empty()) {
    warnings.add(fmt::format("{} without names of classes: they are called class_1, class_2, …",
                             results ? "is a list of results" : "is"),
                 {path.string(), 0, {}});
  }
  std::map<std::string, size_t> mask_pixels;
  size_t number = 0, crowds = 0;
  for (const json& entry : results ? file : list(file, "annotations")) {
    const std::string where = fmt::format("annotations[{}]", number++);
    const std::string id = id_of(member(entry, "image_id", where), where + ".image_id");
    if (!results && !images.contains(id))
      refuse_at({{}, 0, where + ".image_id"}, "names no image of the file");
    ImageDetections& image = images[id];
    if (is_crowd(entry, where)) {
      ++crowds;
      continue;
    }
    if (results) {
      image.image = image_name(id + ".png");
      image.time = time_of(image.image);
    }
    image.detections.push_back(read_annotation(entry, categories, sizes[id], where, path.parent_path()));
    mask_pixels[id] += image.detections.back().region.mask.total();
    if (image.detections.size() > kMaxDetectionsPerImage || mask_pixels[id] > kMaxMaskPixelsPerImage)
      refuse_at({{}, 0, where}, "is one of too many detections of one image");
  }
  if (crowds > 0)
    warnings.add(fmt::format("{} of several objects at once (iscrowd) left out", counted(crowds, "region")),
                 {path.string(), 0, {}});
  std::vector<ImageDetections> all;
  for (auto& [id, image] : images) all.push_back(std::move(image));
  return all;
}

// YOLO.

/// The names of classes from classes.txt or data.yaml in or beside a folder; empty when there are none.
std::vector<std::string> find_class_names(const fs::path& folder) {
  for (const fs::path& place : {folder, folder.parent_path()})
    for (const char* file : {"classes.txt", "data.yaml"})
      if (fs::exists(place / file)) return read_class_names(place / file);
  return {};
}

/// What the files of a YOLO folder leave open.
struct YoloNames {
  std::vector<std::string> classes;
  std::vector<std::string> key_points;  ///< of every detection; empty without
  size_t values_per_point = 3;          ///< x, y and how visible it is, or x, y
};

/// From classes.txt or data.yaml in or beside a folder.
YoloNames read_names(const fs::path& folder) {
  YoloNames names;
  names.classes = find_class_names(folder);
  for (const fs::path& place : {folder, folder.parent_path()}) {
    const fs::path file = place / "data.yaml";
    if (!fs::exists(file)) continue;
    const YAML::Node shape = Config::read(file).node("kpt_shape");
    if (!shape) break;
    int64_t points = 0;
    if (!shape.IsSequence() || shape.size() != 2 || !YAML::convert<int64_t>::decode(shape[0], points) ||
        points < 1 || points > 1000 || !YAML::convert<size_t>::decode(shape[1], names.values_per_point) ||
        (names.values_per_point != 2 && names.values_per_point != 3))
      refuse_at({file.string(), 0, "kpt_shape"}, "must be [number of points, 2 or 3]");
    for (int64_t i = 1; i <= points; ++i) names.key_points.push_back(fmt::format("point_{}", i));
    break;
  }
  return names;
}

std::vector<double> numbers_of_line(const std::string& line) {
  std::vector<double> values;
  for (const std::string& word : words_of(line)) {
    double value = 0;
    const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (code != std::errc() || end != word.data() + word.size() || !std::isfinite(value))
      throw Error("'" + word.substr(0, 20) + "' is not a number");
    values.push_back(value);
  }
  return values;
}

void require_fractions(std::span<const double> values) {
  for (const double value : values)
    if (value < -0.01 || value > 1.01) throw Error("has a value outside 0 to 1");
}

/// x, y, width, height in fractions of an image whose size is not known yet.
ImageRegion region_of_fractions(std::span<const double> box) {
  require_fractions(box);
  if (box[2] <= 0 || box[3] <= 0) throw Error("has a box without width or height");
  ImageRegion region;
  region.image = {1, 1};
  region.box = {box[0] - box[2] / 2, box[1] - box[3] / 2, box[2], box[3]};
  return region;
}

ImageRegion region_of_outline(std::span<const double> outline) {
  require_fractions(outline);
  // Outlines are drawn finely enough for the images of any camera.
  constexpr double kSide = 2048;
  std::vector<double> corners;
  for (const double value : outline) corners.push_back(value * kSide);
  ImageRegion region = region_from_polygons({corners}, {});
  region.image = {static_cast<int>(kSide), static_cast<int>(kSide)};
  return region;
}

/// Labels say 0 of points outside the image; detectors give a confidence.
std::vector<KeyPoint2D> points_of_fractions(std::span<const double> values, const YoloNames& names) {
  constexpr double kSeen = 0.5;
  std::vector<KeyPoint2D> points;
  for (const std::string& name : names.key_points) {
    require_fractions(values.first(2));
    if (names.values_per_point == 2 || values[2] >= kSeen) points.push_back({name, values[0], values[1]});
    values = values.subspan(names.values_per_point);
  }
  return points;
}

Detection2D read_line(const std::string& line, const YoloNames& names) {
  constexpr size_t kBox = 5;  // class x y width height
  std::vector<double> values = numbers_of_line(line);
  if (values.size() < kBox) throw Error("has fewer than five numbers", {}, "class x y width height [score]");
  const double number = values.front();
  if (number < 0 || number > 1e6 || number != std::floor(number)) throw Error("has no class number");
  Detection2D detection;
  const size_t with_points = kBox + names.key_points.size() * names.values_per_point;
  // Boxes and outlines have an odd number of values, and then perhaps a score.
  if (names.key_points.empty() ? values.size() % 2 == 0 : values.size() == with_points + 1) {
    detection.score = values.back();
    values.pop_back();
    if (*detection.score < 0 || *detection.score > 1) throw Error("has a score outside 0 to 1");
  }
  const auto index = static_cast<size_t>(number);
  if (!names.classes.empty() && index >= names.classes.size())
    throw Error(fmt::format("has class {}, and there are names of the classes 0 to {}", index,
                            names.classes.size() - 1),
                {}, kFirstNumber);
  detection.classes = {{index < names.classes.size() ? names.classes[index] : fmt::format("class_{}", index),
                        detection.score.value_or(1.0)}};
  const auto positions = std::span<const double>(values).subspan(1);
  if (values.size() == with_points) {
    detection.region = region_of_fractions(positions.first(4));
    detection.key_points = points_of_fractions(positions.subspan(4), names);
  } else if (!names.key_points.empty()) {
    throw Error(fmt::format("has {} numbers, {} are expected with `kpt_shape`", values.size(), with_points));
  } else if (values.size() < 7) {
    throw Error("has neither a box nor an outline of three corners");
  } else {
    detection.region = region_of_outline(positions);
  }
  return detection;
}

std::vector<ImageDetections> read_yolo(const fs::path& folder, Warnings& warnings) {
  const YoloNames names = read_names(folder);
  if (names.classes.empty())
    warnings.add("has no classes.txt or data.yaml: classes are called class_0, class_1, …",
                 {folder.string(), 0, {}});
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".txt" && entry.path().filename() != "classes.txt")
      files.push_back(entry.path());
  std::ranges::sort(files);
  std::vector<ImageDetections> images;
  for (const fs::path& file : files) {
    if (fs::file_size(file) > (uintmax_t{16} << 20))
      refuse_at({file.string(), 0, {}}, "is larger than 16 MB");
    ImageDetections& image = images.emplace_back();
    image.image = image_name(file.filename().string());
    image.time = time_of(image.image);
    int number = 0;
    size_t mask_pixels = 0;
    for (const std::string& line : split(read_file(file), '\n')) {
      ++number;
      if (trimmed(line).empty()) continue;
      try {
        image.detections.push_back(read_line(line, names));
      } catch (const Error& error) {
        refuse_at({file.string(), number, {}}, error.message(), error.hint());
      }
      mask_pixels += image.detections.back().region.mask.total();
      if (image.detections.size() > kMaxDetectionsPerImage || mask_pixels > kMaxMaskPixelsPerImage)
        refuse_at({file.string(), number, {}}, "has too many detections");
    }
  }
  return images;
}

// JSON Lines.

Detection2D read_detection(const json& entry, const std::string& where, const fs::path& folder) {
  require_object(entry, where);
  Detection2D detection;
  const auto given = [&](const char* key) { return entry.contains(key) && !entry[key].is_null(); };
  if (given("mask"))
    detection.region = region_from_mask(entry["mask"], where + ".mask", folder);
  else if (given("bbox"))
    detection.region = region_from_box(entry["bbox"], where + ".bbox");
  else
    refuse_at({{}, 0, where}, "has no bbox or mask", "`loci-memory ingest` takes positions");
  if (given("score")) detection.score = bounded_number(entry["score"], where + ".score", 0, 1);
  if (given("class")) detection.classes = classes_of(entry["class"], where + ".class");
  if (given("key_points")) detection.key_points = key_points_of(entry["key_points"], where + ".key_points");
  return detection;
}

ImageDetections read_scene(const std::string& line, const fs::path& folder) {
  const json scene = parse_values(line);
  ImageDetections image;
  image.time = parse_time(text_of(member(scene, "time", "the line"), "time"));
  image.image = fmt::format("time {}", *image.time);
  size_t mask_pixels = 0;
  for (const json& entry : require_list(detections_of(scene), "detections")) {
    const std::string where = fmt::format("detections[{}]", image.detections.size());
    image.detections.push_back(read_detection(entry, where, folder));
    mask_pixels += image.detections.back().region.mask.total();
    if (image.detections.size() > kMaxDetectionsPerImage || mask_pixels > kMaxMaskPixelsPerImage)
      refuse_at({{}, 0, where}, "is one of too many detections of one image");
  }
  return image;
}

std::vector<ImageDetections> read_json_lines(const fs::path& path) {
  if (fs::file_size(path) > kMaxFileBytes)
    refuse_at({path.string(), 0, {}}, fmt::format("is larger than {} MB", kMaxFileBytes >> 20));
  std::vector<ImageDetections> images;
  int number = 0;
  for (const std::string& line : split(read_file(path), '\n')) {
    ++number;
    if (trimmed(line).empty()) continue;
    try {
      images.push_back(read_scene(line, path.parent_path()));
    } catch (const Error& error) {
      throw Error(error.message(), {path.string(), number, error.location().key}, error.hint());
    }
  }
  return images;
}

}  // namespace

std::vector<std::string> read_class_names(const fs::path& file) {
  std::vector<std::string> names;
  if (file.extension() == ".yaml") {
    const YAML::Node list = Config::read(file).node("names");
    // Either a list, or a mapping from number to name.
    for (size_t i = 0; list && i < list.size(); ++i) {
      const YAML::Node name = list[i];
      if (!name || !name.IsScalar())
        refuse_at({file.string(), 0, "names"}, "must name the classes from 0 on");
      names.push_back(name.as<std::string>());
    }
  } else {
    for (const std::string& line : split(read_file(file), '\n')) names.push_back(trimmed(line));
    while (!names.empty() && names.back().empty()) names.pop_back();
  }
  for (const std::string& name : names) require_utf8(name);
  return names;
}

DetectionSet DetectionSet::read(const fs::path& path, Warnings& warnings) {
  DetectionSet set;
  if (!fs::exists(path)) throw Error("no such file or folder", {path.string(), 0, {}});
  if (fs::is_directory(path))
    set.images_ = read_yolo(path, warnings);
  else if (path.extension() == ".jsonl")
    set.images_ = read_json_lines(path);
  else
    set.images_ = in_file(path, [&] { return read_coco(path, warnings); });
  if (set.images_.empty())
    throw Error(
        "has no detections", {path.string(), 0, {}},
        "give a COCO file (*.json), JSON Lines (*.jsonl) or a folder with a YOLO text file per image");
  set.index();
  return set;
}

void DetectionSet::index() {
  for (size_t i = 0; i < images_.size(); ++i) {
    const std::string& name = images_[i].image;
    if (!by_name_.emplace(name, i).second)
      throw Error("two images are called '" + name + "'", {}, "detect in one recording at a time");
    if (const auto number = number_of(name)) by_number_.emplace(*number, i);
    if (images_[i].time) by_time_.emplace(*images_[i].time, i);
  }
}

const ImageDetections* DetectionSet::find(const std::string& frame_name, int64_t frame_index,
                                          TimeNs time) const {
  const std::string name = image_name(frame_name + ".png");
  if (const auto found = by_name_.find(name); found != by_name_.end()) return &images_[found->second];
  if (by_time_.size() == images_.size()) {  // Colour and depth have stamps of their own.
    constexpr TimeNs kTolerance = kSecond / 50;
    auto nearest = by_time_.lower_bound(time);
    if (nearest == by_time_.end() ||
        (nearest != by_time_.begin() && time - std::prev(nearest)->first < nearest->first - time))
      nearest = std::prev(nearest);
    return std::abs(nearest->first - time) <= kTolerance ? &images_[nearest->second] : nullptr;
  }
  const auto found = by_number_.find(number_of(name).value_or(frame_index));
  return found != by_number_.end() ? &images_[found->second] : nullptr;
}

}  // namespace loci::perception
