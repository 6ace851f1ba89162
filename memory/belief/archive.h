#pragma once

#include <array>
#include <cstring>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "mapping/base/error.h"
#include "mapping/base/pose.h"

namespace loci::memory::belief {

/// Writes fields one after the other: numbers as they lie in memory (little endian), lists with their length
/// before them. What is written knows its fields: template <class Archive> void archive(Archive&).
class ArchiveWriter {
 public:
  /// `room`: its memory is used again.
  explicit ArchiveWriter(std::string room = {}) : bytes_(std::move(room)) { bytes_.clear(); }

  template <class... Fields>
  void operator()(const Fields&... fields) {
    (field(fields), ...);
  }
  std::string take() { return std::move(bytes_); }

 private:
  template <class T>
  void field(const T& value) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
      bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
    } else {
      const_cast<T&>(value).archive(*this);  // writing changes nothing
    }
  }
  void length(size_t count) { field(static_cast<uint32_t>(count)); }
  void field(const std::string& text) {
    length(text.size());
    bytes_ += text;
  }
  template <class T>
  void field(const std::vector<T>& list) {
    length(list.size());
    if constexpr (std::is_arithmetic_v<T>)
      bytes_.append(reinterpret_cast<const char*>(list.data()), list.size() * sizeof(T));
    else
      for (const T& item : list) field(item);
  }
  template <class T, size_t N>
  void field(const std::array<T, N>& list) {
    for (const T& item : list) field(item);
  }
  template <class T>
  void field(const std::map<std::string, T>& map) {
    length(map.size());
    for (const auto& [name, value] : map) {
      length(name.size());
      bytes_ += name;
      field(value);
    }
  }
  template <class T>
  void field(const std::optional<T>& value) {
    field(value.has_value());
    if (value) field(*value);
  }
  void field(const Vector3d& v) { (*this)(v.x(), v.y(), v.z()); }
  /// All twelve numbers: a detour over a quaternion would not come back bit by bit.
  void field(const Isometry3d& pose) {
    for (int i = 0; i < 12; ++i) field(pose.matrix()(i / 4, i % 4));
  }

  std::string bytes_;
};

/// Reads what ArchiveWriter wrote, field by field. Error when the bytes end too early.
class ArchiveReader {
 public:
  explicit ArchiveReader(std::string_view bytes) : bytes_(bytes) {}

  template <class... Fields>
  void operator()(Fields&... fields) {
    (field(fields), ...);
  }
  bool at_end() const { return bytes_.empty(); }

 private:
  std::string_view next(size_t count) {
    if (count > bytes_.size()) throw Error("the bytes end too early");
    const std::string_view part = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return part;
  }
  template <class T>
  void field(T& value) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
      std::memcpy(&value, next(sizeof(T)).data(), sizeof(T));
    } else {
      value.archive(*this);
    }
  }
  /// Of a list of which each item takes at least a byte.
  size_t length() {
    uint32_t count = 0;
    field(count);
    if (count > bytes_.size()) throw Error("the bytes end too early");
    return count;
  }
  void field(std::string& text) {
    const size_t count = length();
    text = next(count);
  }
  template <class T>
  void field(std::vector<T>& list) {
    list.resize(length());
    if constexpr (std::is_arithmetic_v<T>) {
      const std::string_view part = next(list.size() * sizeof(T));
      if (!part.empty()) std::memcpy(list.data(), part.data(), part.size());
    } else {
      for (T& item : list) field(item);
    }
  }
  template <class T, size_t N>
  void field(std::array<T, N>& list) {
    for (T& item : list) field(item);
  }
  template <class T>
  void field(std::map<std::string, T>& map) {
    for (size_t left = length(); left > 0; --left) {
      std::string name;
      field(name);
      field(map[name]);
    }
  }
  template <class T>
  void field(std::optional<T>& value) {
    bool set = false;
    field(set);
    if (!set) return value.reset();
    field(value.emplace());
  }
  void field(Vector3d& v) { (*this)(v.x(), v.y(), v.z()); }
  void field(Isometry3d& pose) {
    for (int i = 0; i < 12; ++i) field(pose.matrix()(i / 4, i % 4));
  }

  std::string_view bytes_;
};

}  // namespace loci::memory::belief
