#include "perception/detection/network_detector.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <opencv2/dnn.hpp>
#include <opencv2/imgproc.hpp>

#include "mapping/base/text/text.h"

namespace loci::perception {
namespace {

constexpr size_t kMaxCandidates = 3000;  ///< whose overlaps are looked at: the best

struct Candidate {
  cv::Rect2d box;  ///< pixels of the image
  int kind = 0;
  double score = 0;
  const float* coefficients = nullptr;  ///< of its mask; null = none
  std::ptrdiff_t stride = 1;            ///< between two of them
};

/// The outputs of a network as rows of candidates, with the checks that make reading them safe.
class Outputs {
 public:
  Outputs(const std::vector<Network::Output>& outputs, const DetectorDescription& description)
      : description_(description), classes_(static_cast<int>(description.classes.size())) {
    if (description.layout == DetectorLayout::ssd)
      find_ssd(outputs);
    else
      find_yolo(outputs);
  }

  std::vector<Candidate> candidates(const InputFit& fit, const cv::Size& image) const {
    std::vector<Candidate> found;
    const int count = scores_->values.size[candidates_axis_];
    for (int i = 0; i < count; ++i) {
      Candidate candidate = this->candidate(i);
      if (!(candidate.score >= description_.min_score) || !(candidate.score <= 1)) continue;  // NaN, too
      const cv::Point2d low = fit.to_image(candidate.box.tl()), high = fit.to_image(candidate.box.br());
      candidate.box = cv::Rect2d(low, high) & cv::Rect2d(0, 0, image.width, image.height);
      if (candidate.box.width >= 1 && candidate.box.height >= 1) found.push_back(candidate);
    }
    std::ranges::stable_sort(found, std::greater<>(), &Candidate::score);
    if (found.size() > kMaxCandidates) found.resize(kMaxCandidates);
    return found;
  }

  /// (coefficients, rows, columns); null without masks.
  const cv::Mat* prototypes() const { return prototypes_; }

 private:
  [[noreturn]] void refuse(const std::vector<Network::Output>& outputs, const std::string& expected) const {
    std::string shapes;
    for (const Network::Output& output : outputs) {
      const std::vector<int> shape(output.values.size.p, output.values.size.p + output.values.dims);
      shapes += fmt::format("{}'{}' ({})", shapes.empty() ? "" : ", ", output.name, fmt::join(shape, ", "));
    }
    throw Error(
        fmt::format("the outputs of the model are {}, not {} for {} classes", shapes, expected, classes_),
        {description_.model.string(), 0, {}}, "check layout and classes of its description");
  }

  void find_yolo(const std::vector<Network::Output>& outputs) {
    const bool across = description_.layout == DetectorLayout::yolov8;
    first_class_ = across ? 4 : 5;
    for (const Network::Output& output : outputs) {
      if (output.values.dims == 3 && scores_ == nullptr) scores_ = &output;
      if (output.values.dims == 4 && prototypes_ == nullptr && output.values.size[0] == 1)
        prototypes_ = &output.values;
    }
    candidates_axis_ = across ? 2 : 1;
    const int coefficients = prototypes_ != nullptr ? prototypes_->size[1] : 0;
    if (scores_ == nullptr || scores_->values.size[0] != 1 ||
        scores_->values.size[across ? 1 : 2] != first_class_ + classes_ + coefficients)
      refuse(outputs, across ? "(1, 4 + classes, candidates)" : "(1, candidates, 5 + classes)");
  }

  void find_ssd(const std::vector<Network::Output>& outputs) {
    const auto names_boxes = [](const Network::Output& output) {
      return output.name.find("box") != std::string::npos || output.name.find("loc") != std::string::npos;
    };
    for (const Network::Output& output : outputs) {
      if (output.values.dims != 3 || output.values.size[0] != 1) continue;
      const bool boxes = output.values.size[2] == 4 && (classes_ != 3 || names_boxes(output));
      (boxes ? boxes_ : scores_) = &output;
    }
    if (boxes_ == nullptr || scores_ == nullptr || boxes_->values.size[1] != scores_->values.size[1] ||
        scores_->values.size[2] != classes_ + 1)
      refuse(outputs, "scores (1, candidates, 1 + classes) and boxes (1, candidates, 4)");
    first_class_ = 1;
  }

