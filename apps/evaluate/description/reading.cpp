#include "apps/evaluate/description/reading.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <sstream>

#include "apps/evaluate/description/words.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/text/csv.h"
#include "mapping/base/text/json.h"
#include "mapping/image/image_io.h"
#include "perception/recognition/barcode_reader.h"
#include "perception/recognition/text_reader.h"

namespace loci::apps::description_evaluation {
namespace {

namespace fs = std::filesystem;

bool holds(const std::vector<perception::Barcode>& codes, const std::string& truth) {
  return std::any_of(codes.begin(), codes.end(), [&](const perception::Barcode& code) {
    return perception::without_leading_zero(code.code) == perception::without_leading_zero(truth);
  });
}

/// Length of the longest run of digits of `number` that is somewhere in `text`.
size_t longest_run(const std::string& number, const std::string& text) {
  size_t longest = 0;
  for (size_t begin = 0; begin < number.size(); ++begin)
    while (begin + longest < number.size() &&
           text.find(number.substr(begin, longest + 1)) != std::string::npos)
      ++longest;
  return longest;
}

void read_number(const perception::TextReader& reader, const cv::Mat& image, const std::string& number,
                 ReadingResult& result) {
  if (number.find_first_not_of("0123456789") != std::string::npos) return;
  std::string digits;
  for (const perception::TextWord& word : reader.read(image, 0))
    std::copy_if(word.text.begin(), word.text.end(), std::back_inserter(digits),
                 [](char c) { return c >= '0' && c <= '9'; });
  const size_t run = longest_run(number, digits);
  ++result.printed;
  result.printed_read += run == number.size();
  result.digits_read += static_cast<double>(run) / static_cast<double>(number.size());
}

void read_words(const perception::TextReader& reader, const fs::path& folder, ReadingResult& result) {
  const CsvTable table = CsvTable::read(folder / "visible_text.csv");
  const size_t file = table.require_column("file"), words = table.require_column("words");
  for (size_t row = 0; row < table.rows(); ++row) {
    std::set<std::string> read;
    for (const perception::TextWord& word :
         reader.read(mapping::read_color(folder / table.cell(row, file)), 0.5))
      read.insert(folded(word.text));
    std::istringstream stream(table.cell(row, words));
    for (std::string word; std::getline(stream, word, '|'); ++result.words)
      result.words_read += read.contains(folded(word));
  }
}

}  // namespace

ReadingResult evaluate_reading(const fs::path& folder, const fs::path& words, Progress& progress) {
  ReadingResult result;
  const perception::TextReader reader;
  const CsvTable table = CsvTable::read(folder / "expected.csv");
  const size_t file = table.require_column("file"), symbology = table.require_column("symbology"),
               text = table.require_column("text");
  for (size_t row = 0; row < table.rows(); ++row) {
    progress.check(static_cast<double>(row) / static_cast<double>(table.rows()), "codes");
    const cv::Mat image = mapping::read_color(folder / "images" / table.cell(row, file));
    const std::string& truth = table.cell(row, text);
    CodesScore& score = result.codes[table.cell(row, symbology)];
    ++score.images;
    score.plain += holds(perception::read_barcodes(image, false), truth);
    const Stopwatch watch;
    const std::vector<perception::Barcode> codes = perception::read_barcodes(image);
    result.seconds += watch.seconds();
    const bool right = holds(codes, truth);
    score.right += right;
    result.wrong += static_cast<int>(codes.size()) - right;
    if (!right) result.missed.push_back(table.cell(row, file));
    read_number(reader, image, truth, result);
  }
  if (result.printed > 0) result.digits_read /= result.printed;
  if (!words.empty() && fs::exists(words / "visible_text.csv")) read_words(reader, words, result);
  return result;
}

std::string ReadingResult::text() const {
  std::string text;
  CodesScore all;
  const auto line = [&](const std::string& name, const CodesScore& score) {
    text += fmt::format("  {:10}{:>4} of {:>2} read, {:>2} of them in the image as it is\n", name,
                        score.right, score.images, score.plain);
  };
  text += "codes:\n";
  for (const auto& [name, score] : codes) {
    line(name, score);
    all.images += score.images;
    all.plain += score.plain;
    all.right += score.right;
  }
  line("all", all);
  text += fmt::format("  {} wrong, {:.2f} s an image; not read: {}\n", wrong,
                      seconds / std::max(1, all.images), fmt::join(missed, ", "));
  text += fmt::format("printed numbers: {} of {} read whole, {:.0f} % of the digits in one piece\n",
                      printed_read, printed, 100 * digits_read);
  if (words > 0) text += fmt::format("words on packages: {} of {} read\n", words_read, words);
  return text;
}

Json ReadingResult::to_json() const {
  Json json = {{"codes", Json::object()},    {"wrong", wrong},     {"seconds", seconds},
               {"missed", missed},           {"printed", printed}, {"printed_read", printed_read},
               {"digits_read", digits_read}, {"words", words},     {"words_read", words_read}};
  for (const auto& [name, score] : codes)
    json["codes"][name] = {{"images", score.images}, {"plain", score.plain}, {"right", score.right}};
  return json;
}

}  // namespace loci::apps::description_evaluation
