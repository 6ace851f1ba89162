#include "mapping/exchange/map_colors.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <functional>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "mapping/base/parallel.h"
#include "mapping/base/text/json.h"
#include "mapping/image/image_io.h"
#include "mapping/interpretation/furniture/furniture_links.h"
#include "mapping/world/kinematics.h"
#include "mapping/world/mesh_files.h"

namespace loci::mapping {
namespace {

constexpr double kOnSurface_m = 0.015;  ///< objects that stand on a surface are higher
constexpr size_t kMinPoints = 30;
constexpr size_t kMaxPoints = 2'000'000;  ///< of the scans: a median needs no more
constexpr double kSameFace_m = 0.08;      ///< between a front and the plane that was photographed
constexpr double kSameSize_m = 0.05;      ///< of a front that was measured twice
constexpr double kParallel = 0.99;        ///< cosine
constexpr double kMinSeen = 0.5;
constexpr double kBeforePanel_m = 0.001;  ///< nearer, viewers do not tell which is in front

struct ColoredPoint {
  Eigen::Vector3f position;  ///< in the map
  std::array<uint8_t, 3> color;
};

std::vector<ColoredPoint> colored_points(const InterpretedMap& map, const ScanSet& scans) {
  const Isometry3d map_from_set = map_from_scan_set(map, scans);
  size_t all = 0;
  for (const Scan& scan : scans.scans) all += scan.points.size();
  const size_t step = all / kMaxPoints + 1;
  std::vector<ColoredPoint> points;
  for (const Scan& scan : scans.scans) {
    const Eigen::Isometry3f map_from_scan = (map_from_set * scan.map_from_scan).cast<float>();
    for (size_t i = 0; i < scan.points.size(); i += step) {
      const ScanPoint& point = scan.points[i];
      if (point.returned && (point.r != 0 || point.g != 0 || point.b != 0))
        points.push_back({map_from_scan * point.position, {point.r, point.g, point.b}});
    }
  }
  return points;
}

/// Whether a link is of what scans show.
bool is_seen(const SemanticLink& link) {
  return link.class_name != "handle" && link.class_name != "knob" &&
         !(link.evidence.is_object() && link.evidence.value("source", "") == "prototype");
}

/// Values of one channel by how often they occur.
using Histogram = std::array<size_t, 256>;

float median_of(const Histogram& histogram, size_t count) {
  size_t below = 0, value = 0;
  while ((below += histogram[value]) <= count / 2) ++value;
  return static_cast<float>(value) / 255;
}

/// The median colour of the points on the boxes of a link; unset where there are few.
std::optional<Rgba> color_on(const Link& link, const Isometry3d& map_from_link,
                             const std::vector<ColoredPoint>& points) {
  std::array<Histogram, 3> histograms{};
  size_t count = 0;
  for (const Visual& visual : link.visuals) {
    const auto* box = std::get_if<Box>(&visual.geometry);
    if (box == nullptr) continue;
    const Eigen::Isometry3f box_from_map = (map_from_link * visual.link_from_visual).inverse().cast<float>();
    const Eigen::Array3f half = (box->size / 2 + Vector3d::Constant(kOnSurface_m)).array().cast<float>();
    for (const ColoredPoint& point : points) {
      if (((box_from_map * point.position).array().abs() > half).any()) continue;
      for (size_t c = 0; c < 3; ++c) ++histograms[c][point.color[c]];
      ++count;
    }
  }
  if (count < kMinPoints) return std::nullopt;
  return Rgba(median_of(histograms[0], count), median_of(histograms[1], count),
              median_of(histograms[2], count), 1);
}

/// The visual of a link that shows its photo, a mesh; null without one.
const Visual* photo_visual(const Link& link) {
  const auto visual = std::ranges::find(link.visuals, kPhotoVisual, &Visual::name);
  return visual == link.visuals.end() || !std::holds_alternative<Mesh>(visual->geometry) ? nullptr : &*visual;
}

void paint(Link& link, const Rgba& color) {
  for (Visual& visual : link.visuals) visual.material = Material{link.name + "_color", color, ""};
}

/// The rectangle of a front in a photo of its plane; empty when the photo is of another plane.
cv::Mat crop(const FacePhoto& photo, const Front& front, double margin_m) {
  const Vector3d at = photo.face.coordinates(front.centre);
  if (photo.face.normal3().dot(front.normal) < kParallel || std::abs(at.z()) > kSameFace_m) return {};
  const double width = front.width + 2 * margin_m, height = front.height + 2 * margin_m;
  const double pixel = std::max(photo.pixel_m, std::max(width, height) / kMaxTextureSide);
  const cv::Size size(std::max(1, static_cast<int>(width / pixel)),
                      std::max(1, static_cast<int>(height / pixel)));
  const double step_x = width / size.width / photo.pixel_m, step_y = height / size.height / photo.pixel_m;
  const cv::Matx23d photo_from_crop(step_x, 0, photo.column(at.x() - width / 2) + step_x / 2, 0, step_y,
                                    photo.row(at.y() + height / 2) + step_y / 2);
  cv::Mat image;
  cv::warpAffine(photo.color, image, photo_from_crop, size, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP);
  return image;
}

/// The panel of a front as its link has it: a little smaller than what was measured, to move freely.
std::optional<Front> panel_of(const Front& front, const Link& link, const Isometry3d& map_from_link) {
  const auto* box = link.visuals.empty() ? nullptr : std::get_if<Box>(&link.visuals.front().geometry);
  if (box == nullptr) return std::nullopt;
  Front panel = front;
  panel.centre = map_from_link * link.visuals.front().link_from_visual * Vector3d(box->size.x() / 2, 0, 0);
  panel.width = box->size.y();
  panel.height = box->size.z();
  return panel;
}

/// A rectangle in the plane x = 0 that faces along x, y to the right; its material has the name of the file.
std::string rectangle_obj(const std::string& name, double width, double height) {
  const double w = width / 2, h = height / 2;
  return fmt::format(
      "# loci\nmtllib textures.mtl\no {0}\nv 0 {1} {2}\nv 0 {3} {2}\nv 0 {3} {4}\nv 0 {1} {4}\n"
      "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 1 0 0\nusemtl {0}\nf 1/1/1 2/2/1 3/3/1\nf 1/1/1 3/3/1 4/4/1\n",
      name, -w, -h, w, h);
}

/// What of a name may stand in paths and material libraries.
std::string file_name(std::string name) {
  const auto is_plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-';
  };
  std::ranges::replace_if(name, std::not_fn(is_plain), '_');
  return name;
}

/// Where the photo of a panel stands in its link.
Isometry3d link_from_photo(const Front& panel, const Visual& box, const Isometry3d& map_from_link) {
  Isometry3d pose = box.link_from_visual;
  pose.translation() = map_from_link.inverse() * Vector3d(panel.centre + kBeforePanel_m * panel.normal);
  return pose;
}

std::string bytes_of_jpeg(const cv::Mat& image) {
  const std::vector<unsigned char> jpeg = encode_image(image, ".jpg");
  return {jpeg.begin(), jpeg.end()};
}

}  // namespace

