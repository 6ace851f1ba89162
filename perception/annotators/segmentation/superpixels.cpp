#include "perception/annotators/segmentation/superpixels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <opencv2/imgproc.hpp>

#include "mapping/base/math/math.h"
#include "perception/annotators/scene_data.h"
#include "perception/conversions/opencv.h"
#include "perception/recognition/image_features.h"

namespace loci::perception {
namespace {

constexpr double kColorScale = 25;  ///< Lab: colours this far apart count as much as one radius
constexpr double kMinFacingCosine = 0.15;
constexpr int kMaxSuperpixels = 65000;
constexpr int kMaxRounds = 8;
constexpr double kOutlier = 3;      ///< standard deviations above the scene's median stand out
constexpr double kFragment = 0.25;  ///< of a superpixel's expected pixels: smaller pieces go to a neighbour

/// Sums of what belongs to a superpixel.
struct Sum {
  Vector3d position = Vector3d::Zero(), normal = Vector3d::Zero(), lab = Vector3d::Zero();
  int pixels = 0, colored = 0;
};

class Growing {
 public:
  Growing(const cv::Mat& points, const cv::Mat& normals, const cv::Mat& lab,
          const mapping::PinholeCamera& camera, const SuperpixelOptions& options)
      : points_(points.ptr<cv::Vec3f>()),
        normals_(normals.ptr<cv::Vec3f>()),
        lab_(lab.ptr<cv::Vec3f>()),
        camera_(camera),
        options_(options),
        rows_(points.rows),
        cols_(points.cols),
        density_(rows_, cols_, 0.0f) {}

  Superpixels run() {
    seed();
    cv::Mat1i labels(rows_, cols_, -1);
    for (int round = 0; round < options_.iterations; ++round) {
      assign(labels);
      update(labels);
    }
    // A piece may go to one that itself goes elsewhere.
    for (int round = 0; round < kMaxRounds && connect(labels) > 0; ++round) update(labels);
    Superpixels found;
    found.all = centers_;
    labels += 1;
    labels.convertTo(found.labels, CV_16U);
    return found;
  }

 private:
  bool measured(int pixel) const {
    return std::isfinite(points_[pixel][2]) && std::isfinite(normals_[pixel][2]);
  }

  /// Superpixels per pixel, and seeds as dense as that.
  void seed() {
    const double area = kPi * options_.radius_m * options_.radius_m;
    for (int i = 0; i < rows_ * cols_; ++i) {
      if (!measured(i)) continue;
      const Vector3d point = to_vector(points_[i]);
      const double cosine = std::max(
          kMinFacingCosine, std::abs(to_vector(normals_[i]).dot(point)) / std::max(1e-9, point.norm()));
      density_.ptr<float>()[i] = static_cast<float>(
          std::min(1.0, point.z() * point.z() / (camera_.fx * camera_.fy * cosine * area)));
    }
    cv::Mat1d sums;
    cv::integral(density_, sums, CV_64F);
    int side = 1;
    while (side < std::max(rows_, cols_)) side *= 2;
    double left = 0;
    seed(cv::Rect(0, 0, side, side), sums, left);
  }

  /// Parts a square until it holds one superpixel at most; what part of one is left over goes on to the next
  /// square, so that holes and edges lose none.
  void seed(const cv::Rect& square, const cv::Mat1d& sums, double& left) {
    const cv::Rect cell = square & cv::Rect(0, 0, cols_, rows_);
    if (cell.empty()) return;
    const double here =
        sums(cell.br()) - sums(cell.y, cell.br().x) - sums(cell.br().y, cell.x) + sums(cell.tl());
    if (here > 1 && square.width > 1) {
      const int half = square.width / 2;
      for (const int dv : {0, half})
        for (const int du : {0, half}) seed(cv::Rect(square.x + du, square.y + dv, half, half), sums, left);
      return;
    }
    left += here;
    if (left < 0.5 || static_cast<int>(centers_.size()) >= kMaxSuperpixels) return;
    int nearest = -1, least = std::numeric_limits<int>::max();
    for (int v = cell.y; v < cell.br().y; ++v)
      for (int u = cell.x; u < cell.br().x; ++u) {
        const int du = 2 * (u - cell.x) + 1 - cell.width, dv = 2 * (v - cell.y) + 1 - cell.height;
        if (!measured(v * cols_ + u) || du * du + dv * dv >= least) continue;
        least = du * du + dv * dv;
        nearest = v * cols_ + u;
      }
    if (nearest < 0) return;
    centers_.push_back(at(nearest));
    left -= 1;
  }

