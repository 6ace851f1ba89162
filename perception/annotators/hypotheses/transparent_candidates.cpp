#include "perception/annotators/hypotheses/transparent_candidates.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace loci::perception {
namespace {

constexpr double kMaxShadow = 0.3;  ///< of a hole's rows
constexpr int kBorder = 8;          ///< Kinects measure nothing at the edges of their images

/// Where a pixel's ray meets the surface.
Vector3d on_surface(const mapping::PinholeCamera& camera, const HoleSurface& surface, double u, double v) {
  const Vector3d ray = camera.unproject(u, v, 1);
  return surface.offset / surface.normal.dot(ray) * ray;
}

/// Height over `foot` at which an upright line comes nearest to a pixel's ray.
double height_over(const Vector3d& foot, const Vector3d& up, const Vector3d& ray) {
  const double along = up.dot(ray), length = ray.squaredNorm();
  return (along * foot.dot(ray) - length * foot.dot(up)) / (length - along * along);
}

/// Which share of what is measured around a hole is the surface.
double surface_around(const cv::Mat& hole, const cv::Rect& box, const cv::Mat& depth,
                      const mapping::PinholeCamera& camera, const HoleSurface& surface, double tolerance) {
  cv::Mat ring;
  cv::dilate(hole, ring, cv::Mat::ones(7, 7, CV_8U));
  int all = 0;
  int on = 0;
  for (int v = 0; v < box.height; ++v)
    for (int u = 0; u < box.width; ++u) {
      if (!ring.at<unsigned char>(v, u) || hole.at<unsigned char>(v, u)) continue;
      const cv::Point at(u + box.x, v + box.y);
      const auto z = static_cast<double>(depth.at<float>(at));
      if (!(z > 0)) continue;
      ++all;
      const double height = surface.normal.dot(camera.unproject(at.x, at.y, z)) - surface.offset;
      on += surface.inside.at<unsigned char>(at) && !surface.taken.at<unsigned char>(at) &&
                    std::abs(height) < tolerance
                ? 1
                : 0;
    }
  return all == 0 ? 0 : static_cast<double>(on) / all;
}

/// Which share of a hole's rows a sensor whose projector stands beside its camera leaves by itself: the
/// shadow of what is nearer on one side of the row falls on what is farther on the other.
double shadow_share(const cv::Mat& hole, const cv::Rect& box, const cv::Mat& depth,
                    const mapping::PinholeCamera& camera, double baseline_m) {
  constexpr double kSlack = 4;  // Edges are ragged.
  constexpr int kNear = 6;
  int rows = 0;
  int shadows = 0;
  for (int v = 0; v < box.height; ++v) {
    int first = box.width;
    int last = -1;
    for (int u = 0; u < box.width; ++u)
      if (hole.at<unsigned char>(v, u)) {
        first = std::min(first, u);
        last = u;
      }
    if (last < 0) continue;
    ++rows;
    // The nearest measurement that is within some pixels beside the hole.
    const auto beside = [&](int u, int step) {
      double inverse = 0;
      for (int k = 1; k <= kNear; ++k) {
        const int column = u + box.x + step * k;
        if (column < 0 || column >= depth.cols) break;
        const auto z = static_cast<double>(depth.at<float>(v + box.y, column));
        if (z > 0) inverse = std::max(inverse, 1 / z);
      }
      return inverse;
    };
    const double width = camera.fx * baseline_m * std::abs(beside(first, -1) - beside(last, 1));
    shadows += last - first + 1 <= width + kSlack && width > kSlack ? 1 : 0;
  }
  return rows == 0 ? 0 : static_cast<double>(shadows) / rows;
}

}  // namespace

void TransparentOptions::declare(OptionTable& table) {
  table.number("min_width_m", min_width_m, "m", "Narrower holes are none.", 0.005, 1);
  table.number("max_width_m", max_width_m, "m", "Wider holes are none.", 0.01, 2);
  table.number("min_height_m", min_height_m, "m", "What would be lower is none.", 0.005, 1);
  table.number("max_height_m", max_height_m, "m", "What would be higher is none.", 0.01, 2);
  table.number("surrounded", surrounded, "",
               "Share of what is seen around a hole that must be the surface itself.", 0, 1);
  table.number("baseline_m", baseline_m, "m", "Distance between projector and camera: it makes shadows.", 0,
               1);
  table.number("surface_m", surface_m, "m", "Points this near to the plane are the surface.", 0.001, 0.1);
}

std::vector<TransparentCandidate> find_transparent(const cv::Mat& depth, const mapping::PinholeCamera& camera,
                                                   const HoleSurface& surface,
                                                   const TransparentOptions& options) {
  cv::Mat holes = ~(depth > 0) & surface.inside & ~surface.taken;
  // Single pixels that were measured through the glass do not part it, single ones that were not are no hole.
  cv::morphologyEx(holes, holes, cv::MORPH_CLOSE, cv::Mat::ones(5, 5, CV_8U));
  cv::morphologyEx(holes, holes, cv::MORPH_OPEN, cv::Mat::ones(5, 5, CV_8U));
  cv::Mat labels;
  cv::Mat stats;
  cv::Mat centres;
  const int count = cv::connectedComponentsWithStats(holes, labels, stats, centres, 8);
  const cv::Rect image({0, 0}, depth.size());
  std::vector<TransparentCandidate> found;
  for (int label = 1; label < count; ++label) {
    const cv::Rect own(stats.at<int>(label, cv::CC_STAT_LEFT), stats.at<int>(label, cv::CC_STAT_TOP),
                       stats.at<int>(label, cv::CC_STAT_WIDTH), stats.at<int>(label, cv::CC_STAT_HEIGHT));
    const cv::Rect box(own.x - kBorder, own.y - kBorder, own.width + 2 * kBorder, own.height + 2 * kBorder);
    if ((box & image) != box) continue;
    TransparentCandidate candidate;
    const double middle = own.x + 0.5 * (own.width - 1);
    const Vector3d front = on_surface(camera, surface, middle, own.y + own.height - 1);
    candidate.width = own.width * front.z() / camera.fx;
    if (candidate.width < options.min_width_m || candidate.width > options.max_width_m) continue;
    // What is seen first of a foot is its front.
    const Vector3d ahead = (front - surface.normal.dot(front) * surface.normal).normalized();
    candidate.foot = front + 0.5 * candidate.width * ahead;
    // The uppermost pixel shows the far side of its rim.
    candidate.height =
        height_over(front + candidate.width * ahead, surface.normal, camera.unproject(middle, own.y, 1));
    if (candidate.height < options.min_height_m || candidate.height > options.max_height_m) continue;
    const cv::Mat hole = labels(box) == label;
    candidate.surrounded = surface_around(hole, box, depth, camera, surface, options.surface_m);
    if (candidate.surrounded < options.surrounded) continue;
    if (shadow_share(hole, box, depth, camera, options.baseline_m) > kMaxShadow) continue;
    for (int v = 0; v < box.height; ++v)
      for (int u = 0; u < box.width; ++u)
        if (hole.at<unsigned char>(v, u)) candidate.pixels.push_back((v + box.y) * depth.cols + u + box.x);
    found.push_back(std::move(candidate));
  }
  return found;
}

}  // namespace loci::perception
