#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "mapping/base/files.h"
#include "perception/detection/onnx.pb.h"

namespace loci::perception::test {

using Shape = std::vector<int64_t>;

inline void set_value(onnx::ValueInfo& value, const std::string& name, const Shape& shape) {
  value.set_name(name);
  value.mutable_type()->mutable_tensor_type()->set_elem_type(1);
  for (const int64_t side : shape)
    value.mutable_type()->mutable_tensor_type()->mutable_shape()->add_dim()->set_dim_value(side);
}

/// A network that averages each channel of its input and hands it on: nodes (operator, input, output).
inline onnx::Model small_network(const Shape& input, const std::vector<std::array<std::string, 3>>& nodes,
                                 const std::string& output, const Shape& output_shape) {
  onnx::Model model;
  model.set_ir_version(7);
  model.add_opset_import()->set_version(12);
  onnx::Graph& graph = *model.mutable_graph();
  graph.set_name("small");
  for (const auto& [operation, in, out] : nodes) {
    onnx::Node& node = *graph.add_node();
    node.set_op_type(operation);
    node.set_name("node_" + out);
    node.add_input(in);
    node.add_output(out);
  }
  set_value(*graph.add_input(), "image", input);
  set_value(*graph.add_output(), output, output_shape);
  return model;
}

/// The mean of each channel.
inline onnx::Model mean_network(const Shape& input = {1, 3, 8, 8}) {
  return small_network(input, {{"GlobalAveragePool", "image", "pooled"}, {"Flatten", "pooled", "vector"}},
                       "vector", {input[0], 3});
}

inline void write_model(const std::filesystem::path& path, const onnx::Model& model) {
  write_file_atomically(path, model.SerializeAsString());
}

}  // namespace loci::perception::test
