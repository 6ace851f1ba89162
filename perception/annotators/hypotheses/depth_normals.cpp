#include "perception/annotators/hypotheses/depth_normals.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace loci::perception {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
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

}  // namespace

NormalOptions NormalOptions::for_objects() {
  NormalOptions options;
  options.iterations = 4;
  options.edge_px = 0.1;
  options.half_reach_px = 2;
  return options;
}

void NormalOptions::declare(OptionTable& table) {
  table.number("disparity_quantum_px", disparity_quantum_px, "px", "Step of the sensor's disparity.", 1e-3,
               10);
  table.number("noise_quanta", noise_quanta, "",
               "How many quanta the smoothed disparity may leave the measured one; three times the "
               "frame's noise where that is more.",
               0, 20);
  table.number("baseline_m", baseline_m, "m", "Distance between projector and camera.", 1e-3, 1);
  table.integer("iterations", iterations, "", "How often the 3-pixel box filter is applied.", 0, 100);
  table.flag("widen", widen, "The box filter's pixels are twice as far apart in each iteration (up to 32).");
  table.number(
      "edge_px", edge_px, "px",
      "Pixels further from a line of disparity than this, and than the noise that is left, are another "
      "surface.",
      0.01, 100);
  table.integer("half_reach_px", half_reach_px, "px", "Half the distance of the neighbours of a normal.", 1,
                16);
  table.flag("correct_inclination", correct_inclination,
             "Corrects what smoothing does to inclinations, as measured on simulated planes.");
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
      out[u] = std::isnan(z) ? cv::Vec3f(kNan, kNan, kNan)
                             : cv::Vec3f(x_slope[static_cast<size_t>(u)] * z, y_slope * z, z);
    }
  }
  return points;
}

}  // namespace loci::perception
