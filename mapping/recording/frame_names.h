#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/time.h"

namespace loci::mapping {

// What the names of image files say: which images are of one frame, its number, and its time.

struct FrameFiles;
struct RecordingInfo;

/// What the files of one frame share: "frame-000012" of "frame-000012.depth.png", "learn33" of
/// "learn33_color.png".
std::string frame_name(const std::filesystem::path& file);

/// The last number in a file's name, without its ending: "frame-000012.depth.png" → 12. Unset where there is
/// none, or it is a stamp.
std::optional<int64_t> number_in_name(const std::filesystem::path& file);

struct NamedTime {
  TimeNs time_ns = 0;
  bool is_dated = true;  ///< else it counts from assumed_time(0)
};

/// The stamp that a file's name ends with: seconds since 1970 ("1700000001.166667.png", "1700000001.png"), or
/// whole milliseconds (13 digits), microseconds (16) or nanoseconds (19). Without a date: seconds with
/// decimals as the whole name ("12.033333.png"), and Redwood's microseconds ("0000012-000000400417.jpg").
std::optional<NamedTime> time_in_name(const std::filesystem::path& file);

/// The stamp of frame `number` where there are none: from 2000-01-01T00:00:00Z at 30 Hz.
TimeNs assumed_time(int64_t number);

/// By time, else by number ("2.png" comes before "10.png"), else by name.
void sort_by_name(std::vector<std::filesystem::path>& files);

/// Files of a folder but for hidden ones, as macOS strews them ("._000000.png"); none where there is no
/// folder.
std::vector<std::filesystem::path> visible_files(const std::filesystem::path& folder);

/// Times of frames whose layout has no stamps: those in their names; else made up by the numbers in their
/// names, or by their order. So few frames that they would be less than a second of a video are taken as a
/// minute apart. The info says so.
void set_times_by_name(RecordingInfo& info, std::vector<FrameFiles>& frames);

}  // namespace loci::mapping
