#pragma once

#include <opencv2/core.hpp>

#include "mapping/base/text/json_fwd.h"

namespace loci::apps::segmentation_evaluation {

/// What of an image is which object.
struct LabelledImage {
  cv::Mat object;  ///< CV_16U, 0 = no object (the table), n = object n
  cv::Mat judged;  ///< CV_8U, 0 = nobody knows what the pixel shows
};

/// Segments beside labelled objects, over any number of images. Only judged pixels count. With objects G
/// and segments S as sets of pixels:
///
/// - weighted overlap (Silberman et al. 2012, Stein et al. 2014): the mean over the objects, weighted by
///   |G|, of the largest |G ∩ S| / |G ∪ S|;
/// - over-segmentation 1 − N_true / N_all and under-segmentation N_false / N_all (Ückermann et al. 2012,
///   Richtsfeld et al. 2012): each object is given the segment that covers most of it; N_true counts the
///   object's pixels in it, N_false the other pixels of that segment, N_all the objects' pixels;
/// - object F1: a segment finds an object when |G ∩ S| / |G ∪ S| ≥ 0.75; the harmonic mean of the shares of
///   objects found and of segments that find one.
class Scores {
 public:
  /// `segments`: CV_16U, 0 = none. Sizes are those of the truth.
  void add(const LabelledImage& truth, const cv::Mat& segments);

  int objects() const { return objects_; }
  int segments() const { return segments_; }
  int found() const { return found_; }
  double weighted_overlap() const;
  /// Not weighted: every object counts the same.
  double mean_overlap() const;
  double over_segmentation() const;
  double under_segmentation() const;
  double precision() const;
  double recall() const;
  double f1() const;
  /// Segments that find no object, by what most of their pixels are.
  struct Wrong {
    int table = 0;    ///< of no object
    int joined = 0;   ///< more than one object
    int inexact = 0;  ///< an object that no segment overlaps more
    int pieces = 0;   ///< a part of an object that another segment overlaps more
  };
  const Wrong& wrong_segments() const { return wrong_segments_; }
  Json to_json() const;

 private:
  int objects_ = 0;
  int segments_ = 0;
  int found_ = 0;
  double pixels_ = 0;
  double overlap_ = 0;
  double ious_ = 0;
  double right_ = 0;
  double wrong_ = 0;
  Wrong wrong_segments_;
};

}  // namespace loci::apps::segmentation_evaluation
