#include "nbv/floor_region.h"

#include <cmath>
#include <sstream>

#include "mapping/base/error.h"

namespace loci::nbv {

FloorRegion::FloorRegion(const std::string& text) {
  if (text.empty()) return;
  std::istringstream in(text);
  double values[4] = {};
  bool good = true;
  for (int i = 0; i < 4; ++i) {
    char comma = ',';
    if (i > 0) in >> comma;
    good = good && in >> values[i] && comma == ',' && std::isfinite(values[i]);
  }
  if (!good || !(in >> std::ws).eof())
    throw Error("'" + text + "' is no rectangle on the floor", {"", 0, "within"},
                "give two corners: x0,y0,x1,y1 in metres");
  box_.emplace();
  box_->extend(Vector2d(values[0], values[1]));
  box_->extend(Vector2d(values[2], values[3]));
  if (box_->sizes().minCoeff() <= 0)
    throw Error("'" + text + "' has no area", {"", 0, "within"}, "give two opposite corners");
}

}  // namespace loci::nbv
