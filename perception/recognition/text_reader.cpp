#include "perception/recognition/text_reader.h"

#include <tesseract/baseapi.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <set>

#include "mapping/base/error.h"
#include "mapping/base/text/text.h"

namespace loci::perception {
namespace {

constexpr double kSide = 1200;  // pixels: letters of a package then are as high as those of a scanned page
constexpr double kMaxZoom = 3;  // more adds no detail
constexpr int kMargin = 12;     // letters at the border are not recognised
constexpr size_t kMinLetters = 3;
constexpr double kLegible = 6;  // sure letters from which on an image is upright: two short words
constexpr double kLevel = 3;    // degrees that Tesseract does not mind

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || static_cast<unsigned char>(c) >= 0x80;
}

/// Letters, without bytes that only continue one.
size_t letters(const std::string& word) {
  return static_cast<size_t>(std::count_if(
      word.begin(), word.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

/// Runs of letters.
std::vector<std::string> letter_runs(const std::string& text) {
  std::vector<std::string> runs(1);
  for (const char c : text) {
    if (is_letter(c))
      runs.back() += c;
    else if (!runs.back().empty())
      runs.emplace_back();
  }
  if (runs.back().empty()) runs.pop_back();
  return runs;
}

/// What says nothing about an object: common to many texts.
bool is_common(const std::string& word) {
  static const std::set<std::string> common = {"www",  "http", "https", "com",  "the",  "and", "for",
                                               "with", "from", "this",  "that", "are",  "you", "your",
                                               "not",  "our",  "has",   "html", "info", "more"};
  return common.contains(word);
}

/// How far lines of text, and edges of what they are printed on, are turned against the image: degrees, -45
/// to 45, by the directions of the gradients. 0 where no direction stands out.
double skew_of(const cv::Mat& grey) {
  cv::Mat dx, dy;
  cv::Sobel(grey, dx, CV_32F, 1, 0);
  cv::Sobel(grey, dy, CV_32F, 0, 1);
  std::array<double, 90> weights{};
  for (int v = 0; v < grey.rows; ++v)
    for (int u = 0; u < grey.cols; ++u) {
      const auto x = static_cast<double>(dx.at<float>(v, u)), y = static_cast<double>(dy.at<float>(v, u));
      const double strength = std::hypot(x, y);
      if (strength < 60) continue;
      const double degrees = std::atan2(y, x) * 180 / std::numbers::pi + 360;
      weights[static_cast<size_t>(std::lround(degrees)) % 90] += strength;
    }
  const auto around = [&](size_t i) {
    double sum = 0;
    for (size_t k = 88; k <= 92; ++k) sum += weights[(i + k) % 90];
    return sum;
  };
  size_t best = 0;
  double all = 0;
  for (size_t i = 0; i < 90; ++i) {
    all += weights[i];
    if (around(i) > around(best)) best = i;
  }
  if (around(best) < 2.5 * all * 5 / 90) return 0;
  const double degrees = static_cast<double>(best);
  return degrees > 45 ? degrees - 90 : degrees;
}

/// An image turned so that lines of text that rise by `degrees` (clockwise, as in the image) become level.
struct TurnedImage {
  cv::Mat grey;
  cv::Matx23d turned_from_image;
};

TurnedImage turned(const cv::Mat& grey, double degrees) {
  const double angle = degrees * std::numbers::pi / 180, c = std::cos(angle), s = std::sin(angle);
  const double w = grey.cols - 1, h = grey.rows - 1;
  const cv::Size size(static_cast<int>(std::lround(std::abs(c) * w + std::abs(s) * h)) + 1,
                      static_cast<int>(std::lround(std::abs(s) * w + std::abs(c) * h)) + 1);
  TurnedImage image;
  image.turned_from_image = {c,  s, (size.width - 1) / 2.0 - (c * w + s * h) / 2,
                             -s, c, (size.height - 1) / 2.0 - (c * h - s * w) / 2};
  cv::warpAffine(grey, image.grey, image.turned_from_image, size, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return image;
}

/// Letters that are read, weighted by how surely: what is not text, or stands on its head, gives few.
double legibility(const std::vector<TextWord>& words) {
  double sum = 0;
  for (const TextWord& word : words)
    for (const std::string& run : letter_runs(word.text))
      if (letters(run) >= kMinLetters)
        sum += std::pow(word.confidence, 4) * static_cast<double>(letters(run));
  return sum;
}

}  // namespace

struct TextReader::Engine {
  tesseract::TessBaseAPI api;

  void look(tesseract::PageSegMode mode, const TurnedImage& turned, double zoom, const cv::Size& size,
            double min_confidence, std::vector<TextWord>& words) {
    cv::Mat grey;
    cv::copyMakeBorder(turned.grey, grey, kMargin, kMargin, kMargin, kMargin, cv::BORDER_REPLICATE);
    cv::Matx23d image_from_turned;
    cv::invertAffineTransform(turned.turned_from_image, image_from_turned);
    api.SetPageSegMode(mode);
    api.SetImage(grey.data, grey.cols, grey.rows, 1, static_cast<int>(grey.step));
    api.SetSourceResolution(300);
    if (api.Recognize(nullptr) != 0) return;
    const std::unique_ptr<tesseract::ResultIterator> it(api.GetIterator());
    if (!it) return;
    do {
      const std::unique_ptr<char[]> text(it->GetUTF8Text(tesseract::RIL_WORD));
      TextWord word;
      word.confidence = static_cast<double>(it->Confidence(tesseract::RIL_WORD)) / 100;
      int left = 0, top = 0, right = 0, bottom = 0;
      if (!text || word.confidence < min_confidence ||
          !it->BoundingBox(tesseract::RIL_WORD, &left, &top, &right, &bottom))
        continue;
      word.text = text.get();
      std::vector<cv::Point2d> corners;
      for (const int x : {left, right})
        for (const int y : {top, bottom}) {
          const cv::Vec2d at = image_from_turned * cv::Vec3d(x - kMargin, y - kMargin, 1);
          corners.emplace_back(at[0] / zoom, at[1] / zoom);
        }
      cv::Point low(corners[0]), high(corners[0]);
      for (const cv::Point corner : corners) {
        low = {std::min(low.x, corner.x), std::min(low.y, corner.y)};
        high = {std::max(high.x, corner.x), std::max(high.y, corner.y)};
      }
      word.region = cv::Rect(low, high) & cv::Rect({}, size);
      if (word.text.find_first_not_of(" \t\n") != std::string::npos) words.push_back(std::move(word));
    } while (it->Next(tesseract::RIL_WORD));
  }
};

TextReader::TextReader(const std::string& language) : engine_(std::make_unique<Engine>()) {
  engine_->api.SetVariable("debug_file", "/dev/null");
  if (engine_->api.Init(nullptr, language.c_str(), tesseract::OEM_LSTM_ONLY) != 0)
    throw Error("Tesseract has no data for the language '" + language + "'", {},
                "install tesseract-ocr-" + language + " (./setup installs English)");
}
TextReader::~TextReader() = default;
TextReader::TextReader(TextReader&&) noexcept = default;

std::vector<TextWord> TextReader::read(const cv::Mat& image, double min_confidence,
                                       TextOrientation orientation) const {
  cv::Mat grey = image, large;
  if (image.channels() == 3) cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  const double zoom = std::min(kMaxZoom, kSide / std::max(grey.cols, grey.rows));
  cv::resize(grey, large, {}, zoom, zoom, zoom < 1 ? cv::INTER_AREA : cv::INTER_CUBIC);
  std::vector<TextWord> words;
  const auto look = [&](tesseract::PageSegMode mode, const TurnedImage& view) {
    std::vector<TextWord> seen;
    engine_->look(mode, view, zoom, image.size(), min_confidence, seen);
    return seen;
  };
  TurnedImage best = turned(large, 0);
  words = look(tesseract::PSM_SPARSE_TEXT, best);
  double most = legibility(words);
  if (orientation == TextOrientation::any && most < kLegible) {
    const double skew = skew_of(large);
    for (const double quarter : {0.0, 90.0, 180.0, 270.0}) {
      if (most >= kLegible || (quarter == 0 && std::abs(skew) < kLevel)) continue;
      const TurnedImage view = turned(large, skew + quarter);
      std::vector<TextWord> seen = look(tesseract::PSM_SPARSE_TEXT, view);
      const double here = legibility(seen);
      if (here <= most) continue;
      most = here;
      best = view;
      words = std::move(seen);
    }
  }
  for (TextWord& word : look(tesseract::PSM_SINGLE_BLOCK, best)) words.push_back(std::move(word));
  return words;
}

std::vector<RankedWord> rank_words(const std::vector<TextWord>& words, size_t most) {
  std::map<std::string, RankedWord> counts;
  for (const TextWord& word : words)
    for (const std::string& run : letter_runs(word.text)) {
      const std::string key = lower_case(run);
      if (letters(run) < kMinLetters || is_common(key)) continue;
      RankedWord& ranked = counts[key];
      if (ranked.count++ == 0) ranked.word = run;
      if (word.confidence <= ranked.confidence) continue;
      ranked.confidence = word.confidence;
      ranked.region = word.region;
    }
  std::vector<RankedWord> ranked;
  for (auto& [key, word] : counts) ranked.push_back(std::move(word));
  std::stable_sort(ranked.begin(), ranked.end(), [](const RankedWord& a, const RankedWord& b) {
    return a.count != b.count ? a.count > b.count : a.confidence > b.confidence;
  });
  if (ranked.size() > most) ranked.resize(most);
  return ranked;
}

}  // namespace loci::perception
