#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "mapping/base/time.h"
#include "memory/store/rows/rows.h"

namespace loci::memory {
class Store;
}  // namespace loci::memory

namespace loci::gui {

struct MemoryIndex;

/// An annotation of an object.
struct Annotation {
  std::string type = {};  ///< without its package: "ColorAnnotation"
  std::string value = {};
  std::string annotator = {};  ///< empty = unknown
  std::optional<double> confidence = {};
};

/// Numbers that belong together: a histogram, a descriptor.
struct Histogram {
  std::string title = {};
  std::vector<double> bins = {};
};

struct ObjectImage {
  TimeNs time = 0;
  std::string side = {};  ///< of the camera: "from +x"; empty = unknown
  cv::Mat image = {};     ///< CV_8UC3, BGR
};

/// What the memory has of an object beyond its history.
struct ObjectDetails {
  std::vector<ObjectImage> images = {};      ///< the newest from each side
  std::vector<Annotation> annotations = {};  ///< of its last observation
  std::vector<Histogram> histograms = {};
  std::string why = {};  ///< why the memory believes what it does, in words
};

/// As of a time.
ObjectDetails read_details(const memory::Store& store, const MemoryIndex& index, memory::Id object,
                           TimeNs time);

}  // namespace loci::gui
