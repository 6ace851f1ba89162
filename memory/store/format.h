#pragma once

#include <span>

namespace loci::memory {

/// SQLite's application id of a memory: "Loci".
inline constexpr int kMemoryApplicationId = 0x4c6f6369;
/// That of files from before the first release.
inline constexpr int kDevelopmentApplicationId = 0x6c6f6369;

/// One change of the schema, from the minor version before to `version`.
struct Migration {
  int version;             ///< user_version
  const char* sql;         ///< changes the schema and its rows
  const char* read_views;  ///< TEMP views with which a file from before it is read as it is
  const char* revert;      ///< gives an empty memory the schema from before it
};

/// What a program reads and writes. PRAGMA user_version = 1000 · major + minor: a newer minor version can be
/// read, a newer major one cannot; an older minor version is read as it is and migrated before it is written.
struct MemoryFormat {
  int version;                            ///< user_version
  const char* schema;                     ///< of that version
  std::span<const Migration> migrations;  ///< in order, since version 1.0
  const char* schema_digest = "";         ///< that schema_digest() has for it; "" = it is compared in full

  constexpr int major() const { return version / 1000; }
  constexpr int minor() const { return version % 1000; }
};

}  // namespace loci::memory
