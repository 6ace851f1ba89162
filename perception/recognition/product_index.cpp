#include "perception/recognition/product_index.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>
#include <type_traits>

#include "mapping/base/files.h"
#include "mapping/base/math/log_odds.h"
#include "mapping/base/parallel.h"
#include "mapping/base/text/hash.h"
#include "mapping/base/text/json.h"
#include "mapping/image/image_io.h"
#include "perception/recognition/image_features.h"

namespace loci::perception {
namespace {

constexpr int kCatalogueSide = 400;
constexpr int kCatalogueKeypoints = 1500;
constexpr int kCatalogueCells = 48;
constexpr int kQueryCells = 128;  // A product fills a part of the image.
constexpr int kMaxDistance = 2 * 512 * 512;
// What votes count beside features that agree on a place, which decides when hardly any do.
constexpr double kVoteShare = 0.05;
constexpr double kUnknownColor = 0.25;
// An image with more features wins more of everything by chance, and that varies with the root of its
// number.
constexpr double kManyFeatures = 1000;
// Presence over log10 of the expected false alarms: logistic, fitted to images of products and of other
// objects.
constexpr double kPresenceOffset = -1.4, kPresenceSlope = -0.7;

cv::Rect region_of(const std::vector<Correspondence>& pairs, const std::vector<size_t>& inliers,
                   const cv::Size& size) {
  cv::Rect region;
  for (const size_t i : inliers) {
    const cv::Rect point(static_cast<int>(pairs[i].to.x), static_cast<int>(pairs[i].to.y), 1, 1);
    region = region.empty() ? point : region | point;
  }
  return region & cv::Rect({}, size);
}

double presence_of(double log_false_alarms) {
  return probability_from_log_odds(kPresenceOffset + kPresenceSlope * log_false_alarms);
}

template <class Value>
std::vector<Value> reordered(const std::vector<Value>& values, const std::vector<uint32_t>& order) {
  std::vector<Value> result;
  result.reserve(order.size());
  for (const uint32_t number : order) result.push_back(values[number]);
  return result;
}

/// Each level that a tree has more asks for as many comparisons again to miss no more neighbours.
size_t checks_in(size_t features, int checks) {
  constexpr double kOneLevel = 10000;  // Features for which `checks` are meant: a small catalogue.
  const double levels = std::log10(static_cast<double>(std::max<size_t>(1, features)) / kOneLevel);
  return static_cast<size_t>(checks * std::max(1.0, levels));
}

/// Of a large catalogue more products have votes by chance.
size_t candidates_of(size_t products, int candidates) {
  constexpr size_t kShare = 20;
  return std::max(static_cast<size_t>(candidates), products / kShare);
}

/// Each name once, by score.
std::vector<ProductMatch> ranked(std::vector<ProductMatch> matches, const std::vector<Product>& products,
                                 size_t most) {
  std::sort(matches.begin(), matches.end(), [](const ProductMatch& a, const ProductMatch& b) {
    return a.score != b.score ? a.score > b.score : a.product < b.product;
  });
  std::vector<ProductMatch> best;
  std::set<std::string> names;
  double sum = 0;
  for (const ProductMatch& match : matches) {
    if (!names.insert(products[match.product].name).second) continue;
    if (match.verified) sum += match.score;
    best.push_back(match);
  }
  if (best.size() > most) best.resize(most);
  for (ProductMatch& match : best)
    if (match.verified && sum > 0) match.share = match.score / sum;
  return best;
}

// A line of text, the SHA-256 of all that follows in hexadecimal, then a JSON header (its length first, 8
// bytes) and the arrays as they lie in memory (little endian).
constexpr std::string_view kKind = "loci product index ";
constexpr std::string_view kVersion = "1";
constexpr size_t kHashLength = 64;

template <class T>
void append(std::string& bytes, const std::vector<T>& values) {
  static_assert(std::is_trivially_copyable_v<T>);
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

/// Takes arrays off the front of bytes.
class Taker {
 public:
  explicit Taker(std::string_view bytes) : bytes_(bytes) {}
  std::string_view take(size_t count) {
    if (count > bytes_.size()) throw Error("the file ends too early");
    const std::string_view taken = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return taken;
  }
  template <class T>
  std::vector<T> take_array(size_t count) {
    if (count > bytes_.size() / sizeof(T)) throw Error("the file ends too early");
    std::vector<T> values(count);
    if (count > 0) std::memcpy(values.data(), take(count * sizeof(T)).data(), count * sizeof(T));
    return values;
  }
  bool empty() const { return bytes_.empty(); }

 private:
  std::string_view bytes_;
};

std::string_view checked_payload(std::string_view bytes) {
  if (!bytes.starts_with(kKind))
    throw Error("this is no product index", {}, "make one with `loci-perceive index`");
  const size_t line = bytes.find('\n');
  if (line == std::string_view::npos || line > 64) throw Error("this is no product index");
  const std::string_view version = bytes.substr(kKind.size(), line - kKind.size());
  if (version != kVersion)
    throw Error(
        "the index has version " + std::string(version) + ", this program reads " + std::string(kVersion), {},
        "make it anew with `loci-perceive index`");
  bytes.remove_prefix(line + 1);
  if (bytes.size() < kHashLength || content_hash(bytes.substr(kHashLength)) != bytes.substr(0, kHashLength))
    throw Error("the index is damaged", {}, "make it anew with `loci-perceive index`");
  return bytes.substr(kHashLength);
}

}  // namespace

void RecognitionOptions::declare(OptionTable& table) {
  table.integer("side_px", side_px, "px", "Length that the longer side of an image is scaled to.", 50, 4000);
  table.integer("max_keypoints", max_keypoints, "", "Maximum number of features per image, strongest first.",
                10, 100000);
  table.integer("neighbours", neighbours, "",
                "Number of catalogue features that one image feature votes for.", 1, 1000);
  table.integer("checks", checks, "", "Number of comparisons per image feature; more in large catalogues.",
                10, 100000);
  table.integer("candidates", candidates, "",
                "Number of products that are verified geometrically, by votes; 5 % in large catalogues.", 1,
                10000);
  table.number("tolerance", tolerance, "",
               "Maximum position error, relative to the longer side of the image.", 0.001, 0.5);
  table.number("min_presence", min_presence, "",
               "Minimum probability that the matches of a product are not due to chance.", 0, 1);
}

/// Votes and correspondences of every product.
struct ProductIndex::Ballot {
  std::vector<double> votes;
  std::vector<std::vector<Correspondence>> pairs;
};

ProductIndex ProductIndex::build(const std::vector<Product>& catalogue, int threads, Progress& progress,
                                 Warnings& warnings) {
  ProductIndex index;
  for (size_t i = 0; i < catalogue.size(); ++i) {
    progress.check(0.9 * static_cast<double>(i) / static_cast<double>(catalogue.size()), "features");
    cv::Mat image;
    try {
      image = mapping::read_color(catalogue[i].image);
    } catch (const Error& error) {
      warnings.add("left out of the catalogue: " + std::string(error.what()));
      continue;
    }
    const ImageFeatures features = image_features(image, kCatalogueSide, kCatalogueKeypoints);
    index.owners_.insert(index.owners_.end(), features.keypoints.size(),
                         static_cast<uint32_t>(index.products_.size()));
    index.keypoints_.insert(index.keypoints_.end(), features.keypoints.begin(), features.keypoints.end());
    index.descriptors_.insert(index.descriptors_.end(), features.descriptors.begin(),
                              features.descriptors.end());
    index.chroma_.push_back(chroma_of(image, kCatalogueCells));
    index.sizes_.push_back(image.size());
    index.products_.push_back(catalogue[i]);
  }
  if (index.products_.empty()) throw Error("none of the catalogue's images can be read");
  progress.check(0.9, "vocabulary tree");
  index.tree_ = VocabularyTree::build(index.descriptors_, threads);
  const std::vector<uint32_t> order = index.tree_.order_by_leaves();
  index.keypoints_ = reordered(index.keypoints_, order);
  index.descriptors_ = reordered(index.descriptors_, order);
  index.owners_ = reordered(index.owners_, order);
  index.count_features();
  return index;
}

void ProductIndex::count_features() {
  counts_.assign(products_.size(), 0);
  for (const uint32_t owner : owners_) {
    if (owner >= counts_.size()) throw Error("the index contradicts itself");
    ++counts_[owner];
  }
}

ProductIndex::Ballot ProductIndex::vote(const ImageFeatures& query, const RecognitionOptions& options,
                                        int threads) const {
  std::vector<std::vector<VocabularyTree::Neighbour>> nearest(query.descriptors.size());
  parallel_for(nearest.size(), threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      nearest[i] =
          tree_.nearest(query.descriptors[i], descriptors_, static_cast<size_t>(options.neighbours) + 1,
                        checks_in(descriptors_.size(), options.checks));
  });
  Ballot ballot{std::vector<double>(products_.size(), 0),
                std::vector<std::vector<Correspondence>>(products_.size())};
  for (size_t i = 0; i < nearest.size(); ++i) {
    if (nearest[i].empty()) continue;
    // Where the catalogue has nothing else to compare with, nothing is as far as can be.
    const bool enough = nearest[i].size() > static_cast<size_t>(options.neighbours);
    const int background = enough ? nearest[i].back().distance : kMaxDistance;
    std::set<uint32_t> voted;
    for (const VocabularyTree::Neighbour& neighbour : nearest[i]) {
      const double weight = static_cast<double>(background - neighbour.distance) / kMaxDistance;
      if (weight <= 0) break;
      const uint32_t owner = owners_[neighbour.number];
      if (voted.insert(owner).second) ballot.votes[owner] += weight;
      ballot.pairs[owner].push_back({keypoints_[neighbour.number], query.keypoints[i], weight});
    }
  }
  return ballot;
}

std::vector<ProductMatch> ProductIndex::recognise(const cv::Mat& image, const RecognitionOptions& options,
                                                  int threads, size_t most) const {
  const ImageFeatures query = image_features(image, options.side_px, options.max_keypoints);
  const Ballot ballot = vote(query, options, threads);
  std::vector<size_t> order;
  for (size_t i = 0; i < products_.size(); ++i)
    if (ballot.votes[i] > 0) order.push_back(i);
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return ballot.votes[a] > ballot.votes[b]; });
  const size_t looked_at = candidates_of(products_.size(), options.candidates);
  if (order.size() > looked_at) order.resize(looked_at);
  const cv::Mat chroma = chroma_of(image, kQueryCells);
  const double tolerance_px = options.tolerance * std::max(image.cols, image.rows);
  std::vector<ProductMatch> matches(order.size());
  parallel_for(order.size(), threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const size_t product = order[i];
      const std::vector<Correspondence>& pairs = ballot.pairs[product];
      const ImageFit fit = fit_images(pairs, tolerance_px);
      ProductMatch& match = matches[i];
      match.product = product;
      match.inliers = static_cast<int>(fit.inliers.size());
      match.presence = presence_of(log_false_alarms(pairs, fit, tolerance_px, image.size(), order.size()));
      match.verified = match.inliers > 0 && match.presence >= options.min_presence;
      match.region = region_of(pairs, fit.inliers, image.size());
      const double root = std::sqrt(static_cast<double>(counts_[product]) / kManyFeatures);
      match.score = kUnknownColor * kVoteShare * ballot.votes[product] / root;
      if (match.inliers == 0) continue;
      const double color =
          color_agreement(chroma_[product], sizes_[product], chroma, image.size(), fit.to_from_from);
      match.score += fit.weight * color * color / root;
    }
  });
  return ranked(std::move(matches), products_, most);
}

