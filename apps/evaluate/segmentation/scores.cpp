#include "apps/evaluate/segmentation/scores.h"

#include <algorithm>
#include <map>
#include <set>

#include "mapping/base/text/json.h"

namespace loci::apps::segmentation_evaluation {

namespace {

constexpr double kFound = 0.75;

using Sizes = std::map<int, double>;

/// Adds what a segment that finds no object is; `shared`: its pixels by object, `best`: whether no other
/// segment overlaps one of these objects more.
void add_wrong(double size, const Sizes& shared, bool best, Scores::Wrong& wrong) {
  constexpr double kMajority = 0.5, kOne = 0.8;
  double of_objects = 0, most = 0;
  for (const auto& [object, both] : shared) of_objects += both, most = std::max(most, both);
  ++(of_objects < kMajority * size ? wrong.table
     : most < kOne * of_objects    ? wrong.joined
     : best                        ? wrong.inexact
                                   : wrong.pieces);
}

}  // namespace

void Scores::add(const LabelledImage& truth, const cv::Mat& segments) {
  Sizes of_object, of_segment;
  std::set<int> finding, overlapping;  ///< segments: an object, or one best that none finds
  std::map<int, Sizes> shared;
  for (int v = 0; v < truth.object.rows; ++v)
    for (int u = 0; u < truth.object.cols; ++u) {
      if (!truth.judged.at<unsigned char>(v, u)) continue;
      const int object = truth.object.at<uint16_t>(v, u);
      const int segment = segments.at<uint16_t>(v, u);
      if (object > 0) of_object[object] += 1;
      if (segment > 0) of_segment[segment] += 1;
      if (object > 0 && segment > 0) shared[object][segment] += 1;
    }
  objects_ += static_cast<int>(of_object.size());
  segments_ += static_cast<int>(of_segment.size());
  for (const auto& [object, size] : of_object) {
    double best = 0;
    int best_segment = 0;
    double most = 0;
    double its_segment = 0;
    for (const auto& [segment, both] : shared[object]) {
      const double iou = both / (size + of_segment[segment] - both);
      if (iou > best) best = iou, best_segment = segment;
      if (both <= most) continue;
      most = both;
      its_segment = of_segment[segment];
    }
    pixels_ += size;
    overlap_ += size * best;
    ious_ += best;
    right_ += most;
    wrong_ += its_segment - most;
    found_ += best >= kFound ? 1 : 0;  // Above one half no segment finds two objects.
    (best >= kFound ? finding : overlapping).insert(best_segment);
  }
  for (const auto& [segment, size] : of_segment) {
    if (finding.contains(segment)) continue;
    Sizes its;
    for (const auto& [object, by_segment] : shared)
      if (const auto both = by_segment.find(segment); both != by_segment.end()) its[object] = both->second;
    add_wrong(size, its, overlapping.contains(segment), wrong_segments_);
  }
}

double Scores::weighted_overlap() const {
  return pixels_ > 0 ? overlap_ / pixels_ : 0;
}

double Scores::mean_overlap() const {
  return objects_ > 0 ? ious_ / objects_ : 0;
}

double Scores::over_segmentation() const {
  return pixels_ > 0 ? 1 - right_ / pixels_ : 0;
}

double Scores::under_segmentation() const {
  return pixels_ > 0 ? wrong_ / pixels_ : 0;
}

double Scores::precision() const {
  return segments_ > 0 ? static_cast<double>(found_) / segments_ : 0;
}

double Scores::recall() const {
  return objects_ > 0 ? static_cast<double>(found_) / objects_ : 0;
}

double Scores::f1() const {
  return objects_ + segments_ > 0 ? 2.0 * found_ / (objects_ + segments_) : 0;
}

Json Scores::to_json() const {
  return {{"objects", objects_},
          {"segments", segments_},
          {"weighted_overlap", weighted_overlap()},
          {"mean_overlap", mean_overlap()},
          {"over_segmentation", over_segmentation()},
          {"under_segmentation", under_segmentation()},
          {"precision", precision()},
          {"recall", recall()},
          {"f1", f1()},
          {"wrong_segments",
           {{"table", wrong_segments_.table},
            {"joined", wrong_segments_.joined},
            {"inexact", wrong_segments_.inexact},
            {"pieces", wrong_segments_.pieces}}}};
}

}  // namespace loci::apps::segmentation_evaluation
