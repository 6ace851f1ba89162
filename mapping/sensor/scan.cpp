#include "mapping/sensor/scan.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <bit>
#include <cmath>
#include <limits>

#include "mapping/base/config.h"
#include "mapping/base/files.h"
#include "mapping/sensor/pcd.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

template <class T>
void append(std::string& data, T value) {
  data.append(reinterpret_cast<const char*>(&value), sizeof value);
}

PcdCloud cloud_from_points(const std::vector<ScanPoint>& points) {
  PcdCloud cloud;
  for (const char* name : {"x", "y", "z", "intensity"}) cloud.add_field(name, 'F', 4);
  cloud.add_field("rgb", 'F', 4);  // Packed in the bits of a float, as other PCD programs expect it.
  cloud.add_field("origin_index", 'U', 2);
  cloud.add_field("return", 'U', 1);
  cloud.width = points.size();
  cloud.data.reserve(points.size() * cloud.point_size);
  for (const ScanPoint& point : points) {
    for (int i = 0; i < 3; ++i) append(cloud.data, point.position[i]);
    append(cloud.data, point.intensity);
    append(cloud.data, uint32_t{point.r} << 16 | uint32_t{point.g} << 8 | point.b);
    append(cloud.data, point.origin_index);
    append(cloud.data, static_cast<uint8_t>(point.returned ? 1 : 0));
  }
  return cloud;
}

/// Points of a PCD; what is not finite is left out.
std::vector<ScanPoint> points_from_cloud(const PcdCloud& cloud, const fs::path& path) {
  const PcdField* xyz[3] = {cloud.find("x"), cloud.find("y"), cloud.find("z")};
  if (xyz[0] == nullptr || xyz[1] == nullptr || xyz[2] == nullptr)
    throw Error("the PCD file has no fields x y z", {path.string(), 0, {}});
  const PcdField* intensity = cloud.find("intensity");
  const PcdField* rgb = cloud.find("rgb") != nullptr ? cloud.find("rgb") : cloud.find("rgba");
  const PcdField* origin = cloud.find("origin_index");
  const PcdField* returned = cloud.find("return");
  std::vector<ScanPoint> points;
  points.reserve(cloud.size());
  for (size_t i = 0; i < cloud.size(); ++i) {
    ScanPoint point;
    for (int k = 0; k < 3; ++k) point.position[k] = static_cast<float>(cloud.number(i, *xyz[k]));
    if (!point.position.allFinite()) continue;
    if (intensity != nullptr) point.intensity = static_cast<float>(cloud.number(i, *intensity));
    if (rgb != nullptr) {
      const uint32_t color = cloud.bits(i, *rgb);
      point.r = static_cast<uint8_t>(color >> 16);
      point.g = static_cast<uint8_t>(color >> 8);
      point.b = static_cast<uint8_t>(color);
    }
    if (origin != nullptr) {
      const double index = cloud.number(i, *origin);
      if (!(index >= 0 && index <= std::numeric_limits<uint16_t>::max()))
        throw Error(fmt::format("the origin_index of point {} is {}", i, index), {path.string(), 0, {}});
      point.origin_index = static_cast<uint16_t>(index);
    }
    if (returned != nullptr) point.returned = cloud.number(i, *returned) != 0;
    points.push_back(point);
  }
  return points;
}

std::string scan_text(const Scan& scan) {
  std::string text = fmt::format("  - file: {}.pcd\n    pose: [{}]\n", scan.name,
                                 fmt::join(values_from_pose(scan.map_from_scan), ", "));
  if (!scan.covariance.isZero(0)) {
    const Eigen::Matrix<double, 6, 6, Eigen::RowMajor> rows = scan.covariance;
    text += fmt::format("    covariance: [{}]\n", fmt::join(rows.data(), rows.data() + rows.size(), ", "));
  }
  if (!scan.registered) text += "    registered: false\n";
  text += "    origins:";
  if (scan.origins.empty()) text += " []";
  text += '\n';
  for (const Eigen::Vector3f& origin : scan.origins)
    text += fmt::format("      - [{}, {}, {}]\n", origin.x(), origin.y(), origin.z());
  return text;
}

