#pragma once

#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "perception/cas/type_system.h"

namespace loci::perception::cas {

/// The kind of array that a C++ element type is kept in. Byte arrays hold images and blobs, hence unsigned.
template <typename T>
constexpr Kind kind_of() {
  if constexpr (std::is_same_v<T, bool>) return Kind::kBoolean;
  if constexpr (std::is_same_v<T, uint8_t>) return Kind::kByte;
  if constexpr (std::is_same_v<T, int16_t>) return Kind::kShort;
  if constexpr (std::is_same_v<T, int32_t>) return Kind::kInteger;
  if constexpr (std::is_same_v<T, int64_t>) return Kind::kLong;
  if constexpr (std::is_same_v<T, float>) return Kind::kFloat;
  if constexpr (std::is_same_v<T, double>) return Kind::kDouble;
  if constexpr (std::is_same_v<T, std::string>) return Kind::kString;
  return Kind::kStructure;
}

/// An immutable run of elements that shares the ownership of its memory: copying a buffer copies no elements.
template <typename T>
class Buffer {
 public:
  using value_type = T;
  using const_iterator = const T*;
  Buffer() = default;
  /// Memory of somebody else, kept alive through `owner`. Nobody may write to it any more.
  Buffer(std::shared_ptr<const void> owner, const T* data, size_t size)
      : owner_(std::move(owner)), data_(data), size_(size) {}
  /// Takes the vector over, without copying.
  explicit Buffer(std::vector<T>&& values) requires(!std::is_same_v<T, bool>) {
    const auto kept = std::make_shared<const std::vector<T>>(std::move(values));
    *this = Buffer(kept, kept->data(), kept->size());
  }
  static Buffer copy(std::span<const T> values) {
    const std::shared_ptr<T[]> kept(new T[values.size()]);
    std::copy(values.begin(), values.end(), kept.get());
    return Buffer(kept, kept.get(), values.size());
  }

  const T* data() const { return data_; }
  size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  const T* begin() const { return data_; }
  const T* end() const { return data_ + size_; }
  const T& operator[](size_t index) const { return data_[index]; }
  std::span<const T> span() const { return {data_, size_}; }
  const std::shared_ptr<const void>& owner() const { return owner_; }

 private:
  std::shared_ptr<const void> owner_;
  const T* data_ = nullptr;
  size_t size_ = 0;
};

/// A Buffer whose element type is known at run time.
struct RawBuffer {
  std::shared_ptr<const void> owner;
  const void* data = nullptr;
  size_t size = 0;  ///< elements

  template <typename T>
  RawBuffer(const Buffer<T>& buffer) : owner(buffer.owner()), data(buffer.data()), size(buffer.size()) {}
  RawBuffer() = default;
  template <typename T>
  Buffer<T> as() const {
    return {owner, static_cast<const T*>(data), size};
  }
};

/// Bytes per element of an array of numbers; 0 for strings and structures.
constexpr size_t element_bytes(Kind kind) {
  switch (kind) {
    case Kind::kBoolean:
    case Kind::kByte:
      return 1;
    case Kind::kShort:
      return 2;
    case Kind::kInteger:
    case Kind::kFloat:
      return 4;
    case Kind::kLong:
    case Kind::kDouble:
      return 8;
    default:
      return 0;
  }
}

}  // namespace loci::perception::cas
