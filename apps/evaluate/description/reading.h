#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"

namespace loci::apps::description_evaluation {

/// Codes of one symbology that images show, and who read them.
struct CodesScore {
  int images = 0;
  int plain = 0;  ///< right in the image as it is
  int right = 0;  ///< with preparations
};

struct ReadingResult {
  std::map<std::string, CodesScore> codes;  ///< by symbology
  int wrong = 0;                            ///< codes that are not there
  double seconds = 0;                       ///< of all images, with preparations
  std::vector<std::string> missed;
  int printed = 0,
      printed_read = 0;           ///< images with a number of digits, and those where it was read as text
  double digits_read = 0;         ///< mean share of a number that was read in one piece
  int words = 0, words_read = 0;  ///< of visible_text.csv

  std::string text() const;
  Json to_json() const;
};

/// Reads codes and text of DIR/images as DIR/expected.csv (file, symbology, text) has them: the numbers are
/// also printed below the bars. With `words`, a folder with visible_text.csv (file, words with | between),
/// those words, too. UPC-A and the EAN-13 of it with a leading zero are the same.
ReadingResult evaluate_reading(const std::filesystem::path& folder, const std::filesystem::path& words,
                               Progress& progress);

}  // namespace loci::apps::description_evaluation