  Superpixel at(int pixel) const {
    const bool colored = std::isfinite(lab_[pixel][0]);
    return {to_vector(points_[pixel]), to_vector(normals_[pixel]),
            colored ? to_vector(lab_[pixel]) : Vector3d(std::numeric_limits<double>::quiet_NaN(), 0, 0), 1};
  }

  double distance(const Superpixel& center, int pixel) const {
    const double place =
        (to_vector(points_[pixel]) - center.position).squaredNorm() / (options_.radius_m * options_.radius_m);
    const double direction = 1 - to_vector(normals_[pixel]).dot(center.normal);
    double color = 0;
    if (std::isfinite(lab_[pixel][0]) && std::isfinite(center.lab[0]))
      color = (to_vector(lab_[pixel]) - center.lab).squaredNorm() / (kColorScale * kColorScale);
    return (1 - options_.color - options_.normal) * place + options_.color * color +
           options_.normal * 2 * direction;
  }

  void assign(cv::Mat1i& labels) const {
    cv::Mat1f best(rows_, cols_, std::numeric_limits<float>::infinity());
    labels.setTo(-1);
    for (size_t k = 0; k < centers_.size(); ++k) {
      const Superpixel& center = centers_[k];
      const Vector2d middle = camera_.project(center.position);
      const double reach = 2 * options_.radius_m * camera_.fx / center.position.z();
      const int u0 = std::max(0, static_cast<int>(middle.x() - reach)),
                u1 = std::min(cols_ - 1, static_cast<int>(middle.x() + reach) + 1),
                v0 = std::max(0, static_cast<int>(middle.y() - reach)),
                v1 = std::min(rows_ - 1, static_cast<int>(middle.y() + reach) + 1);
      for (int v = v0; v <= v1; ++v)
        for (int u = u0; u <= u1; ++u) {
          const int i = v * cols_ + u;
          if (!measured(i)) continue;
          const auto d = static_cast<float>(distance(center, i));
          if (d >= best(v, u)) continue;
          best(v, u) = d;
          labels(v, u) = static_cast<int>(k);
        }
    }
  }

  /// Means over their pixels; superpixels without any vanish, and labels are numbered anew.
  void update(cv::Mat1i& labels) {
    std::vector<Sum> sums(centers_.size());
    for (int i = 0; i < rows_ * cols_; ++i) {
      const int k = labels.ptr<int>()[i];
      if (k < 0) continue;
      Sum& sum = sums[static_cast<size_t>(k)];
      sum.position += to_vector(points_[i]);
      sum.normal += to_vector(normals_[i]);
      ++sum.pixels;
      if (!std::isfinite(lab_[i][0])) continue;
      sum.lab += to_vector(lab_[i]);
      ++sum.colored;
    }
    std::vector<int> number(centers_.size(), -1);
    std::vector<Superpixel> kept;
    for (size_t k = 0; k < sums.size(); ++k) {
      const Sum& sum = sums[k];
      if (sum.pixels == 0) continue;
      number[k] = static_cast<int>(kept.size());
      Superpixel center{sum.position / sum.pixels, sum.normal.stableNormalized(),
                        Vector3d(std::numeric_limits<double>::quiet_NaN(), 0, 0), sum.pixels};
      if (sum.colored > 0) center.lab = sum.lab / sum.colored;
      kept.push_back(center);
    }
    for (int i = 0; i < rows_ * cols_; ++i)
      if (int& label = labels.ptr<int>()[i]; label >= 0) label = number[static_cast<size_t>(label)];
    centers_ = std::move(kept);
  }

