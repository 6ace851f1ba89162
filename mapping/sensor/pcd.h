#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace loci::mapping {

/// A column of a PCD file.
struct PcdField {
  std::string name;
  char type = 'F';  ///< F float, I signed, U unsigned
  int size = 4;     ///< bytes
  int count = 1;    ///< values per point
  size_t offset = 0;
};

/// A point cloud file as it is: fields and packed points (little endian, one point after the other).
struct PcdCloud {
  std::vector<PcdField> fields;
  size_t width = 0;
  size_t height = 1;  ///< 1 = not organised
  size_t point_size = 0;
  std::string data;  ///< width · height · point_size bytes

  size_t size() const { return width * height; }
  /// Field of a name; nullptr when there is none.
  const PcdField* find(std::string_view name) const;
  /// First value of a field of a point as a number.
  double number(size_t point, const PcdField& field) const;
  /// The four bytes of a field as they are, for packed colours (rgb, rgba).
  uint32_t bits(size_t point, const PcdField& field) const;
  /// Appends a field behind the ones that are there (before any points).
  void add_field(std::string name, char type, int size);
};

/// Reads ascii, binary and binary_compressed PCD (version 0.6 and 0.7). Error when it is missing, malformed
/// or truncated.
PcdCloud read_pcd(const std::filesystem::path& path);

/// Writes binary PCD, atomically.
void write_pcd(const PcdCloud& cloud, const std::filesystem::path& path);

}  // namespace loci::mapping
