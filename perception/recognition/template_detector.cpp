#include "perception/recognition/template_detector.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>

#include "mapping/base/error.h"
#include "mapping/base/math/math.h"
#include "mapping/base/text/json.h"

namespace loci::perception {
namespace {

constexpr std::array<double, 4> kScales = {0.8, 0.9, 1.0, 1.12};
constexpr std::array<double, 3> kTurnsDeg = {-12, 0, 12};
constexpr int kDirections = 8;
constexpr int kSpread = 8;           // Pixels by which a feature may be off.
constexpr int kStep = 4;             // Places are tried this far apart.
constexpr size_t kMaxFeatures = 60;  // of each kind
constexpr size_t kMinFeatures = 15;
constexpr double kMinGradient = 40;      // Grey values over a Sobel mask, summed.
constexpr float kSameSurface_m = 0.03f;  // Neighbours farther away tell nothing about a normal.
constexpr uint8_t kBest = 4;

using Maps = std::array<cv::Mat, 2>;  ///< gradients and normals: CV_8U, one bit per direction, 0 = none

/// Directions of gradients, a turn by 180 degrees being the same: dark and bright surroundings look alike.
cv::Mat quantised_gradients(const cv::Mat& color, cv::Mat& strength) {
  cv::Mat grey, dx, dy;
  cv::cvtColor(color, grey, cv::COLOR_BGR2GRAY);
  cv::GaussianBlur(grey, grey, {7, 7}, 0);
  cv::Sobel(grey, dx, CV_32F, 1, 0);
  cv::Sobel(grey, dy, CV_32F, 0, 1);
  cv::magnitude(dx, dy, strength);
  cv::Mat bits = cv::Mat::zeros(grey.size(), CV_8U);
  for (int v = 0; v < grey.rows; ++v)
    for (int u = 0; u < grey.cols; ++u) {
      if (static_cast<double>(strength.at<float>(v, u)) < kMinGradient) continue;
      double angle =
          std::atan2(static_cast<double>(dy.at<float>(v, u)), static_cast<double>(dx.at<float>(v, u)));
      if (angle < 0) angle += kPi;
      const int direction = static_cast<int>(angle / kPi * kDirections) % kDirections;
      bits.at<uint8_t>(v, u) = static_cast<uint8_t>(1 << direction);
    }
  return bits;
}

/// Directions to which surfaces lean, from how depth changes over some pixels; those that face the camera
/// have none.
cv::Mat quantised_normals(const cv::Mat& depth) {
  constexpr int kReach = 5;
  constexpr double kMinLean =
      0.1;  // Metres of depth per metre of width, at a focal length of some 500 pixels.
  constexpr double kFocal = 525;
  cv::Mat bits = cv::Mat::zeros(depth.size(), CV_8U);
  for (int v = kReach; v < depth.rows - kReach; ++v)
    for (int u = kReach; u < depth.cols - kReach; ++u) {
      const float here = depth.at<float>(v, u);
      const float left = depth.at<float>(v, u - kReach), right = depth.at<float>(v, u + kReach),
                  above = depth.at<float>(v - kReach, u), below = depth.at<float>(v + kReach, u);
      const bool same = std::abs(left - here) < kSameSurface_m && std::abs(right - here) < kSameSurface_m &&
                        std::abs(above - here) < kSameSurface_m && std::abs(below - here) < kSameSurface_m;
      if (!same) continue;  // Also where something was not measured.
      const double width = 2 * kReach * static_cast<double>(here) / kFocal;
      const double x = static_cast<double>(right - left) / width,
                   y = static_cast<double>(below - above) / width;
      if (std::hypot(x, y) < kMinLean) continue;
      const double turn = (std::atan2(y, x) / (2 * kPi) + 1) * kDirections;
      bits.at<uint8_t>(v, u) = static_cast<uint8_t>(1 << (static_cast<int>(turn) % kDirections));
    }
  return bits;
}

/// Every direction that is somewhere near.
cv::Mat spread(const cv::Mat& bits) {
  cv::Mat result = bits.clone();
  const auto or_shifted = [&](int dx, int dy) {
    const cv::Rect to(std::max(0, -dx), std::max(0, -dy), bits.cols - std::abs(dx), bits.rows - std::abs(dy));
    cv::Mat part = result(to);
    cv::bitwise_or(part, bits(to + cv::Point(dx, dy)), part);
  };
  for (int dy = -kSpread / 2; dy < kSpread / 2; ++dy)
    for (int dx = -kSpread / 2; dx < kSpread / 2; ++dx) or_shifted(dx, dy);
  return result;
}

/// How well spread directions answer a direction: best where it is among them, half where a neighbour is.
std::array<uint8_t, 256> answers_to(int direction) {
  std::array<uint8_t, 256> answers{};
  const int beside =
      1 << ((direction + 1) % kDirections) | 1 << ((direction + kDirections - 1) % kDirections);
  for (int bits = 0; bits < 256; ++bits)
    answers[static_cast<size_t>(bits)] = (bits >> direction & 1) ? kBest : (bits & beside) ? kBest / 2 : 0;
  return answers;
}

double overlap_of(const cv::Rect& a, const cv::Rect& b) {
  const double both = (a & b).area();
  return both / (a.area() + b.area() - both);
}

}  // namespace

struct TemplateDetector::View {
  struct Feature {
    int x = 0, y = 0, kind = 0, direction = 0;
  };
  std::string name;
  cv::Size size;
  std::vector<Feature> features;
};

void TemplateOptions::declare(OptionTable& table) {
  table.number("min_similarity", min_similarity, "", "Minimum share of matching features of a template.", 0.1,
               1);
  table.number("overlap", overlap, "",
               "Maximum overlap of detections; of more overlapping ones the most similar is taken.", 0, 1);
}

TemplateDetector::TemplateDetector() = default;
TemplateDetector::~TemplateDetector() = default;
TemplateDetector::TemplateDetector(TemplateDetector&&) noexcept = default;
TemplateDetector& TemplateDetector::operator=(TemplateDetector&&) noexcept = default;

size_t TemplateDetector::templates() const {
  return views_.size();
}

bool TemplateDetector::add_view(const std::string& name, const cv::Mat& color, const cv::Mat& depth,
                                const cv::Mat& mask) {
  const cv::Rect box = cv::boundingRect(mask);
  if (box.empty()) return false;
  View view{name, box.size(), {}};
  cv::Mat strength, inside;
  const Maps maps = {quantised_gradients(color, strength), quantised_normals(depth)};
  cv::erode(mask, inside, cv::Mat::ones(5, 5, CV_8U));
  for (int kind = 0; kind < 2; ++kind) {
    const cv::Mat& allowed = kind == 0 ? mask : inside;
    std::vector<std::pair<float, cv::Point>> places;
    for (int v = box.y; v < box.br().y; ++v)
      for (int u = box.x; u < box.br().x; ++u)
        if (allowed.at<uint8_t>(v, u) > 0 && maps[static_cast<size_t>(kind)].at<uint8_t>(v, u) > 0)
          places.emplace_back(kind == 0 ? -strength.at<float>(v, u) : 0.0f, cv::Point(u, v));
    std::stable_sort(places.begin(), places.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    // Far from each other first, nearer when there are not enough.
    std::vector<cv::Point> chosen;
    for (double apart = std::sqrt(box.area() / 40.0); apart >= 2 && chosen.size() < kMaxFeatures;
         apart *= 0.7)
      for (const auto& [rank, at] : places) {
        if (chosen.size() >= kMaxFeatures) break;
        if (std::all_of(chosen.begin(), chosen.end(),
                        [&, &at = at](const cv::Point& other) { return cv::norm(at - other) >= apart; }))
          chosen.push_back(at);
      }
    for (const cv::Point& at : chosen)
      view.features.push_back({at.x - box.x, at.y - box.y, kind,
                               std::countr_zero(maps[static_cast<size_t>(kind)].at<uint8_t>(at))});
  }
  if (view.features.size() < kMinFeatures) return false;
  views_.push_back(std::move(view));
  return true;
}

int TemplateDetector::add(const std::string& name, const cv::Mat& color, const cv::Mat& depth,
                          const cv::Mat& mask) {
  if (color.size() != depth.size() || color.size() != mask.size())
    throw Error("templates need colour, depth and mask of the same size", {}, "register them first");
  const cv::Rect box = cv::boundingRect(mask);
  const cv::Point2f middle(static_cast<float>(box.x) + static_cast<float>(box.width) / 2,
                           static_cast<float>(box.y) + static_cast<float>(box.height) / 2);
  int kept = 0;
  for (const double scale : kScales)
    for (const double turn : kTurnsDeg) {
      const cv::Mat map = cv::getRotationMatrix2D(middle, turn, scale);
      cv::Mat seen, far, part;
      cv::warpAffine(color, seen, map, color.size(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
      cv::warpAffine(depth, far, map, color.size(), cv::INTER_NEAREST, cv::BORDER_CONSTANT,
                     cv::Scalar(std::nan("")));
      cv::warpAffine(mask, part, map, color.size(), cv::INTER_NEAREST);
      far /= scale;  // What is smaller in the image is farther.
      kept += add_view(name, seen, far, part) ? 1 : 0;
    }
  return kept;
}

std::vector<TemplateMatch> TemplateDetector::detect(const cv::Mat& color, const cv::Mat& depth,
                                                    const TemplateOptions& options) const {
  if (color.size() != depth.size())
    throw Error("templates need colour and depth of the same size", {}, "register them first");
  cv::Mat strength;
  const Maps near = {spread(quantised_gradients(color, strength)), spread(quantised_normals(depth))};
  // What every place answers to each direction, on the grid of places: [kind][direction][row offset][column
  // offset].
  const int columns = color.cols / kStep, rows = color.rows / kStep;
  std::map<std::array<int, 4>, cv::Mat> grids;
  for (int kind = 0; kind < 2; ++kind)
    for (int direction = 0; direction < kDirections; ++direction) {
      const std::array<uint8_t, 256> answers = answers_to(direction);
      for (int dy = 0; dy < kStep; ++dy)
        for (int dx = 0; dx < kStep; ++dx) {
          cv::Mat grid(rows, columns, CV_8U);
          for (int y = 0; y < rows; ++y)
            for (int x = 0; x < columns; ++x)
              grid.at<uint8_t>(y, x) =
                  answers[near[static_cast<size_t>(kind)].at<uint8_t>(y * kStep + dy, x * kStep + dx)];
          grids[{kind, direction, dy, dx}] = grid;
        }
    }
  std::vector<TemplateMatch> all, best;
  for (const View& view : views_) {
    const int across = columns - (view.size.width + kStep - 1) / kStep,
              down = rows - (view.size.height + kStep - 1) / kStep;
    if (across <= 0 || down <= 0) continue;
    cv::Mat sum = cv::Mat::zeros(down, across, CV_16U);
    for (const View::Feature& feature : view.features) {
      const cv::Mat& grid = grids.at({feature.kind, feature.direction, feature.y % kStep, feature.x % kStep});
      cv::add(sum, grid(cv::Rect(feature.x / kStep, feature.y / kStep, across, down)), sum, cv::noArray(),
              CV_16U);
    }
    const double most = kBest * static_cast<double>(view.features.size());
    for (int y = 0; y < down; ++y)
      for (int x = 0; x < across; ++x)
        if (const double similarity = sum.at<uint16_t>(y, x) / most; similarity >= options.min_similarity)
          all.push_back({view.name, similarity, cv::Rect({x * kStep, y * kStep}, view.size)});
  }
  std::stable_sort(all.begin(), all.end(), [](const TemplateMatch& a, const TemplateMatch& b) {
    return a.similarity > b.similarity;
  });
  for (const TemplateMatch& match : all)
    if (std::none_of(best.begin(), best.end(), [&](const TemplateMatch& other) {
          return overlap_of(match.region, other.region) > options.overlap;
        }))
      best.push_back(match);
  return best;
}

void TemplateDetector::save(const std::filesystem::path& path) const {
  Json views = Json::array();
  for (const View& view : views_) {
    Json features = Json::array();
    for (const View::Feature& f : view.features) features.push_back({f.x, f.y, f.kind, f.direction});
    views.push_back(
        {{"name", view.name}, {"size", {view.size.width, view.size.height}}, {"features", features}});
  }
  write_json(path, {{"kind", "loci templates"}, {"version", 1}, {"views", std::move(views)}});
}

TemplateDetector TemplateDetector::load(const std::filesystem::path& path) try {
  const Json json = read_json(path);
  if (!json.is_object() || json.value("kind", "") != "loci templates" || json.at("version") != 1)
    throw Error("these are no templates", {path.string(), 0, {}},
                "make some with `loci-perceive train --templates`");
  TemplateDetector loaded;
  for (const Json& each : json.at("views")) {
    View view{each.at("name"), {each.at("size").at(0).get<int>(), each.at("size").at(1).get<int>()}, {}};
    for (const Json& f : each.at("features")) {
      const View::Feature feature{f.at(0), f.at(1), f.at(2), f.at(3)};
      const bool sound = feature.x >= 0 && feature.x < view.size.width && feature.y >= 0 &&
                         feature.y < view.size.height && (feature.kind == 0 || feature.kind == 1) &&
                         feature.direction >= 0 && feature.direction < kDirections;
      if (!sound)
        throw Error("the templates contradict themselves", {path.string(), 0, {}}, "make them anew");
      view.features.push_back(feature);
    }
    loaded.views_.push_back(std::move(view));
  }
  return loaded;
} catch (const nlohmann::json::exception&) {
  throw Error("the templates contradict themselves", {path.string(), 0, {}}, "make them anew");
}

}  // namespace loci::perception
