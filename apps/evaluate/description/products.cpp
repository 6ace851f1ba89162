#include "apps/evaluate/description/products.h"

#include <fmt/format.h>
#include <algorithm>
#include <filesystem>
#include <numeric>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "mapping/base/math/random.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/temporary_folder.h"
#include "mapping/base/text/csv.h"
#include "mapping/base/text/json.h"
#include "mapping/image/image_io.h"
#include "perception/recognition/product_catalogue.h"

namespace loci::apps::description_evaluation {
namespace {

constexpr int kSide = 198;

int any_int(Random& random, int low, int high) {
  return low + static_cast<int>(random.index(static_cast<uint64_t>(high - low + 1)));
}

cv::Scalar any_color(Random& random) {
  return {random.uniform(0, 255), random.uniform(0, 255), random.uniform(0, 255)};
}

cv::Point any_point(Random& random) {
  return {any_int(random, 0, kSide), any_int(random, 0, kSide)};
}

std::string any_word(Random& random, int least, int most) {
  std::string word(static_cast<size_t>(any_int(random, least, most)), ' ');
  const char first = random.uniform() < 0.5 ? 'a' : 'A';
  for (char& letter : word) letter = static_cast<char>(first + any_int(random, 0, 25));
  return word;
}

void draw_shapes(cv::Mat& image, Random& random) {
  for (int i = any_int(random, 3, 8); i > 0; --i) {
    const cv::Size size(any_int(random, 4, 60), any_int(random, 4, 60));
    if (random.uniform() < 0.5) {
      cv::ellipse(image, any_point(random), size, random.uniform(0, 180), 0, 360, any_color(random),
                  cv::FILLED, cv::LINE_AA);
      continue;
    }
    std::vector<cv::Point> corners;
    const cv::Point centre = any_point(random);
    for (int k = any_int(random, 3, 7); k > 0; --k)
      corners.push_back(centre + cv::Point(any_int(random, -size.width, size.width),
                                           any_int(random, -size.height, size.height)));
    cv::fillPoly(image, std::vector<std::vector<cv::Point>>{corners}, any_color(random), cv::LINE_AA);
  }
}

void draw_words(cv::Mat& image, Random& random, double scale, int thickness, int least, int most) {
  const int font = any_int(random, 0, 7);
  cv::putText(image, any_word(random, least, most),
              {any_int(random, 2, kSide / 3), any_int(random, 15, kSide - 4)}, font, scale, any_color(random),
              thickness, cv::LINE_AA);
}

/// Draws the front of a package that nobody sells: 198 × 198 pixels like a shop's images, a few coloured
/// shapes, a name in large letters, lines in small ones.
cv::Mat invented_package(Random random) {
  cv::Mat image(kSide, kSide, CV_8UC3, any_color(random));
  draw_shapes(image, random);
  for (int i = any_int(random, 1, 3); i > 0; --i)
    draw_words(image, random, random.uniform(0.8, 2), any_int(random, 2, 4), 3, 8);
  for (int i = any_int(random, 2, 8); i > 0; --i)
    draw_words(image, random, random.uniform(0.3, 0.5), 1, 8, 24);
  return image;
}

/// Writes so many of them into a folder, as entries of a catalogue that no query shows. Same seed, same
/// bytes.
std::vector<perception::Product> invent_products(int count, const std::filesystem::path& folder) {
  std::vector<perception::Product> products;
  const Random random(1);
  for (int i = 0; i < count; ++i) {
    const std::filesystem::path path = folder / fmt::format("invented_{}.png", i);
    mapping::write_image(path, invented_package(random.fork(static_cast<uint64_t>(i))));
    products.push_back({fmt::format("invented {}", i), {}, path});
  }
  return products;
}

namespace fs = std::filesystem;

constexpr float kRatio = 0.75f;
constexpr size_t kAmong = 5;

/// Times one query and counts its answer.
class Counting {
 public:
  explicit Counting(ProductsScore& score) : score_(score) {}
  void done(const std::vector<std::string>& answers, const std::string& truth) {
    score_.seconds += watch_.seconds();
    score_.cpu_seconds += watch_.cpu_seconds();
    ++score_.queries;
    const auto found = std::find(answers.begin(), answers.end(), truth);
    if (found == answers.begin() && !answers.empty()) ++score_.first;
    if (found != answers.end()) ++score_.among_five;
  }

 private:
  ProductsScore& score_;
  Stopwatch watch_;
};

/// Every query feature against every catalogue image.
class BruteForce {
 public:
  explicit BruteForce(const std::vector<perception::Product>& catalogue) {
    for (const perception::Product& product : catalogue) {
      names_.push_back(product.name);
      descriptors_.push_back(describe(mapping::read_color(product.image)));
    }
  }

  std::vector<std::string> recognise(const cv::Mat& image) const {
    const cv::Mat query = describe(image);
    std::vector<int> matches;
    for (const cv::Mat& descriptors : descriptors_) matches.push_back(count(query, descriptors));
    std::vector<size_t> order(names_.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return matches[a] > matches[b]; });
    std::vector<std::string> names;
    for (size_t i = 0; i < std::min(kAmong, order.size()); ++i) names.push_back(names_[order[i]]);
    return names;
  }

