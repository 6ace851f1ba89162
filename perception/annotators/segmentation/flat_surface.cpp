#include "perception/annotators/segmentation/flat_surface.h"

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>

#include "mapping/base/error.h"
#include "mapping/base/math/math.h"
#include "mapping/image/image_io.h"

namespace loci::perception {
namespace {

using Vector6f = Eigen::Matrix<float, 6, 1>;

/// Where on the plane a pixel looks.
class Terms {
 public:
  /// A row of the image: both coordinates are quotients of what grows evenly along it.
  struct Row {
    float x_start, x_step, y_start, y_step, slope_start, slope_step;

    std::pair<float, float> at(int u) const {
      const auto column = static_cast<float>(u);
      const float inverse = 1 / (slope_start + slope_step * column);
      return {(x_start + x_step * column) * inverse, (y_start + y_step * column) * inverse};
    }
  };

  Terms(const mapping::PinholeCamera& camera, const Vector3d& normal, double offset)
      : camera_(camera),
        normal_(normal),
        x_(offset * normal.unitOrthogonal()),
        y_(offset * normal.cross(normal.unitOrthogonal())) {}

  Row row(int v) const {
    const Vector3d ray = camera_.unproject(0, v, 1);
    const auto part = [&](const Vector3d& axis) {
      return std::pair(static_cast<float>(axis.dot(ray)), static_cast<float>(axis.x() / camera_.fx));
    };
    const auto [x_start, x_step] = part(x_);
    const auto [y_start, y_step] = part(y_);
    const auto [slope_start, slope_step] = part(normal_);
    return {x_start, x_step, y_start, y_step, slope_start, slope_step};
  }
  /// The polynomial's terms at a pixel.
  Vector6f at(int u, int v) const {
    const auto [x, y] = row(v).at(u);
    Vector6f terms;
    terms << 1, x, y, x * x, x * y, y * y;
    return terms;
  }

