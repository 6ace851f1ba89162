#pragma once

#include <map>
#include <set>
#include <string>

#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"

namespace loci::apps::description_evaluation {

/// Of codes, by who read them.
struct DrawnCodesScore {
  int images = 0;
  int plain = 0;    ///< in the image as it is
  int right = 0;    ///< with preparations
  int zbarimg = 0;  ///< by ZBar's own program
};

struct DrawnCodesResult {
  DrawnCodesScore all;
  std::map<std::string, DrawnCodesScore> by_symbology, by_distortion;
  int wrong = 0;         ///< codes that are not there
  double seconds = 0;    ///< of all images, with preparations
  bool has_peer = true;  ///< zbarimg is installed

  std::string text() const;
  Json to_json() const;
};

/// Draws codes of ten symbologies (or of those named) with zint, changes each image in thirteen ways, and
/// reads them. Error without zint.
DrawnCodesResult evaluate_drawn_codes(Progress& progress, const std::set<std::string>& names = {});

/// Whether the program that draws the codes is installed.
bool can_draw_codes();

}  // namespace loci::apps::description_evaluation