 private:
  cv::Mat describe(const cv::Mat& image) const {
    cv::Mat grey, descriptors;
    cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
    std::vector<cv::KeyPoint> keypoints;
    sift_->detectAndCompute(grey, cv::noArray(), keypoints, descriptors);
    return descriptors;
  }

  static int count(const cv::Mat& query, const cv::Mat& descriptors) {
    if (query.empty() || descriptors.rows < 2) return 0;
    std::vector<std::vector<cv::DMatch>> nearest;
    cv::BFMatcher(cv::NORM_L2).knnMatch(query, descriptors, nearest, 2);
    return static_cast<int>(std::count_if(nearest.begin(), nearest.end(), [](const auto& two) {
      return two.size() == 2 && two[0].distance < kRatio * two[1].distance;
    }));
  }

  cv::Ptr<cv::SIFT> sift_ = cv::SIFT::create();
  std::vector<std::string> names_;
  std::vector<cv::Mat> descriptors_;
};

double percent(int part, int whole) {
  return whole == 0 ? 0 : 100.0 * part / whole;
}

std::string line(const char* name, const ProductsScore& score) {
  const double queries = std::max(1, score.queries);
  return fmt::format(
      "{:22} {:5.1f} % first, {:5.1f} % among five, {:.3f} s a query ({:.3f} s of processor)\n", name,
      percent(score.first, score.queries), percent(score.among_five, score.queries), score.seconds / queries,
      score.cpu_seconds / queries);
}

Json score_json(const ProductsScore& score) {
  const double queries = std::max(1, score.queries);
  return {{"queries", score.queries},
          {"first_percent", percent(score.first, score.queries)},
          {"among_five_percent", percent(score.among_five, score.queries)},
          {"seconds_a_query", score.seconds / queries},
          {"cpu_seconds_a_query", score.cpu_seconds / queries}};
}

}  // namespace

void ProductsOptions::declare(OptionTable& table) {
  table.integer("every", every, "", "Take every n-th query.", 1, 1000000);
  table.integer("distractors", distractors, "",
                "Invented packages in the catalogue besides: shapes and words that no query shows.", 0,
                100000);
  table.flag("peer", peer, "Run plain brute-force SIFT beside.");
}

ProductsResult evaluate_products(const fs::path& folder, const ProductsOptions& options,
                                 const perception::RecognitionOptions& recognition, int threads,
                                 Progress& progress, Warnings& warnings) {
  ProductsResult result;
  std::vector<perception::Product> catalogue = perception::read_catalogue(folder);
  const TemporaryFolder scratch("loci-evaluate-products");
  std::ranges::move(invent_products(options.distractors, scratch.path()), std::back_inserter(catalogue));
  const Stopwatch watch;
  PartialProgress building(progress, 0, 0.2);
  const perception::ProductIndex index =
      perception::ProductIndex::build(catalogue, threads, building, warnings);
  result.index_seconds = watch.seconds();
  result.images = index.products().size();
  result.features = index.features();
  std::optional<BruteForce> peer;
  if (options.peer) peer.emplace(index.products());
  const CsvTable labels = CsvTable::read(folder / "labels.csv");
  const size_t file = labels.require_column("file"), name = labels.require_column("class_name");
  for (size_t row = 0; row < labels.rows(); row += static_cast<size_t>(options.every)) {
    progress.check(0.2 + 0.8 * static_cast<double>(row) / static_cast<double>(labels.rows()), "queries");
    const cv::Mat image = mapping::read_color(folder / labels.cell(row, file));
    const std::string& truth = labels.cell(row, name);
    Counting counting(result.ours);
    const std::vector<perception::ProductMatch> matches =
        index.recognise(image, recognition, threads, kAmong);
    std::vector<std::string> names;
    for (const perception::ProductMatch& match : matches)
      names.push_back(index.products()[match.product].name);
    counting.done(names, truth);
    const bool right = !names.empty() && names[0] == truth,
               believed = !matches.empty() && matches[0].verified;
    result.believed += believed;
    result.believed_wrong += believed && !right;
    if (!right) ++result.mistakes[truth + " taken for " + (names.empty() ? "nothing" : names[0])];
    if (!peer) continue;
    Counting peer_counting(result.brute_force);
    peer_counting.done(peer->recognise(image), truth);
  }
  return result;
}

std::string ProductsResult::text() const {
  std::string text = fmt::format("products: {} images, {} features, indexed in {:.1f} s; {} queries\n",
                                 images, features, index_seconds, ours.queries);
  text += line("  ours", ours);
  if (brute_force.queries > 0) text += line("  brute-force SIFT", brute_force);
  text += fmt::format("  verified {:.1f} % of the first answers, {} of them wrong\n",
                      percent(believed, ours.queries), believed_wrong);
  for (const auto& [mistake, times] : mistakes) text += fmt::format("  {} times {}\n", times, mistake);
  return text;
}

Json ProductsResult::to_json() const {
  Json json = {{"images", images},         {"features", features}, {"index_seconds", index_seconds},
               {"ours", score_json(ours)}, {"verified", believed}, {"verified_wrong", believed_wrong},
               {"mistakes", mistakes}};
  if (brute_force.queries > 0) json["brute_force"] = score_json(brute_force);
  return json;
}

}  // namespace loci::apps::description_evaluation