 private:
  const mapping::PinholeCamera& camera_;
  Vector3d normal_;
  Vector3d x_, y_;  ///< axes of the plane, times its offset
};

struct HeightSample {
  Vector6f terms;
  float height;
};

Vector6f fitted(const std::vector<HeightSample>& samples) {
  constexpr int kRounds = 4;
  constexpr double kStiffness = 0.02;  // m⁴: a metre of surface bends freely, a foot hardly.
  Vector6f bend = Vector6f::Zero();
  float reach = 0.01f;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix<double, 6, 6> a = Eigen::Matrix<double, 6, 6>::Identity() * 1e-6;
    Eigen::Matrix<double, 6, 1> b = Eigen::Matrix<double, 6, 1>::Zero();
    for (const HeightSample& sample : samples) {
      if (std::abs(sample.height - bend.dot(sample.terms)) > reach) continue;
      const Eigen::Matrix<double, 6, 1> terms = sample.terms.cast<double>();
      a.noalias() += terms * terms.transpose();
      b += static_cast<double>(sample.height) * terms;
    }
    const double weight = a(0, 0);
    for (int i = 3; i < 6; ++i) a(i, i) += kStiffness * weight;
    bend = a.ldlt().solve(b).cast<float>();
    reach = std::max(0.003f, reach * 0.6f);
  }
  return bend;
}

/// A short piece of an object's border.
struct BorderPiece {
  int border = 0;  ///< pixels of the border
  std::optional<float>
      step;  ///< how much higher the object is than what is beside it, metres; nothing = not seen
};

/// `beyond`, `within` (CV_32F): distances of what is outside to the object, and of its pixels to its border.
BorderPiece border_piece(const cv::Mat& heights, const cv::Mat& ground, const cv::Mat& beyond,
                         const cv::Mat& within) {
  constexpr float kGap = 3;  // Pixels at an edge show a bit of both.
  constexpr float kNear = 10;
  constexpr int kMin = 8;  // Fewer pixels have no mean to speak of.
  BorderPiece piece;
  float inner = 0;
  float outer = 0;
  int inner_count = 0;
  int outer_count = 0;
  for (int v = 0; v < heights.rows; ++v)
    for (int u = 0; u < heights.cols; ++u) {
      const float inwards = within.at<float>(v, u);
      const float outwards = beyond.at<float>(v, u);
      piece.border += inwards > 0 && inwards < 1.2f ? 1 : 0;
      const float height = heights.at<float>(v, u);
      if (std::isnan(height)) continue;
      if (inwards > 1.2f && inwards <= kNear) {
        inner += height;
        ++inner_count;
      } else if (outwards > kGap && outwards <= kNear && ground.at<unsigned char>(v, u)) {
        outer += height;
        ++outer_count;
      }
    }
  if (inner_count >= kMin && outer_count >= kMin)
    piece.step = inner / static_cast<float>(inner_count) - outer / static_cast<float>(outer_count);
  return piece;
}

constexpr double kTopViewCell = 0.005;  ///< of the top view, metres
constexpr int kMaxCells = 2000;

/// Where each pixel of the image falls in the top view of a plane.
struct TopView {
  cv::Mat cell;  ///< CV_32SC2 per pixel, (-1, -1) = outside
  cv::Size size;
};

TopView top_view(const cv::Mat& heights, const mapping::PinholeCamera& camera, const Vector3d& normal,
                 double offset) {
  const Vector3d x = normal.unitOrthogonal();
  const Vector3d y = normal.cross(x);
  cv::Mat positions(heights.size(), CV_64FC2);
  Eigen::AlignedBox2d extent;
  for (int v = 0; v < heights.rows; ++v)
    for (int u = 0; u < heights.cols; ++u) {
      if (std::isnan(heights.at<float>(v, u))) continue;
      const Vector3d ray = camera.unproject(u, v, 1);
      const Vector3d p = offset / normal.dot(ray) * ray;
      const Vector2d at(x.dot(p), y.dot(p));
      positions.at<cv::Vec2d>(v, u) = {at.x(), at.y()};
      extent.extend(at);
    }
  TopView view{cv::Mat(heights.size(), CV_32SC2, cv::Scalar(-1, -1)), {}};
  if (extent.isEmpty()) return view;
  const auto cells = [&](int axis) {
    return std::min(kMaxCells, static_cast<int>(extent.sizes()[axis] / kTopViewCell) + 1);
  };
  view.size = {cells(0), cells(1)};
  for (int v = 0; v < heights.rows; ++v)
    for (int u = 0; u < heights.cols; ++u) {
      if (std::isnan(heights.at<float>(v, u))) continue;
      const cv::Vec2d& at = positions.at<cv::Vec2d>(v, u);
      const cv::Vec2i cell(static_cast<int>((at[0] - extent.min().x()) / kTopViewCell),
                           static_cast<int>((at[1] - extent.min().y()) / kTopViewCell));
      if (cell[0] < view.size.width && cell[1] < view.size.height) view.cell.at<cv::Vec2i>(v, u) = cell;
    }
  return view;
}

/// Weighted mean of the surroundings; NaN where there is nothing near.
cv::Mat blurred(const cv::Mat& values, const cv::Mat& weights, double sigma_cells) {
  cv::Mat sum;
  cv::Mat weight;
  cv::GaussianBlur(values.mul(weights), sum, {}, sigma_cells, sigma_cells, cv::BORDER_CONSTANT);
  cv::GaussianBlur(weights, weight, {}, sigma_cells, sigma_cells, cv::BORDER_CONSTANT);
  cv::Mat result = sum / weight;
  result.setTo(std::numeric_limits<float>::quiet_NaN(), weight < 1e-4);
  return result;
}

/// cv::erode with MORPH_ELLIPSE of `width` (odd), border without effect, in time that grows with the width
/// and not with its square: each row of the disc is a run, and the minima over longer runs come from shorter
/// ones.
cv::Mat eroded_by_disc(const cv::Mat& image, int width) {
  constexpr float kBeyond = std::numeric_limits<float>::max();
  const int reach = width / 2;
  const cv::Mat disc = cv::getStructuringElement(cv::MORPH_ELLIPSE, {width, width});
  std::vector<std::vector<int>> rows_of_half(size_t(reach) + 1);  // by half the length of the run
  for (int row = 0; row < width; ++row)
    rows_of_half[static_cast<size_t>(cv::countNonZero(disc.row(row)) / 2)].push_back(row - reach);
  cv::Mat padded;
  cv::copyMakeBorder(image, padded, reach, reach, reach, reach, cv::BORDER_CONSTANT, cv::Scalar(kBeyond));
  cv::Mat run = padded.colRange(reach, reach + image.cols).clone();
  cv::Mat least(image.size(), CV_32F, cv::Scalar(kBeyond));
  for (int half = 0; half <= reach; ++half) {
    if (half > 0) {
      cv::min(run, padded.colRange(reach - half, reach - half + image.cols), run);
      cv::min(run, padded.colRange(reach + half, reach + half + image.cols), run);
    }
    for (const int row : rows_of_half[static_cast<size_t>(half)])
      cv::min(least, run.rowRange(reach + row, reach + row + image.rows), least);
  }
  return least;
}

/// The lower envelope of a top view: what narrow objects leave of it, level with the surface on the whole.
cv::Mat envelope(const cv::Mat& cells, const cv::Mat& known, double window_m) {
  const int width = static_cast<int>(window_m / kTopViewCell) | 1;
  cv::Mat filled;
  cv::medianBlur(cells, filled, 3);
  filled.setTo(1, ~known);  // Gaps are no low ground,
  cv::Mat opened = eroded_by_disc(filled, width);
  opened.setTo(-1, opened > 0.5);  // nor high ground.
  opened = -eroded_by_disc(-opened, width);
  std::vector<float> above;
  for (int v = 0; v < cells.rows; v += 2)
    for (int u = 0; u < cells.cols; u += 2)
      if (known.at<unsigned char>(v, u)) above.push_back(cells.at<float>(v, u) - opened.at<float>(v, u));
  if (above.empty()) return opened;
  // A minimum lies below the mean by the noise; most of what is seen is surface.
  return opened + static_cast<double>(quantile(above, 0.4));
}

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

/// Box filter over what there is.
cv::Mat smoothed(const cv::Mat& heights, int width) {
  if (width <= 1) return heights;
  const cv::Mat known = heights == heights;
  cv::Mat values = heights.clone();
  values.setTo(0, ~known);
  cv::Mat weight;
  known.convertTo(weight, CV_32F, 1.0 / 255);
  cv::boxFilter(values, values, CV_32F, {width, width}, {-1, -1}, false, cv::BORDER_CONSTANT);
  cv::boxFilter(weight, weight, CV_32F, {width, width}, {-1, -1}, false, cv::BORDER_CONSTANT);
  cv::Mat result = values / weight;
  result.setTo(kNone, ~known);
  return result;
}

int filter_width(double noise, const FlatOptions& options) {
  const int width = static_cast<int>(std::ceil(noise / options.noise_m));
  return std::clamp(width | 1, 1, 11);
}

/// Heights of single pixels over the plane, or over the empty surface where that is known.
cv::Mat raw_heights(const cv::Mat& depth, const mapping::PinholeCamera& camera, const FlatSurface& surface,
                    const FlatOptions& options) {
  const bool calibrated = !surface.empty_depth.empty();
  cv::Mat heights(depth.size(), CV_32F);
  const double per_column = surface.normal.x() / camera.fx;
  const double most = 2 * options.max_height_m;
  for (int v = 0; v < depth.rows; ++v) {
    const double start = surface.normal.dot(camera.unproject(0, v, 1));
    const auto* z = depth.ptr<float>(v);
    const auto* inside = surface.inside.ptr<unsigned char>(v);
    const auto* empty = calibrated ? surface.empty_depth.ptr<float>(v) : nullptr;
    auto* height_of = heights.ptr<float>(v);
    for (int u = 0; u < depth.cols; ++u) {
      const double slope = start + per_column * u;
      const double ground = calibrated ? slope * static_cast<double>(empty[u]) : surface.offset;
      const double height = slope * static_cast<double>(z[u]) - ground;
      // What is much too high or too low would only spoil its neighbours.
      const bool near = z[u] > 0 && inside[u] != 0 && std::abs(height) < most;
      height_of[u] = near ? static_cast<float>(height) : kNone;
    }
  }
  return heights;
}

/// Whether most of it lies where the surface is expected.
bool level(const cv::Mat& heights, double tolerance) {
  size_t within = 0;
  size_t all = 0;
  for (int v = 0; v < heights.rows; v += 2)
    for (int u = 0; u < heights.cols; u += 2) {
      const float height = heights.at<float>(v, u);
      if (std::isnan(height)) continue;
      ++all;
      within += std::abs(height) < static_cast<float>(tolerance) ? 1 : 0;
    }
  return 2 * within > all;
}

constexpr double kUnitsPerMetre = 10000;  ///< of the calibration image

/// Heights over the uneven surface that lies about the plane, as far as one image shows it: in a top view
/// the heights are opened morphologically with a disc of diameter `window_m`, which removes what is narrower.
/// What is then lower than `object_m` is the surface and is averaged over its surroundings.
cv::Mat over_uneven_surface(const cv::Mat& heights, const mapping::PinholeCamera& camera,
                            const Vector3d& normal, double offset, double window_m, double object_m) {
  const TopView view = top_view(heights, camera, normal, offset);
  if (view.size.empty()) return heights;
  cv::Mat sum = cv::Mat::zeros(view.size, CV_32F);
  cv::Mat count = cv::Mat::zeros(view.size, CV_32F);
  for (int v = 0; v < heights.rows; ++v)
    for (int u = 0; u < heights.cols; ++u) {
      const cv::Vec2i& cell = view.cell.at<cv::Vec2i>(v, u);
      if (cell[0] < 0) continue;
      sum.at<float>(cell[1], cell[0]) += heights.at<float>(v, u);
      count.at<float>(cell[1], cell[0]) += 1;
    }
  cv::Mat known = count > 0;
  cv::Mat cells = sum / cv::max(count, 1.0f);
  // Rows that are far apart leave gaps between cells.
  const cv::Mat near = blurred(cells, cv::min(count, 1.0f), 1.0);
  near.copyTo(cells, ~known & (near == near));
  known |= near == near;
  cells.setTo(0, ~known);
  const cv::Mat first = envelope(cells, known, window_m);
  cv::Mat surface_weight;
  const cv::Mat level = cv::abs(cells - first) < object_m;
  cv::Mat(known & level).convertTo(surface_weight, CV_32F, 1.0 / 255);
  const cv::Mat ground = blurred(cells, surface_weight, 0.15 * window_m / kTopViewCell);
  cv::Mat result(heights.size(), CV_32F, cv::Scalar(std::numeric_limits<double>::quiet_NaN()));
  for (int v = 0; v < heights.rows; ++v)
    for (int u = 0; u < heights.cols; ++u) {
      const cv::Vec2i& cell = view.cell.at<cv::Vec2i>(v, u);
      if (cell[0] < 0) continue;
      const float own = ground.at<float>(cell[1], cell[0]);
      result.at<float>(v, u) =
          heights.at<float>(v, u) - (std::isnan(own) ? first.at<float>(cell[1], cell[0]) : own);
    }
  return result;
}

}  // namespace

