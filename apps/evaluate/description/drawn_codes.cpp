#include "apps/evaluate/description/drawn_codes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <opencv2/imgproc.hpp>

#include "mapping/base/math/math.h"
#include "mapping/base/math/random.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/temporary_folder.h"
#include "mapping/base/text/json.h"
#include "mapping/image/image_io.h"
#include "perception/recognition/barcode_reader.h"

namespace loci::apps::description_evaluation {
namespace {

namespace fs = std::filesystem;

/// A symbology, as zint draws it with two pixels per module.
struct Symbology {
  std::string name;
  std::string options;  ///< of zint
  std::string content;
};

const std::vector<Symbology>& symbologies() {
  static const std::vector<Symbology> all = {{"EAN-13", "-b 14", "4006381333931"},
                                             {"EAN-8", "-b 14", "96385074"},
                                             {"UPC-A", "-b 34", "036000291452"},
                                             {"Code 128", "-b 20", "LOCI-2026-A7"},
                                             {"Code 39", "-b 8", "SHELF 42"},
                                             {"Interleaved 2 of 5", "-b 3", "1234567890"},
                                             {"QR", "-b 58 --scale=2", "https://example.org/milk"},
                                             {"Data Matrix", "-b 71 --scale=2", "010400638133393117261123"},
                                             {"PDF417", "-b 55", "Best before 2026-11-23"},
                                             {"Aztec", "-b 92 --scale=2", "M1DOE/JANE LOCI 0042"}};
  return all;
}

constexpr int kBackground = 205;

cv::Mat turned(const cv::Mat& image, double degrees) {
  const cv::Point2f middle(static_cast<float>(image.cols) / 2, static_cast<float>(image.rows) / 2);
  cv::Mat result;
  cv::warpAffine(image, result, cv::getRotationMatrix2D(middle, degrees, 1), image.size(), cv::INTER_LINEAR,
                 cv::BORDER_CONSTANT, cv::Scalar(kBackground));
  return result;
}

cv::Mat seen_from_the_side(const cv::Mat& image) {
  const auto w = static_cast<float>(image.cols), h = static_cast<float>(image.rows);
  const cv::Mat map = cv::getPerspectiveTransform(
      std::vector<cv::Point2f>{{0, 0}, {w, 0}, {w, h}, {0, h}},
      std::vector<cv::Point2f>{
          {0.1F * w, 0.08F * h}, {0.85F * w, 0.25F * h}, {0.85F * w, 0.75F * h}, {0.1F * w, 0.92F * h}});
  cv::Mat result;
  cv::warpPerspective(image, result, map, image.size(), cv::INTER_LINEAR, cv::BORDER_CONSTANT,
                      cv::Scalar(kBackground));
  return result;
}

/// On a can, whose axis is upright.
cv::Mat around_a_can(const cv::Mat& image) {
  constexpr double kRadius = 0.42;  // of the image's width
  cv::Mat x(image.size(), CV_32F), y(image.size(), CV_32F), result;
  for (int v = 0; v < image.rows; ++v)
    for (int u = 0; u < image.cols; ++u) {
      const double across = (u - image.cols / 2.0) / (kRadius * image.cols);
      x.at<float>(v, u) =
          std::abs(across) < 1 ? static_cast<float>(image.cols * (0.5 + kRadius * std::asin(across))) : -1;
      y.at<float>(v, u) = static_cast<float>(v);
    }
  cv::remap(image, result, x, y, cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar(kBackground));
  return result;
}

cv::Mat unevenly_lit(const cv::Mat& image) {
  cv::Mat result = image.clone();
  for (int v = 0; v < image.rows; ++v)
    for (int u = 0; u < image.cols; ++u)
      result.at<uchar>(v, u) = cv::saturate_cast<uchar>(
          image.at<uchar>(v, u) * (0.12 + 0.88 * u / image.cols) + 40.0 * (image.rows - v) / image.rows);
  return result;
}

cv::Mat noisy(const cv::Mat& image) {
  Random draw(7);
  cv::Mat result = image.clone();
  for (int i = 0; i < static_cast<int>(result.total()); ++i)
    result.data[i] = cv::saturate_cast<uchar>(result.data[i] + draw.normal(45));
  return result;
}

cv::Mat moved(const cv::Mat& image) {
  cv::Mat result;
  cv::blur(image, result, {5, 1});
  return result;
}

cv::Mat blurred(const cv::Mat& image) {
  cv::Mat result;
  cv::GaussianBlur(image, result, {0, 0}, 1.6);
  return result;
}

cv::Mat smaller(const cv::Mat& image) {
  cv::Mat result;
  cv::resize(image, result, {}, 0.6, 0.6, cv::INTER_AREA);
  return result;
}

const std::vector<std::pair<std::string, std::function<cv::Mat(const cv::Mat&)>>>& distortions() {
  static const std::vector<std::pair<std::string, std::function<cv::Mat(const cv::Mat&)>>> all = {
      {"none", [](const cv::Mat& image) { return image; }},
      {"turned by 20 degrees", [](const cv::Mat& image) { return turned(image, 20); }},
      {"turned by 45 degrees", [](const cv::Mat& image) { return turned(image, 45); }},
      {"turned by 90 degrees", [](const cv::Mat& image) { return turned(image, 90); }},
      {"upside down", [](const cv::Mat& image) { return turned(image, 180); }},
      {"1.2 pixels per module", smaller},
      {"blurred", blurred},
      {"moved", moved},
      {"noise", noisy},
      {"weak contrast", [](const cv::Mat& image) { return cv::Mat(image * 0.12 + 90); }},
      {"uneven light", unevenly_lit},
      {"from the side", seen_from_the_side},
      {"on a can", around_a_can}};
  return all;
}

/// On a square of background, so that no turn cuts it off.
cv::Mat drawn(const Symbology& symbology, const fs::path& folder) {
  const fs::path file = folder / "code.png";
  const std::string command = fmt::format("zint {} --quietzones -d '{}' -o '{}' >/dev/null 2>&1",
                                          symbology.options, symbology.content, file.string());
  if (std::system(command.c_str()) != 0)
    throw Error("zint did not draw " + symbology.name, {}, "install zint 2.11");
  cv::Mat code;
  cv::cvtColor(mapping::read_color(file), code, cv::COLOR_BGR2GRAY);
  const int side = static_cast<int>(1.5 * std::hypot(code.cols, code.rows)) / 2 * 2;
  cv::Mat image(side, side, CV_8U, cv::Scalar(kBackground));
  code.copyTo(image(cv::Rect((side - code.cols) / 2, (side - code.rows) / 2, code.cols, code.rows)));
  return image;
}

bool read_by_zbarimg(const cv::Mat& image, const std::string& content, const fs::path& folder) {
  mapping::write_image(folder / "image.png", image);
  const std::string command = fmt::format("zbarimg -q --raw '{}' 2>/dev/null | grep -qE '^0?{}$'",
                                          (folder / "image.png").string(), content);
  return std::system(command.c_str()) == 0;
}

}  // namespace

bool can_draw_codes() {
  return std::system("command -v zint >/dev/null 2>&1") == 0;
}

DrawnCodesResult evaluate_drawn_codes(Progress& progress, const std::set<std::string>& names) {
  if (!can_draw_codes())
    throw Error("zint is not installed", {}, "apt install zint (and zbar-tools for the peer)");
  const TemporaryFolder folder("loci-evaluate-codes");
  DrawnCodesResult result;
  result.has_peer = std::system("command -v zbarimg >/dev/null 2>&1") == 0;
  double done = 0;
  for (const Symbology& symbology : symbologies()) {
    if (!names.empty() && !names.contains(symbology.name)) continue;
    const cv::Mat image = drawn(symbology, folder.path());
    for (const auto& [name, distort] : distortions()) {
      progress.check(done++ / static_cast<double>(symbologies().size() * distortions().size()), "codes");
      const cv::Mat seen = distort(image);
      const auto is_right = [&](const perception::Barcode& code) {
        return perception::without_leading_zero(code.code) ==
               perception::without_leading_zero(symbology.content);
      };
      const bool plain = std::ranges::any_of(perception::read_barcodes(seen, false), is_right);
      const Stopwatch watch;
      const std::vector<perception::Barcode> codes = perception::read_barcodes(seen);
      result.seconds += watch.seconds();
      const auto right = std::ranges::count_if(codes, is_right);
      result.wrong += static_cast<int>(static_cast<std::ptrdiff_t>(codes.size()) - right);
      const bool by_peer = result.has_peer && read_by_zbarimg(seen, symbology.content, folder.path());
      for (DrawnCodesScore* score :
           {&result.all, &result.by_symbology[symbology.name], &result.by_distortion[name]}) {
        ++score->images;
        score->plain += plain;
        score->right += right > 0;
        score->zbarimg += by_peer;
      }
    }
  }
  return result;
}

std::string DrawnCodesResult::text() const {
  std::string text =
      fmt::format("drawn codes: {} wrong, {:.2f} s an image\n  {:<24}{:>8}{:>8}{:>8}{:>10}\n", wrong,
                  seconds / std::max(1, all.images), "", "images", "plain", "read", "zbarimg");
  const auto line = [&](const std::string& name, const DrawnCodesScore& score) {
    text += fmt::format("  {:<24}{:>8}{:>8}{:>8}{:>10}\n", name, score.images, score.plain, score.right,
                        has_peer ? std::to_string(score.zbarimg) : "-");
  };
  for (const auto& [name, score] : by_symbology) line(name, score);
  for (const auto& [name, score] : by_distortion) line(name, score);
  line("all", all);
  return text;
}

Json DrawnCodesResult::to_json() const {
  const auto score_to_json = [](const DrawnCodesScore& score) {
    return Json{
        {"images", score.images}, {"plain", score.plain}, {"right", score.right}, {"zbarimg", score.zbarimg}};
  };
  Json json = score_to_json(all);
  json.update({{"wrong", wrong}, {"seconds", seconds}, {"has_peer", has_peer}});
  for (const auto& [name, score] : by_symbology) json["symbologies"][name] = score_to_json(score);
  for (const auto& [name, score] : by_distortion) json["distortions"][name] = score_to_json(score);
  return json;
}

}  // namespace loci::apps::description_evaluation
