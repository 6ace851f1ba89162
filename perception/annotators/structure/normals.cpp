#include "perception/annotators/structure/normals.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "mapping/base/math/math.h"
#include "mapping/base/math/random.h"
#include "perception/annotators/scene_data.h"
#include "perception/conversions/opencv.h"

namespace loci::perception {
namespace {

/// Linear between the middles of the bins, 0 at both ends.
double interpolate(const InclinationBias::Table& table, double inclination_deg) {
  const double position = inclination_deg / InclinationBias::kBinDeg - 0.5;
  const auto bin = static_cast<int>(std::floor(position));
  const auto value = [&](int b) {
    return b < 0 || b >= InclinationBias::kBins ? 0.0 : table[static_cast<size_t>(b)];
  };
  // The outer halves of the first and the last bin go from 0 at the end to the middle's value.
  if (bin < 0) return 2 * (position + 0.5) * value(0);
  if (bin >= InclinationBias::kBins - 1) return 2 * (InclinationBias::kBins - 0.5 - position) * value(bin);
  return value(bin) + (position - bin) * (value(bin + 1) - value(bin));
}

constexpr float kNoDepth = std::numeric_limits<float>::quiet_NaN();
constexpr int kMaxStride = 32;
constexpr int kBlock = 64;  ///< columns that are smoothed together: they stay in the processor's cache

/// Rows of disparity with zeros around them as far as any tap reaches, and columns up to a whole number of
/// blocks.
class DisparityImage {
 public:
  /// Zeros around the pixels of an image; the pixels themselves are undefined. Memory of the same size is
  /// used again.
  void resize(cv::Size size) {
    if (size == size_) return;
    size_ = size;
    blocks_ = (size.width + kBlock - 1) / kBlock;
    pixels_ = cv::Mat(size.height + 2 * kMaxStride, blocks_ * kBlock + 2 * kMaxStride, CV_32F, cv::Scalar(0));
  }

  cv::Size size() const { return size_; }
  int rows() const { return size_.height; }
  int padded_cols() const { return blocks_ * kBlock; }
  int pitch() const { return pixels_.cols; }
  float* row(int v) { return pixels_.ptr<float>(v + kMaxStride) + kMaxStride; }
  const float* row(int v) const { return pixels_.ptr<float>(v + kMaxStride) + kMaxStride; }

