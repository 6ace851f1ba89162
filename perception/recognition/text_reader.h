#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace loci::perception {

struct TextWord {
  std::string text;
  double confidence = 0;  ///< Tesseract's, 0 to 1
  cv::Rect region;        ///< pixels of the image
};

/// A word with how often it was read.
struct RankedWord {
  std::string word;  ///< as it was written the first time
  int count = 0;
  double confidence = 0;  ///< of the surest reading
  cv::Rect region;        ///< likewise
};

/// How text may stand in an image.
enum class TextOrientation {
  upright,  ///< a few degrees off at most
  any,      ///< up to three times the work where there is little text to read
};

/// Reads printed text with Tesseract. One image at a time.
class TextReader {
 public:
  /// `language` as Tesseract names it ("eng", "deu+eng"). Error when its data is not installed.
  explicit TextReader(const std::string& language = "eng");
  ~TextReader();
  TextReader(TextReader&&) noexcept;

  /// Words of an image (CV_8UC1 or CV_8UC3 BGR), small ones enlarged first, that Tesseract is sure of by at
  /// least `min_confidence`. Where text may be turned and too little is read upright, the image is levelled
  /// by the directions of its edges and read in four orientations; that of the surest letters counts, and at
  /// most six looks are taken. Scattered words and blocks of text are looked for: a word may come twice.
  std::vector<TextWord> read(const cv::Mat& image, double min_confidence = 0.5,
                             TextOrientation orientation = TextOrientation::any) const;

 private:
  struct Engine;
  std::unique_ptr<Engine> engine_;
};

/// The words that describe what was read (§5.4.5): strings of at least three letters, but for common words,
/// by how often they occur, then by confidence; upper and lower case alike.
std::vector<RankedWord> rank_words(const std::vector<TextWord>& words, size_t most = 5);

}  // namespace loci::perception
