#include "gui/data/scene_content.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>
#include <unordered_map>
#include <vector>

#include "mapping/base/error.h"
#include "mapping/base/text/json.h"
#include "mapping/image/image_io.h"
#include "memory/store/scene_images.h"
#include "memory/store/store.h"

namespace loci::gui {

cv::Mat read_image(const memory::Store& store, memory::Id blob) {
  const std::string name = fmt::format("{}: image {}", store.path().string(), blob);
  const memory::BlobRow row = store.blob(blob);
  const std::vector<unsigned char> bytes(row.bytes.begin(), row.bytes.end());
  cv::Mat image = mapping::decode_image(bytes, name);
  if (image.type() == CV_8UC3) return image;
  if (image.depth() != CV_8U) throw Error("an image with more than 8 bits", {name, 0, {}});
  cv::Mat color;
  cv::cvtColor(image, color, image.channels() == 4 ? cv::COLOR_BGRA2BGR : cv::COLOR_GRAY2BGR);
  return color;
}

namespace {

double distance_of(const std::optional<Vector3d>& position, const SceneContent& content) {
  double z = 1;
  if (position && content.map_from_camera) z = (content.map_from_camera->inverse() * *position).z();
  return std::max(z, 0.1);
}

/// Where a part of the depth image is in the colour image, at the distance of what it shows.
cv::Rect2d in_color_image(const cv::Rect2d& roi, const std::optional<Vector3d>& position,
                          const SceneContent& content) {
  const mapping::RgbdCamera& camera = content.camera;
  const Isometry3d color_from_depth = camera.depth_from_color.inverse();
  const double z = distance_of(position, content);
  Eigen::AlignedBox2d area;
  for (const auto& [u, v] : {std::pair(roi.x, roi.y), std::pair(roi.x + roi.width, roi.y + roi.height)})
    area.extend(camera.color.project(color_from_depth * camera.depth.unproject(u, v, z)));
  return {area.min().x(), area.min().y(), area.sizes().x(), area.sizes().y()};
}

cv::Mat read_mask(const memory::Store& store, memory::Id blob) {
  cv::Mat mask;
  cv::extractChannel(read_image(store, blob), mask, 0);
  return mask;
}

/// The mask's outlines as drawings over both images.
void add_outlines(const cv::Mat& mask, const std::optional<Vector3d>& position, const SceneContent& content,
                  ImageBox& box) {
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(mask, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_SIMPLE);
  const mapping::RgbdCamera& camera = content.camera;
  const Isometry3d color_from_depth = camera.depth_from_color.inverse();
  const double z = distance_of(position, content);
  for (const auto& contour : contours) {
    auto& in_depth = box.depth_outline.emplace_back();
    auto& in_color = box.color_outline.emplace_back();
    for (const cv::Point& pixel : contour) {
      const double u = pixel.x + box.depth.x, v = pixel.y + box.depth.y;
      const Vector2d there = camera.color.project(color_from_depth * camera.depth.unproject(u, v, z));
      in_depth.emplace_back(static_cast<float>(u), static_cast<float>(v));
      in_color.emplace_back(static_cast<float>(there.x()), static_cast<float>(there.y()));
    }
  }
}

std::vector<ImageBox> read_boxes(const memory::Store& store, const SceneContent& content) {
  std::unordered_map<memory::Id, memory::Id> object_of;  // 0 = of a false cluster
  for (const memory::AssociationRow& association : store.associations(content.scene.id))
    if (association.chosen && association.observation && association.probability > 0)
      object_of[*association.observation] = association.object.value_or(0);
  std::vector<ImageBox> boxes;
  for (const memory::ObservationRow& seen : store.observations(content.scene.id)) {
    if (!seen.roi) continue;
    const auto found = object_of.find(seen.id);
    ImageBox box{.object = found == object_of.end() ? 0 : found->second, .number = seen.number};
    if (box.object == 0) box.unnamed = found == object_of.end() ? "tentative" : "false cluster";
    const auto& roi = *seen.roi;
    box.depth = cv::Rect2d(roi[0], roi[1], roi[2], roi[3]);
    box.color = in_color_image(box.depth, seen.position, content);
    if (seen.mask) add_outlines(read_mask(store, *seen.mask), seen.position, content, box);
    boxes.push_back(std::move(box));
  }
  return boxes;
}

}  // namespace

SceneContent read_scene_content(const memory::Store& store, const memory::SceneRow& row) {
  SceneContent content{.scene = row, .map_from_camera = row.map_from_camera};
  if (row.camera) content.camera = cameras_of(store, row);
  if (row.image) content.color = read_image(store, *row.image);
  if (row.depth) {
    std::vector<float> depth = depth_thumbnail(store, row);
    content.depth = cv::Mat(row.depth_height, row.depth_width, CV_32F, depth.data()).clone();
  }
  if (const auto kinds = pixel_kinds(store, row)) {
    content.kinds = cv::Mat(kinds->height, kinds->width, CV_8U);
    for (size_t i = 0; i < kinds->pixels.size(); ++i)
      content.kinds.data[i] = static_cast<uint8_t>(kinds->pixels[i]);
  }
  content.boxes = read_boxes(store, content);
  return content;
}

std::array<uint8_t, 3> color_at(const SceneContent& content, const Vector3d& in_camera) {
  constexpr std::array<uint8_t, 3> kGrey = {150, 150, 150};
  if (content.color.empty()) return kGrey;
  const Vector3d in_color = content.camera.depth_from_color.inverse() * in_camera;
  if (in_color.z() <= 0) return kGrey;
  const Vector2d pixel = content.camera.color.project(in_color);
  if (!content.camera.color.contains(pixel)) return kGrey;
  // The stored image may be smaller than the camera's.
  const int x = static_cast<int>((pixel.x() + 0.5) * content.color.cols / content.camera.color.width);
  const int y = static_cast<int>((pixel.y() + 0.5) * content.color.rows / content.camera.color.height);
  const auto& bgr = content.color.at<cv::Vec3b>(std::clamp(y, 0, content.color.rows - 1),
                                                std::clamp(x, 0, content.color.cols - 1));
  return {bgr[2], bgr[1], bgr[0]};
}

ColoredCloud frame_cloud(const SceneContent& content, size_t limit) {
  ColoredCloud cloud;
  if (content.depth.empty() || !content.map_from_camera || limit == 0) return cloud;
  const auto pixels = static_cast<double>(content.depth.total());
  const int step = std::max(1, static_cast<int>(std::ceil(std::sqrt(pixels / static_cast<double>(limit)))));
  const mapping::PinholeCamera& camera = content.camera.depth;
  const double scale_x = static_cast<double>(camera.width) / content.depth.cols;
  const double scale_y = static_cast<double>(camera.height) / content.depth.rows;
  for (int v = step / 2; v < content.depth.rows; v += step)
    for (int u = step / 2; u < content.depth.cols; u += step) {
      const float z = content.depth.at<float>(v, u);
      if (!std::isfinite(z) || z <= 0) continue;
      const Vector3d point =
          camera.unproject((u + 0.5) * scale_x - 0.5, (v + 0.5) * scale_y - 0.5, static_cast<double>(z));
      cloud.points.push_back((*content.map_from_camera * point).cast<float>());
      cloud.colors.push_back(color_at(content, point));
    }
  return cloud;
}

cv::Mat kinds_in_color(const SceneContent& content) {
  const mapping::RgbdCamera& camera = content.camera;
  if (content.kinds.empty() || content.kinds.size() != content.depth.size() || camera.color.width <= 0)
    return {};
  const Isometry3d color_from_depth = camera.depth_from_color.inverse();
  const double depth_x = static_cast<double>(camera.depth.width) / content.depth.cols;
  const double depth_y = static_cast<double>(camera.depth.height) / content.depth.rows;
  const double color_x = static_cast<double>(content.depth.cols) / camera.color.width;
  const double color_y = static_cast<double>(content.depth.rows) / camera.color.height;
  const cv::Rect all(0, 0, content.kinds.cols, content.kinds.rows);
  cv::Mat seen(content.kinds.size(), CV_8U, cv::Scalar(0));
  cv::Mat nearest(content.kinds.size(), CV_64F, cv::Scalar(1e9));
  for (int v = 0; v < content.depth.rows; ++v)
    for (int u = 0; u < content.depth.cols; ++u) {
      const float z = content.depth.at<float>(v, u);
      if (!std::isfinite(z) || z <= 0) continue;
      const Vector3d point =
          color_from_depth * camera.depth.unproject((u + 0.5) * depth_x - 0.5, (v + 0.5) * depth_y - 0.5,
                                                    static_cast<double>(z));
      if (point.z() <= 0) continue;
      const Vector2d pixel = camera.color.project(point);
      const cv::Point at(static_cast<int>(std::floor((pixel.x() + 0.5) * color_x)),
                         static_cast<int>(std::floor((pixel.y() + 0.5) * color_y)));
      if (!all.contains(at) || nearest.at<double>(at) <= point.z()) continue;
      nearest.at<double>(at) = point.z();
      seen.at<uint8_t>(at) = content.kinds.at<uint8_t>(v, u);
    }
  // Between pixels that have spread apart: what is beside them.
  cv::Mat filled;
  cv::dilate(seen, filled, {});
  filled.copyTo(seen, seen == 0);
  return seen;
}

namespace {

constexpr int kSteps = 6;  // of the search for a colour pixel's depth
constexpr double kFirstGuess = 1.5;

/// Pixel of an image that may be stored smaller than the camera's; unset outside.
std::optional<cv::Point> stored_pixel(const cv::Mat& image, const mapping::PinholeCamera& camera,
                                      const Vector2d& pixel) {
  if (image.empty() || camera.width <= 0 || camera.height <= 0) return std::nullopt;
  const cv::Point at(static_cast<int>(std::floor((pixel.x() + 0.5) * image.cols / camera.width)),
                     static_cast<int>(std::floor((pixel.y() + 0.5) * image.rows / camera.height)));
  return cv::Rect(0, 0, image.cols, image.rows).contains(at) ? std::optional(at) : std::nullopt;
}

std::optional<double> depth_at(const SceneContent& content, const Vector2d& pixel) {
  const auto at = stored_pixel(content.depth, content.camera.depth, pixel);
  if (!at) return std::nullopt;
  const float z = content.depth.at<float>(*at);
  return std::isfinite(z) && z > 0 ? std::optional(static_cast<double>(z)) : std::nullopt;
}

std::optional<std::array<uint8_t, 3>> color_at(const SceneContent& content, const Vector2d& pixel) {
  const auto at = stored_pixel(content.color, content.camera.color, pixel);
  if (!at) return std::nullopt;
  const auto& bgr = content.color.at<cv::Vec3b>(*at);
  return std::array<uint8_t, 3>{bgr[2], bgr[1], bgr[0]};
}

}  // namespace

PixelValues values_at_depth(const SceneContent& content, const Vector2d& pixel) {
  PixelValues values;
  values.depth = depth_at(content, pixel);
  if (!values.depth) return values;
  const Vector3d point = content.camera.depth.unproject(pixel.x(), pixel.y(), *values.depth);
  const Vector3d in_color = content.camera.depth_from_color.inverse() * point;
  if (in_color.z() > 0) values.color = color_at(content, content.camera.color.project(in_color));
  if (content.map_from_camera) values.position = *content.map_from_camera * point;
  return values;
}

PixelValues values_at_color(const SceneContent& content, const Vector2d& pixel) {
  PixelValues values;
  values.color = color_at(content, pixel);
  double z = kFirstGuess;  // along the colour camera's axis
  for (int i = 0; i < kSteps; ++i) {
    const Vector3d guess =
        content.camera.depth_from_color * content.camera.color.unproject(pixel.x(), pixel.y(), z);
    if (guess.z() <= 0) return values;
    const Vector2d there = content.camera.depth.project(guess);
    values.depth = depth_at(content, there);
    if (!values.depth) return values;
    const Vector3d point = content.camera.depth.unproject(there.x(), there.y(), *values.depth);
    if (content.map_from_camera) values.position = *content.map_from_camera * point;
    z = (content.camera.depth_from_color.inverse() * point).z();
  }
  return values;
}

namespace {

/// A feature that refers to another structure: written in it, or by its id ("#2").
Json referred(const Json& value, const std::map<std::string, Json>& by_id) {
  if (value.is_object()) return value.value("features", Json::object());
  const auto found = value.is_string() ? by_id.find(value.get<std::string>()) : by_id.end();
  return found == by_id.end() ? Json::object() : found->second.value("features", Json::object());
}

/// What people read of it, whatever its type calls that.
std::string text_of(const Json& features) {
  std::string text;
  for (const char* name : {"title", "name", "text", "code", "brand", "result_text"})
    if (features.contains(name) && features[name].is_string()) {
      const auto part = features[name].get<std::string>();
      if (!part.empty() && text.find(part) == std::string::npos) text += (text.empty() ? "" : ", ") + part;
    }
  return text;
}

}  // namespace

std::vector<ImageNote> notes_in(const std::string& text) {
  std::vector<ImageNote> notes;
  if (text.find("\"roi\"") == std::string::npos) return notes;
  const Json structures = parse_json(text, "feature_structure").value("structures", Json::array());
  std::map<std::string, Json> by_id;
  for (const Json& structure : structures)
    if (structure.contains("id") && structure["id"].is_string())
      by_id[structure["id"].get<std::string>()] = structure;
  for (const Json& structure : structures) {
    const std::string type = structure.value("type", std::string());
    const Json features = structure.value("features", Json::object());
    if (!type.ends_with("Annotation") || !features.contains("roi")) continue;
    const Json rect = referred(features["roi"], by_id);
    const auto number = [&](const char* name) {
      return rect.contains(name) && rect[name].is_number() ? rect[name].get<double>() : 0;
    };
    ImageNote note{type.substr(type.rfind('.') + 1),
                   text_of(features),
                   features.value("source", std::string()),
                   -1,
                   {number("x"), number("y"), number("width"), number("height")}};
    if (!note.region.empty()) notes.push_back(std::move(note));
  }
  return notes;
}

std::vector<ImageNote> image_notes(const memory::Store& store, memory::Id scene) {
  std::vector<ImageNote> all;
  std::map<memory::Id, int64_t> numbers;
  for (const memory::ObservationRow& row : store.observations(scene)) numbers[row.id] = row.number;
  for (const memory::FeatureStructureRow& row : store.feature_structures(scene))
    for (ImageNote& note : notes_in(row.json)) {
      if (row.observation) note.observation = numbers[*row.observation];
      all.push_back(std::move(note));
    }
  return all;
}

}  // namespace loci::gui