void FlatOptions::declare(OptionTable& table) {
  table.number("table_m", table_m, "m", "Maximum height of pixels that certainly show the surface.", 0, 0.05);
  table.number("object_m", object_m, "m", "Minimum height of pixels that certainly show an object.", 0.001,
               0.05);
  table.number("thin_m", thin_m, "m", "Minimum height of thin objects; 0 = only objects above object_m.", 0,
               0.05);
  table.number("step_m", step_m, "m", "Minimum step in height along the border of a thin object.", 0.0005,
               0.05);
  table.number("max_height_m", max_height_m, "m", "Maximum height of a flat object.", 0.005, 0.2);
  table.number("noise_m", noise_m, "m", "Heights are smoothed until their noise is below this value.", 0.0001,
               0.01);
  table.number("background_m", background_m, "m",
               "Without calibration, width of the window in which the surface is estimated; 0 = heights over "
               "the plane.",
               0, 1);
  table.number("reach_m", reach_m, "m",
               "Maximum distance by which colour extends an object beyond its certain pixels.", 0, 0.2);
  table.number("min_area_m2", min_area_m2, "m2", "Minimum area of an object.", 0, 0.1);
  table.number("max_extent_m", max_extent_m, "m", "Maximum extent of an object.", 0.01, 5);
  table.number(
      "min_contrast", min_contrast, "",
      "Minimum difference in colour from the surface around it, in standard deviations of a pixel, of "
      "what does not rise along its whole border.",
      0, 100);
  table.integer("bins", bins, "", "Number of histogram bins for hue and for saturation.", 2, 180);
}