  Candidate candidate(int i) const {
    const cv::Mat& values = scores_->values;
    const bool across = candidates_axis_ == 2;
    const std::ptrdiff_t stride = across ? values.size[2] : 1;
    const float* row = values.ptr<float>() + (across ? i : std::ptrdiff_t{i} * values.size[2]);
    const auto at = [&](int k) { return static_cast<double>(row[k * stride]); };
    Candidate candidate;
    for (int k = 0; k < classes_; ++k)
      if (const double score = at(first_class_ + k); score > candidate.score) {
        candidate.score = score;
        candidate.kind = k;
      }
    if (boxes_ != nullptr) {
      const float* corners = boxes_->values.ptr<float>() + std::ptrdiff_t{i} * 4;
      const cv::Size& size = description_.input.size;
      const auto corner = [&](int k) {
        return cv::Point2d(static_cast<double>(corners[k]) * size.width,
                           static_cast<double>(corners[k + 1]) * size.height);
      };
      candidate.box = cv::Rect2d(corner(0), corner(2));
      return candidate;
    }
    if (description_.layout == DetectorLayout::yolov5) candidate.score *= at(4);
    candidate.box = {at(0) - at(2) / 2, at(1) - at(3) / 2, at(2), at(3)};
    if (prototypes_ != nullptr) {
      candidate.coefficients = row + (first_class_ + classes_) * stride;
      candidate.stride = stride;
    }
    return candidate;
  }