 private:
  cv::Size size_;
  int blocks_ = 0;
  cv::Mat pixels_;
};

/// Working memory of a thread, kept from frame to frame: fresh pages would cost a third of the time.
struct Workspace {
  DisparityImage measured, smoothed;
  std::vector<float> block,
      next_block;  ///< columns with zeros above and below, as smooth_columns() leaves them
};

Workspace& workspace() {
  thread_local Workspace memory;
  return memory;
}

float depth_times_disparity(const mapping::PinholeCamera& camera, const NormalOptions& options) {
  return static_cast<float>(options.baseline_m * camera.fx);
}

void set_disparity(DisparityImage& image, const cv::Mat& depth, float scale) {
  image.resize(depth.size());
  for (int v = 0; v < depth.rows; ++v)
    disparity_of_depth(depth.ptr<float>(v), image.row(v), depth.cols, scale);
}

void set_depth(cv::Mat& depth, const DisparityImage& disparity, float scale) {
  depth.create(disparity.size(), CV_32F);
  for (int v = 0; v < depth.rows; ++v)
    depth_of_disparity(disparity.row(v), depth.ptr<float>(v), depth.cols, scale);
}

/// Standard deviation of the noise of an image's disparity, its quantisation included: neighbours in a row
/// lie on one line but for noise. The median does not care about edges. 0 when there is too little to tell.
double noise_of(const cv::Mat& depth, float scale) {
  constexpr int kEveryRow = 12, kEveryColumn = 7;
  constexpr double kSigmaOfMedian = 1.4826, kSigmaOfBend = 2.449;  // √6 for 1, -2, 1
  std::vector<float> bends, row(static_cast<size_t>(depth.cols));
  for (int v = 0; v < depth.rows; v += kEveryRow) {
    disparity_of_depth(depth.ptr<float>(v), row.data(), depth.cols, scale);
    for (size_t u = kEveryColumn; u + 1 < row.size(); u += kEveryColumn)
      if (row[u - 1] > 0 && row[u] > 0 && row[u + 1] > 0)
        bends.push_back(std::abs(row[u - 1] - 2 * row[u] + row[u + 1]));
  }
  if (bends.size() < 100) return 0;
  const auto middle = bends.begin() + static_cast<std::ptrdiff_t>(bends.size() / 2);
  std::nth_element(bends.begin(), middle, bends.end());
  return static_cast<double>(*middle) * kSigmaOfMedian / kSigmaOfBend;
}

/// What each iteration does.
struct Iteration {
  int stride;
  SmoothingStep step;
};

std::vector<Iteration> iterations_for(double noise_px, const NormalOptions& options) {
  constexpr double kSigmas = 3, kSigmaOfBend = 2.449;
  const double width = std::max(options.disparity_quantum_px * options.noise_quanta, kSigmas * noise_px);
  std::vector<Iteration> result;
  for (int i = 0; i < options.iterations; ++i) {
    const int stride = options.widen ? std::min(1 << std::min(i, 20), kMaxStride) : 1;
    const double edge = std::max(options.edge_px, kSigmas * kSigmaOfBend * noise_px);
    result.push_back({stride, {static_cast<float>(edge), static_cast<float>(width)}});
    noise_px /= std::sqrt(3.0);  // The mean of three.
  }
  return result;
}

/// Takes the disparities of an image and smooths them along rows, one row after the other while it is in the
/// processor's cache.
void measure_and_smooth_rows(const cv::Mat& depth, float scale, DisparityImage& measured,
                             DisparityImage& value, const std::vector<Iteration>& iterations) {
  const auto length = static_cast<size_t>(measured.pitch());
  std::vector<float> first(length), second(length);
  float* from = first.data() + kMaxStride;
  float* to = second.data() + kMaxStride;
  for (int v = 0; v < measured.rows(); ++v) {
    float* line = measured.row(v);
    disparity_of_depth(depth.ptr<float>(v), line, depth.cols, scale);
    const float* source = line;
    for (const Iteration& i : iterations) {
      float* target = &i == &iterations.back() ? value.row(v) : to;
      box_step(source - i.stride, source, source + i.stride, line, target, measured.padded_cols(), i.step);
      source = to;
      std::swap(from, to);
    }
  }
}

void smooth_columns(const DisparityImage& measured, DisparityImage& value,
                    const std::vector<Iteration>& iterations) {
  const int rows = measured.rows();
  const auto size = static_cast<size_t>(rows + 2 * kMaxStride) * kBlock;
  Workspace& memory = workspace();
  if (memory.block.size() != size) {
    memory.block.assign(size, 0);
    memory.next_block.assign(size, 0);
  }
  float* from = memory.block.data() + kMaxStride * kBlock;
  float* to = memory.next_block.data() + kMaxStride * kBlock;
  for (int u = 0; u < measured.padded_cols(); u += kBlock) {
    for (int v = 0; v < rows; ++v) std::copy_n(value.row(v) + u, kBlock, from + v * kBlock);
    for (const Iteration& i : iterations) {
      const int stride = i.stride * kBlock;
      const bool last = &i == &iterations.back();
      for (int v = 0; v < rows; ++v) {
        const float* centre = from + v * kBlock;
        box_step(centre - stride, centre, centre + stride, measured.row(v) + u,
                 last ? value.row(v) + u : to + v * kBlock, kBlock, i.step);
      }
      std::swap(from, to);
    }
  }
}

const DisparityImage& smoothed_disparity(const cv::Mat& depth, float scale, const NormalOptions& options) {
  Workspace& memory = workspace();
  if (options.iterations == 0) {
    set_disparity(memory.measured, depth, scale);
    return memory.measured;
  }
  memory.measured.resize(depth.size());
  memory.smoothed.resize(depth.size());
  const std::vector<Iteration> iterations = iterations_for(noise_of(depth, scale), options);
  measure_and_smooth_rows(depth, scale, memory.measured, memory.smoothed, iterations);
  smooth_columns(memory.measured, memory.smoothed, iterations);
  return memory.smoothed;
}

void set_normals(cv::Mat& normals, const DisparityImage& disparity, const mapping::PinholeCamera& camera,
                 const NormalOptions& options, const InclinationBias& bias) {
  const SlopeOptions slope_options = {2 * options.half_reach_px, static_cast<float>(options.edge_px), 0.05f};
  RowRays rays = {static_cast<float>(camera.fx), static_cast<float>(camera.fy), static_cast<float>(camera.cx),
                  0};
  const cv::Size size = disparity.size();
  normals.create(size, CV_32FC3);
  cv::Mat rows(5, size.width, CV_32F);
  float* across = rows.ptr<float>(0);
  float* down = rows.ptr<float>(1);
  float* x = rows.ptr<float>(2);
  float* y = rows.ptr<float>(3);
  float* z = rows.ptr<float>(4);
  for (int v = 0; v < size.height; ++v) {
    const float* row = disparity.row(v);
    slopes(row, 1, across, size.width, slope_options);
    slopes(row, disparity.pitch(), down, size.width, slope_options);
    rays.v = static_cast<float>(v - camera.cy);
    normals_of_slopes(row, across, down, x, y, z, size.width, rays);
    tilt_normals(x, y, z, size.width, bias.tilt());
    interleave(x, y, z, normals.ptr<float>(v), size.width);
  }
}

/// A plane through the middle of a small image as the sensor would measure it.
cv::Mat plane_image(const mapping::PinholeCamera& camera, const NormalOptions& options,
                    const Vector3d& normal, double distance, Random& random) {
  const double bf = options.baseline_m * camera.fx;
  const double quantum = options.disparity_quantum_px;
  const double offset = normal.z() * distance;
  cv::Mat depth(camera.height, camera.width, CV_32F, cv::Scalar(std::numeric_limits<float>::quiet_NaN()));
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u) {
      const double inverse_depth = normal.dot(camera.unproject(u, v, 1)) / offset;
      const double disparity = bf * inverse_depth + random.normal(quantum / 2);
      if (inverse_depth > 0.1)
        depth.at<float>(v, u) = static_cast<float>(bf / (std::round(disparity / quantum) * quantum));
    }
  return depth;
}

/// Mean of the Gaussian around the peak of values: the mean of those within two deviations of it, three
/// times.
double mean_of_peak(const std::vector<double>& values) {
  double mean = 0, deviation = 10;
  for (int round = 0; round < 4 && !values.empty(); ++round) {
    double sum = 0, squares = 0;
    int count = 0;
    for (const double value : values)
      if (std::abs(value - mean) <= 2 * deviation) {
        sum += value;
        squares += value * value;
        ++count;
      }
    if (count == 0) break;
    mean = sum / count;
    deviation = std::sqrt(std::max(0.0, squares / count - mean * mean)) + 1e-3;
  }
  return mean;
}

}  // namespace

