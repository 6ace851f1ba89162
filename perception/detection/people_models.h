#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace loci::perception {

/// A window of the size that the model of bodies has, in an image.
struct BodyWindow {
  cv::Rect window;
  double score = 0;  ///< distance from the separating plane
};

/// OpenCV's models of people, behind an interface: their library loads thirty others, and only programs that
/// look for people load it.
class PeopleModels {
 public:
  virtual ~PeopleModels() = default;
  /// Faces of these sizes in a grey image.
  virtual std::vector<cv::Rect> faces(const cv::Mat& grey, int min_neighbours, int min_size,
                                      int max_size) = 0;
  /// Bodies in windows of 64 x 128 pixels every 8 pixels, at the scale of the image only.
  virtual std::vector<BodyWindow> bodies_at_scale(const cv::Mat& grey, double min_score) = 0;
  /// Bodies of all sizes, overlapping windows joined.
  virtual std::vector<BodyWindow> bodies(const cv::Mat& grey) = 0;
};

}  // namespace loci::perception