Isometry3d map_from_scan_set(const InterpretedMap& map, const ScanSet& scans) {
  if (scans.levelled || !map.semantics.map_from_input) return Isometry3d::Identity();
  return *map.semantics.map_from_input;
}

void color_links(const ScanSet& scans, int threads, InterpretedMap& map) {
  const std::vector<ColoredPoint> points = colored_points(map, scans);
  const std::vector<Isometry3d> map_from_link = root_from_links(map.world, {});
  parallel_each(map.world.links.size(), threads, [&](size_t i) {
    Link& link = map.world.links[i];
    const auto entry = map.semantics.links.find(link.name);
    if (entry == map.semantics.links.end() || !is_seen(entry->second) || photo_visual(link)) return;
    if (const auto color = color_on(link, map_from_link[i], points)) paint(link, *color);
  });
}

cv::Mat seen_pixels(const cv::Mat& photo) {
  cv::Mat unseen;
  cv::inRange(photo, cv::Scalar::all(0), cv::Scalar::all(0), unseen);
  return ~unseen;
}

cv::Mat photo_of(const InterpretedMap& map, const Front& front, double margin_m) {
  cv::Mat best;
  double best_seen = kMinSeen;
  for (const FacePhoto& photo : map.photos) {
    const cv::Mat own = crop(photo, front, 0);
    if (own.empty()) continue;
    const double seen = cv::mean(seen_pixels(own))[0] / 255;
    if (seen <= best_seen) continue;
    best_seen = seen;
    best = margin_m > 0 ? crop(photo, front, margin_m) : own;
  }
  return best;
}

