#include "perception/detection/image_encoder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace loci::perception {
namespace {

constexpr size_t kMaxBatch = 16;
constexpr int kMaxLength = 16384;

}  // namespace

ImageEncoder::Description::Description(const std::filesystem::path& path) {
  const Config config = Config::read(path);
  config.refuse_other_keys({"model", "name", "output", "input", "max_memory_mb"});
  model = path.parent_path() / config.require<std::string>("model");
  name = config.require<std::string>("name");
  if (name.empty()) throw Error("must not be empty", config.location("name"));
  output = config.get<std::string>("output", "");
  input = NetworkInput::read(config.map("input"));
  max_memory_mb = config.get<double>("max_memory_mb", max_memory_mb);
  if (!(max_memory_mb >= 1 && max_memory_mb <= 1e6))
    throw Error("must be from 1 to 1000000", config.location("max_memory_mb"));
}

ImageEncoder::ImageEncoder(const std::filesystem::path& description)
    : ImageEncoder(Description(description)) {}

ImageEncoder::ImageEncoder(const Description& description)
    : name_(description.name),
      output_(description.output),
      network_(description.model, description.input, description.max_memory_mb) {
  const cv::Mat blank(network_.input().size, CV_8UC3, cv::Scalar::all(0));
  vectors({blank});  // What does not fit is refused now.
  if (!network_.takes_batches()) return;
  try {
    batches_ = vectors({blank, blank}).rows == 2;
  } catch (const Error&) {  // Exported for one image after all.
  }
}

cv::Mat ImageEncoder::vectors(const std::vector<cv::Mat>& images) const {
  const std::vector<Network::Output> outputs = network_.run(images);
  const auto wanted = std::ranges::find_if(outputs, [&](const Network::Output& output) {
    return output_.empty() ? outputs.size() == 1 : output.name == output_;
  });
  std::string names;
  for (const Network::Output& output : outputs) names += (names.empty() ? "" : ", ") + output.name;
  if (wanted == outputs.end())
    throw Error(
        output_.empty() ? "the model has several outputs" : "the model has no output '" + output_ + "'",
        {network_.file(), 0, {}}, "give `output`, one of " + names);
  const cv::Mat& values = wanted->values;
  const size_t length = values.total() / images.size();
  if (values.size[0] != static_cast<int>(images.size()) || length < 1 || length > kMaxLength)
    throw Error(fmt::format("the output '{}' is not a vector of at most {} values per image", wanted->name,
                            kMaxLength),
                {network_.file(), 0, {}}, "take the output after pooling");
  return values.reshape(1, static_cast<int>(images.size())).clone();
}

std::vector<std::vector<float>> ImageEncoder::encode(const std::vector<cv::Mat>& images) const {
  std::vector<std::vector<float>> encoded;
  const size_t step = batches_ ? kMaxBatch : 1;
  for (size_t begin = 0; begin < images.size(); begin += step) {
    const size_t end = std::min(images.size(), begin + step);
    const cv::Mat rows = vectors({images.begin() + static_cast<std::ptrdiff_t>(begin),
                                  images.begin() + static_cast<std::ptrdiff_t>(end)});
    for (int i = 0; i < rows.rows; ++i) {
      const double norm = cv::norm(rows.row(i));
      std::vector<float>& vector = encoded.emplace_back();
      if (!(norm > 1e-12) || !std::isfinite(norm)) continue;
      for (int k = 0; k < rows.cols; ++k)
        vector.push_back(static_cast<float>(static_cast<double>(rows.at<float>(i, k)) / norm));
    }
  }
  return encoded;
}

}  // namespace loci::perception
