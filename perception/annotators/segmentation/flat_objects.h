#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "perception/annotators/segmentation/flat_surface.h"
#include "perception/pipeline/annotator.h"

namespace loci::perception {

struct FlatObject {
  cv::Rect box;             ///< in the colour image
  cv::Mat mask;             ///< CV_8U, of the box's size: 255 = object
  std::vector<int> pixels;  ///< of the depth image, row · width + column, ascending
  double height = 0;        ///< median over the surface, metres
};

/// An image of the depth camera as the colour camera would see it if it were painted on the surface's plane
/// (nearest pixel; `outside` where the depth image does not reach). Flat objects move by less than a pixel.
cv::Mat seen_by_color(const cv::Mat& image, const mapping::RgbdCamera& camera, const FlatSurface& surface,
                      double outside);

/// Flat objects in two stages: what is certainly surface (below table_m) and certainly object (above
/// object_m) trains histograms of hue and saturation, anew for every image, so that the light may change;
/// every pixel of the colour image, which may be the larger one, is then decided by its colour and its height
/// together. What is left is searched once more for objects that are too thin to be certain (above thin_m,
/// over the plane as it bends as a whole): these must rise over what is next to them by step_m along their
/// whole border, see rises_all_around(). `color`: CV_8UC3 of camera.color's size.
std::vector<FlatObject> find_flat_objects(const cv::Mat& depth, const cv::Mat& color,
                                          const mapping::RgbdCamera& camera, const FlatSurface& surface,
                                          const FlatOptions& options);

/// Whether a flat object is the low part of one of `clusters` (pixels of the depth image, row · width +
/// column): a good part of its outline runs along that cluster, and it has its colour, as the inside of a
/// plate has that of the rim. `color`: CV_8UC3 of camera.color's size.
bool is_part_of_cluster(const FlatObject& object, const std::vector<std::vector<int>>& clusters,
                        const cv::Mat& depth, const cv::Mat& color, const mapping::RgbdCamera& camera);

/// Flat objects on the supports that were found before it, one cluster each, with a mask in the colour image
/// (§4.3): what is too low to be told from the support by its height alone. What already is a cluster, or the
/// low part of one, is left alone.
class FlatObjectExtractor : public Annotator {
 public:
  static constexpr const char* kName = "FlatObjectExtractor";
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  /// Error when the calibration is asked for and cannot be read.
  void start(Context& context) override;
  void process(cas::Cas& cas, Context& context) override;

 private:
  FlatOptions options_;
  std::string calibration_;
  cv::Mat empty_depth_;
};

}  // namespace loci::perception
