#include "mapping/recording/frame_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "mapping/base/text/text.h"
#include "mapping/base/time_limits.h"
#include "mapping/recording/file_recording.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

/// The last digits of a name, with those before a point: "kinect_1700000001.166667" → "1700000001", "166667".
struct LastNumber {
  std::string whole, decimals;
  bool is_last = false;   ///< nothing follows
  bool is_alone = false;  ///< nor precedes
  bool has_dash = false;  ///< precedes
};

LastNumber last_number(const std::string& name) {
  LastNumber number;
  const auto digits_before = [&](std::string::const_reverse_iterator& at) {
    const auto end = std::find_if_not(at, name.rend(), is_digit);
    std::string digits(end.base(), at.base());
    at = end;
    return digits;
  };
  auto at = std::find_if(name.rbegin(), name.rend(), is_digit);
  number.is_last = at == name.rbegin();
  number.whole = digits_before(at);
  if (at != name.rend() && *at == '.' && at + 1 != name.rend() && is_digit(*(at + 1))) {
    number.decimals = number.whole;
    number.whole = digits_before(++at);
  }
  number.is_alone = number.is_last && at == name.rend();
  number.has_dash = at != name.rend() && *at == '-';
  return number;
}

std::optional<NamedTime> dated(const std::string& digits, TimeNs unit_ns) {
  const uint64_t count = std::stoull(digits);
  if (digits[0] == '0' || count >= static_cast<uint64_t>(kMaxTime / unit_ns)) return std::nullopt;
  return NamedTime{static_cast<TimeNs>(count) * unit_ns};
}

std::optional<NamedTime> time_of(const LastNumber& number) {
  const auto& [whole, decimals, is_last, is_alone, has_dash] = number;
  if (!is_last || whole.empty()) return std::nullopt;
  if (!decimals.empty()) {
    std::string part = decimals;
    part.resize(9, '0');
    const bool is_dated = whole.size() == 9 || whole.size() == 10;
    if (whole.size() > 10 || !(is_dated || is_alone)) return std::nullopt;
    if (!is_dated) return NamedTime{assumed_time(0) + std::stoll(whole) * kSecond + std::stoll(part), false};
    const std::optional<NamedTime> seconds = dated(whole, kSecond);
    return seconds ? std::optional(NamedTime{seconds->time_ns + std::stoll(part)}) : std::nullopt;
  }
  switch (whole.size()) {
    case 10:
      return dated(whole, kSecond);
    case 12:
      if (!has_dash) return std::nullopt;
      return NamedTime{assumed_time(0) + 1000 * std::stoll(whole), false};
    case 13:
      return dated(whole, kSecond / 1000);
    case 16:
      return dated(whole, 1000);
    case 19:
      return dated(whole, 1);
    default:
      return std::nullopt;
  }
}

/// Times in the names of all frames; false where one has none.
bool take_times_in_names(RecordingInfo& info, std::vector<FrameFiles>& frames) {
  std::vector<NamedTime> times;
  for (const FrameFiles& frame : frames) {
    const std::optional<NamedTime> time = time_in_name(frame.depth);
    if (!time || (!times.empty() && time->is_dated != times.front().is_dated)) return false;
    times.push_back(*time);
  }
  for (size_t i = 0; i < frames.size(); ++i) frames[i].time_ns = times[i].time_ns;
  info.time_assumed = !times.front().is_dated;
  if (info.time_assumed)
    info.guesses.emplace_back("no date in the stamps: they begin at 2000-01-01T00:00:00Z");
  return true;
}

/// The numbers in the names of all frames, where they count up.
std::optional<std::vector<int64_t>> ascending_numbers(const std::vector<FrameFiles>& frames) {
  std::vector<int64_t> numbers;
  for (const FrameFiles& frame : frames) {
    const std::optional<int64_t> number = number_in_name(frame.depth);
    if (!number || (!numbers.empty() && *number <= numbers.back())) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

}  // namespace

std::string frame_name(const fs::path& file) {
  std::string name = file.stem().string();
  for (const char* kind : {"depth", "color", "rgb"})
    for (const char separator : {'.', '_', '-'})
      if (const std::string suffix = separator + std::string(kind); name.ends_with(suffix))
        return name.substr(0, name.size() - suffix.size());
  return name;
}

std::optional<int64_t> number_in_name(const fs::path& file) {
  constexpr size_t kMaxDigits = 9;  // Longer ones are stamps, not numbers.
  const LastNumber number = last_number(frame_name(file));
  if (time_of(number)) return std::nullopt;
  std::string digits = number.decimals.empty() ? number.whole : number.decimals;
  digits.erase(0, std::min(digits.find_first_not_of('0'), std::max<size_t>(digits.size(), 1) - 1));
  if (digits.empty() || digits.size() > kMaxDigits) return std::nullopt;
  return std::stoll(digits);
}

std::optional<NamedTime> time_in_name(const fs::path& file) {
  return time_of(last_number(frame_name(file)));
}

TimeNs assumed_time(int64_t number) {
  constexpr TimeNs year_2000 = 946'684'800 * kSecond;
  return year_2000 + number * kSecond / 30;
}

void sort_by_name(std::vector<fs::path>& files) {
  struct Key {
    std::optional<TimeNs> time;
    std::optional<int64_t> number;
    fs::path file;
  };
  std::vector<Key> keys;
  bool all_timed = true, all_numbered = true;
  for (const fs::path& file : files) {
    const std::optional<NamedTime> time = time_in_name(file);
    keys.push_back({time ? std::optional(time->time_ns) : std::nullopt, number_in_name(file), file});
    all_timed = all_timed && time;
    all_numbered = all_numbered && keys.back().number;
  }
  std::ranges::sort(keys, [&](const Key& a, const Key& b) {
    if (all_timed && a.time != b.time) return a.time < b.time;
    if (all_numbered && a.number != b.number) return a.number < b.number;
    return a.file < b.file;
  });
  for (size_t i = 0; i < files.size(); ++i) files[i] = keys[i].file;
}

std::vector<fs::path> visible_files(const fs::path& folder) {
  std::vector<fs::path> files;
  if (!fs::is_directory(folder)) return files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (!entry.is_directory() && !entry.path().filename().string().starts_with('.'))
      files.push_back(entry.path());
  return files;
}

void set_times_by_name(RecordingInfo& info, std::vector<FrameFiles>& frames) {
  constexpr int64_t kSecondOfVideo = 30;
  if (frames.empty() || take_times_in_names(info, frames)) return;
  info.time_assumed = true;
  const auto numbers = ascending_numbers(frames);
  const auto number_of = [&](size_t i) { return numbers ? (*numbers)[i] : static_cast<int64_t>(i); };
  const bool is_video = frames.size() == 1 || number_of(frames.size() - 1) - number_of(0) >= kSecondOfVideo;
  for (size_t i = 0; i < frames.size(); ++i)
    frames[i].time_ns =
        is_video ? assumed_time(number_of(i)) : assumed_time(0) + static_cast<TimeNs>(i) * 60 * kSecond;
  info.guesses.push_back(
      is_video ? fmt::format("no time stamps: 30 Hz from 2000-01-01T00:00:00Z by {} (--seconds-apart sets "
                             "the time between frames)",
                             numbers ? "the number in the name" : "the order of the names")
               : "no time stamps: so few frames are taken as a minute apart, from 2000-01-01T00:00:00Z "
                 "(--seconds-apart sets the time between frames)");
}

}  // namespace loci::mapping