std::map<std::string, std::string> add_textures(InterpretedMap& map) {
  std::map<std::string, std::string> files;
  std::string materials = "# loci\n";
  const std::vector<Isometry3d> map_from_link = root_from_links(map.world, {});
  for (const Front& front : fronts_of(map.world, map.semantics)) {
    const size_t index = map.world.link_index(*front_link(front.name, map.semantics));
    Link& link = map.world.links[index];
    const auto panel = panel_of(front, link, map_from_link[index]);
    if (!panel) continue;
    cv::Mat image = photo_of(map, *panel);
    if (image.empty()) continue;
    const cv::Mat seen = seen_pixels(image);
    const cv::Scalar mean = cv::mean(image, seen);
    image.setTo(mean, ~seen);
    const cv::Vec3f bgr(cv::Vec3d(mean[0], mean[1], mean[2]) / 255);
    paint(link, {bgr[2], bgr[1], bgr[0], 1});
    std::string name = file_name(front.name);
    while (files.contains("textures/" + name + ".obj")) name += '_';
    link.visuals.push_back({kPhotoVisual, link_from_photo(*panel, link.visuals.front(), map_from_link[index]),
                            Mesh{"textures/" + name + ".obj"}, std::nullopt});
    files["textures/" + name + ".obj"] = rectangle_obj(name, panel->width, panel->height);
    files["textures/" + name + ".jpg"] = bytes_of_jpeg(image);
    materials += fmt::format("newmtl {0}\nKa 1 1 1\nKd 1 1 1\nKs 0 0 0\nillum 1\nmap_Kd {0}.jpg\n", name);
  }
  if (!files.empty()) files["textures/textures.mtl"] = materials;
  return files;
}

void keep_textures(const World& before, InterpretedMap& map) {
  const std::vector<Isometry3d> map_from_link = root_from_links(map.world, {});
  for (const Front& front : fronts_of(map.world, map.semantics)) {
    const size_t index = map.world.link_index(*front_link(front.name, map.semantics));
    Link& link = map.world.links[index];
    const Link* old = before.find_link(link.name);
    const Visual* photo = old == nullptr ? nullptr : photo_visual(*old);
    if (photo == nullptr || photo_visual(link) != nullptr) continue;
    const auto panel = panel_of(front, link, map_from_link[index]);
    const auto* box = std::get_if<Box>(&old->visuals.front().geometry);
    if (!panel || box == nullptr || std::abs(panel->width - box->size.y()) > kSameSize_m ||
        std::abs(panel->height - box->size.z()) > kSameSize_m)
      continue;
    if (const auto& material = old->visuals.front().material; material && material->color)
      paint(link, *material->color);
    Mesh mesh = std::get<Mesh>(photo->geometry);
    mesh.scale.y() *= panel->width / box->size.y();
    mesh.scale.z() *= panel->height / box->size.z();
    link.visuals.push_back({kPhotoVisual, link_from_photo(*panel, link.visuals.front(), map_from_link[index]),
                            mesh, std::nullopt});
  }
}

std::vector<FacePhoto> photos_of_textures(const InterpretedMap& map, const std::filesystem::path& folder,
                                          Warnings& warnings) {
  std::vector<FacePhoto> photos;
  const std::vector<Isometry3d> map_from_link = root_from_links(map.world, {});
  for (const Front& front : fronts_of(map.world, map.semantics)) {
    const size_t index = map.world.link_index(*front_link(front.name, map.semantics));
    const Visual* visual = photo_visual(map.world.links[index]);
    const auto panel = panel_of(front, map.world.links[index], map_from_link[index]);
    if (visual == nullptr || !panel || panel->up.z() < kParallel) continue;
    const auto parts = load_mesh_parts(std::get<Mesh>(visual->geometry), {{}, folder}, warnings);
    if (parts.empty() || parts.front().texture.empty()) continue;
    FacePhoto photo;
    try {
      photo.color = read_color(parts.front().texture);
    } catch (const Error& error) {
      warnings.add(error.what());
      continue;
    }
    photo.pixel_m = panel->width / photo.color.cols;
    const int rows = std::max(1, static_cast<int>(std::lround(panel->height / photo.pixel_m)));
    cv::resize(photo.color, photo.color, {photo.color.cols, rows});
    FurnitureFace& face = photo.face;
    face.normal = panel->normal.head<2>().normalized();
    face.offset = face.normal.dot(panel->centre.head<2>());
    const Vector3d centre = face.coordinates(panel->centre);
    face.u_min = photo.u0 = centre.x() - panel->width / 2;
    face.u_max = centre.x() + panel->width / 2;
    face.v_min = photo.v0 = centre.y() - panel->height / 2;
    face.v_max = centre.y() + panel->height / 2;
    photos.push_back(std::move(photo));
  }
  return photos;
}

}  // namespace loci::mapping
