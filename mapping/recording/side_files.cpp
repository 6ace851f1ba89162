#include "mapping/recording/side_files.h"

#include <fmt/format.h>

#include "mapping/base/config.h"
#include "mapping/base/files.h"
#include "mapping/recording/loci_layout.h"

namespace loci::mapping {

namespace fs = std::filesystem;

Isometry3d read_pose_file(const fs::path& path) {
  const std::string text = read_file(path);
  Eigen::Matrix4d matrix;
  const char* at = text.c_str();
  for (int i = 0; i < 16; ++i) {
    char* end = nullptr;
    matrix(i / 4, i % 4) = std::strtod(at, &end);  // Reads "nan" too, which the pose check then names.
    if (end == at)
      throw Error(fmt::format("a pose is 16 numbers, this file has {}", i), {path.string(), 0, {}});
    at = end;
  }
  return pose_from_matrix(matrix, {path.string(), 0, {}});
}

fs::path beside_or_above(const fs::path& folder, const char* name) {
  const fs::path absolute = fs::absolute(folder).lexically_normal();
  const fs::path clean = absolute.has_filename() ? absolute : absolute.parent_path();
  for (const fs::path& place : {clean, clean.parent_path()})
    if (fs::is_regular_file(place / name)) return place / name;
  return {};
}

void read_cameras(const fs::path& path, FileRecordingContent& content) {
  const Config config = Config::read(path);
  const Config depth = config.map("depth");
  content.info.camera.depth = read_pinhole(depth);
  content.depth_scale = depth.get<double>("unit_m", 0.001);
  content.invalid_depth = depth.get<std::vector<int>>("invalid", {0, 65535});
  for (const int raw : content.invalid_depth)
    if (raw < 0 || raw > 65535) throw Error("depth values are 0 to 65535", depth.place("invalid"));
  depth.finish();
  const Config color = config.map("color");
  content.info.camera.color = config.has("color") ? read_pinhole(color) : content.info.camera.depth;
  color.finish();
  if (config.has("color_from_depth")) {
    const Config transform = config.map("color_from_depth");
    const auto r = transform.require<std::array<double, 9>>("R");
    const auto t = transform.require<std::array<double, 3>>("t");
    transform.finish();
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    for (int i = 0; i < 9; ++i) matrix(i / 3, i % 3) = r[static_cast<size_t>(i)];
    for (int i = 0; i < 3; ++i) matrix(i, 3) = t[static_cast<size_t>(i)];
    content.info.camera.depth_from_color =
        pose_from_matrix(matrix, config.place("color_from_depth")).inverse();
  }
  config.finish();
}

}  // namespace loci::mapping
