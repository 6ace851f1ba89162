#include "perception/classification/shape_features.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "mapping/base/error.h"
#include "perception/classification/features/delegates.h"

namespace loci::perception {
namespace {

using namespace feature_delegates;

struct FeatureDelegate {
  const char* name;
  const char* signature;
  std::vector<float> (*compute)(const SurfacePoints&);
};

constexpr std::array<FeatureDelegate, 20> kDelegates = {
    {{"VFH", "VFHSignature308", feature_delegates::vfh},
     {"CVFH", "CVFHSignature308", feature_delegates::cvfh},
     {"OURCVFH", "OURCVFHSignature308", feature_delegates::our_cvfh},
     {"ESF", "ESFSignature640", feature_delegates::esf},
     {"GRSD", "GRSDSignature21", feature_delegates::grsd},
     {"RSD", "PrincipalRadiiRSD2", feature_delegates::rsd},
     {"CRH", "CameraRollHistogram90", feature_delegates::crh},
     {"PFH", "PFHSignature125", feature_delegates::pfh},
     {"PFHRGB", "PFHRGBSignature250", feature_delegates::pfh_rgb},
     {"FPFH", "FPFHSignature33", feature_delegates::fpfh},
     {"SHOT", "SHOT352", feature_delegates::shot},
     {"ColorSHOT", "SHOT1344", feature_delegates::color_shot},
     {"USC", "UniqueShapeContext1960", feature_delegates::usc},
     {"3DSC", "ShapeContext1980", feature_delegates::shape_context},
     {"GASD", "GASDSignature512", feature_delegates::gasd},
     {"RIFT", "RIFT32", feature_delegates::rift},
     {"SpinImage", "SpinImage153", feature_delegates::spin_image},
     {"Moments", "MomentInvariants3", feature_delegates::moments},
     {"Curvatures", "PrincipalCurvatures2", feature_delegates::curvatures},
     {"GaussImage", "GaussImage12", feature_delegates::gauss_image}}};

const FeatureDelegate& delegate(const std::string& name) {
  for (const FeatureDelegate& each : kDelegates)
    if (each.name == name) return each;
  std::string known;
  for (const FeatureDelegate& each : kDelegates)
    known += (known.empty() ? "" : ", ") + std::string(each.name);
  throw Error("there is no descriptor " + name, {}, "there are " + known);
}

}  // namespace

SurfacePoints thinned_surface(const SurfacePoints& surface) {
  constexpr float kCell = 0.005f;
  std::vector<std::pair<std::array<int, 3>, size_t>> order;
  for (size_t i = 0; i < surface.points.size(); ++i) {
    const Eigen::Vector3f& p = surface.points[i];
    if (!p.allFinite() || !surface.normals[i].allFinite()) continue;
    std::array<int, 3> cell;
    for (size_t axis = 0; axis < 3; ++axis)
      cell[axis] = static_cast<int>(std::floor(p[static_cast<int>(axis)] / kCell));
    order.emplace_back(cell, i);
  }
  std::sort(order.begin(), order.end());
  SurfacePoints thin;
  for (size_t first = 0; first < order.size();) {
    Eigen::Vector3f point = Eigen::Vector3f::Zero();
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();
    Eigen::Vector3f color = Eigen::Vector3f::Zero();
    size_t last = first;
    for (; last < order.size() && order[last].first == order[first].first; ++last) {
      point += surface.points[order[last].second];
      normal += surface.normals[order[last].second];
      if (!surface.colors.empty()) color += surface.colors[order[last].second];
    }
    if (normal.norm() > 0) {
      thin.points.emplace_back(point / static_cast<float>(last - first));
      thin.normals.emplace_back(normal.normalized());
      if (!surface.colors.empty()) thin.colors.emplace_back(color / static_cast<float>(last - first));
    }
    first = last;
  }
  return thin;
}

std::vector<std::string> shape_feature_names() {
  std::vector<std::string> names;
  for (const FeatureDelegate& each : kDelegates) names.emplace_back(each.name);
  return names;
}

std::string shape_feature_signature(const std::string& name) {
  return delegate(name).signature;
}

std::vector<float> shape_feature(const std::string& name, const SurfacePoints& surface) {
  constexpr size_t kMinPoints = 20;
  const FeatureDelegate& wanted = delegate(name);
  if (surface.points.size() != surface.normals.size()) throw Error("points and normals are not as many");
  const SurfacePoints thin = thinned_surface(surface);
  if (thin.points.size() < kMinPoints) return {};
  std::vector<float> values = wanted.compute(thin);
  const bool finite =
      std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); });
  return finite ? values : std::vector<float>();
}

}  // namespace loci::perception