  /// Pieces that are no part of their superpixel's largest one (or of none), and small, go to the neighbour
  /// with the longest common border; larger ones become superpixels of their own. Returns how many there
  /// were.
  size_t connect(cv::Mat1i& labels) {
    cv::Mat1i piece(rows_, cols_, -1);
    std::vector<std::vector<int>> pieces;
    for (int i = 0; i < rows_ * cols_; ++i)
      if (measured(i) && piece.ptr<int>()[i] < 0) flood(labels, i, piece, pieces);
    const auto label_of = [&](size_t p) { return labels.ptr<int>()[pieces[p][0]]; };
    std::vector<size_t> largest(centers_.size(), pieces.size());
    for (size_t p = 0; p < pieces.size(); ++p) {
      if (label_of(p) < 0) continue;
      size_t& first = largest[static_cast<size_t>(label_of(p))];
      if (first == pieces.size() || pieces[p].size() > pieces[first].size()) first = p;
    }
    std::vector<size_t> others;
    for (size_t p = 0; p < pieces.size(); ++p)
      if (label_of(p) < 0 || largest[static_cast<size_t>(label_of(p))] != p) others.push_back(p);
    for (const size_t p : others) {
      double expected = 0;
      for (const int i : pieces[p]) expected += static_cast<double>(density_.ptr<float>()[i]);
      int next = expected < kFragment ? neighbour(labels, pieces[p]) : -1;
      if (next < 0 && static_cast<int>(centers_.size()) < kMaxSuperpixels) {
        next = static_cast<int>(centers_.size());
        centers_.emplace_back();
      }
      for (const int i : pieces[p]) labels.ptr<int>()[i] = next;
    }
    return others.size();
  }

  template <class Visit>
  void for_neighbours(int pixel, const Visit& visit) const {
    const int v = pixel / cols_, u = pixel % cols_;
    if (u > 0) visit(pixel - 1);
    if (u + 1 < cols_) visit(pixel + 1);
    if (v > 0) visit(pixel - cols_);
    if (v + 1 < rows_) visit(pixel + cols_);
  }

  void flood(const cv::Mat1i& labels, int start, cv::Mat1i& piece,
             std::vector<std::vector<int>>& pieces) const {
    const int label = labels.ptr<int>()[start], number = static_cast<int>(pieces.size());
    std::vector<int> members = {start};
    piece.ptr<int>()[start] = number;
    for (size_t next = 0; next < members.size(); ++next)
      for_neighbours(members[next], [&](int i) {
        if (labels.ptr<int>()[i] != label || piece.ptr<int>()[i] >= 0 || !measured(i)) return;
        piece.ptr<int>()[i] = number;
        members.push_back(i);
      });
    pieces.push_back(std::move(members));
  }

  /// The other superpixel beside a piece whose points are near, with the longest border; -1 = none.
  int neighbour(const cv::Mat1i& labels, const std::vector<int>& members) const {
    const int own = labels.ptr<int>()[members[0]];
    std::map<int, int> border;
    for (const int i : members)
      for_neighbours(i, [&](int j) {
        const int label = labels.ptr<int>()[j];
        if (label < 0 || label == own) return;
        if ((to_vector(points_[i]) - to_vector(points_[j])).norm() < options_.radius_m) ++border[label];
      });
    int best = -1, longest = 0;
    for (const auto& [label, length] : border)
      if (length > longest) {
        best = label;
        longest = length;
      }
    return best;
  }

