#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/math/random.h"
#include "mapping/base/text/json_fwd.h"
#include "perception/classification/classifier.h"
#include "perception/classification/shape_features.h"

namespace loci::perception {

/// What is seen of an object. Either part may be empty.
struct ObjectView {
  SurfacePoints surface;
  cv::Mat image;                   ///< CV_8UC3 (BGR) or CV_8UC1
  cv::Mat mask;                    ///< CV_8U, 255 = the object; empty: all of the image
  std::optional<Ground> ground{};  ///< what it stands on, in the frame of the points; unset = not known
};

/// Descriptors of key points, each of `length` values.
struct LocalFeatures {
  size_t length = 0;
  std::vector<float> values;            ///< one descriptor after the other
  std::vector<Eigen::Vector3f> places;  ///< x, y, diameter in pixels of the image, or x, y, z in metres

  size_t count() const { return places.size(); }
};

/// "SIFT" (as RootSIFT) and "ORB" (its bits) of key points of the image, "SHOT" and "FPFH" of
/// intrinsic-shape key points of the surface (Zhong 2009), or of points spread over it where there are fewer
/// than 20 of these.
std::vector<std::string> local_feature_names();
/// Those of a view; none when it shows too little. Error for other names. The same for the same view.
LocalFeatures local_features(const std::string& name, const ObjectView& view);

/// "HOG": histograms of oriented gradients (Dalal and Triggs, CVPR 2005) of the image of an object without
/// its surroundings, scaled to 64 × 64 pixels. Empty when there is no image.
FeatureVector hog_of(const cv::Mat& image, const cv::Mat& mask);
/// Length of what hog_of() gives.
inline constexpr size_t kHogLength = 324;

/// Words that descriptors are told by: the centres of k-means over descriptors of examples.
class Vocabulary {
 public:
  /// At most so many words. Error when there is no descriptor. The same for the same random numbers.
  static Vocabulary learn(const std::vector<const LocalFeatures*>& examples, size_t words,
                          const Random& random);
  /// How often each word occurs, of all descriptors; empty when there is none. Square roots of the shares:
  /// what repeats itself counts less (Jégou et al. 2009).
  FeatureVector bag_of(const LocalFeatures& features) const;
  size_t words() const { return length_ == 0 ? 0 : centres_.size() / length_; }

  Json to_json() const;
  static Vocabulary from_json(const Json& json);

 private:
  size_t nearest(const float* descriptor) const;

  size_t length_ = 0;
  std::vector<float> centres_;
};

}  // namespace loci::perception
