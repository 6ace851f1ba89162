#include "perception/annotators/description/geometry_annotator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "mapping/base/math.h"
#include "mapping/base/quantile.h"
#include "perception/annotators/scene_data.h"

namespace loci::perception {
namespace {

struct Range {
  double low;
  double high;
};

Range range_of(std::vector<double> values, double outliers) {
  const auto [low, high] = quantiles(values, outliers, 1 - outliers);
  return {low, high};
}

}  // namespace

UprightBox upright_box(const std::vector<Vector3d>& points, double ground, double reach, double outliers) {
  UprightBox box;
  if (points.empty()) return box;
  std::vector<cv::Point2f> footprint;
  std::vector<double> heights;
  footprint.reserve(points.size());
  heights.reserve(points.size());
  const Vector3d origin = points.front();  // Floats lose digits far from the map's origin.
  for (const Vector3d& p : points) {
    footprint.emplace_back(static_cast<float>(p.x() - origin.x()), static_cast<float>(p.y() - origin.y()));
    heights.push_back(p.z());
  }
  const cv::RotatedRect rectangle = cv::minAreaRect(footprint);
  double yaw = static_cast<double>(rectangle.angle) * kPi / 180;
  if (rectangle.size.height > rectangle.size.width) yaw += kPi / 2;
  yaw = std::remainder(yaw, kPi);
  const Vector2d x(std::cos(yaw), std::sin(yaw));
  const Vector2d y(-x.y(), x.x());
  std::vector<double> along;
  std::vector<double> across;
  along.reserve(points.size());
  across.reserve(points.size());
  for (const Vector3d& p : points) {
    along.push_back(x.dot(p.head<2>()));
    across.push_back(y.dot(p.head<2>()));
  }
  const Range a = range_of(std::move(along), outliers);
  const Range b = range_of(std::move(across), outliers);
  Range z = range_of(std::move(heights), outliers);
  if (z.low > ground && z.low - ground < reach) z.low = ground;
  const Vector2d centre = x * (a.low + a.high) / 2 + y * (b.low + b.high) / 2;
  box.map_from_box.linear() = Eigen::AngleAxisd(yaw, Vector3d::UnitZ()).toRotationMatrix();
  box.map_from_box.translation() = Vector3d(centre.x(), centre.y(), (z.low + z.high) / 2);
  box.size = {a.high - a.low, b.high - b.low, z.high - z.low};
  return box;
}

AnnotatorDescriptor GeometryAnnotator::descriptor() const {
  return {"GeometryAnnotator",
          "Gives each object an upright box, in the map and in the frame of its place.",
          {"Scene", "Cluster", "ReferenceClusterPoints", "PlanarSupport", "view:cloud"},
          {"GeometryAnnotation"}};
}

void GeometryAnnotator::declare(OptionTable& table) {
  table.number("outliers", outliers_, "", "Share of the points at each end of an axis that may stick out.", 0,
               0.2);
  table.number("ground_m", ground_m_, "m", "Boxes that end this near above the support reach down to it.", 0,
               1);
}

void GeometryAnnotator::process(cas::Cas& cas, Context& /*context*/) {
  const types::SceneCas facade(cas);
  for (const types::Cluster& cluster : facade.clusters()) {
    const std::vector<Vector3d> points = cluster_points(facade, cluster);
    if (points.empty()) continue;
    const types::PlanarSupport support = cluster.support.get();
    double ground = -std::numeric_limits<double>::infinity();
    const Vector3d centroid = types::from<Vector3d>(cluster.centroid.get());
    double highest = 0;
    if (support) {
      const Vector3d normal = types::from<Vector3d>(support.normal.get());
      ground = (support.offset.get() - normal.head<2>().dot(centroid.head<2>())) / normal.z();
      for (const Vector3d& p : points) highest = std::max(highest, normal.dot(p) - support.offset.get());
    }
    const UprightBox box = upright_box(points, ground, ground_m_, outliers_);
    const auto annotation = types::GeometryAnnotation::create(cas);
    annotation.source.set(descriptor().name);
    annotation.map_from_object.set(types::to(cas, box.map_from_box));
    annotation.size.set(types::to(cas, box.size));
    if (support) {
      annotation.height.set(highest);
      const Isometry3d map_from_support = types::from<Isometry3d>(support.map_from_support.get());
      annotation.place_from_object.set(
          types::to(cas, Isometry3d(map_from_support.inverse() * box.map_from_box)));
      if (support.name.is_set()) annotation.place.set(support.name.get());
    }
    cluster.annotations.push_back(annotation);
  }
}

}  // namespace loci::perception
