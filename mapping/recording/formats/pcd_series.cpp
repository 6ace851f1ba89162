#include "mapping/recording/formats/layouts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

#include "mapping/base/files.h"
#include "mapping/recording/depth_image.h"
#include "mapping/sensor/pcd.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

bool is_cloud(const fs::path& path) {
  return path.extension() == ".pcd" && fs::is_regular_file(path) &&
         !path.filename().string().starts_with('.');
}

/// Columns and rows of a cloud from its header alone; zero where it does not say.
std::pair<size_t, size_t> size_in_header(const fs::path& path) {
  require_regular_file(path);
  std::ifstream file(path, std::ios::binary);
  std::pair<size_t, size_t> size;
  for (std::string key, rest; file >> key && key != "DATA"; std::getline(file, rest)) {
    if (key == "WIDTH") file >> size.first;
    if (key == "HEIGHT") file >> size.second;
  }
  return size;
}

/// The coordinates of an organised cloud. Error when it is not one.
struct Coordinates {
  const PcdField *x, *y, *z;
};

Coordinates coordinates_of(const PcdCloud& cloud, const fs::path& path) {
  if (cloud.height < 2)
    throw Error("the cloud is not organised: its points are in no image", {path.string(), 0, {}},
                "a series has clouds of WIDTH x HEIGHT pixels; register takes other clouds");
  const Coordinates fields{cloud.find("x"), cloud.find("y"), cloud.find("z")};
  if (fields.x == nullptr || fields.y == nullptr || fields.z == nullptr)
    throw Error("the cloud has no x, y, z", {path.string(), 0, {}});
  return fields;
}

/// A line through pixel positions over slopes: pixel = f · slope + c.
struct Line {
  double f = 0, c = 0, worst = 0;
};

/// Least squares; `worst` is what nine of ten pixels stay below.
Line fit_line(const std::vector<std::pair<double, double>>& slopes_pixels) {
  const auto n = static_cast<double>(slopes_pixels.size());
  double s = 0, p = 0, ss = 0, sp = 0;
  for (const auto& [slope, pixel] : slopes_pixels) {
    s += slope;
    p += pixel;
    ss += slope * slope;
    sp += slope * pixel;
  }
  Line line;
  line.f = (n * sp - s * p) / (n * ss - s * s);
  line.c = (p - line.f * s) / n;
  std::vector<double> off;
  for (const auto& [slope, pixel] : slopes_pixels) off.push_back(std::abs(line.f * slope + line.c - pixel));
  const auto at = off.begin() + static_cast<std::ptrdiff_t>(off.size() * 9 / 10);
  std::nth_element(off.begin(), at, off.end());
  line.worst = *at;
  return line;
}

double rounded(double pixels) {
  return std::round(1e3 * pixels) / 1e3;
}

}  // namespace

bool is_pcd_series(const fs::path& path) {
  if (!fs::is_directory(path)) return is_cloud(path);
  if (fs::exists(path / "scans.yaml")) return false;
  return std::any_of(fs::directory_iterator(path), fs::directory_iterator(),
                     [](const fs::directory_entry& entry) { return is_cloud(entry.path()); });
}

PcdSeries::PcdSeries(const fs::path& path) {
  info_.format = "pcd";
  info_.path = path.string();
  info_.map_frame = "world";
  info_.levelled = false;
  find_frames(path);
  fit_camera();
  complete_info(info_, frames_);
}

void PcdSeries::find_frames(const fs::path& path) {
  std::vector<fs::path> files;
  if (fs::is_directory(path)) {
    for (const auto& entry : fs::directory_iterator(path))
      if (is_cloud(entry.path())) files.push_back(entry.path());
  } else {
    files.push_back(path);
  }
  sort_by_name(files);
  for (const fs::path& file : files) {
    if (size_in_header(file) != size_in_header(files.front()))
      throw Error(fmt::format("this cloud has another size than {}", files.front().filename().string()),
                  {file.string(), 0, {}}, "a series has clouds of one camera");
    FrameFiles frame;
    frame.index = static_cast<int64_t>(frames_.size());
    frame.depth = frame.color = file;
    frame.location = {file.string(), 0, {}};
    fs::path pose = file;
    pose.replace_extension(".pose.txt");
    if (fs::exists(pose)) frame.map_from_camera = read_pose_file(pose);
    frames_.push_back(std::move(frame));
  }
  set_times_by_name(info_, frames_);
}

