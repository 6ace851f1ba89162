#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

namespace loci::apps::normals_evaluation {

/// Angles between normals, counted in steps of a tenth of a degree.
class ErrorHistogram {
 public:
  static constexpr int kBins = 900;
  static constexpr double kBinDeg = 0.1;

  void add(double degrees);
  size_t count() const { return count_; }
  /// Share of what was counted that is below an angle (a multiple of 0.1°); 0 when nothing was.
  double within(double degrees) const;
  double median() const;
  const std::array<size_t, kBins>& bins() const { return bins_; }

 private:
  std::array<size_t, kBins> bins_ = {};
  size_t count_ = 0;
};

/// How much steeper normals are than the surface, by the surface's inclination in steps of 5° (Fig. 4.4):
/// each row is a histogram of deviations from -10° to 10° in steps of 0.25°.
class InclinationHistogram {
 public:
  static constexpr int kRows = 18, kColumns = 80;
  static constexpr double kRowDeg = 5, kColumnDeg = 0.25, kReachDeg = 10;

  void add(double inclination_deg, double deviation_deg);
  /// Counts of a row as shares of its largest one.
  std::array<double, kColumns> row(int index) const;
  /// Median deviation of a row; 0 when it is empty.
  double median(int index) const;

 private:
  std::array<std::array<size_t, kColumns>, kRows> counts_ = {};
};

/// What one method did to a set of images.
struct MethodErrors {
  ErrorHistogram to_truth;
  ErrorHistogram to_reference;  ///< against pcl::NormalEstimation, where that was run
  InclinationHistogram by_inclination;
  size_t pixels = 0;   ///< with depth and a known truth
  size_t normals = 0;  ///< of these, with a normal
  std::vector<double> seconds;

  /// Counts an image. `reference` may be empty. Signs do not count: a method may leave them open.
  void add(const cv::Mat& normals, const cv::Mat& truth, const cv::Mat& reference);
  double density() const;
  double median_ms() const;
  /// Time that this share of the images stays below, milliseconds.
  double quantile_ms(double share) const;
};

}  // namespace loci::apps::normals_evaluation
