#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "memory/store/rows.h"

namespace loci::memory {
class Store;
}  // namespace loci::memory

namespace loci::gui {

/// Something that an annotator read or recognised in a part of an image: a text, a barcode, a logo, an
/// answer of a visual search.
struct ImageNote {
  std::string type = {};    ///< without its package: "BarcodeAnnotation"
  std::string text = {};    ///< what it says; empty = only where
  std::string expert = {};  ///< the annotator; empty = unknown
  int64_t observation = 0;  ///< number of the observation it is about within its scene; -1 = of none
  cv::Rect2d region = {};   ///< pixels of the colour image
};

/// All annotations of a scene that have an image region of their own, as they stand in the memory.
std::vector<ImageNote> image_notes(const memory::Store& store, memory::Id scene);

/// The same from the JSON of one feature structure.
std::vector<ImageNote> notes_in(const std::string& json);

}  // namespace loci::gui
