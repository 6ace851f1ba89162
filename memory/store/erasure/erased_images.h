#pragma once

// Private to this module: objects are cut out of all images in which they are visible.

#include <opencv2/core.hpp>

#include "memory/store/database.h"

namespace loci::memory {

struct ErasedImages {
  int64_t scenes = 0, regions = 0, images = 0;  ///< images = removed as a whole
  /// Of the regions of colour images that show it. Where only the depth speaks for it, a region counts unless
  /// an image that remains looks the same there: then it was a closed door, or whatever else hid it.
  std::vector<ImageSignature> signatures = {};
};

/// Cuts the observations of table temp.gone_observation out of colour images, depth thumbnails, pixel kinds
/// and the crops and masks of others: in the scenes that observed them, with their boxes as far as the colour
/// image shows them, in those between in which their box is in view and not seen empty, and in those before
/// and after in which the depth shows something in it. A scene of which nobody knows what it shows loses its
/// images. Scenes that changed are added to temp.gone_image. Must run before the rows of the observations
/// are deleted.
ErasedImages erase_from_images(const Store& store, Store::Connection& db);

/// Of a region of an image (CV_8UC1, CV_8UC3 or CV_8UC4).
ImageSignature signature_of(const cv::Mat& image, const cv::Rect& region);

/// Whether an image shows what a region looked like. Images compressed again differ by a few levels; a
/// uniform region, as erased ones are, says nothing.
bool shows(const cv::Mat& image, const ImageSignature& signature);
/// The image of a scene; unset where there is none of 8 bits.
std::optional<cv::Mat> stored_image(const Store& store, const SceneRow& scene);

}  // namespace loci::memory