InclinationBias::InclinationBias(const Table& correction_deg) : correction_deg_(correction_deg) {
  for (int i = 0; i < kCosineSteps; ++i) {
    const double cosine = static_cast<double>(i) / kCosineSteps;
    const double inclination = std::acos(cosine) / kDegree;
    const double wanted = std::clamp(inclination + interpolate(correction_deg, inclination), 0.1, 89.9);
    // The normal (sin, -cos) gets the direction (sin w, -cos w) when its z is shortened to sin / tan w.
    tilt_[static_cast<size_t>(i)] =
        static_cast<float>(cosine - std::sin(inclination * kDegree) / std::tan(wanted * kDegree));
  }
  tilt_[kCosineSteps] = tilt_[kCosineSteps - 1];
}

NormalOptions NormalOptions::for_objects() {
  NormalOptions options;
  options.iterations = 4;
  options.edge_px = 0.1;
  options.half_reach_px = 2;
  return options;
}

void NormalOptions::declare(OptionTable& table) {
  table.number("disparity_quantum_px", disparity_quantum_px, "px",
               "Quantisation step of the sensor's disparity.", 1e-3, 10);
  table.number("noise_quanta", noise_quanta, "",
               "Maximum deviation of the smoothed from the measured disparity, in quanta; at least three "
               "times the noise of the frame.",
               0, 20);
  table.number("baseline_m", baseline_m, "m", "Baseline between projector and camera.", 1e-3, 1);
  table.integer("iterations", iterations, "", "Iterations of the 3-pixel box filter.", 0, 100);
  table.flag("widen", widen, "Doubles the spacing of the filter taps in each iteration (up to 32 px).");
  table.number("edge_px", edge_px, "px",
               "Disparity step between surfaces: pixels that deviate by more from a straight line, and by "
               "more than the noise, are not mixed.",
               0.01, 100);
  table.integer("half_reach_px", half_reach_px, "px",
                "Half the distance between the neighbours that a normal is computed from.", 1, 16);
  table.flag("correct_inclination", correct_inclination,
             "Corrects the bias of the inclination due to smoothing, as calibrated on simulated planes.");
}

cv::Mat smooth_depth(const cv::Mat& depth, const mapping::PinholeCamera& camera,
                     const NormalOptions& options) {
  const float scale = depth_times_disparity(camera, options);
  cv::Mat result;
  set_depth(result, smoothed_disparity(depth, scale, options), scale);
  return result;
}

cv::Mat normals_from_depth(const cv::Mat& smoothed, const mapping::PinholeCamera& camera,
                           const NormalOptions& options, const InclinationBias& bias) {
  DisparityImage& disparity = workspace().measured;
  set_disparity(disparity, smoothed, depth_times_disparity(camera, options));
  cv::Mat normals;
  set_normals(normals, disparity, camera, options, bias);
  return normals;
}

