#pragma once

#include <opencv2/core.hpp>

#include "memory/store/rows.h"

namespace loci {

class Store;

/// An image of the memory as CV_8UC3, BGR. Error when it is broken.
cv::Mat read_image(const Store& store, Id blob);

}  // namespace loci