void ProductIndex::save(const std::filesystem::path& path) const {
  Json header = {
      {"features", descriptors_.size()}, {"nodes", tree_.nodes().size()}, {"products", Json::array()}};
  for (size_t i = 0; i < products_.size(); ++i) {
    Json properties = Json::array();
    for (const auto& [key, value] : products_[i].properties) properties.push_back({key, value});
    header["products"].push_back({{"name", products_[i].name},
                                  {"image", products_[i].image.string()},
                                  {"size", {sizes_[i].width, sizes_[i].height}},
                                  {"cells", {chroma_[i].cols, chroma_[i].rows}},
                                  {"properties", properties}});
  }
  const std::string text = header.dump(-1, ' ', false, Json::error_handler_t::replace);
  const uint64_t length = text.size();
  std::string payload(reinterpret_cast<const char*>(&length), sizeof(length));
  payload += text;
  append(payload, keypoints_);
  append(payload, descriptors_);
  append(payload, owners_);
  append(payload, tree_.nodes());
  append(payload, tree_.numbers());
  for (const cv::Mat& chroma : chroma_)
    payload.append(reinterpret_cast<const char*>(chroma.data), chroma.total() * chroma.elemSize());
  write_file_atomically(path,
                        std::string(kKind) + std::string(kVersion) + "\n" + content_hash(payload) + payload);
}

