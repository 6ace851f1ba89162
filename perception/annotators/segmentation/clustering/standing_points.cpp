#include "perception/annotators/segmentation/clustering/standing_points.h"

#include <opencv2/imgproc.hpp>

#include "mapping/base/parallel.h"
#include "perception/annotators/scene_data.h"

namespace loci::perception {
namespace {

using Eigen::Vector3f;

constexpr int kNoSupport = -1;  ///< below a point
constexpr int kOnSupport = -2;  ///< it is the support itself

/// The highest support below a point, or one of the two above, and the point in its frame.
int support_below(const Vector3f& p, int label, const std::vector<SupportGround>& grounds,
                  const ClusterOptions& options, Vector3d& position) {
  // Beyond the outline by this much objects are still looked at, to tell what merely reaches over the
  // support.
  constexpr double kAround = 0.15;
  int best = kNoSupport;
  for (size_t s = 0; s < grounds.size(); ++s) {
    const SupportPlane& support = grounds[s].plane;
    if (support.region != label) continue;
    const Vector3d at = support.in_plane(p.cast<double>());
    if (at.z() > options.max_height_m || at.z() < -0.03) continue;
    const double floor = options.floor_m + (grounds[s].color ? 0 : support.uncertainty) +
                         1.5 * height_noise(support, p.cast<double>());
    if (at.z() < -floor || (best >= 0 && at.z() > floor && at.z() >= position.z())) continue;
    const double inside = grounds[s].outline.inside(at.head<2>());
    if (inside < -kAround) continue;
    if (std::abs(at.z()) <= floor) return kOnSupport;
    if (at.z() <= floor) continue;
    best = static_cast<int>(s);
    position = at;
  }
  return best;
}

}  // namespace

std::vector<Standing> stand_on_supports(const ClusterImages& images, const mapping::PinholeCamera& camera,
                                        const std::vector<SupportGround>& grounds,
                                        const ClusterOptions& options, int threads, cv::Mat& shows) {
  const cv::Mat& points = images.points;
  const auto* point = points.ptr<cv::Vec3f>();
  const auto* normal = images.normals.ptr<cv::Vec3f>();
  const auto* label_of = images.region.empty() ? nullptr : images.region.ptr<uint16_t>();
  const auto focal_squared = static_cast<float>(camera.fx * camera.fy);
  shows = cv::Mat::zeros(points.size(), CV_8U);
  constexpr int kRows = 16;
  const auto blocks = static_cast<size_t>((points.rows + kRows - 1) / kRows);
  std::vector<std::vector<Standing>> of_block(blocks, std::vector<Standing>(grounds.size()));
  parallel_each(blocks, threads, [&](size_t block) {
    const int end = std::min(points.rows, static_cast<int>(block + 1) * kRows) * points.cols;
    for (int i = static_cast<int>(block) * kRows * points.cols; i < end; ++i) {
      if (std::isnan(point[i][2])) continue;
      const Vector3f p = to_vector3f(point[i]);
      Vector3d position;
      const int best = label_of && label_of[i] == 0
                           ? kNoSupport
                           : support_below(p, label_of ? label_of[i] : 0, grounds, options, position);
      shows.ptr<uint8_t>()[i] = static_cast<uint8_t>(best >= 0            ? Shows::candidate
                                                     : best == kOnSupport ? Shows::support
                                                                          : Shows::surroundings);
      if (best < 0) continue;
      const auto s = static_cast<size_t>(best);
      Standing& target = of_block[block][s];
      target.pixels.push_back(i);
      target.points.push_back(p);
      target.normals.push_back(to_vector3f(normal[i]));
      target.in_plane.push_back(position.cast<float>());
      target.normals_in_plane.push_back(grounds[s].plane_from_camera * target.normals.back());
      target.areas.push_back(p.z() * p.z() / focal_squared);
    }
  });
  std::vector<Standing> standing(grounds.size());
  for (size_t s = 0; s < standing.size(); ++s) {
    size_t count = 0;
    for (const auto& part : of_block) count += part[s].pixels.size();
    standing[s].reserve(count);
    for (const auto& part : of_block)
      for (size_t i = 0; i < part[s].pixels.size(); ++i) standing[s].add(part[s], i);
  }
  return standing;
}

Standing subset(const Standing& all, const std::vector<size_t>& members) {
  Standing part;
  part.reserve(members.size());
  for (const size_t i : members) part.add(all, i);
  return part;
}

void drop_specks(Standing& standing, const SupportPlane& support, const ClusterOptions& options,
                 cv::Mat& shows) {
  constexpr double kSigmas = 4, kMinShare = 0.3;
  cv::Mat share;
  cv::boxFilter(shows == static_cast<uint8_t>(Shows::candidate), share, CV_32F, {5, 5});
  std::vector<size_t> kept;
  for (size_t i = 0; i < standing.pixels.size(); ++i) {
    const double reach = options.floor_m + support.uncertainty +
                         kSigmas * height_noise(support, standing.points[i].cast<double>());
    const int pixel = standing.pixels[i];
    if (static_cast<double>(standing.in_plane[i].z()) > reach ||
        static_cast<double>(share.ptr<float>()[pixel]) > kMinShare * 255)
      kept.push_back(i);
    else
      shows.ptr<uint8_t>()[pixel] = static_cast<uint8_t>(Shows::support);
  }
  if (kept.size() < standing.pixels.size()) standing = subset(standing, kept);
}

}  // namespace loci::perception
