#include "perception/classification/local_features.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/objdetect.hpp>

#include "mapping/base/error.h"
#include "mapping/base/text/json.h"
#include "mapping/image/root_sift.h"
#include "perception/classification/features/delegates.h"

namespace loci::perception {
namespace {

constexpr int kSide = 320;  // Images of objects are scaled to it: SIFT then sees like scales.
constexpr int kMaxKeypoints = 500;

cv::Mat grey_of(const cv::Mat& image) {
  cv::Mat grey = image;
  if (image.channels() == 3) cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

LocalFeatures of_image(cv::Feature2D& detector, const ObjectView& view) {
  LocalFeatures features;
  if (view.image.empty()) return features;
  const double scale = static_cast<double>(kSide) / std::max(view.image.cols, view.image.rows);
  cv::Mat grey, mask, values;
  cv::resize(grey_of(view.image), grey, {}, scale, scale, scale < 1 ? cv::INTER_AREA : cv::INTER_CUBIC);
  if (!view.mask.empty()) cv::resize(view.mask, mask, grey.size(), 0, 0, cv::INTER_NEAREST);
  std::vector<cv::KeyPoint> found;
  detector.detectAndCompute(grey, mask, found, values);
  const auto back = static_cast<float>(1 / scale);
  for (const cv::KeyPoint& point : found)
    features.places.emplace_back(point.pt.x * back, point.pt.y * back, point.size * back);
  features.length = static_cast<size_t>(values.cols);
  if (values.type() == CV_32F) {
    const cv::Mat rooted = mapping::root_sift(values);
    features.values.assign(rooted.begin<float>(), rooted.end<float>());
    return features;
  }
  features.length *= 8;
  for (int row = 0; row < values.rows; ++row)
    for (int i = 0; i < values.cols; ++i)
      for (int bit = 0; bit < 8; ++bit)
        features.values.push_back(static_cast<float>((values.at<unsigned char>(row, i) >> bit) & 1));
  return features;
}

}  // namespace

std::vector<std::string> local_feature_names() {
  return {"SIFT", "ORB", "SHOT", "FPFH"};
}

LocalFeatures local_features(const std::string& name, const ObjectView& view) {
  if (name == "SIFT") return of_image(*cv::SIFT::create(kMaxKeypoints, 3, 0.02, 12), view);
  if (name == "ORB")
    return of_image(*cv::ORB::create(kMaxKeypoints, 1.2f, 6, 15, 0, 2, cv::ORB::HARRIS_SCORE, 31, 10), view);
  if (name != "SHOT" && name != "FPFH")
    throw Error("there are no local descriptors " + name, {}, "there are SIFT, ORB, SHOT, FPFH");
  constexpr size_t kMinPoints = 20;
  const SurfacePoints thin = thinned_surface(view.surface);
  if (thin.points.size() < kMinPoints) return {};
  const std::vector<int> at = feature_delegates::keypoints(thin);
  return name == "SHOT" ? feature_delegates::shot_at(thin, at) : feature_delegates::fpfh_at(thin, at);
}

FeatureVector hog_of(const cv::Mat& image, const cv::Mat& mask) {
  if (image.empty()) return {};
  cv::Mat grey = grey_of(image).clone(), small;
  if (!mask.empty()) grey.setTo(cv::mean(grey, mask)[0], mask == 0);
  cv::resize(grey, small, {64, 64}, 0, 0, cv::INTER_AREA);
  const cv::HOGDescriptor hog({64, 64}, {32, 32}, {16, 16}, {16, 16}, 9);
  FeatureVector values;
  hog.compute(small, values);
  return values;
}

size_t Vocabulary::nearest(const float* descriptor) const {
  size_t best = 0;
  float least = std::numeric_limits<float>::infinity();
  for (size_t word = 0; word < words(); ++word) {
    float distance = 0;
    for (size_t i = 0; i < length_; ++i) {
      const float off = descriptor[i] - centres_[word * length_ + i];
      distance += off * off;
    }
    if (distance < least) {
      least = distance;
      best = word;
    }
  }
  return best;
}

Vocabulary Vocabulary::learn(const std::vector<const LocalFeatures*>& examples, size_t words,
                             const Random& random) {
  constexpr int kRounds = 10;
  constexpr size_t kMax = 20000;  // Descriptors; more teach nothing.
  std::vector<const float*> all;
  Vocabulary vocabulary;
  for (const LocalFeatures* each : examples) {
    if (each->count() == 0) continue;
    vocabulary.length_ = each->length;
    for (size_t i = 0; i < each->count(); ++i) all.push_back(&each->values[i * each->length]);
  }
  if (all.empty()) throw Error("there are no key points to learn words from");
  Random draw = random;
  for (size_t i = 0; i + 1 < all.size(); ++i) std::swap(all[i], all[i + draw.index(all.size() - i)]);
  if (all.size() > kMax) all.resize(kMax);
  words = std::min(words, all.size());
  const size_t length = vocabulary.length_;
  for (size_t word = 0; word < words; ++word)
    vocabulary.centres_.insert(vocabulary.centres_.end(), all[word], all[word] + length);
  for (int round = 0; round < kRounds; ++round) {
    std::vector<double> sums(words * length, 0.0), counts(words, 0.0);
    for (const float* descriptor : all) {
      const size_t word = vocabulary.nearest(descriptor);
      ++counts[word];
      for (size_t i = 0; i < length; ++i) sums[word * length + i] += static_cast<double>(descriptor[i]);
    }
    for (size_t word = 0; word < words; ++word)
      for (size_t i = 0; counts[word] > 0 && i < length; ++i)
        vocabulary.centres_[word * length + i] = static_cast<float>(sums[word * length + i] / counts[word]);
  }
  return vocabulary;
}

FeatureVector Vocabulary::bag_of(const LocalFeatures& features) const {
  if (features.count() == 0 || features.length != length_) return {};
  FeatureVector bag(words(), 0.0f);
  for (size_t i = 0; i < features.count(); ++i) bag[nearest(&features.values[i * length_])] += 1;
  for (float& value : bag) value = std::sqrt(value / static_cast<float>(features.count()));
  return bag;
}

Json Vocabulary::to_json() const {
  return {{"length", length_}, {"centres", centres_}};
}

Vocabulary Vocabulary::from_json(const Json& json) {
  Vocabulary vocabulary;
  vocabulary.length_ = json.at("length").get<size_t>();
  vocabulary.centres_ = json.at("centres").get<std::vector<float>>();
  if (vocabulary.length_ == 0 || vocabulary.centres_.empty() ||
      vocabulary.centres_.size() % vocabulary.length_ != 0)
    throw Error("the vocabulary contradicts itself");
  return vocabulary;
}

}  // namespace loci::perception
