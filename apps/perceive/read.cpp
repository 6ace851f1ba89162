#include <fmt/format.h>

#include <optional>

#include "apps/perceive/commands.h"
#include "mapping/base/json.h"
#include "mapping/base/stopwatch.h"
#include "mapping/image/image_io.h"
#include "perception/recognition/barcode_reader.h"
#include "perception/recognition/text_reader.h"

namespace loci::apps {
namespace {

struct Arguments {
  std::vector<std::string> images;
  std::string language = "eng";
  double min_confidence = 0.5;
  bool no_text = false;
};

Json region_json(const cv::Rect& region) {
  return {region.x, region.y, region.width, region.height};
}

void read(const Arguments& given, Session& session) {
  std::optional<perception::TextReader> reader;
  if (!given.no_text) reader.emplace(given.language);
  std::string text;
  Json answers = Json::array();
  for (const std::string& path : given.images) {
    const cv::Mat image = mapping::read_color(path);
    const Stopwatch watch;
    Json codes = Json::array(), words = Json::array(), terms = Json::array();
    text += path + "\n";
    for (const perception::Barcode& code : perception::read_barcodes(image)) {
      text += fmt::format("  {} {}{}\n", code.symbology, code.code,
                          code.preparation.empty() ? "" : " (image " + code.preparation + ")");
      codes.push_back({{"symbology", code.symbology},
                       {"code", code.code},
                       {"preparation", code.preparation},
                       {"region", region_json(code.region)}});
    }
    const std::vector<perception::TextWord> found =
        reader ? reader->read(image, given.min_confidence) : std::vector<perception::TextWord>();
    for (const perception::TextWord& word : found)
      words.push_back(
          {{"text", word.text}, {"confidence", word.confidence}, {"region", region_json(word.region)}});
    for (const perception::RankedWord& word : rank_words(found)) {
      text += fmt::format("  {} {}\n", word.count, word.word);
      terms.push_back({{"word", word.word}, {"count", word.count}, {"confidence", word.confidence}});
    }
    session.timing(path, watch.seconds());
    answers.push_back({{"image", path}, {"barcodes", codes}, {"terms", terms}, {"words", words}});
  }
  session.answer(text, answers);
}

}  // namespace

Command read_command() {
  return {"read",
          "Barcodes, QR codes and printed words of images",
          {"loci-perceive read tests/data/images/ean13.png",
           "loci-perceive read tests/data/images/ean13.png tests/data/products/Oatly-Oat-Milk.jpg --json"},
          [](ArgumentTable& table) {
            auto given = std::make_shared<Arguments>();
            table.positional("IMAGE...", &given->images, "Images (PNG, JPEG)");
            table.option("--language", &given->language, "Of the text, as Tesseract names it");
            table.option("--min-confidence", &given->min_confidence, "Words that are less sure are left out",
                         {.min = 0.0, .max = 1.0});
            table.flag("--no-text", given->no_text, "Only codes");
            return [given](Session& session) { read(*given, session); };
          }};
}

}  // namespace loci::apps
