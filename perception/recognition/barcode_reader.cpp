#include "perception/recognition/barcode_reader.h"

#include <zbar.h>

// After ZBar, whose names its macros would replace.
#define ZX_USE_UTF8 1  // text() as UTF-8
#include <ZXing/ReadBarcode.h>

#include <algorithm>
#include <functional>
#include <map>
#include <opencv2/imgproc.hpp>
#include <set>

namespace loci::perception {
namespace {

std::string symbology_of(ZXing::BarcodeFormat format) {
  switch (format) {
    case ZXing::BarcodeFormat::EAN13:
      return "EAN-13";
    case ZXing::BarcodeFormat::EAN8:
      return "EAN-8";
    case ZXing::BarcodeFormat::UPCA:
      return "UPC-A";
    case ZXing::BarcodeFormat::UPCE:
      return "UPC-E";
    case ZXing::BarcodeFormat::QRCode:
      return "QR";
    case ZXing::BarcodeFormat::DataMatrix:
      return "Data Matrix";
    case ZXing::BarcodeFormat::PDF417:
      return "PDF417";
    case ZXing::BarcodeFormat::Aztec:
      return "Aztec";
    case ZXing::BarcodeFormat::Code128:
      return "Code 128";
    case ZXing::BarcodeFormat::Code93:
      return "Code 93";
    case ZXing::BarcodeFormat::Code39:
      return "Code 39";
    case ZXing::BarcodeFormat::Codabar:
      return "Codabar";
    case ZXing::BarcodeFormat::ITF:
      return "Interleaved 2 of 5";
    default:
      return {};
  }
}

std::string symbology_of(zbar::zbar_symbol_type_t type) {
  switch (type) {
    case zbar::ZBAR_EAN13:
    case zbar::ZBAR_ISBN13:
      return "EAN-13";
    case zbar::ZBAR_EAN8:
      return "EAN-8";
    case zbar::ZBAR_UPCA:
      return "UPC-A";
    case zbar::ZBAR_UPCE:
      return "UPC-E";
    case zbar::ZBAR_QRCODE:
      return "QR";
    case zbar::ZBAR_CODE128:
      return "Code 128";
    case zbar::ZBAR_CODE93:
      return "Code 93";
    case zbar::ZBAR_CODE39:
      return "Code 39";
    case zbar::ZBAR_CODABAR:
      return "Codabar";
    case zbar::ZBAR_I25:
      return "Interleaved 2 of 5";
    default:
      return {};  // Add-ons of books and what is as good as never on a package, but often read into noise.
  }
}

/// Codes of areas, whose error correction no noise passes.
bool is_matrix(const Barcode& code) {
  return code.symbology == "QR" || code.symbology == "Data Matrix" || code.symbology == "PDF417" ||
         code.symbology == "Aztec";
}

/// Whether a code carries enough checks to be taken from a changed image.
bool is_checked(const Barcode& code) {
  return code.symbology.starts_with("EAN") || code.symbology == "UPC-A" || code.symbology == "Code 128" ||
         is_matrix(code);
}

std::vector<Barcode> scan_with_zbar(const cv::Mat& pixels) {
  zbar::ImageScanner scanner;
  scanner.set_config(zbar::ZBAR_NONE, zbar::ZBAR_CFG_ENABLE, 1);
  scanner.set_config(zbar::ZBAR_DATABAR, zbar::ZBAR_CFG_ENABLE, 0);
  scanner.set_config(zbar::ZBAR_DATABAR_EXP, zbar::ZBAR_CFG_ENABLE, 0);
  scanner.set_config(zbar::ZBAR_UPCA, zbar::ZBAR_CFG_ENABLE, 1);
  zbar::Image image(static_cast<unsigned>(pixels.cols), static_cast<unsigned>(pixels.rows), "Y800",
                    pixels.data, pixels.total());
  scanner.scan(image);
  std::vector<Barcode> codes;
  for (auto symbol = image.symbol_begin(); symbol != image.symbol_end(); ++symbol) {
    Barcode code{symbology_of(symbol->get_type()), symbol->get_data(), {}, {}};
    std::vector<cv::Point> outline;
    for (unsigned i = 0; i < static_cast<unsigned>(symbol->get_location_size()); ++i)
      outline.emplace_back(symbol->get_location_x(i), symbol->get_location_y(i));
    if (!outline.empty()) code.region = cv::boundingRect(outline);
    codes.push_back(std::move(code));
  }
  return codes;
}

std::vector<Barcode> scan_with_zxing(const cv::Mat& pixels) {
  using Format = ZXing::BarcodeFormat;
  // One code of bars at most: ZXing 1.4 aborts when it compares two that have several lines each (ZBar reads
  // all).
  const auto bars = ZXing::DecodeHints().setMaxNumberOfSymbols(1).setFormats(
      Format::EAN13 | Format::EAN8 | Format::UPCA | Format::UPCE | Format::Code128 | Format::Code93 |
      Format::Code39 | Format::Codabar | Format::ITF);
  const auto matrices =
      ZXing::DecodeHints().setFormats(Format::QRCode | Format::DataMatrix | Format::PDF417 | Format::Aztec);
  std::vector<Barcode> codes;
  const ZXing::ImageView view(pixels.data, pixels.cols, pixels.rows, ZXing::ImageFormat::Lum);
  for (const ZXing::DecodeHints& hints : {bars, matrices})
    for (const ZXing::Result& result : ZXing::ReadBarcodes(view, hints)) {
      Barcode code{symbology_of(result.format()), result.text(), {}, {}};
      std::vector<cv::Point> outline;
      for (const ZXing::PointI& corner : result.position()) outline.emplace_back(corner.x, corner.y);
      code.region = cv::boundingRect(outline) & cv::Rect({}, pixels.size());
      codes.push_back(std::move(code));
    }
  return codes;
}

/// What ZBar and ZXing read in an image; `agreed`: the codes that both read.
std::vector<Barcode> scan(const cv::Mat& grey, std::set<std::string>* agreed = nullptr) {
  const cv::Mat pixels = grey.isContinuous() ? grey : grey.clone();
  std::vector<Barcode> codes = scan_with_zbar(pixels);
  for (Barcode& code : scan_with_zxing(pixels)) {
    const bool known = std::ranges::any_of(codes, [&](const Barcode& other) {
      return without_leading_zero(other.code) == without_leading_zero(code.code);
    });
    if (!known)
      codes.push_back(std::move(code));
    else if (agreed != nullptr)
      agreed->insert(without_leading_zero(code.code));
  }
  std::erase_if(codes, [](const Barcode& code) { return code.symbology.empty() || code.code.empty(); });
  std::sort(codes.begin(), codes.end(), [](const Barcode& a, const Barcode& b) {
    return std::tie(a.region.x, a.region.y, a.symbology, a.code) <
           std::tie(b.region.x, b.region.y, b.symbology, b.code);
  });
  return codes;
}

using Filter = std::function<cv::Mat(const cv::Mat&)>;

cv::Mat sharpened(const cv::Mat& grey, double sigma, double strength) {
  cv::Mat soft, sharp;
  cv::GaussianBlur(grey, soft, {0, 0}, sigma);
  cv::addWeighted(grey, 1 + strength, soft, -strength, 0, sharp);
  return sharp;
}

cv::Mat evenly_lit(const cv::Mat& grey) {
  cv::Mat even;
  cv::createCLAHE(3, {8, 8})->apply(grey, even);
  return even;
}

cv::Mat black_and_white(const cv::Mat& grey) {
  cv::Mat binary;
  cv::adaptiveThreshold(grey, binary, 255, cv::ADAPTIVE_THRESH_GAUSSIAN_C, cv::THRESH_BINARY, 31, 5);
  return binary;
}

/// Along bars, blur takes noise and leaves edges.
cv::Mat smoothed_upwards(const cv::Mat& grey) {
  cv::Mat smooth;
  cv::GaussianBlur(grey, smooth, {1, 31}, 0, 8);
  return smooth;
}

const std::vector<std::pair<std::string, Filter>>& filters() {
  static const std::vector<std::pair<std::string, Filter>> all = {
      {"", [](const cv::Mat& grey) { return grey; }},
      {"sharpened", [](const cv::Mat& grey) { return sharpened(grey, 1, 1.5); }},
      {"deblurred", [](const cv::Mat& grey) { return sharpened(grey, 2, 4); }},
      {"evenly lit", evenly_lit},
      {"smoothed along the bars", smoothed_upwards},
      {"black and white", black_and_white}};
  return all;
}

struct Frame {
  std::string name;
  double scale = 1, turn_deg = 0;
};

const std::vector<Frame>& frames() {
  static const std::vector<Frame> all = {{"", 1, 0},
                                         {"twice as large", 2, 0},
                                         {"half as large", 0.5, 0},
                                         {"turned by 30 degrees", 1, 30},
                                         {"turned by -30 degrees", 1, -30},
                                         {"three times as large", 3, 0}};
  return all;
}

/// The image in a frame; `back` maps its pixels to those of the given one.
cv::Mat framed(const cv::Mat& grey, const Frame& frame, cv::Mat& back) {
  const cv::Point2f middle(static_cast<float>(grey.cols) / 2, static_cast<float>(grey.rows) / 2);
  cv::Mat map = cv::getRotationMatrix2D(middle, frame.turn_deg, frame.scale), result;
  map.at<double>(0, 2) += static_cast<double>(middle.x) * (frame.scale - 1);
  map.at<double>(1, 2) += static_cast<double>(middle.y) * (frame.scale - 1);
  cv::invertAffineTransform(map, back);
  const cv::Size size(static_cast<int>(grey.cols * frame.scale), static_cast<int>(grey.rows * frame.scale));
  if (frame.turn_deg == 0)
    cv::resize(grey, result, size, 0, 0, frame.scale < 1 ? cv::INTER_AREA : cv::INTER_CUBIC);
  else
    cv::warpAffine(grey, result, map, size, cv::INTER_CUBIC, cv::BORDER_REPLICATE);
  return result;
}

cv::Rect mapped(const cv::Rect& region, const cv::Mat& back, const cv::Size& size) {
  std::vector<cv::Point2f> corners = {region.tl(),
                                      region.br(),
                                      {static_cast<float>(region.x), static_cast<float>(region.br().y)},
                                      {static_cast<float>(region.br().x), static_cast<float>(region.y)}};
  cv::transform(corners, corners, back);
  return cv::boundingRect(corners) & cv::Rect({}, size);
}

}  // namespace

std::string without_leading_zero(const std::string& code) {
  return code.size() == 13 && code[0] == '0' ? code.substr(1) : code;
}

std::vector<Barcode> read_barcodes(const cv::Mat& image, bool thorough) {
  cv::Mat grey = image;
  if (image.channels() == 3) cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  std::vector<Barcode> plain = scan(grey);
  if (!plain.empty() || !thorough) return plain;
  std::map<std::string, int> seen;
  for (const Frame& frame : frames()) {
    cv::Mat back;
    const cv::Mat framed_image = framed(grey, frame, back);
    if (std::min(framed_image.cols, framed_image.rows) < 16) continue;
    for (const auto& [name, filter] : filters()) {
      std::vector<Barcode> agreed;
      std::set<std::string> read_by_both;
      for (Barcode& code : scan(filter(framed_image), &read_by_both)) {
        if (!is_checked(code)) continue;
        const std::string number = without_leading_zero(code.code);
        seen[number] += is_matrix(code) || read_by_both.contains(number) ? 2 : 1;
        if (seen[number] < 2) continue;
        code.region = mapped(code.region, back, grey.size());
        code.preparation = frame.name + (frame.name.empty() || name.empty() ? "" : ", ") + name;
        agreed.push_back(std::move(code));
      }
      if (!agreed.empty()) return agreed;
    }
  }
  return {};
}

}  // namespace loci::perception