  const DetectorDescription& description_;
  int classes_;
  int first_class_ = 0;
  int candidates_axis_ = 1;
  const Network::Output* scores_ = nullptr;
  const Network::Output* boxes_ = nullptr;  ///< of ssd
  const cv::Mat* prototypes_ = nullptr;
};

/// Without those that overlap a better one of their class.
std::vector<Candidate> without_duplicates(const std::vector<Candidate>& candidates, double max_overlap) {
  std::map<int, std::vector<size_t>> by_class;
  for (size_t i = 0; i < candidates.size(); ++i) by_class[candidates[i].kind].push_back(i);
  std::vector<size_t> kept;
  for (const auto& [kind, members] : by_class) {
    std::vector<cv::Rect2d> boxes;
    std::vector<float> scores;
    for (const size_t i : members) {
      boxes.push_back(candidates[i].box);
      scores.push_back(static_cast<float>(candidates[i].score));
    }
    std::vector<int> indices;
    cv::dnn::NMSBoxes(boxes, scores, 0, static_cast<float>(max_overlap), indices);
    for (const int index : indices) kept.push_back(members[static_cast<size_t>(index)]);
  }
  std::ranges::sort(kept);
  std::vector<Candidate> best;
  for (const size_t i : kept) best.push_back(candidates[i]);
  return best;
}

/// The mask of a candidate inside its box: prototypes, weighted, above 0. Empty when nothing is.
void add_mask(const Candidate& candidate, const cv::Mat& prototypes, const InputFit& fit,
              const cv::Size& input, ImageRegion& region) {
  const int rows = prototypes.size[2], columns = prototypes.size[3];
  cv::Mat sum = cv::Mat::zeros(rows, columns, CV_32F);
  for (int k = 0; k < prototypes.size[1]; ++k) {
    const cv::Mat prototype(rows, columns, CV_32F,
                            const_cast<float*>(prototypes.ptr<float>(0, k)));  // only read
    cv::scaleAdd(prototype, static_cast<double>(candidate.coefficients[k * candidate.stride]), sum, sum);
  }
  const cv::Rect box = cv::Rect(cv::Point(candidate.box.tl()),
                                cv::Point(cvCeil(candidate.box.br().x), cvCeil(candidate.box.br().y))) &
                       cv::Rect({}, region.image);
  // Prototypes from pixels of the box. Here pixel centres are at integers.
  const double x = fit.scale.x * columns / input.width, y = fit.scale.y * rows / input.height;
  const cv::Matx23d map(x, 0, (box.x + 0.5) * x + fit.offset.x * columns / input.width - 0.5,  //
                        0, y, (box.y + 0.5) * y + fit.offset.y * rows / input.height - 0.5);
  cv::Mat values;
  cv::warpAffine(sum, values, map, box.size(), cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  region.mask = values > 0;
  region.origin = box.tl();
}

}  // namespace

DetectorDescription DetectorDescription::read(const std::filesystem::path& path) {
  const Config config = Config::read(path);
  config.refuse_other_keys(
      {"model", "layout", "classes", "input", "min_score", "max_overlap", "max_detections", "max_memory_mb"});
  DetectorDescription description;
  const std::filesystem::path folder = path.parent_path();
  description.model = folder / config.require<std::string>("model");
  const auto layout = config.require<std::string>("layout");
  const std::vector<std::string> layouts = {"yolov5", "yolov8", "ssd"};
  const auto known = std::ranges::find(layouts, layout);
  if (known == layouts.end())
    throw Error(fmt::format("unknown layout '{}'", layout), config.location("layout"),
                "it is one of " + fmt::format("{}", fmt::join(layouts, ", ")));
  description.layout = static_cast<DetectorLayout>(known - layouts.begin());
  const std::filesystem::path classes = folder / config.require<std::string>("classes");
  description.classes = read_class_names(classes);
  if (description.layout == DetectorLayout::ssd && description.classes.size() > 1 &&
      lower_case(description.classes.front()) == "background")
    description.classes.erase(description.classes.begin());
  if (description.classes.empty() || std::ranges::count(description.classes, "") > 0)
    throw Error("a class has no name", {classes.string(), 0, {}}, "write one name per line");
  description.input = NetworkInput::read(config.map("input"));
  const auto number = [&](const char* key, double fallback, double low, double high) {
    const double value = config.get<double>(key, fallback);
    if (!(value >= low && value <= high))
      throw Error(fmt::format("must be from {} to {}", low, high), config.location(key));
    return value;
  };
  description.min_score = number("min_score", description.min_score, 0.001, 1);
  description.max_overlap = number("max_overlap", description.max_overlap, 0, 1);
  description.max_detections = static_cast<int>(
      number("max_detections", description.max_detections, 1, static_cast<double>(kMaxDetectionsPerImage)));
  description.max_memory_mb = number("max_memory_mb", description.max_memory_mb, 1, 1e6);
  return description;
}

std::vector<Detection2D> decode_detections(const std::vector<Network::Output>& outputs,
                                           const DetectorDescription& description, const InputFit& fit,
                                           const cv::Size& image) {
  const Outputs checked(outputs, description);
  std::vector<Candidate> best = without_duplicates(checked.candidates(fit, image), description.max_overlap);
  if (best.size() > static_cast<size_t>(description.max_detections))
    best.resize(static_cast<size_t>(description.max_detections));
  std::vector<Detection2D> detections;
  for (const Candidate& candidate : best) {
    Detection2D detection;
    detection.region.image = image;
    detection.region.box = candidate.box;
    detection.classes = {{description.classes[static_cast<size_t>(candidate.kind)], candidate.score}};
    detection.score = candidate.score;
    if (candidate.coefficients != nullptr) {
      add_mask(candidate, *checked.prototypes(), fit, description.input.size, detection.region);
      if (cv::countNonZero(detection.region.mask) == 0) continue;
    }
    detections.push_back(std::move(detection));
  }
  return detections;
}

ObjectDetector::ObjectDetector(const std::filesystem::path& description)
    : description_(DetectorDescription::read(description)),
      network_(description_.model, description_.input, description_.max_memory_mb) {
  description_.input = network_.input();
  // Outputs that do not fit are refused now, not at the first frame.
  detect(cv::Mat(description_.input.size, CV_8UC3, cv::Scalar::all(0)));
}

std::vector<Detection2D> ObjectDetector::detect(const cv::Mat& image) const {
  return decode_detections(network_.run(image), description_, network_.fit(image.size()), image.size());
}

}  // namespace loci::perception
