#include "perception/annotators/hypotheses/flat_object_extractor.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <tuple>

#include "mapping/image/image_io.h"
#include "perception/annotators/hypotheses/cluster_parts.h"
#include "perception/annotators/hypotheses/object_clusters.h"
#include "perception/annotators/hypotheses/support_pixels.h"
#include "perception/annotators/scene_data.h"
#include "perception/conversions/camera.h"
#include "perception/conversions/opencv.h"

namespace loci::perception {
namespace {

constexpr const char* kName = "FlatObjectExtractor";
constexpr double kUnitsPerMetre = 10000;
constexpr int kMargin = 5;  ///< pixels beside a cluster show a bit of both

void add_cluster(const FlatObject& object, const types::PlanarSupport& support, const types::SceneCas& scene,
                 const Isometry3d& pose) {
  const auto cluster = types::Cluster::create(scene.cas());
  set_points(cluster, kName, object.pixels, scene, pose);
  add_image(cluster, kName, {object.box, object.mask}, scene);
  const cv::Size image = cloud_points(scene).size();
  cluster.at_image_border.set(is_at_image_border(box_of(object.pixels, image), image));
  cluster.at_support_border.set(false);
  cluster.partly_hidden.set(false);
  cluster.support.set(support);
  scene.add_cluster(cluster);
}

}  // namespace

AnnotatorDescriptor FlatObjectExtractor::descriptor() const {
  return {
      kName,
      "Finds flat things on supports by height and colour, in two stages, with masks in the colour image.",
      {"Scene", "CameraInfo", "view:depth", "view:color", "view:cloud", "PlanarSupport"},
      {"Cluster", "ReferenceClusterPoints", "StandaloneImageROI"},
      {"Cluster"}};
}

void FlatObjectExtractor::declare(OptionTable& table) {
  options_.declare(table);
  table.text("calibration", calibration_,
             "Image of the empty surface, made by `loci-perceive surface`, for a camera that stands still.");
}

void FlatObjectExtractor::start(Context& /*context*/) {
  if (!calibration_.empty()) empty_depth_ = read_surface(calibration_);
}

void FlatObjectExtractor::process(cas::Cas& cas, Context& /*context*/) {
  const types::SceneCas scene(cas);
  if (!scene.scene().map_from_camera.is_set() || !scene.has(types::SceneCas::kColor)) {
    scene.log(kName, "info", "flat things need a pose and a colour image");
    return;
  }
  const Isometry3d pose = map_from_camera(scene.scene());
  const mapping::RgbdCamera camera = types::cameras(scene);
  const cv::Mat depth = types::view_image(scene, types::SceneCas::kDepth);
  const cv::Mat color = types::view_image(scene, types::SceneCas::kColor);
  if (!empty_depth_.empty() && empty_depth_.size() != depth.size())
    throw Error("the empty surface is not as large as the depth image", {calibration_, 0, {}},
                "make it from a recording of the same camera");
  cv::Mat taken = pixels_of_clusters(scene, depth.size(), kMargin);
  const cv::Mat map_depth = scene.has(kMapDepthView) ? types::view_image(scene, kMapDepthView) : cv::Mat();
  size_t found = 0;
  for (const types::PlanarSupport& support : scene.supports()) {
    FlatSurface surface;
    std::tie(surface.normal, surface.offset) = plane_in_camera(support, pose);
    surface.inside = pixels_over(support, pose.inverse(), camera.depth) & ~taken;
    if (!map_depth.empty())
      leave_out_what_the_map_hides(map_depth, surface.normal, surface.offset, camera.depth, surface.inside);
    surface.empty_depth = empty_depth_;
    for (const FlatObject& object : find_flat_objects(depth, color, camera, surface, options_)) {
      if (object.pixels.empty()) continue;
      add_cluster(object, support, scene, pose);
      // Of two supports that overlap in the image one has it.
      for (const int pixel : object.pixels) taken.ptr<unsigned char>()[pixel] = 255;
      ++found;
    }
  }
  scene.log(kName, "info", fmt::format("{} flat things", found));
}

void write_surface(const std::filesystem::path& path, const cv::Mat& empty_depth) {
  cv::Mat units(empty_depth.size(), CV_16U);
  for (int v = 0; v < units.rows; ++v)
    for (int u = 0; u < units.cols; ++u) {
      const double value = static_cast<double>(empty_depth.at<float>(v, u)) * kUnitsPerMetre;
      units.at<uint16_t>(v, u) = value > 0 && value < 65535 ? static_cast<uint16_t>(std::lround(value)) : 0;
    }
  mapping::write_image(path, units);
}

cv::Mat read_surface(const std::filesystem::path& path) {
  cv::Mat depth;
  const cv::Mat units = mapping::read_uint16(path);
  units.convertTo(depth, CV_32F, 1 / kUnitsPerMetre);
  depth.setTo(std::numeric_limits<float>::quiet_NaN(), units == 0);
  return depth;
}

}  // namespace loci::perception
