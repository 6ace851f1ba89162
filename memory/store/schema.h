#pragma once

namespace loci {

/// SQLite's application id of a memory: "loci".
inline constexpr int kMemoryApplicationId = 0x6c6f6369;
/// user_version = 1000 · major + minor. A newer minor version can be read, a newer major one cannot.
inline constexpr int kMemoryMajor = 1;
inline constexpr int kMemoryMinor = 0;
inline constexpr int kMemoryVersion = 1000 * kMemoryMajor + kMemoryMinor;

/// memory/store/schema.sql.
extern const char* const kMemorySchema;

}  // namespace loci
