#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "mapping/base/options.h"

namespace loci::perception {

struct TemplateOptions {
  double min_similarity = 0.88;
  double overlap = 0.3;

  void declare(OptionTable& table);
};

/// Something that an image shows as it was shown before.
struct TemplateMatch {
  std::string name;
  double similarity = 0;  ///< share of the template's features that are there, 0 to 1
  cv::Rect region;        ///< of the image
};

/// Looks for objects in whole images, without clusters, by templates of quantised gradients of colour and
/// normals of depth (in the manner of LINEMOD, Hinterstoisser et al. 2012). A template matches its own size
/// and turn only, so each view is kept in several (add()).
class TemplateDetector {
 public:
  TemplateDetector();
  ~TemplateDetector();
  TemplateDetector(TemplateDetector&&) noexcept;
  TemplateDetector& operator=(TemplateDetector&&) noexcept;

  /// A view of an object: colour (CV_8UC3), depth (CV_32F, m, NaN = none) of the same size and its mask
  /// (CV_8U). Kept as it is, nearer and farther, and turned to either side. Views that show too little are
  /// passed over; how many templates were kept is returned.
  int add(const std::string& name, const cv::Mat& color, const cv::Mat& depth, const cv::Mat& mask);
  size_t templates() const;

  /// What is in an image, surest first; of matches that overlap the surest. Error when colour and depth
  /// differ in size.
  std::vector<TemplateMatch> detect(const cv::Mat& color, const cv::Mat& depth,
                                    const TemplateOptions& options) const;

  void save(const std::filesystem::path& path) const;
  /// Error when it is no file of templates.
  static TemplateDetector load(const std::filesystem::path& path);

 private:
  struct View;
  bool add_view(const std::string& name, const cv::Mat& color, const cv::Mat& depth, const cv::Mat& mask);

  std::vector<View> views_;
};

}  // namespace loci::perception
