#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"
#include "perception/recognition/product_index.h"

namespace loci::apps::description_evaluation {

struct ServiceResult {
  int images = 0, results = 0;
  std::map<std::string, int> categories;  ///< Table 5.3
  struct Example {
    std::string image;
    std::vector<std::pair<std::string, int>> terms;
  };
  std::vector<Example> examples;  ///< Table 5.4
  int named = 0;                  ///< images of which it is known what they are called
  std::array<int, 6> relevant{};  ///< Table 5.5: these by how many of the five terms are relevant
  int first_relevant = 0;         ///< images whose most frequent term is
  std::vector<double> seconds;    ///< Table 5.6, of each request, ascending
  int alike_asked = 0, alike_remembered = 0, alike_wrong = 0;  ///< the cache, over all pairs of images

  std::string text() const;
  Json to_json() const;
};

/// The experiment of §5.4.5 with our own service: a server at a free port of this machine over the catalogue
/// in `folder` is asked about the images of labels.csv, and about those of `codes` (expected.csv), by the
/// client, one after the other. A term is relevant when it is a word of the true product's name, category or
/// brand, or of what visible_text.csv says is printed there; other words that are printed count as not
/// relevant. Of the cache: how many images are taken for alike, and how many of these show another product.
ServiceResult evaluate_service(const std::filesystem::path& folder, const std::filesystem::path& codes,
                               int every, int threads, Progress& progress, Warnings& warnings);

}  // namespace loci::apps::description_evaluation
