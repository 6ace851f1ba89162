#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "mapping/base/text/json_fwd.h"
#include "perception/recognition/product_index.h"

namespace loci::apps::description_evaluation {

struct ProductsOptions {
  int every = 1;
  bool peer = true;
  int distractors = 0;  ///< entries of the catalogue that no query shows

  void declare(OptionTable& table);
};

/// One way to recognise products, over all queries.
struct ProductsScore {
  int queries = 0, first = 0, among_five = 0;
  double seconds = 0;      ///< of all queries, wall clock
  double cpu_seconds = 0;  ///< of all threads
};

struct ProductsResult {
  size_t images = 0, features = 0;
  double index_seconds = 0;
  ProductsScore ours, brute_force;
  int believed = 0, believed_wrong = 0;  ///< our first answers that are verified
  std::map<std::string, int> mistakes;   ///< "truth taken for answer"

  std::string text() const;
  Json to_json() const;
};

/// Recognises DIR/labels.csv's images (columns file, class_name) with the catalogue in DIR. Beside it plain
/// brute-force SIFT: OpenCV's defaults, each catalogue image by the number of matches that pass Lowe's
/// ratio test (0.75).
ProductsResult evaluate_products(const std::filesystem::path& folder, const ProductsOptions& options,
                                 const perception::RecognitionOptions& recognition, int threads,
                                 Progress& progress, Warnings& warnings);

}  // namespace loci::apps::description_evaluation
