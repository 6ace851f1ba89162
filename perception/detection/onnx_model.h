#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace loci::perception {

/// An input or output of a network.
struct OnnxValue {
  std::string name;
  std::vector<int64_t> shape;  ///< batch first; 0 = any size
};

/// An ONNX file whose structure has been checked.
struct OnnxModel {
  std::string bytes;  ///< the file
  int64_t opset = 0;  ///< version of ONNX's operators
  OnnxValue input;    ///< the only one
  std::vector<OnnxValue> outputs;
};

/// Largest file of a network, and most bytes that one of its tensors may take.
inline constexpr uint64_t kMaxModelBytes = uint64_t{1} << 30;

/// Reads a network. Error for what is no ONNX model or contradicts itself: tensors whose sizes do not fit
/// their data, nodes that read what no node makes, several inputs, weights in another file.
OnnxModel read_onnx_model(const std::filesystem::path& path);

}  // namespace loci::perception
