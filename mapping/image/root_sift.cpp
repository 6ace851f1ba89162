#include "mapping/image/root_sift.h"

#include <algorithm>
#include <cmath>

namespace loci::mapping {

cv::Mat root_sift(const cv::Mat& descriptors) {
  cv::Mat rooted(descriptors.size(), CV_32F);
  for (int row = 0; row < descriptors.rows; ++row) {
    const double sum = std::max(1.0, cv::norm(descriptors.row(row), cv::NORM_L1));  // A row of zeros stays.
    for (int i = 0; i < descriptors.cols; ++i)
      rooted.at<float>(row, i) =
          static_cast<float>(std::sqrt(static_cast<double>(descriptors.at<float>(row, i)) / sum));
  }
  return rooted;
}

}  // namespace loci::mapping