ProductIndex ProductIndex::load(const std::filesystem::path& path) try {
  const std::string bytes = read_file(path);
  Taker payload(checked_payload(bytes));
  const uint64_t length = payload.take_array<uint64_t>(1)[0];
  const Json header = parse_json(payload.take(length), path.string());
  ProductIndex index;
  for (const Json& entry : header.at("products")) {
    Product product{entry.at("name"), {}, entry.at("image").get<std::string>()};
    for (const Json& property : entry.at("properties"))
      product.properties.emplace_back(property.at(0), property.at(1));
    index.products_.push_back(std::move(product));
    index.sizes_.emplace_back(entry.at("size").at(0).get<int>(), entry.at("size").at(1).get<int>());
    index.chroma_.emplace_back(entry.at("cells").at(1).get<int>(), entry.at("cells").at(0).get<int>(),
                               CV_8UC3);
  }
  const size_t features = header.at("features");
  index.keypoints_ = payload.take_array<Keypoint>(features);
  index.descriptors_ = payload.take_array<Descriptor>(features);
  index.owners_ = payload.take_array<uint32_t>(features);
  auto nodes = payload.take_array<VocabularyTree::Node>(header.at("nodes"));
  index.tree_ = VocabularyTree::restore(std::move(nodes), payload.take_array<uint32_t>(features));
  for (cv::Mat& chroma : index.chroma_) {
    const std::string_view cells = payload.take(chroma.total() * chroma.elemSize());
    std::memcpy(chroma.data, cells.data(), cells.size());
  }
  index.count_features();
  return index;
} catch (const Error& error) {
  if (!error.location().file.empty()) throw;
  throw Error(error.message(), {path.string(), 0, {}}, error.hint());
} catch (const nlohmann::json::exception&) {
  throw Error("the index contradicts itself", {path.string(), 0, {}},
              "make it anew with `loci-perceive index`");
}

}  // namespace loci::perception