Scan read_scan(const Config& config, const fs::path& folder) {
  Scan scan;
  const fs::path file = folder / config.require<std::string>("file");
  scan.name = file.stem().string();
  scan.map_from_scan =
      pose_from_values(config.require<std::array<double, 7>>("pose"), config.location("pose"));
  if (config.has("covariance")) {
    const auto values = config.require<std::array<double, 36>>("covariance");
    scan.covariance = Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(values.data());
  }
  scan.registered = config.get<bool>("registered", true);
  for (const auto& origin : config.get<std::vector<std::array<float, 3>>>("origins", {}))
    scan.origins.emplace_back(origin[0], origin[1], origin[2]);
  config.finish();
  scan.points = points_from_cloud(read_pcd(file), file);
  for (const ScanPoint& point : scan.points)
    if (!scan.origins.empty() && point.origin_index >= scan.origins.size())
      throw Error(fmt::format("a point starts from origin {}, the scan has {}", point.origin_index,
                              scan.origins.size()),
                  {file.string(), 0, {}});
  return scan;
}

ScanSet set_from_bare_cloud(const fs::path& path) {
  ScanSet set;
  set.sensor = "unknown";
  set.free_space = false;
  set.levelled = false;
  Scan scan;
  scan.name = path.stem().string();
  scan.points = points_from_cloud(read_pcd(path), path);
  scan.origins.emplace_back(0.F, 0.F, 0.F);
  set.scans.push_back(std::move(scan));
  return set;
}

void write_points(const Scan& scan, const fs::path& folder) {
  write_pcd(cloud_from_points(scan.points), folder / (scan.name + ".pcd"));
}

/// Last of all: a folder without this file is not a scan set.
void write_list(const ScanSet& set, const fs::path& folder) {
  std::string text = fmt::format(
      "version: 1\nsensor: {}\nlevelled: {}\nrange_max: {}\nresolution: {}\nfree_space: {}\nscans:{}\n",
      set.sensor.empty() ? "unknown" : set.sensor, set.levelled, set.range_max, set.resolution,
      set.free_space, set.scans.empty() ? " []" : "");
  for (const Scan& scan : set.scans) text += scan_text(scan);
  write_file_atomically(folder / "scans.yaml", text);
}

}  // namespace

void write_scan_set(const ScanSet& set, const fs::path& folder) {
  make_folder(folder);
  for (const Scan& scan : set.scans) write_points(scan, folder);
  write_list(set, folder);
}

void append_to_scan_set(const ScanSet& set, const fs::path& folder) {
  make_folder(folder);
  if (!set.scans.empty()) write_points(set.scans.back(), folder);
  write_list(set, folder);
}

ScanSet read_scan_set(const fs::path& path) {
  if (!fs::exists(path)) throw Error("no such scan set", {path.string(), 0, {}});
  if (path.extension() == ".pcd") return set_from_bare_cloud(path);
  const fs::path folder = fs::is_directory(path) ? path : path.parent_path();
  if (!fs::exists(folder / "scans.yaml"))
    throw Error(fs::is_directory(path) && fs::is_empty(path) ? "the folder is empty" : "this is no scan set",
                {path.string(), 0, {}}, "a scan set is a folder with scans.yaml, or a single .pcd file");
  const Config config = Config::read(folder / "scans.yaml");
  if (config.get<int>("version", 1) != 1)
    throw Error("only version 1 of scan sets is read", config.location("version"));
  ScanSet set;
  set.sensor = config.get<std::string>("sensor", "unknown");
  set.levelled = config.get<bool>("levelled", true);
  set.range_max = config.get<double>("range_max", 0);
  set.resolution = config.get<double>("resolution", 0);
  set.free_space = config.get<bool>("free_space", true);
  const std::vector<Config> scans = config.list("scans");
  config.finish();
  if (scans.empty()) throw Error("the scan set has no scans", config.location("scans"));
  for (const Config& scan : scans) {
    set.scans.push_back(read_scan(scan, folder));
    if (set.scans.back().origins.empty()) set.free_space = false;  // its rays are unknown
  }
  return set;
}

ScanSet read_registered_scans(const fs::path& path, Warnings& warnings) {
  ScanSet set = read_scan_set(path);
  const size_t all = set.scans.size();
  std::erase_if(set.scans, [](const Scan& scan) { return !scan.registered; });
  if (set.scans.empty())
    throw Error("none of the scans could be registered", {path.string(), 0, {}},
                "loci-map register may find their poses");
  if (set.scans.size() < all)
    warnings.add(
        fmt::format("{} of {} scans are left out: they could not be registered", all - set.scans.size(), all),
        {path.string(), 0, {}});
  return set;
}

}  // namespace loci::mapping
