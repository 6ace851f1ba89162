#pragma once

#include <opencv2/core.hpp>

#include "memory/store/rows.h"

namespace loci::memory {
class Store;
}  // namespace loci::memory

namespace loci::gui {

/// An image of the memory as CV_8UC3, BGR. Error when it is broken.
cv::Mat read_image(const memory::Store& store, memory::Id blob);

}  // namespace loci::gui