void SurfaceCalibration::add(const cv::Mat& depth) {
  if (frames_++ == 0) {
    sum_ = cv::Mat::zeros(depth.size(), CV_64F);
    count_ = cv::Mat::zeros(depth.size(), CV_32S);
  }
  if (depth.size() != sum_.size()) throw Error("images of different sizes cannot be averaged");
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u) {
      const float z = depth.at<float>(v, u);
      if (!(z > 0)) continue;
      sum_.at<double>(v, u) += 1 / static_cast<double>(z);
      ++count_.at<int>(v, u);
    }
}

cv::Mat SurfaceCalibration::mean() const {
  cv::Mat mean(sum_.size(), CV_32F, cv::Scalar(static_cast<double>(kNone)));
  for (int v = 0; v < mean.rows; ++v)
    for (int u = 0; u < mean.cols; ++u)
      if (const int count = count_.at<int>(v, u); 2 * count >= frames_ && count > 0)
        mean.at<float>(v, u) = static_cast<float>(count / sum_.at<double>(v, u));
  return mean;
}

SurfaceHeights measure_heights(const cv::Mat& depth, const mapping::PinholeCamera& camera,
                               const FlatSurface& surface, const FlatOptions& options) {
  SurfaceHeights heights;
  heights.raw = raw_heights(depth, camera, surface, options);
  const cv::Mat smooth = smoothed(heights.raw, filter_width(pixel_noise(heights.raw), options));
  heights.bent = heights.uneven = smooth;
  if (!surface.empty_depth.empty() || options.background_m == 0) return heights;
  heights.bent = heights.uneven = over_bent_surface(smooth, camera, surface.normal, surface.offset);
  // The envelope costs time and takes wide objects for surface.
  if (!level(heights.bent, 0.5 * options.table_m))
    heights.uneven = over_uneven_surface(smooth, camera, surface.normal, surface.offset, options.background_m,
                                         (options.table_m + options.object_m) / 2);
  return heights;
}

