#pragma once

#include <array>
#include <opencv2/core.hpp>

#include "mapping/orthophoto/orthophoto.h"

namespace loci::mapping {

/// Evidence for a straight line in an orthophoto.
struct PhotoLine {
  enum class Kind { none, seam, step };
  Kind kind = Kind::none;
  int position = 0;     ///< column of an upright line, row of a level one
  double z = 0;         ///< sum of the standard scores of its chunks over the root of their number
  double share = 0;     ///< of its chunks that show it
  double strength = 0;  ///< sum of the scores without limit: compares neighbouring positions
};

/// Upright and level lines of an orthophoto: thin lines (seams) and steps of colour. Along every
/// column and row, chunks of 4 cm are compared with their flanks; the scores are relative to the variation of
/// the face itself, so that grain and reflections count little.
class PhotoLines {
 public:
  /// `hidden`: pixels that are not used (CV_8U, not 0), such as handles; may be empty.
  explicit PhotoLines(const Orthophoto& photo, const cv::Mat& hidden = {});

  /// Evidence for a line at a column (`upright`) between two rows, or at a row between two columns, in the
  /// channel where it is strongest; kind none where too little is known.
  PhotoLine line(bool upright, int position, int from, int to) const;
  /// The strongest line with a position in [first, last] that shows along its whole length; kind none
  /// without.
  PhotoLine strongest(bool upright, int first, int last, int from, int to) const;

 private:
  static constexpr size_t kChannels = 4;  ///< thin line; steps of blue, green, red
  static constexpr size_t kSeam = 0;
  struct Direction {
    std::array<cv::Mat, kChannels> scores;  ///< CV_32F; NaN = unknown. Level lines: of the transposed images
  };
  static Direction direction_of(const cv::Mat& color, const cv::Mat& known, const cv::Mat& face);
  PhotoLine line_in(size_t channel, bool upright, int position, int from, int to) const;

  Direction upright_, level_;
};

}  // namespace loci::mapping
