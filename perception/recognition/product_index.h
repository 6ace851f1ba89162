#pragma once

#include <filesystem>

#include "mapping/base/options.h"
#include "mapping/base/progress.h"
#include "perception/recognition/product_catalogue.h"
#include "perception/recognition/vocabulary_tree.h"

namespace loci::perception {

struct RecognitionOptions {
  int side_px = 400;
  int max_keypoints = 900;
  int neighbours = 40;
  int checks = 250;
  int candidates = 40;
  double tolerance = 0.03;
  double min_presence = 0.5;

  void declare(OptionTable& table);
};

/// A product that an image may show.
struct ProductMatch {
  size_t product = 0;     ///< its number in ProductIndex::products()
  double score = 0;       ///< grows with what speaks for it; of one image's matches only
  double share = 0;       ///< of the scores of all verified products, 0 to 1
  int inliers = 0;        ///< features that agree on where the catalogue's image lies in the image
  double presence = 0;    ///< probability that they do not agree by chance: a package like this is shown
  bool verified = false;  ///< presence is at least min_presence
  cv::Rect region;        ///< of the image, that those features cover

  /// Probability that this product is shown, and no other one that looks alike.
  double confidence() const { return presence * share; }
};

/// Products known by images, as ODUFinder did (§5.3): SIFT features in a vocabulary tree vote for products;
/// the places of the features and then colours decide among those with most votes.
///
/// A feature votes for the products of its nearest neighbours by how much nearer they are than the last of
/// them (local naive Bayes nearest neighbour, McCann and Lowe, CVPR 2012): what many products show (a brand)
/// counts for little.
class ProductIndex {
 public:
  /// Broken images are left out with a warning; Error when none is left.
  static ProductIndex build(const std::vector<Product>& catalogue, int threads, Progress& progress,
                            Warnings& warnings);
  void save(const std::filesystem::path& path) const;
  /// Error when the file is no index, of another version, or damaged.
  static ProductIndex load(const std::filesystem::path& path);

  /// The best products for an image (CV_8UC3), best first, each name once. Empty
  /// when the image has no features. `threads` = 0: all cores; the answer does not depend on it.
  std::vector<ProductMatch> recognise(const cv::Mat& image, const RecognitionOptions& options, int threads,
                                      size_t most = 5) const;

  const std::vector<Product>& products() const { return products_; }
  size_t features() const { return descriptors_.size(); }
  size_t words() const { return tree_.words(); }

 private:
  struct Ballot;
  void count_features();
  Ballot vote(const ImageFeatures& query, const RecognitionOptions& options, int threads) const;

  std::vector<Product> products_;
  std::vector<cv::Mat> chroma_;      ///< per product: CV_8UC3 (a, b of Lab, 255 = is coloured), small
  std::vector<cv::Size> sizes_;      ///< of its image
  std::vector<Keypoint> keypoints_;  ///< of all products, in the order of the tree's leaves
  std::vector<Descriptor> descriptors_;
  std::vector<uint32_t> owners_;  ///< product of each feature
  std::vector<size_t> counts_;    ///< features of each product
  VocabularyTree tree_;
};

}  // namespace loci::perception