double pixel_noise(const cv::Mat& heights) {
  constexpr float kStep = 0.02f;  // What differs by more is an edge.
  double sum = 0;
  int count = 0;
  for (int v = 0; v < heights.rows; v += 2) {
    const auto* height = heights.ptr<float>(v);
    for (int u = 1; u < heights.cols; u += 2) {
      const float d = height[u] - height[u - 1];
      if (!(std::abs(d) < kStep)) continue;
      sum += static_cast<double>(d * d);
      ++count;
    }
  }
  return count == 0 ? 0 : std::sqrt(sum / count / 2);
}

cv::Mat over_bent_surface(const cv::Mat& heights, const mapping::PinholeCamera& camera,
                          const Vector3d& normal, double offset) {
  constexpr int kStep = 4;
  const Terms terms(camera, normal, offset);
  std::vector<HeightSample> samples;
  for (int v = 0; v < heights.rows; v += kStep)
    for (int u = 0; u < heights.cols; u += kStep)
      if (const float height = heights.at<float>(v, u); !std::isnan(height))
        samples.push_back({terms.at(u, v), height});
  const Vector6f bend = fitted(samples);
  cv::Mat result(heights.size(), CV_32F);
  for (int v = 0; v < heights.rows; ++v) {
    const auto* height = heights.ptr<float>(v);
    auto* over = result.ptr<float>(v);
    const Terms::Row row = terms.row(v);
    for (int u = 0; u < heights.cols; ++u) {
      const auto [x, y] = row.at(u);
      over[u] =
          height[u] - (bend[0] + (bend[1] + bend[3] * x + bend[4] * y) * x + (bend[2] + bend[5] * y) * y);
    }
  }
  return result;
}

bool rises_all_around(const cv::Mat& heights, const std::vector<int>& pixels, const cv::Mat& ground,
                      double step_m) {
  constexpr int kNear = 10;
  constexpr int kCell = 16;        // Pieces of the border, pixels.
  constexpr size_t kCells = 6;     // Fewer may be noise that lies together.
  constexpr double kBorder = 0.6;  // The rest may lie at something else.
  cv::Mat own = cv::Mat::zeros(heights.size(), CV_8U);
  std::vector<cv::Point> places;
  for (const int pixel : pixels) {
    own.ptr<unsigned char>()[pixel] = 255;
    places.emplace_back(pixel % heights.cols, pixel / heights.cols);
  }
  if (places.empty()) return false;
  const cv::Rect box = cv::boundingRect(places);
  const cv::Rect around =
      cv::Rect(box.x - kNear, box.y - kNear, box.width + 2 * kNear, box.height + 2 * kNear) &
      cv::Rect({0, 0}, heights.size());
  cv::Mat beyond;
  cv::Mat within;
  cv::distanceTransform(~own(around), beyond, cv::DIST_L2, 3);
  cv::distanceTransform(own(around), within, cv::DIST_L2, 3);
  std::vector<float> steps;
  int border = 0;
  int compared = 0;
  for (int top = 0; top < around.height; top += kCell)
    for (int left = 0; left < around.width; left += kCell) {
      const cv::Rect cell = cv::Rect(left, top, kCell, kCell) & cv::Rect({0, 0}, around.size());
      const BorderPiece piece =
          border_piece(heights(around)(cell), ground(around)(cell), beyond(cell), within(cell));
      border += piece.border;
      if (!piece.step) continue;
      compared += piece.border;
      steps.push_back(*piece.step);
    }
  if (steps.size() < kCells || compared < kBorder * border) return false;
  const auto step = static_cast<float>(step_m);
  return median(steps) >= step && quantile(steps, 0.2) >= step / 3;
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
