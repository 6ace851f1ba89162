#include "memory/questions/people_time.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <vector>

#include "mapping/base/error.h"

namespace loci {
namespace {

constexpr TimeNs kMinute = 60 * kSecond;
constexpr TimeNs kHour = 60 * kMinute;
constexpr TimeNs kDay = 24 * kHour;

std::vector<std::string> words_of(std::string_view text) {
  std::vector<std::string> words(1);
  for (const char c : text) {
    if (c == ' ')
      words.emplace_back();
    else
      words.back().push_back(c);
  }
  std::erase(words, "");
  return words;
}

std::optional<int> number_of(std::string_view text) {
  int value = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || result.ec != std::errc() || result.ptr != text.data() + text.size())
    return std::nullopt;
  return value;
}

/// "8:30", "08:30:15" as a span after midnight.
std::optional<TimeSpan> clock_of(const std::string& text) {
  const size_t first = text.find(':');
  if (first == std::string::npos || text.find_first_not_of("0123456789:") != std::string::npos)
    return std::nullopt;
  const size_t second = text.find(':', first + 1);
  const auto hour = number_of(text.substr(0, first));
  const auto minute =
      number_of(text.substr(first + 1, second == std::string::npos ? second : second - first - 1));
  const auto seconds = second == std::string::npos ? std::optional(0) : number_of(text.substr(second + 1));
  if (!hour || !minute || !seconds || *hour > 24 || *minute > 59 || *seconds > 59) return std::nullopt;
  const TimeNs start = *hour * kHour + *minute * kMinute + *seconds * kSecond;
  return TimeSpan{start, start + (second == std::string::npos ? kMinute : kSecond) - 1};
}

std::optional<TimeNs> unit_of(std::string word) {
  if (word.ends_with('s') && word.size() > 1) word.pop_back();
  if (word == "second" || word == "sec") return kSecond;
  if (word == "minute" || word == "min") return kMinute;
  if (word == "hour" || word == "h") return kHour;
  if (word == "day") return kDay;
  if (word == "week") return 7 * kDay;
  return std::nullopt;
}

bool is_date(const std::string& word) {
  return word.size() == 10 && word[4] == '-' && word[7] == '-';
}

bool has_zone(std::string_view text) {
  const size_t t = text.find_first_of("T ");
  return text.ends_with('Z') ||
         (t != std::string_view::npos && text.find_first_of("+-", t) != std::string_view::npos);
}

TimeNs floor_to(TimeNs time, TimeNs unit) {
  const TimeNs rest = time % unit;
  return time - (rest < 0 ? rest + unit : rest);
}

}  // namespace

TimeReader::TimeReader(const Store& store) : last_scene_(0), zone_minutes_(store.time_zone_minutes()) {
  const auto scenes = store.scenes();
  last_scene_ = scenes.empty() ? now() : scenes.back().time;
}

TimeSpan TimeReader::read(std::string_view text) const {
  const auto fail = [&]() -> TimeSpan {
    throw Error(fmt::format("'{}' is not a time", text), {},
                "write 2026-05-01T08:30:00Z, 2026-05-01 08:30, 08:30, yesterday 9:00, or 20 minutes ago");
  };
  const TimeNs zone = zone_minutes_ * kMinute;
  const TimeNs midnight = floor_to(last_scene_ + zone, kDay) - zone;
  std::vector<std::string> words = words_of(text);
  if (words.empty()) return fail();
  for (std::string& word : words)
    if (word == "Today" || word == "Yesterday" || word == "Now")
      word[0] = static_cast<char>(std::tolower(word[0]));

  if (words[0] == "now" && words.size() == 1) return {last_scene_, last_scene_};
  if (words.back() == "ago" && words.size() == 3) {
    const auto count = number_of(words[0]);
    const auto unit = unit_of(words[1]);
    if (!count || !unit || *count < 0 || *count > 100000) return fail();
    const TimeNs time = last_scene_ - *count * *unit;
    return {time, time};
  }

  TimeNs day = midnight;
  bool day_given = true;
  if (words[0] == "yesterday")
    day = midnight - kDay;
  else if (is_date(words[0]))
    day = parse_time(words[0]) - zone;
  else if (words[0] != "today")
    day_given = false;
  if (day_given && words.size() == 1) return {day, day + kDay - 1};
  if (day_given ? words.size() == 2 : words.size() == 1)
    if (const auto clock = clock_of(words.back())) return {day + clock->first, day + clock->last};

  const std::string whole(text);
  if (has_zone(whole)) {
    const TimeNs time = parse_time(whole);
    return {time, time};
  }
  // A local ISO 8601 time.
  if (whole.size() > 11 && is_date(whole.substr(0, 10))) {
    if (const auto clock = clock_of(whole.substr(11))) {
      const TimeNs date = parse_time(whole.substr(0, 10)) - zone;
      return {date + clock->first, date + clock->last};
    }
    const TimeNs time = parse_time(whole + "Z") - zone;
    return {time, time};
  }
  return fail();
}

TimeWriter::TimeWriter(const Store& store) : zone_minutes_(store.time_zone_minutes()), with_seconds_(false) {
  const auto scenes = store.scenes();
  const TimeNs zone = zone_minutes_ * kMinute;
  with_date_ = scenes.empty() ||
               floor_to(scenes.front().time + zone, kDay) != floor_to(scenes.back().time + zone, kDay);
  for (size_t i = 0; i < scenes.size(); ++i) {
    if (scenes[i].time % kMinute != 0) with_seconds_ = true;
    // Decimals only where whole seconds would not tell neighbours apart.
    if (i > 0 && scenes[i].time != scenes[i - 1].time &&
        scenes[i].time / kSecond == scenes[i - 1].time / kSecond)
      decimals_ = 2;
  }
}

std::string TimeWriter::text(TimeNs time) const {
  const std::string iso = format_time(time, zone_minutes_);  // 2026-05-01T09:10:00.5+02:00
  std::string text = with_date_ ? iso.substr(0, 10) + " " : "";
  text += iso.substr(11, 5);
  // The last moment of a minute is the end of a time that was given in minutes.
  if (with_seconds_ || (time % kMinute != 0 && (time + 1) % kMinute != 0)) text += iso.substr(16, 3);
  if (decimals_ > 0) {
    const TimeNs rest = time - floor_to(time, kSecond);
    text += fmt::format(".{:02}", rest / (kSecond / 100));
  }
  return text;
}

std::string TimeWriter::span_text(TimeNs from, TimeNs to) const {
  const std::string a = text(from), b = text(to);
  return a == b ? "at " + a : fmt::format("from {} to {}", a, b);
}

}  // namespace loci
