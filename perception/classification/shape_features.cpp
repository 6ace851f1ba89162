#include "perception/classification/shape_features.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "mapping/base/error.h"
#include "perception/classification/features/delegates.h"

namespace loci {
namespace {

using namespace feature_delegates;

struct FeatureDelegate {
  const char* name;
  const char* signature;
  std::vector<float> (*compute)(const SurfacePoints&);
};

constexpr std::array<FeatureDelegate, 9> kDelegates = {{{"VFH", "VFHSignature308", vfh},
                                                        {"CVFH", "CVFHSignature308", cvfh},
                                                        {"ESF", "ESFSignature640", esf},
                                                        {"GRSD", "GRSDSignature21", grsd},
                                                        {"PFH", "PFHSignature125", pfh},
                                                        {"FPFH", "FPFHSignature33", fpfh},
                                                        {"SHOT", "SHOT352", shot},
                                                        {"SpinImage", "SpinImage153", spin_image},
                                                        {"GaussImage", "GaussImage12", gauss_image}}};

const FeatureDelegate& delegate(const std::string& name) {
  for (const FeatureDelegate& each : kDelegates)
    if (each.name == name) return each;
  std::string known;
  for (const FeatureDelegate& each : kDelegates)
    known += (known.empty() ? "" : ", ") + std::string(each.name);
  throw Error("there is no descriptor " + name, {}, "there are " + known);
}

/// One point per cell: the mean of those in it, in order of the cells.
SurfacePoints thinned(const SurfacePoints& surface, float cell_m) {
  std::vector<std::pair<std::array<int, 3>, size_t>> order;
  for (size_t i = 0; i < surface.points.size(); ++i) {
    const Eigen::Vector3f& p = surface.points[i];
    if (!p.allFinite() || !surface.normals[i].allFinite()) continue;
    std::array<int, 3> cell;
    for (size_t axis = 0; axis < 3; ++axis)
      cell[axis] = static_cast<int>(std::floor(p[static_cast<int>(axis)] / cell_m));
    order.emplace_back(cell, i);
  }
  std::sort(order.begin(), order.end());
  SurfacePoints thin;
  for (size_t first = 0; first < order.size();) {
    Eigen::Vector3f point = Eigen::Vector3f::Zero();
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();
    size_t last = first;
    for (; last < order.size() && order[last].first == order[first].first; ++last) {
      point += surface.points[order[last].second];
      normal += surface.normals[order[last].second];
    }
    if (normal.norm() > 0) {
      thin.points.emplace_back(point / static_cast<float>(last - first));
      thin.normals.emplace_back(normal.normalized());
    }
    first = last;
  }
  return thin;
}

}  // namespace

std::vector<std::string> shape_feature_names() {
  std::vector<std::string> names;
  for (const FeatureDelegate& each : kDelegates) names.emplace_back(each.name);
  return names;
}

std::string shape_feature_signature(const std::string& name) {
  return delegate(name).signature;
}

std::vector<float> shape_feature(const std::string& name, const SurfacePoints& surface) {
  constexpr float kCell = 0.005f;
  constexpr size_t kLeastPoints = 20;
  const FeatureDelegate& wanted = delegate(name);
  if (surface.points.size() != surface.normals.size()) throw Error("points and normals are not as many");
  const SurfacePoints thin = thinned(surface, kCell);
  if (thin.points.size() < kLeastPoints) return {};
  std::vector<float> values = wanted.compute(thin);
  const bool finite =
      std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); });
  return finite ? values : std::vector<float>();
}

}  // namespace loci
