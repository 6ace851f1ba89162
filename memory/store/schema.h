#pragma once

namespace loci::memory {

/// SQLite's application id of a memory: "loci".
inline constexpr int kMemoryApplicationId = 0x6c6f6369;
/// user_version = 1000 · major + minor. A newer minor version can be read, a newer major one cannot.
inline constexpr int kMemoryMajor = 1;
inline constexpr int kMemoryMinor = 5;
inline constexpr int kMemoryVersion = 1000 * kMemoryMajor + kMemoryMinor;

/// memory/store/schema.sql.
extern const char* const kMemorySchema;

/// Leads a memory of version 1.0 to 1.1.
extern const char* const kMigrationTo1001;
/// Leads a memory of version 1.1 to 1.2; then what is derived is to be derived anew.
extern const char* const kMigrationTo1002;
/// Leads a memory of version 1.2 to 1.3; then what is derived is to be derived anew.
extern const char* const kMigrationTo1003;
/// Leads a memory of version 1.3 to 1.4: two indexes.
extern const char* const kMigrationTo1004;
/// Leads a memory of version 1.4 to 1.5: kinds of pixels, clouds, logs, counted rows.
extern const char* const kMigrationTo1005;
/// Makes what is derived from other rows anew: stays, visits, words of objects, marks of scenes and
/// sightings, full text.
extern const char* const kDerivation;
/// Counts the rows of large tables anew; part of kDerivation.
extern const char* const kCounting;
/// Removes blobs that nothing refers to any more.
extern const char* const kDropUnusedBlobs;
/// Views that let a memory of version 1.0 be read as it is, one of 1.0 to 1.2, and one of 1.0 to 1.4.
extern const char* const kViewsOf1000;
extern const char* const kViewsOf1002;
extern const char* const kViewsOf1004;

}  // namespace loci::memory
