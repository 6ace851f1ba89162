#include "perception/recognition/text_reader.h"

#include <tesseract/baseapi.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>
#include <set>

#include "mapping/base/error.h"
#include "mapping/base/text.h"

namespace loci::perception {
namespace {

constexpr double kSide = 1200;  // pixels: letters of a package then are as high as those of a scanned page
constexpr double kMaxZoom = 3;  // more adds no detail
constexpr int kMargin = 12;     // letters at the border are not recognised
constexpr size_t kMinLetters = 3;

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

}  // namespace

struct TextReader::Engine {
  tesseract::TessBaseAPI api;

  void look(tesseract::PageSegMode mode, const cv::Mat& grey, double zoom, const cv::Size& size,
            double min_confidence, std::vector<TextWord>& words) {
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
      const auto pixel = [&](int value) { return static_cast<int>(std::lround((value - kMargin) / zoom)); };
      word.region = cv::Rect(cv::Point(pixel(left), pixel(top)), cv::Point(pixel(right), pixel(bottom))) &
                    cv::Rect({}, size);
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

std::vector<TextWord> TextReader::read(const cv::Mat& image, double min_confidence) const {
  cv::Mat grey = image, large;
  if (image.channels() == 3) cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  const double zoom = std::min(kMaxZoom, kSide / std::max(grey.cols, grey.rows));
  cv::resize(grey, large, {}, zoom, zoom, zoom < 1 ? cv::INTER_AREA : cv::INTER_CUBIC);
  cv::copyMakeBorder(large, large, kMargin, kMargin, kMargin, kMargin, cv::BORDER_REPLICATE);
  std::vector<TextWord> words;
  for (const auto mode : {tesseract::PSM_SPARSE_TEXT, tesseract::PSM_SINGLE_BLOCK})
    engine_->look(mode, large, zoom, image.size(), min_confidence, words);
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