  const cv::Vec3f* points_;
  const cv::Vec3f* normals_;
  const cv::Vec3f* lab_;
  const mapping::PinholeCamera& camera_;
  const SuperpixelOptions& options_;
  int rows_, cols_;
  cv::Mat1f density_;
  std::vector<Superpixel> centers_;
};

/// From where a value stands out from most of the others (median and median deviation as of a normal law).
double outlier_from(std::vector<double> values) {
  const auto median = [&values] {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  };
  if (values.empty()) return 0;
  const double usual = median();
  for (double& value : values) value = std::abs(value - usual);
  return usual + kOutlier * 1.4826 * median();
}

Superpixels superpixels_of(const types::SceneCas& scene, const SuperpixelOptions& options) {
  const mapping::RgbdCamera camera = types::cameras(scene);
  const cv::Mat points = cloud_points(scene);
  const cv::Mat lab = lab_of_points(points, types::view_image(scene, types::SceneCas::kColor), camera);
  return find_superpixels(points, cloud_normals(scene), lab, camera.depth, options);
}

/// Share of a cluster's points in a ball (map frame).
double share_inside(const std::vector<Vector3d>& points, const Vector3d& center, double radius) {
  if (points.empty()) return 0;
  size_t inside = 0;
  for (const Vector3d& point : points) inside += (point - center).norm() <= radius ? 1 : 0;
  return static_cast<double>(inside) / static_cast<double>(points.size());
}

}  // namespace

void SuperpixelOptions::declare(OptionTable& table) {
  table.number("radius_m", radius_m, "m", "Radius of a superpixel in space.", 0.002, 1);
  table.integer("iterations", iterations, "", "Iterations of k-means.", 1, 100);
  table.number("color", color, "", "Weight of colour; position gets the remaining weight.", 0, 0.9);
  table.number("normal", normal, "", "Weight of the surface normal.", 0, 0.9);
}

Superpixels find_superpixels(const cv::Mat& points, const cv::Mat& normals, const cv::Mat& lab,
                             const mapping::PinholeCamera& camera, const SuperpixelOptions& options) {
  if (!(options.color + options.normal < 1))
    throw Error("the weights of colour and normal leave nothing for the place", {}, "their sum is below 1");
  return Growing(points, normals, lab, camera, options).run();
}

cv::Mat lab_of_points(const cv::Mat& points, const cv::Mat& color, const mapping::RgbdCamera& camera) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  cv::Mat lab, seen(points.size(), CV_32FC3, cv::Scalar::all(static_cast<double>(nan)));
  color.convertTo(lab, CV_32F, 1.0 / 255);
  lab = lab_of(lab);
  const Isometry3d color_from_depth = camera.depth_from_color.inverse();
  for (int i = 0; i < points.rows * points.cols; ++i) {
    const Vector3d point = color_from_depth * to_vector(points.ptr<cv::Vec3f>()[i]);
    if (!(point.z() > 0)) continue;
    const Vector2d pixel = camera.color.project(point);
    const int u = static_cast<int>(std::lround(pixel.x())), v = static_cast<int>(std::lround(pixel.y()));
    if (u < 0 || v < 0 || u >= lab.cols || v >= lab.rows) continue;
    seen.ptr<cv::Vec3f>()[i] = lab.at<cv::Vec3f>(v, u);
  }
  return seen;
}

std::vector<double> saliency(const Superpixels& superpixels, double reach) {
  const std::vector<Superpixel>& all = superpixels.all;
  std::vector<double> found(all.size(), 0);
  for (size_t i = 0; i < all.size(); ++i) {
    double sum = 0, weight = 0;
    for (size_t j = 0; j < all.size(); ++j) {
      const double away = (all[i].position - all[j].position).squaredNorm() / (reach * reach);
      if (away > 9 || !std::isfinite(all[i].lab[0]) || !std::isfinite(all[j].lab[0])) continue;
      // Patches are of one size in space, so that each counts once.
      const double w = std::exp(-away / 2);
      sum += w * (all[i].lab - all[j].lab).norm();
      weight += w;
    }
    if (weight > 0) found[i] = sum / weight;
  }
  const double most = found.empty() ? 0 : *std::max_element(found.begin(), found.end());
  if (most > 0)
    for (double& value : found) value /= most;
  return found;
}