void smooth_depth_and_normals(const cv::Mat& depth, const mapping::PinholeCamera& camera,
                              const NormalOptions& options, const InclinationBias& bias,
                              DepthNormals& result) {
  const float scale = depth_times_disparity(camera, options);
  const DisparityImage& disparity = smoothed_disparity(depth, scale, options);
  set_depth(result.depth, disparity, scale);
  set_normals(result.normals, disparity, camera, options, bias);
}

cv::Mat points_from_depth(const cv::Mat& depth, const mapping::PinholeCamera& camera) {
  cv::Mat points(depth.rows, depth.cols, CV_32FC3);
  std::vector<float> x_slope(static_cast<size_t>(depth.cols));
  for (int u = 0; u < depth.cols; ++u)
    x_slope[static_cast<size_t>(u)] = static_cast<float>((u - camera.cx) / camera.fx);
  for (int v = 0; v < depth.rows; ++v) {
    const auto y_slope = static_cast<float>((v - camera.cy) / camera.fy);
    const float* in = depth.ptr<float>(v);
    cv::Vec3f* out = points.ptr<cv::Vec3f>(v);
    for (int u = 0; u < depth.cols; ++u) {
      const float z = in[u];
      out[u] = std::isnan(z) ? cv::Vec3f(kNoDepth, kNoDepth, kNoDepth)
                             : cv::Vec3f(x_slope[static_cast<size_t>(u)] * z, y_slope * z, z);
    }
  }
  return points;
}

InclinationBias measure_inclination_bias(const mapping::PinholeCamera& camera, const NormalOptions& options) {
  constexpr int kTurns = 4, kSize = 64, kMin = 200;
  constexpr double kMiddle = 1.2;
  mapping::PinholeCamera small = camera;
  small.width = small.height = kSize;
  small.cx = small.cy = kSize / 2.0;
  Random random(421);
  std::vector<double> missing[InclinationBias::kBins];
  DepthNormals found;
  for (double inclination = 2.5; inclination < 85; inclination += 2.5)
    for (int turn = 0; turn < kTurns; ++turn) {
      const double azimuth = (turn + random.uniform()) * 2 * kPi / kTurns;
      const double sine = std::sin(inclination * kDegree);
      const Vector3d normal(sine * std::cos(azimuth), sine * std::sin(azimuth),
                            -std::cos(inclination * kDegree));
      const cv::Mat depth = plane_image(small, options, normal, kMiddle, random);
      smooth_depth_and_normals(depth, small, options, InclinationBias(), found);
      for (int v = 0; v < kSize; ++v)
        for (int u = 0; u < kSize; ++u) {
          const cv::Vec3f& n = found.normals.at<cv::Vec3f>(v, u);
          if (std::isnan(n[0])) continue;
          const double estimate = std::acos(std::clamp(-static_cast<double>(n[2]), -1.0, 1.0)) / kDegree;
          const auto bin = static_cast<size_t>(
              std::min(estimate / InclinationBias::kBinDeg, InclinationBias::kBins - 1.0));
          missing[bin].push_back(inclination - estimate);
        }
    }
  InclinationBias::Table table = {};
  for (size_t bin = 0; bin < table.size(); ++bin)
    if (missing[bin].size() >= kMin) table[bin] = mean_of_peak(missing[bin]);
  return InclinationBias(table);
}

AnnotatorDescriptor NormalEstimator::descriptor() const {
  return {"NormalEstimator",
          "Smooths the depth image within the measurement uncertainty and computes a normal per point.",
          {"Scene", "view:depth", "CameraInfo"},
          {"view:smoothed_depth", "view:cloud", "view:normals"}};
}

void NormalEstimator::process(cas::Cas& cas, Context& /*context*/) {
  const types::SceneCas scene(cas);
  const mapping::PinholeCamera camera = types::cameras(scene).depth;
  if (!bias_ || camera != bias_camera_) {
    bias_ = options_.correct_inclination ? measure_inclination_bias(camera, options_) : InclinationBias();
    bias_camera_ = camera;
  }
  DepthNormals found;
  smooth_depth_and_normals(types::view_image(scene, types::SceneCas::kDepth), camera, options_, *bias_,
                           found);
  types::set_view_image(scene, types::SceneCas::kSmoothedDepth, found.depth);
  set_cloud_points(scene, points_from_depth(found.depth, camera));
  set_cloud_normals(scene, found.normals);
}

}  // namespace loci::perception
