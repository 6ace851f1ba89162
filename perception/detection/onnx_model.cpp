#include "perception/detection/onnx_model.h"

#include <fmt/format.h>

#include <map>
#include <set>

#include "mapping/base/error.h"
#include "mapping/base/files.h"
#include "perception/detection/onnx.pb.h"

namespace loci::perception {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxDimensions = 8;
constexpr int64_t kMaxSide = 1 << 24;  ///< of an input or output

/// Checks one model; errors name its file.
class ModelCheck {
 public:
  explicit ModelCheck(const fs::path& path) : file_(path.string()) {}

  void tensor(const onnx::Tensor& tensor) const {
    const std::string name = fmt::format("the tensor '{}'", tensor.name());
    if (tensor.data_location() != 0)
      refuse(name + " is stored in another file", "export the model into one file");
    if (tensor.dims_size() > kMaxDimensions)
      refuse(fmt::format("{} has {} dimensions", name, tensor.dims_size()));
    uint64_t elements = 1;
    for (const int64_t side : tensor.dims()) {
      if (side < 0 || (side > 0 && elements > kMaxModelBytes / static_cast<uint64_t>(side)))
        refuse(name + " has impossible dimensions");
      elements *= static_cast<uint64_t>(side);
    }
    // Bytes of an element, by the numbers that ONNX gives the types that OpenCV reads.
    static const std::map<int, uint64_t> sizes = {{1, 4}, {2, 1}, {3, 1}, {4, 2},  {5, 2},
                                                  {6, 4}, {7, 8}, {9, 1}, {10, 2}, {11, 8}};
    const auto size = sizes.find(tensor.data_type());
    if (size == sizes.end())
      refuse(fmt::format("{} has elements of type {}", name, tensor.data_type()),
             "export it with 32-bit floating-point weights");
    const int values = tensor.float_data_size() + tensor.int32_data_size() + tensor.int64_data_size() +
                       tensor.double_data_size();
    const bool fits = tensor.has_raw_data() ? tensor.raw_data().size() == elements * size->second
                                            : static_cast<uint64_t>(values) == elements;
    if (!fits) refuse(name + " does not have as many values as its dimensions say");
  }

  OnnxValue value(const onnx::ValueInfo& info) const {
    OnnxValue value{info.name(), {}};
    for (const onnx::Dimension& side : info.type().tensor_type().shape().dim()) {
      if (side.dim_value() < 0 || side.dim_value() > kMaxSide)
        refuse(fmt::format("'{}' has a side of {}", info.name(), side.dim_value()));
      value.shape.push_back(side.dim_value());
    }
    if (value.shape.size() > kMaxDimensions)
      refuse(fmt::format("'{}' has {} dimensions", info.name(), value.shape.size()));
    return value;
  }

  /// Every node reads what was made before it.
  void order(const onnx::Graph& graph) const {
    std::set<std::string> made = {""};
    for (const onnx::Tensor& tensor : graph.initializer()) made.insert(tensor.name());
    for (const onnx::ValueInfo& input : graph.input()) made.insert(input.name());
    for (const onnx::Node& node : graph.node()) {
      for (const std::string& input : node.input())
        if (!made.contains(input))
          refuse(fmt::format("the node '{}' ({}) reads '{}', which no node before it makes", node.name(),
                             node.op_type(), input));
      made.insert(node.output().begin(), node.output().end());
    }
    for (const onnx::ValueInfo& output : graph.output())
      if (!made.contains(output.name())) refuse(fmt::format("no node makes the output '{}'", output.name()));
  }

  [[noreturn]] void refuse(const std::string& what,
                           const std::string& hint = "export the model again") const {
    throw Error(what, {file_, 0, {}}, hint);
  }

 private:
  std::string file_;
};

}  // namespace

OnnxModel read_onnx_model(const fs::path& path) {
  const ModelCheck check(path);
  std::error_code none;
  if (const uintmax_t size = fs::file_size(path, none); !none && size > kMaxModelBytes)
    check.refuse(fmt::format("the model is larger than {} MB", kMaxModelBytes >> 20), "take a smaller one");
  OnnxModel model{read_file(path), 0, {}, {}};
  onnx::Model message;
  if (!message.ParseFromString(model.bytes) || message.graph().node().empty())
    check.refuse("the file holds no ONNX model", "export one from the program that trained it");
  for (const onnx::OperatorSet& set : message.opset_import())
    if (set.domain().empty() || set.domain() == "ai.onnx") model.opset = set.version();
  const onnx::Graph& graph = message.graph();
  std::set<std::string> constants;
  for (const onnx::Tensor& tensor : graph.initializer()) {
    check.tensor(tensor);
    constants.insert(tensor.name());
  }
  for (const onnx::Node& node : graph.node())
    for (const onnx::Attribute& attribute : node.attribute())
      if (attribute.has_t()) check.tensor(attribute.t());
  check.order(graph);
  std::vector<OnnxValue> inputs;
  for (const onnx::ValueInfo& input : graph.input())
    if (!constants.contains(input.name())) inputs.push_back(check.value(input));
  if (inputs.size() != 1) check.refuse(fmt::format("the model has {} inputs instead of one", inputs.size()));
  model.input = inputs.front();
  for (const onnx::ValueInfo& output : graph.output()) model.outputs.push_back(check.value(output));
  if (model.outputs.empty()) check.refuse("the model has no output");
  return model;
}

}  // namespace loci::perception
