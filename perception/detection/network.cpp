#include "perception/detection/network.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>
#include <regex>

#include "mapping/base/text/text.h"
#include "perception/detection/onnx_model.h"

namespace loci::perception {
namespace {

constexpr int kMaxInputSide = 4096;
constexpr double kBorder = 114;  ///< grey of the border that letterboxed networks are trained with

/// OpenCV prints what it throws, too.
class SilentOpenCv {
 public:
  SilentOpenCv() : before_(cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT)) {}
  ~SilentOpenCv() { cv::utils::logging::setLogLevel(before_); }
  SilentOpenCv(const SilentOpenCv&) = delete;
  SilentOpenCv& operator=(const SilentOpenCv&) = delete;

 private:
  cv::utils::logging::LogLevel before_;
};

/// Runs a function of OpenCV; what it throws becomes an Error in one line.
template <class Function>
auto guarded(const std::string& file, const std::string& what, const std::string& hint, Function function) {
  const SilentOpenCv silent;
  try {
    return function();
  } catch (const cv::Exception& error) {
    // "... Node [NonZero@ai.onnx]:(onnx_node!/name) parse error: ..."
    std::smatch node;
    const std::string text = error.what();
    static const std::regex kNode(R"(\[([A-Za-z0-9_]+)(?:@[^\]]*)?\]:\((?:onnx_node!)?([^)]*)\))");
    if (std::regex_search(text, node, kNode))
      throw Error(fmt::format("{}: operator {} ('{}')", what, node[1].str(), node[2].str()), {file, 0, {}},
                  hint);
    throw Error(fmt::format("{} ({})", what, trimmed(split(error.err, '\n').front())), {file, 0, {}}, hint);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {  // bad_alloc, out_of_range
    throw Error(fmt::format("{} ({})", what, error.what()), {file, 0, {}}, hint);
  }
}

std::array<double, 3> read_channels(const Config& config, const std::string& key,
                                    const std::array<double, 3>& fallback) {
  if (!config.has(key)) return fallback;
  const auto values = config.require<std::vector<double>>(key);
  if (values.size() != 3 || !std::ranges::all_of(values, [](double v) { return std::abs(v) < 1e6; }))
    throw Error("expected three numbers, one per channel", config.location(key));
  return {values[0], values[1], values[2]};
}

/// The input's shape (batch 1) from the model and the description.
cv::Size input_size(const OnnxModel& model, const cv::Size& wanted, const std::string& file) {
  const std::vector<int64_t>& shape = model.input.shape;
  if (shape.size() != 4 || (shape[1] != 3 && shape[1] != 0))
    throw Error(fmt::format("the input of the model has the shape ({}), not (1, 3, height, width)",
                            fmt::join(shape, ", ")),
                {file, 0, {}}, "take a model for colour images, with the channels before rows and columns");
  const cv::Size own(static_cast<int>(shape[3]), static_cast<int>(shape[2]));
  const auto differs = [](int of_model, int given) { return of_model > 0 && given > 0 && of_model != given; };
  if (differs(own.width, wanted.width) || differs(own.height, wanted.height))
    throw Error(fmt::format("the model takes images of {} x {}, the description says {} x {}", own.width,
                            own.height, wanted.width, wanted.height),
                {file, 0, {}}, "correct width and height of the input");
  const cv::Size size(std::max(own.width, wanted.width), std::max(own.height, wanted.height));
  if (size.empty())
    throw Error("the model takes images of any size", {file, 0, {}}, "give the input's width and height");
  if (std::max(size.width, size.height) > kMaxInputSide)
    throw Error(fmt::format("the model takes images of {} x {}", size.width, size.height), {file, 0, {}},
                fmt::format("at most {} pixels a side are allowed", kMaxInputSide));
  return size;
}

}  // namespace

NetworkInput NetworkInput::read(const Config& config) {
  config.refuse_other_keys({"width", "height", "channels", "scale", "mean", "deviation", "resize"});
  NetworkInput input;
  const auto side = [&](const char* key) {
    const int value = config.get<int>(key, 0);
    if (value < 0 || value > kMaxInputSide)
      throw Error(fmt::format("must be from 1 to {}", kMaxInputSide), config.location(key));
    return value;
  };
  const auto choice = [&](const char* key, const std::string& first, const std::string& second) {
    const auto value = config.get<std::string>(key, first);
    if (value != first && value != second)
      throw Error(fmt::format("must be {} or {}", first, second), config.location(key));
    return value == first;
  };
  input.size = {side("width"), side("height")};
  input.rgb = choice("channels", "rgb", "bgr");
  input.letterbox = choice("resize", "letterbox", "stretch");
  input.scale = config.get<double>("scale", input.scale);
  if (!(std::abs(input.scale) < 1e6) || input.scale == 0)
    throw Error("must be a number other than 0", config.location("scale"));
  input.mean = read_channels(config, "mean", input.mean);
  input.deviation = read_channels(config, "deviation", input.deviation);
  if (std::ranges::count(input.deviation, 0.0) > 0)
    throw Error("must not be 0", config.location("deviation"));
  return input;
}

Network::Network(const std::filesystem::path& model, const NetworkInput& input, double max_memory_mb)
    : file_(model.string()), input_(input) {
  const OnnxModel checked = read_onnx_model(model);
  input_.size = input_size(checked, input_.size, file_);
  takes_batches_ = checked.input.shape[0] == 0;
  const std::string hint = fmt::format(
      "OpenCV {} reads operator sets up to about 13, this model has {}: export it with opset 12, without "
      "post-processing such as NMS, and simplified",
      CV_VERSION, checked.opset);
  guarded(file_, "OpenCV cannot read this model", hint, [&] {
    net_ = cv::dnn::readNetFromONNX(checked.bytes.data(), checked.bytes.size());
    net_.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    outputs_ = net_.getUnconnectedOutLayersNames();
    size_t weights = 0, blobs = 0;
    net_.getMemoryConsumption(cv::dnn::MatShape{1, 3, input_.size.height, input_.size.width}, weights, blobs);
    const double needed_mb = static_cast<double>(weights + blobs) / (1 << 20);
    if (needed_mb > max_memory_mb)
      throw Error(
          fmt::format("the model needs {:.0f} MB of memory, {:.0f} are allowed", needed_mb, max_memory_mb),
          {file_, 0, {}}, "raise max_memory_mb, or take a smaller model or input");
  });
  // What cannot run is refused now, not at the first frame.
  run(cv::Mat(input_.size, CV_8UC3, cv::Scalar::all(kBorder)));
}

InputFit Network::fit(const cv::Size& image) const {
  const double x = static_cast<double>(input_.size.width) / image.width,
               y = static_cast<double>(input_.size.height) / image.height;
  if (!input_.letterbox) return {{x, y}, {0, 0}};
  const double scale = std::min(x, y);
  return {{scale, scale},
          {std::floor((input_.size.width - std::round(image.width * scale)) / 2),
           std::floor((input_.size.height - std::round(image.height * scale)) / 2)}};
}

cv::Mat Network::prepared(const cv::Mat& image) const {
  const InputFit fit = this->fit(image.size());
  const cv::Size inner(
      std::clamp(static_cast<int>(std::round(image.cols * fit.scale.x)), 1, input_.size.width),
      std::clamp(static_cast<int>(std::round(image.rows * fit.scale.y)), 1, input_.size.height));
  cv::Mat filled(input_.size, CV_8UC3, cv::Scalar::all(kBorder));
  cv::resize(image, filled(cv::Rect({static_cast<int>(fit.offset.x), static_cast<int>(fit.offset.y)}, inner)),
             inner, 0, 0, fit.scale.x < 1 ? cv::INTER_AREA : cv::INTER_LINEAR);
  if (input_.rgb) cv::cvtColor(filled, filled, cv::COLOR_BGR2RGB);
  cv::Mat values;
  filled.convertTo(values, CV_32F, input_.scale);
  values -= cv::Scalar(input_.mean[0], input_.mean[1], input_.mean[2]);
  cv::divide(values, cv::Scalar(input_.deviation[0], input_.deviation[1], input_.deviation[2]), values);
  return values;
}

std::vector<Network::Output> Network::run(const std::vector<cv::Mat>& images) const {
  std::vector<cv::Mat> inputs;
  for (const cv::Mat& image : images) inputs.push_back(prepared(image));
  std::vector<cv::Mat> values;
  guarded(file_, "OpenCV cannot run this model", "check that width and height are those it was made for",
          [&] {
            net_.setInput(cv::dnn::blobFromImages(inputs));
            net_.forward(values, outputs_);
          });
  std::vector<Output> outputs;
  for (size_t i = 0; i < values.size(); ++i) {
    if (values[i].depth() != CV_32F)
      throw Error(fmt::format("the output '{}' has no floating-point values", outputs_[i]), {file_, 0, {}});
    outputs.push_back({outputs_[i], values[i].clone()});  // The network's own is overwritten by the next run.
  }
  return outputs;
}

}  // namespace loci::perception