void PcdSeries::fit_camera() {
  const fs::path& path = frames_.front().depth;
  const PcdCloud cloud = read_pcd(path);
  const auto [x, y, z] = coordinates_of(cloud, path);
  std::vector<std::pair<double, double>> across, down;
  for (size_t i = 0; i < cloud.size(); ++i) {
    const double depth = cloud.number(i, *z);
    if (!std::isfinite(depth) || depth == 0) continue;
    const size_t column = i % cloud.width, row = i / cloud.width;
    across.emplace_back(cloud.number(i, *x) / std::abs(depth), static_cast<double>(column));
    down.emplace_back(cloud.number(i, *y) / std::abs(depth), static_cast<double>(row));
    backwards_ = depth < 0;
  }
  const FileLocation location{path.string(), 0, {}};
  if (across.size() < 100)
    throw Error("the first cloud has next to no points: no camera can be fitted", location);
  const Line u = fit_line(across), v = fit_line(down);
  if (!(u.worst < 0.6 && v.worst < 0.6) || u.f <= 0 || (v.f < 0) != backwards_)
    throw Error("the cloud is not what a pinhole camera sees", location,
                "points are in the optical frame: x right, y down, z forward");
  PinholeCamera& camera = info_.camera.depth;
  camera = {static_cast<int>(cloud.width),
            static_cast<int>(cloud.height),
            rounded(u.f),
            rounded(std::abs(v.f)),
            rounded(u.c),
            rounded(v.c)};
  info_.camera.color = camera;
  info_.guesses.emplace_back("the camera was fitted to the first cloud");
  if (cloud.find("rgb") == nullptr && cloud.find("rgba") == nullptr)
    for (FrameFiles& frame : frames_) frame.color.clear();
}

RgbdFrame PcdSeries::frame(size_t i) const {
  const FrameFiles& from = frames_.at(i);
  RgbdFrame frame;
  frame.index = from.index;
  frame.name = from.depth.stem().string();
  frame.time_ns = from.time_ns;
  frame.camera = info_.camera;
  frame.map_from_camera = from.map_from_camera;
  cv::Mat color;
  read_images(
      frame, [&] { return images_of(from, color); }, [&] { return color; });
  return frame;
}

cv::Mat PcdSeries::images_of(const FrameFiles& from, cv::Mat& color) const {
  const PcdCloud cloud = read_pcd(from.depth);
  const auto [x, y, z] = coordinates_of(cloud, from.depth);
  const PinholeCamera& camera = info_.camera.depth;
  if (cloud.width != static_cast<size_t>(camera.width) || cloud.height != static_cast<size_t>(camera.height))
    throw Error(fmt::format("the cloud is {} x {}, the first of the series {} x {}", cloud.width,
                            cloud.height, camera.width, camera.height),
                from.location);
  const PcdField* field = cloud.find("rgb") != nullptr ? cloud.find("rgb") : cloud.find("rgba");
  cv::Mat depth(camera.height, camera.width, CV_32F);
  if (field != nullptr) color.create(camera.height, camera.width, CV_8UC3);
  for (size_t p = 0; p < cloud.size(); ++p) {
    const double value = backwards_ ? -cloud.number(p, *z) : cloud.number(p, *z);
    depth.ptr<float>()[p] = metres_or_nan(static_cast<float>(value));
    if (field == nullptr) continue;
    const uint32_t bits = cloud.bits(p, *field);
    color.ptr<cv::Vec3b>()[p] = {static_cast<uint8_t>(bits), static_cast<uint8_t>(bits >> 8),
                                 static_cast<uint8_t>(bits >> 16)};
  }
  return depth;
}

}  // namespace loci::mapping
