#include "mapping/tracking/depth_calibration.h"

#include <Eigen/Cholesky>

#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "mapping/base/parallel.h"

namespace loci::mapping::tracking {
namespace {

/// The offset is interpolated bilinearly between nodes over the image.
constexpr int kColumns = 13, kRows = 10, kNodes = kColumns * kRows;
constexpr size_t kLevel = 1;         // Residuals are taken here: the field is smooth.
constexpr size_t kMaxViews = 60;     // That are compared …
constexpr size_t kEnoughViews = 10;  // … and so many where the camera moves little: then they are nearer.
constexpr size_t kMaxPairs = 180;    // Of few views all are compared with each other, of many neighbours …
constexpr size_t kMinPairs = 20;     // … of which so many must fit.
constexpr size_t kGroup = 4;         // Views whose pairs are held out together.
constexpr double kMinImprovement = 0.25;
constexpr double kMaxOffset = 0.004;  // 1/m, RMS; more is another error: of lenses, of stamps, of motion.

/// Nodes around a pixel and their weights.
struct Stencil {
  std::array<int, 4> nodes;
  std::array<double, 4> weights;
};

Stencil stencil_at(double u, double v, const PinholeCamera& camera) {
  const double x = std::clamp(u / (camera.width - 1) * (kColumns - 1), 0.0, kColumns - 1.001);
  const double y = std::clamp(v / (camera.height - 1) * (kRows - 1), 0.0, kRows - 1.001);
  const int column = static_cast<int>(x), row = static_cast<int>(y), first = row * kColumns + column;
  const double a = x - column, b = y - row;
  return {{first, first + 1, first + kColumns, first + kColumns + 1},
          {(1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b}};
}

/// Normal equations of the offsets: their sum over pairs whose poses are free.
struct Equations {
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(kNodes, kNodes);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(kNodes);

  void add(const Equations& other) {
    hessian += other.hessian;
    gradient += other.gradient;
  }
  /// Change of the sum of squares by offsets.
  double change(const Eigen::VectorXd& offsets) const {
    return offsets.dot(hessian * offsets) + 2 * offsets.dot(gradient);
  }
};

/// What a view is compared as.
struct View {
  std::unique_ptr<Keyframe> keyframe;
  FrameImages images;
};

/// One distance from a surface, and its derivatives by the pose and by the offsets at the two pixels.
struct Residual {
  double value = 0, weight = 0;
  Vector6d motion;
  std::array<std::pair<int, double>, 8> offsets;
};

/// Compares a point of one view with what another one measured there, as alignment does.
std::optional<Residual> residual_of(const ModelPoint& model, const FrameImages& images,
                                    const Isometry3d& to_from_from) {
  const ImageLevel& level = images.levels[kLevel];
  const PinholeCamera& camera = level.depth_camera;
  const Vector3d own = model.position.cast<double>();
  const Vector3d turned = to_from_from.linear() * own;
  const Vector3d point = turned + to_from_from.translation();
  const Vector3d normal = to_from_from.linear() * model.normal.cast<double>();
  if (point.z() < 0.1) return std::nullopt;
  const Vector2d pixel = camera.project(point);
  if (!camera.contains(pixel)) return std::nullopt;
  const int x = static_cast<int>(std::lround(pixel.x())), y = static_cast<int>(std::lround(pixel.y()));
  const auto inverse = static_cast<double>(level.inverse_depth.at<float>(y, x));
  if (inverse <= 0) return std::nullopt;
  const double z = 1 / inverse;
  const cv::Vec3f& other = level.normals.at<cv::Vec3f>(y, x);
  const Vector3d measured = camera.unproject(x, y, z);
  const double gate =
      static_cast<double>(kAlignment.gate_m[kLevel]) + static_cast<double>(kAlignment.gate_per_z2) * z * z;
  Residual residual;
  residual.value = normal.dot(measured - point);
  if (std::abs(residual.value) > gate ||
      normal.cast<float>().dot(Eigen::Vector3f(other[0], other[1], other[2])) < kAlignment.same_side_cosine)
    return std::nullopt;
  const double share = 1 - residual.value * residual.value / (gate * gate);
  const double slant = std::max(0.2, -normal.dot(measured) / measured.norm());
  const double sigma = kAlignment.disparity_sigma * z * z * slant;
  residual.weight = share * share / (sigma * sigma + kAlignment.floor_sigma * kAlignment.floor_sigma);
  residual.motion << normal, measured.cross(normal);
  // Inverse depth that is too large by a little moves a point towards the camera, by its distance times
  // depth.
  const PinholeCamera& finest = images.levels.front().depth_camera;
  const Vector2d own_pixel = finest.project(own);
  const Stencil at = stencil_at(x, y, camera), own_at = stencil_at(own_pixel.x(), own_pixel.y(), finest);
  for (size_t k = 0; k < 4; ++k) {
    residual.offsets[k] = {at.nodes[k], at.weights[k] * normal.dot(measured) * z};
    residual.offsets[k + 4] = {own_at.nodes[k], -own_at.weights[k] * normal.dot(turned) * own.z()};
  }
  return residual;
}

struct PairEquations {
  Equations equations;
  double squares = 0;
};

/// One pair of views, aligned, with its pose eliminated; nothing when they do not fit.
std::optional<PairEquations> equations_of(const View& from, const View& to, const Isometry3d& guess) {
  const Reference reference{from.keyframe.get(), Isometry3d::Identity()};
  const Alignment alignment = align(to.images, {&reference, 1}, guess, {kLevel + 1, kLevel});
  if (!misfit_of(alignment, kVerdict.min_inliers).empty()) return std::nullopt;
  PairEquations result;
  Eigen::MatrixXd mixed = Eigen::MatrixXd::Zero(kNodes, 6);
  for (const ModelPoint& model : from.keyframe->points(kLevel)) {
    const auto residual = residual_of(model, to.images, alignment.map_from_camera.inverse());
    if (!residual) continue;
    for (const auto& [a, slope] : residual->offsets) {
      const double weighted = residual->weight * slope;
      result.equations.gradient[a] += weighted * residual->value;
      mixed.row(a) += weighted * residual->motion.transpose();
      for (const auto& [b, other] : residual->offsets) result.equations.hessian(a, b) += weighted * other;
    }
    result.squares += residual->weight * residual->value * residual->value;
  }
  Matrix6d pose = alignment.hessian;
  pose.diagonal() *= 1 + 1e-6;
  pose.diagonal().array() += 1;
  result.equations.hessian -= mixed * pose.ldlt().solve(mixed.transpose());
  return result;
}

/// Offsets are small and smooth; where nothing is measured they follow their neighbours.
void add_prior(Equations& equations) {
  constexpr double kSize = 0.005, kBend = 0.0006;  // 1/m
  equations.hessian.diagonal().array() += 1 / (kSize * kSize);
  const auto bend = [&](int a, int b, int c) {
    const std::array<std::pair<int, double>, 3> row = {{{a, 1.0}, {b, -2.0}, {c, 1.0}}};
    for (const auto& [i, x] : row)
      for (const auto& [j, y] : row) equations.hessian(i, j) += x * y / (kBend * kBend);
  };
  for (int r = 0; r < kRows; ++r)
    for (int c = 0; c < kColumns; ++c) {
      const int node = r * kColumns + c;
      if (c > 0 && c + 1 < kColumns) bend(node - 1, node, node + 1);
      if (r > 0 && r + 1 < kRows) bend(node - kColumns, node, node + kColumns);
    }
}

Eigen::VectorXd solved(Equations equations) {
  equations.hessian /= kAlignment.correlation;
  equations.gradient /= kAlignment.correlation;
  add_prior(equations);
  return -equations.hessian.ldlt().solve(equations.gradient);
}

cv::Mat image_of(const Eigen::VectorXd& offsets, const PinholeCamera& camera) {
  cv::Mat image(camera.height, camera.width, CV_32F);
  for (int v = 0; v < image.rows; ++v)
    for (int u = 0; u < image.cols; ++u) {
      const Stencil at = stencil_at(u, v, camera);
      double value = 0;
      for (size_t k = 0; k < 4; ++k) value += at.weights[k] * offsets[at.nodes[k]];
      image.at<float>(v, u) = static_cast<float>(value);
    }
  return image;
}

/// Views that are some way from the one before.
std::vector<CalibrationView> spread(const std::vector<CalibrationView>& views, double shift, double turn) {
  std::vector<CalibrationView> chosen;
  for (const CalibrationView& view : views) {
    if (!chosen.empty()) {
      const Isometry3d motion = chosen.back().map_from_camera.inverse() * view.map_from_camera;
      if (motion.translation().norm() < shift && Eigen::AngleAxisd(motion.linear()).angle() < turn) continue;
    }
    chosen.push_back(view);
    if (chosen.size() == kMaxViews) break;
  }
  return chosen;
}

/// As far apart as leaves enough of them, down to a quarter of the largest distance.
std::vector<CalibrationView> spread(const std::vector<CalibrationView>& views) {
  constexpr double kTurn = 5 * kDegree, kShift = 0.08;
  std::vector<CalibrationView> chosen = spread(views, kShift, kTurn);
  for (int part = 2; chosen.size() < kEnoughViews && part <= 4; part *= 2)
    chosen = spread(views, kShift / part, kTurn / part);
  return chosen;
}

/// How many of the views behind it each is compared with.
size_t neighbours_of(size_t views) {
  return std::max<size_t>(3, kMaxPairs / std::max<size_t>(1, views));
}

/// Neighbouring views, by number.
std::vector<std::pair<size_t, size_t>> neighbours(size_t views) {
  std::vector<std::pair<size_t, size_t>> pairs;
  for (size_t from = 0; from < views; ++from)
    for (size_t to = from + 1; to < std::min(views, from + 1 + neighbours_of(views)); ++to)
      pairs.emplace_back(from, to);
  return pairs;
}

std::vector<View> prepared_views(const Recording& recording, const std::vector<CalibrationView>& views,
                                 const cv::Mat& offsets, int threads) {
  std::vector<View> prepared(views.size());
  parallel_each(views.size(), threads, [&](size_t i) {
    prepared[i].images = frame_images(recording.frame(views[i].number), offsets);
    prepared[i].keyframe = std::make_unique<Keyframe>(i, prepared[i].images, Features{});
  });
  return prepared;
}

/// Equations of all pairs that fit; every other group of views is held out.
struct Experiment {
  Equations fitted, held_out;
  double held_out_squares = 0;
  size_t pairs = 0;

  /// The part by which squared residuals fall where nothing was fitted.
  double improvement() const { return -held_out.change(solved(fitted)) / std::max(held_out_squares, 1e-9); }
  Equations all() const {
    Equations sum = fitted;
    sum.add(held_out);
    return sum;
  }
};

Experiment experiment(const std::vector<View>& prepared, const std::vector<CalibrationView>& views,
                      int threads) {
  const auto pairs = neighbours(views.size());
  std::vector<std::optional<PairEquations>> found(pairs.size());
  parallel_each(pairs.size(), threads, [&](size_t i) {
    const auto& [from, to] = pairs[i];
    found[i] = equations_of(prepared[from], prepared[to],
                            views[from].map_from_camera.inverse() * views[to].map_from_camera);
  });
  Experiment result;
  for (size_t i = 0; i < pairs.size(); ++i) {
    if (!found[i]) continue;
    ++result.pairs;
    const bool holds = (pairs[i].first / kGroup) % 2 == 1;
    (holds ? result.held_out : result.fitted).add(found[i]->equations);
    if (holds) result.held_out_squares += found[i]->squares;
  }
  return result;
}

}  // namespace

DepthCalibration calibrate_depth(const Recording& recording, const std::vector<CalibrationView>& views,
                                 int threads) {
  const std::vector<CalibrationView> chosen = spread(views);
  DepthCalibration result;
  Eigen::VectorXd offsets = Eigen::VectorXd::Zero(kNodes);
  for (int round = 0; round < 2; ++round) {  // The second corrects what the images have already.
    const std::vector<View> prepared = prepared_views(recording, chosen, result.offsets, threads);
    const Experiment found = experiment(prepared, chosen, threads);
    if (found.pairs < kMinPairs) return {};
    if (round == 0) result.improvement = found.improvement();
    offsets += solved(found.all());
    result.rms = offsets.norm() / std::sqrt(static_cast<double>(kNodes));
    if (result.improvement < kMinImprovement || result.rms > kMaxOffset) return {};
    result.offsets = image_of(offsets, prepared.front().images.levels.front().depth_camera);
  }
  return result;
}

}  // namespace loci::mapping::tracking
