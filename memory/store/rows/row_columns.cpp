#include "memory/store/rows/row_columns.h"

#include "mapping/base/time_limits.h"

namespace loci::memory {
namespace {

/// Sides and pixels of the largest image that rows are believed to describe.
constexpr int kMaxImageSide = 1 << 15;
constexpr int64_t kMaxPixels = int64_t{1} << 26;

bool is_image_size(int width, int height) {
  return width > 0 && height > 0 && width <= kMaxImageSide && height <= kMaxImageSide &&
         int64_t{width} * height <= kMaxPixels;
}

}  // namespace

template <size_t N>
std::optional<std::array<double, N>> RowReader::numbers(const char* prefix, const char* const (&names)[N]) {
  std::array<double, N> values{};
  for (size_t i = 0; i < N; ++i) {
    const auto value = row_.get<std::optional<double>>(std::string(prefix) + names[i]);
    if (!value) return std::nullopt;
    values[i] = *value;
  }
  return values;
}

void RowReader::operator()(const char* name, std::vector<Vector2d>& outline) {
  if (const auto text = row_.get<std::optional<std::string>>(name)) outline = outline_from_json(*text);
}

void RowReader::operator()(const char* name, std::map<std::string, double>& numbers) {
  const auto text = row_.get<std::optional<std::string>>(name);
  if (!text) return;
  try {
    numbers = parse_json(*text, {}).get<std::map<std::string, double>>();
  } catch (const Json::exception&) {
    refuse(name, "is no JSON object of numbers");
  }
}

void RowReader::vector(const char* prefix, std::optional<Vector3d>& vector) {
  if (const auto v = numbers(prefix, kVectorColumns)) vector = Vector3d((*v)[0], (*v)[1], (*v)[2]);
}

void RowReader::pose(const char* prefix, std::optional<Isometry3d>& pose) {
  if (const auto values = numbers(prefix, kPoseColumns))
    pose = pose_from_values(*values, {{}, 0, std::string(prefix) + "pose"});
}

void RowReader::color(std::optional<HsvColor>& color) {
  if (const auto v = numbers("", {"hue", "saturation", "value"})) color = HsvColor{(*v)[0], (*v)[1], (*v)[2]};
}

void RowReader::camera(std::optional<SceneCamera>& camera) {
  SceneCamera read;
  null_as(0, "camera_width", read.width);
  null_as(0, "camera_height", read.height);
  const auto fx = row_.get<std::optional<double>>("fx");
  if (!fx || (read.width == 0 && read.height == 0)) return;
  read.fx = *fx;
  (*this)("fy", read.fy);
  (*this)("cx", read.cx);
  (*this)("cy", read.cy);
  if (!is_image_size(read.width, read.height) || read.fx <= 0 || read.fy <= 0)
    refuse("camera_width", "and its neighbours are of no camera");
  (*this)("range_min", read.range_min);
  (*this)("range_max", read.range_max);
  camera = read;
}

void RowReader::roi(std::optional<std::array<int, 4>>& roi) {
  if (row_.is_null(kRoiColumns[0])) return;
  roi.emplace();
  for (size_t i = 0; i < 4; ++i) {
    (*this)(kRoiColumns[i], (*roi)[i]);
    if ((*roi)[i] < 0 || (*roi)[i] > kMaxImageSide) refuse(kRoiColumns[i], "lies outside of any image");
  }
}

void RowReader::thumbnail_size(int& width, int& height) {
  null_as(0, "depth_width", width);
  null_as(0, "depth_height", height);
  if ((width != 0 || height != 0) && !is_image_size(width, height))
    refuse("depth_width", "and depth_height are of no image");
}

void RowReader::time(const char* name, TimeNs& time) {
  (*this)(name, time);
  if (!is_within_limits(time)) refuse(name, "is a time that is too far off");
}

void RowReader::refuse(const char* name, const char* what) {
  throw Error(fmt::format("{} {}", name, what), {}, "loci-memory verify lists what is damaged");
}

void RowReader::bitemporal(Bitemporal& times) {
  time("valid_from", times.valid_from);
  (*this)("valid_to", times.valid_to);
  time("known_from", times.known_from);
  (*this)("known_to", times.known_to);
  (*this)("supersedes", times.supersedes);
  (*this)("run", times.run);
  (*this)("source", times.source);
}

std::vector<Vector2d> outline_from_json(const std::string& text) {
  std::vector<Vector2d> outline;
  try {
    for (const Json& point : parse_json(text, {}))
      outline.emplace_back(point.at(0).get<double>(), point.at(1).get<double>());
  } catch (const Json::exception&) {
    throw Error("an outline is no list of points", {}, "loci-memory verify lists what is damaged");
  }
  return outline;
}

void RowWriter::json(const char* name, bool empty, const Json& value) {
  columns_.emplace_back(name, empty ? SqlValue() : sql(texts_.emplace_back(value.dump())));
}

void RowWriter::operator()(const char* name, const std::vector<Vector2d>& outline) {
  Json points = Json::array();
  for (const Vector2d& point : outline) points.push_back({point.x(), point.y()});
  json(name, outline.empty(), points);
}

void RowWriter::operator()(const char* name, const std::map<std::string, double>& numbers) {
  json(name, numbers.empty(), numbers);
}

void RowWriter::vector(const char* prefix, const std::optional<Vector3d>& vector) {
  for (int i = 0; i < 3; ++i)
    columns_.emplace_back(SqlName(prefix, kVectorColumns[i]), vector ? sql((*vector)[i]) : SqlValue());
}

void RowWriter::pose(const char* prefix, const std::optional<Isometry3d>& pose) {
  std::array<double, 7> values{};
  if (pose) values = values_from_pose(*pose);
  for (size_t i = 0; i < 7; ++i)
    columns_.emplace_back(SqlName(prefix, kPoseColumns[i]), pose ? sql(values[i]) : SqlValue());
}

void RowWriter::color(const std::optional<HsvColor>& color) {
  columns_.emplace_back("hue", color ? sql(color->hue) : SqlValue());
  columns_.emplace_back("saturation", color ? sql(color->saturation) : SqlValue());
  columns_.emplace_back("value", color ? sql(color->value) : SqlValue());
}

void RowWriter::camera(const std::optional<SceneCamera>& camera) {
  const auto add = [&](const char* name, auto SceneCamera::*field) {
    columns_.emplace_back(name, camera ? sql((*camera).*field) : SqlValue());
  };
  add("camera_width", &SceneCamera::width);
  add("camera_height", &SceneCamera::height);
  add("fx", &SceneCamera::fx);
  add("fy", &SceneCamera::fy);
  add("cx", &SceneCamera::cx);
  add("cy", &SceneCamera::cy);
  add("range_min", &SceneCamera::range_min);
  add("range_max", &SceneCamera::range_max);
}

void RowWriter::roi(const std::optional<std::array<int, 4>>& roi) {
  for (size_t i = 0; i < 4; ++i) columns_.emplace_back(kRoiColumns[i], roi ? sql((*roi)[i]) : SqlValue());
}

void RowWriter::time(const char* name, TimeNs time) {
  if (!is_within_limits(time))
    throw Error(fmt::format("{} is a time that is too far off", name), {}, "times lie from 1824 to 2115");
  (*this)(name, time);
}

void RowWriter::thumbnail_size(int width, int height) {
  null_as(0, "depth_width", width);
  null_as(0, "depth_height", height);
}

void RowWriter::bitemporal(const Bitemporal& times) {
  time("valid_from", times.valid_from);
  (*this)("valid_to", times.valid_to);
  time("known_from", times.known_from);
  (*this)("known_to", times.known_to);
  (*this)("supersedes", times.supersedes);
  (*this)("run", times.run);
  (*this)("source", times.source);
}

}  // namespace loci::memory