std::vector<SalientBall> salient_balls(const Superpixels& superpixels, const std::vector<double>& saliency,
                                       double share, double step, double max_radius, size_t most) {
  const std::vector<Superpixel>& all = superpixels.all;
  std::vector<size_t> order(all.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return saliency[a] > saliency[b]; });
  std::vector<bool> used(all.size(), false);
  const double least = outlier_from(saliency);
  std::vector<SalientBall> balls;
  for (const size_t peak : order) {
    if (balls.size() >= most || !(saliency[peak] > least)) break;
    const auto inside = [&](const SalientBall& ball) {
      return (all[peak].position - ball.center).norm() <= ball.radius;
    };
    if (used[peak] || std::any_of(balls.begin(), balls.end(), inside)) continue;
    std::vector<size_t> members = {peak};
    used[peak] = true;
    for (size_t next = 0; next < members.size(); ++next)
      for (size_t j = 0; j < all.size(); ++j) {
        if (used[j] || saliency[j] < share * saliency[peak]) continue;
        if ((all[j].position - all[members[next]].position).norm() > step) continue;
        used[j] = true;
        members.push_back(j);
      }
    SalientBall ball;
    ball.saliency = saliency[peak];
    for (const size_t j : members) ball.center += all[j].position / static_cast<double>(members.size());
    for (const size_t j : members)
      ball.radius = std::max(ball.radius, (all[j].position - ball.center).norm() + step / 2);
    if (ball.radius <= max_radius) balls.push_back(ball);
  }
  return balls;
}

AnnotatorDescriptor SuperpixelExtractor::descriptor() const {
  return {"SuperpixelExtractor",
          "Segments the image into depth-adaptive superpixels of similar size, colour and normal.",
          {"Scene", "CameraInfo", "view:color", "view:cloud", "view:normals"},
          {"view:superpixels"}};
}

void SuperpixelExtractor::process(cas::Cas& cas, Context& /*context*/) {
  const types::SceneCas scene(cas);
  types::set_view_image(scene, kSuperpixelsView, superpixels_of(scene, options_).labels);
}

AnnotatorDescriptor SaliencyDetector::descriptor() const {
  return {"SaliencyDetector",
          "Adds sphere hypotheses around regions with salient colours.",
          {"Scene", "CameraInfo", "view:color", "view:cloud", "view:normals"},
          {"TFLinkSphereROI", "view:saliency"},
          {"Cluster", "ReferenceClusterPoints"},
          {"Cluster"}};
}

void SaliencyDetector::declare(OptionTable& table) {
  superpixels_.declare(table);
  table.number("reach_m", reach_m_, "m", "Radius of the neighbourhood that colours are compared with.", 0.01,
               10);
  table.number("share", share_, "", "Minimum saliency of a region's superpixels relative to its peak.", 0.05,
               1);
  table.number("max_radius_m", max_radius_m_, "m", "Maximum radius of a sphere.", 0.01, 10);
  table.integer("most", most_, "", "Maximum number of spheres, most salient first.", 1, 1000);
}

void SaliencyDetector::process(cas::Cas& cas, Context& /*context*/) {
  const types::SceneCas scene(cas);
  const Superpixels superpixels = superpixels_of(scene, superpixels_);
  const std::vector<double> values = saliency(superpixels, reach_m_);
  cv::Mat image = cv::Mat::zeros(superpixels.labels.size(), CV_8U);
  for (int i = 0; i < image.rows * image.cols; ++i)
    if (const int label = superpixels.labels.ptr<uint16_t>()[i]; label > 0)
      image.ptr<uint8_t>()[i] = static_cast<uint8_t>(255 * values[static_cast<size_t>(label - 1)]);
  types::set_view_image(scene, kSaliencyView, image);
  const Isometry3d pose = map_from_camera(scene.scene());
  for (const SalientBall& ball : salient_balls(superpixels, values, share_, 2.5 * superpixels_.radius_m,
                                               max_radius_m_, static_cast<size_t>(most_))) {
    const auto sphere = types::TFLinkSphereROI::create(cas);
    sphere.source.set("SaliencyDetector");
    sphere.tf_frame.set("map");
    const Vector3d center = pose * ball.center;
    sphere.center.set(types::to(cas, center));
    sphere.radius.set(ball.radius);
    sphere.add_to_index(kSaliencyView);
    for (const types::Cluster& cluster : scene.clusters())
      if (share_inside(cluster_points(scene, cluster), center, ball.radius) > 0.5)
        cluster.hypotheses.push_back(sphere);
  }
}

}  // namespace loci::perception
