#include "memory/questions/time_parser.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <initializer_list>
#include <vector>

#include "mapping/base/error.h"
#include "mapping/base/text/text.h"
#include "mapping/base/time_limits.h"

namespace loci::memory {
namespace {

// Times that memories have, with room for zones and days on both sides.
constexpr TimeNs kLatest = kMaxTime - 50 * kDay;
constexpr TimeNs kEarliest = -kLatest;

/// An hour so little before the first scene is that of the same half of the day.
constexpr TimeNs kBeforeFirst = 30 * kMinute;

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
  if (*hour == 24 && *minute + *seconds > 0) return std::nullopt;
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

/// A part of the day, as a span after midnight.
std::optional<TimeSpan> part_of_day(const std::string& word) {
  struct Part {
    const char* name;
    TimeNs first, end;
  };
  static const std::array<Part, 12> parts = {{{"midday", 12 * kHour, 12 * kHour + kMinute},
                                              {"lunchtime", 11 * kHour, 15 * kHour},
                                              {"morning", 5 * kHour, 12 * kHour},
                                              {"afternoon", 12 * kHour, 18 * kHour},
                                              {"evening", 18 * kHour, 24 * kHour},
                                              {"night", 22 * kHour, 30 * kHour},
                                              {"breakfast", 5 * kHour, 11 * kHour},
                                              {"lunch", 11 * kHour, 15 * kHour},
                                              {"dinner", 17 * kHour, 23 * kHour},
                                              {"supper", 17 * kHour, 23 * kHour},
                                              {"noon", 12 * kHour, 12 * kHour + kMinute},
                                              {"midnight", 0, kMinute}}};
  for (const Part& part : parts)
    if (word == part.name) return TimeSpan{part.first, part.end - 1};
  return std::nullopt;
}

/// "october", "oct", "sept": 1 to 12.
std::optional<unsigned> month_of(const std::string& word) {
  static const std::array<std::string, 12> names = {"january",   "february", "march",    "april",
                                                    "may",       "june",     "july",     "august",
                                                    "september", "october",  "november", "december"};
  for (unsigned i = 0; i < names.size(); ++i)
    if (word == names[i] || word == names[i].substr(0, 3)) return i + 1;
  return word == "sept" ? std::optional(9U) : std::nullopt;
}

/// "25", "25th": 1 to 31.
std::optional<unsigned> day_of_month(std::string word) {
  for (const char* ending : {"st", "nd", "rd", "th"})
    if (word.size() > 2 && is_digit(word[0]) && word.ends_with(ending)) word.resize(word.size() - 2);
  const auto number = word.size() <= 2 ? number_of(word) : std::nullopt;
  return number && *number >= 1 && *number <= 31 ? std::optional(static_cast<unsigned>(*number))
                                                 : std::nullopt;
}

bool is_date(const std::string& word) {
  return word.size() == 10 && word[4] == '-' && word[7] == '-';
}

constexpr size_t kOffsetLength = 6;

/// Of a time that ends with the offset of its zone: "02:30+02:00".
std::optional<TimeNs> offset_of(std::string_view text) {
  if (text.size() <= kOffsetLength) return std::nullopt;
  const std::string_view offset = text.substr(text.size() - kOffsetLength);
  const auto hours = number_of(offset.substr(1, 2)), minutes = number_of(offset.substr(4));
  const bool is_one = (offset[0] == '+' || offset[0] == '-') && offset[3] == ':' && hours && minutes &&
                      *hours >= 0 && *minutes >= 0;
  if (!is_one) return std::nullopt;
  return (offset[0] == '-' ? -1 : 1) * (*hours * kHour + *minutes * kMinute);
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

/// The number that a word spells in letters; 0 for any other word.
int spelled_count(const std::string& word) {
  if (word.empty() || is_digit(word[0]) || word == "a" || word == "an") return 0;
  return count_of(word).value_or(0);
}

/// In lower case, numbers of two words in digits: "twenty-five past seven" as "25 past seven".
std::vector<std::string> time_words(std::string_view text) {
  const std::vector<std::string> words = words_of(lower_case(text));
  std::vector<std::string> result;
  for (const std::string& word : words) {
    const size_t dash = word.find('-');
    const bool one_word = dash != std::string::npos;
    const std::string tens = one_word ? word.substr(0, dash) : result.empty() ? "" : result.back();
    const int ten = spelled_count(tens), one = spelled_count(word.substr(one_word ? dash + 1 : 0));
    const bool both = ten >= 20 && one > 0 && one < 10;
    if (both && !one_word) result.pop_back();
    result.push_back(both ? std::to_string(ten + one) : word);
  }
  return result;
}

/// "now", "20 minutes ago": a moment, whatever clocks on the wall show. Days and weeks ago it was as late.
std::optional<TimeNs> moment_of(std::vector<std::string> words, TimeNs now, const TimeZone& zone) {
  if (words == std::vector<std::string>{"now"}) return now;
  if (words.empty() || words.back() != "ago") return std::nullopt;
  words.pop_back();
  const bool half = words.size() == 3 && words[0] == "half" && words[1] == "an";
  if (half) words.erase(words.begin());
  if (words.size() != 2) return std::nullopt;
  const auto count = count_of(words[0]);
  const auto unit = unit_of(words[1]);
  if (!count || !unit || *count < 0 || *count > now / *unit - kEarliest / *unit) return std::nullopt;
  const TimeNs elapsed = *count * *unit / (half ? 2 : 1);
  return *unit < kDay ? now - elapsed : zone.first_moment(zone.local(now) - elapsed);
}

/// Reads the words of a time one after the other, in local time: days since the epoch and spans after
/// midnight.
class TimePhrase {
 public:
  TimePhrase(std::vector<std::string> words, TimeNs local_now)
      : words_(std::move(words)), now_(local_now), midnight_(floor_to(local_now, kDay)) {}

  /// The span in local time, if all the words are a time.
  std::optional<TimeSpan> read() {
    if (is("last", "night")) return whole(TimeSpan{midnight_ - 4 * kHour, midnight_ + 6 * kHour - 1});
    if (is("tonight")) return whole(TimeSpan{midnight_ + 18 * kHour, midnight_ + kDay - 1});
    if (const auto week = read_week()) return whole(*week);
    skip({"on"});
    const auto day = read_day();
    skip({"at", "around", "about", "in", "the"});
    const auto time = read_time_of_day();
    if (!day && !time) return std::nullopt;
    const TimeNs start = day.value_or(midnight_);
    return whole(time ? TimeSpan{start + time->first, start + time->last}
                      : TimeSpan{start, start + kDay - 1});
  }

 private:
  std::string word(size_t ahead = 0) const {
    return next_ + ahead < words_.size() ? words_[next_ + ahead] : "";
  }
  std::optional<TimeSpan> whole(TimeSpan span) const {
    return next_ == words_.size() ? std::optional(span) : std::nullopt;
  }
  /// Takes the next words if they are these.
  template <class... Words>
  bool is(Words... expected) {
    size_t ahead = 0;
    if (!((word(ahead++) == expected) && ...)) return false;
    next_ += ahead;
    return true;
  }
  void skip(std::initializer_list<const char*> fillers) {
    while (std::find(fillers.begin(), fillers.end(), word()) != fillers.end() && next_ < words_.size())
      ++next_;
  }

  /// Weeks begin on Monday.
  std::optional<TimeSpan> read_week() {
    const TimeNs monday = midnight_ - local_weekday(midnight_, TimeZone()) * kDay;
    if (is("this", "week")) return TimeSpan{monday, monday + 7 * kDay - 1};
    if (is("last", "week")) return TimeSpan{monday - 7 * kDay, monday - 1};
    return std::nullopt;
  }

  std::optional<TimeNs> read_day() {
    if (is("the", "day", "before", "yesterday")) return midnight_ - 2 * kDay;
    if (is("yesterday")) return midnight_ - kDay;
    if (is("today")) return midnight_;
    const bool half = word(1) == "early" || word(1) == "late";
    if (word() == "this" && part_of_day(word(half ? 2 : 1))) return ++next_, midnight_;
    if (is_date(word())) {
      try {
        return parse_time(words_[next_++]);
      } catch (const Error&) {
        return std::nullopt;
      }
    }
    if (const auto date = read_date()) return date;
    const bool last = word() == "last";
    const auto day = weekday_of(word(last ? 1 : 0));
    if (!day) return std::nullopt;
    next_ += last ? 2 : 1;
    int back = (local_weekday(midnight_, TimeZone()) - *day + 7) % 7;
    if (last && back == 0) back = 7;
    return midnight_ - back * kDay;
  }

  /// "25 October", "October 25th, 2026", "the 25th of October"; without a year the last one.
  std::optional<TimeNs> read_date() {
    size_t at = word() == "the" ? 1 : 0;
    const bool month_first = month_of(word(at)).has_value();
    const auto day = day_of_month(word(month_first ? at + 1 : at));
    const size_t of = !month_first && word(at + 1) == "of" ? 1 : 0;
    const auto month = month_of(word(month_first ? at : at + 1 + of));
    if (!day || !month) return std::nullopt;
    at += 2 + of;
    const auto given = word(at).size() == 4 ? number_of(word(at)) : std::nullopt;
    const std::chrono::year_month_day today(std::chrono::sys_days(std::chrono::days(midnight_ / kDay)));
    std::chrono::year_month_day date(given ? std::chrono::year(*given) : today.year(),
                                     std::chrono::month(*month), std::chrono::day(*day));
    if (!given && date > today) date -= std::chrono::years(1);
    if (!date.ok()) return std::nullopt;
    next_ += at + (given ? 1 : 0);
    return std::chrono::sys_days(date).time_since_epoch().count() * kDay;
  }

  std::optional<TimeSpan> read_time_of_day() {
    if (const auto part = part_of_day(word())) return ++next_, part;
    if ((word() == "early" || word() == "late") && part_of_day(word(1))) {
      TimeSpan half = *part_of_day(word(1));
      const TimeNs middle = half.first + (half.last + 1 - half.first) / 2;
      (word() == "early" ? half.last : half.first) = word() == "early" ? middle - 1 : middle;
      next_ += 2;
      return half;
    }
    auto clock = read_clock();
    if (!clock) return std::nullopt;
    const auto moved = [&](TimeNs hours) {
      return TimeSpan{clock->first + hours * kHour, clock->last + hours * kHour};
    };
    if (word() == "am" || word() == "pm") {
      const bool late = words_[next_++] == "pm";
      if (clock->first >= 13 * kHour) return std::nullopt;
      const bool twelve = clock->first >= 12 * kHour;  // 12:30 am is half past midnight
      return late == twelve ? *clock : moved(late ? 12 : -12);
    }
    if (word() == "in" && word(1) == "the" && part_of_day(word(2))) {
      const bool late = word(2) != "morning" && (word(2) != "night" || clock->first >= 6 * kHour);
      next_ += 3;
      if (late && clock->first < 12 * kHour) return moved(12);
    }
    return clock;
  }

  /// "9am" is "9 am", "8:30am" is "8:30 am".
  void split_half_of_day() {
    const std::string text = word();
    if (text.size() < 3 || !is_digit(text[0]) || !(text.ends_with("am") || text.ends_with("pm"))) return;
    words_.insert(words_.begin() + static_cast<std::ptrdiff_t>(next_) + 1, text.substr(text.size() - 2));
    words_[next_].resize(text.size() - 2);
  }

  std::optional<TimeSpan> read_clock() {
    split_half_of_day();
    if (const auto clock = clock_of(word())) return ++next_, clock;
    const auto at_minute = [](int hour, int minute) {
      const TimeNs start = hour * kHour + minute * kMinute;
      return TimeSpan{start, start + kMinute - 1};
    };
    // "ten past nine", "twenty minutes to ten"
    const bool minutes_named = word(1) == "minutes";
    const std::string to_or_past = word(minutes_named ? 2 : 1);
    if (const auto count = count_of(word());
        count && *count > 0 && *count < 60 && word() != "a" && (to_or_past == "past" || to_or_past == "to")) {
      const auto hour = count_of(word(minutes_named ? 3 : 2));
      if (!hour || *hour < 0 || *hour > 24) return std::nullopt;
      next_ += minutes_named ? 4 : 3;
      return at_minute(*hour, to_or_past == "past" ? *count : -*count);
    }
    const bool half =
        word() == "half" && word(1) != "past" && count_of(word(1)) && word(1) != "an" && word(1) != "a";
    const auto shift = half && is("half")      ? 30
                       : is("half", "past")    ? 30
                       : is("quarter", "past") ? 15
                       : is("quarter", "to")   ? -15
                                               : 0;
    if (shift != 0) split_half_of_day();
    const std::string text = word();
    const auto hour = text == "a" || text == "an" ? std::nullopt : count_of(text);
    if (!hour || *hour < 0 || *hour > 24 || text.size() > 6) return std::nullopt;
    ++next_;
    is("o'clock");
    // "eight thirty", "8 30"
    const auto minute = count_of(word());
    const bool named = minute && *minute >= 10 && *minute < 60 && shift == 0 && *hour > 0 &&
                       (word().size() == 2 || !is_digit(word()[0])) && word() != "ten" &&
                       word(1) != "minutes";
    if (named) ++next_;
    return at_minute(*hour, named ? *minute : shift);
  }

  std::vector<std::string> words_;
  size_t next_ = 0;
  TimeNs now_, midnight_;
};

}  // namespace

TimeReader::TimeReader(const Store& store) : last_scene_(0), zone_(store.time_zone()) {
  const std::vector<TimeNs> scenes = store.scene_times_at_ends(1);
  last_scene_ = scenes.empty() ? now() : scenes.back();
  if (!scenes.empty()) first_scene_ = scenes.front();
}

TimeSpan TimeReader::read(std::string_view text) const {
  const auto span = try_read(text);
  if (!span)
    throw Error(fmt::format("'{}' is not a time", text), {},
                "write 2026-05-01T08:30:00Z, 2026-05-01 08:30, 08:30, 1 May at 9:00, yesterday 9:00, this "
                "morning, last Monday at nine, or 20 minutes ago");
  return *span;
}

std::optional<TimeSpan> TimeReader::try_read(std::string_view text) const {
  const TimeNs last_scene = std::clamp(last_scene_, kEarliest, kLatest);
  if (const auto moment = moment_of(time_words(text), last_scene, zone_)) return TimeSpan{*moment, *moment};
  if (is_date(std::string(text.substr(0, 10))) && has_zone(text)) {
    try {
      const TimeNs time = parse_time(text);
      return TimeSpan{time, time};
    } catch (const Error&) {  // not in ISO 8601: "2026-10-25 02:30+02:00"
    }
  }
  if (const auto offset = offset_of(text)) {
    const auto local = read_local(text.substr(0, text.size() - kOffsetLength));
    const TimeNs first = local ? local->first - *offset : 0;
    const bool is_one_of_two = local && zone_.first_moment(local->first) < zone_.last_moment(local->first) &&
                               zone_.local(first) == local->first;
    if (is_one_of_two) return TimeSpan{first, local->last - *offset};
  }
  if (const auto local = read_local(text)) {
    const auto afternoon = afternoon_of(text);
    const bool before_all = first_scene_ && in_utc(*local).last < *first_scene_ - kBeforeFirst;
    return before_all && afternoon ? *afternoon : in_utc(*local);
  }
  return std::nullopt;
}

std::optional<TimeSpan> TimeReader::read_local(std::string_view text) const {
  const TimeNs now = zone_.local(std::clamp(last_scene_, kEarliest, kLatest));
  if (const auto span = TimePhrase(time_words(text), now).read()) return span;
  const std::string whole(text);
  if (whole.size() < 11 || !is_date(whole.substr(0, 10)) || has_zone(whole)) return std::nullopt;
  try {  // a local ISO 8601 time
    if (const auto clock = clock_of(whole.substr(11))) {
      const TimeNs date = parse_time(whole.substr(0, 10));
      return TimeSpan{date + clock->first, date + clock->last};
    }
    const TimeNs time = parse_time(whole + "Z");
    return TimeSpan{time, time};
  } catch (const Error&) {
    return std::nullopt;
  }
}

bool TimeReader::is_repeated(std::string_view text, bool end) const {
  const auto local = read_local(text);
  const auto read = try_read(text);
  if (!local || !read || read->first != in_utc(*local).first) return false;
  const TimeNs moment = end ? local->last : local->first;
  return zone_.first_moment(moment) < zone_.last_moment(moment);
}

std::optional<std::pair<TimeSpan, TimeSpan>> TimeReader::repeated(std::string_view text) const {
  if (!is_repeated(text, false) || !is_repeated(text, true)) return std::nullopt;
  const TimeSpan local = *read_local(text);
  return std::pair(TimeSpan{zone_.first_moment(local.first), zone_.first_moment(local.last)},
                   TimeSpan{zone_.last_moment(local.first), zone_.last_moment(local.last)});
}

std::optional<TimeSpan> TimeReader::afternoon_of(std::string_view text) const {
  const TimeNs now = zone_.local(std::clamp(last_scene_, kEarliest, kLatest));
  std::vector<std::string> words = time_words(text);
  const bool spoken = joined(words, " ").find_first_of(":-") == std::string::npos;
  const auto span = TimePhrase(words, now).read();
  words.emplace_back("pm");
  const auto later = TimePhrase(words, now).read();
  if (!spoken || !span || !later || later->first <= span->first) return std::nullopt;
  const TimeSpan afternoon = {zone_.first_moment(later->first), zone_.last_moment(later->last)};
  return afternoon.first <= last_scene_ ? std::optional(afternoon) : std::nullopt;
}

bool TimeReader::may_be_other_half(std::string_view text) const {
  const auto taken = try_read(text), afternoon = afternoon_of(text);
  if (!taken || !afternoon || !first_scene_) return false;
  return taken->first != afternoon->first && afternoon->last >= *first_scene_;
}

int local_hour(TimeNs time, const TimeZone& zone) {
  const TimeNs local = zone.local(time);
  return static_cast<int>((local - floor_to(local, kDay)) / kHour);
}

int local_weekday(TimeNs time, const TimeZone& zone) {
  const auto days =
      static_cast<int>(floor_to(zone.local(time), kDay) / kDay) + 3;  // the epoch was a Thursday
  return ((days % 7) + 7) % 7;
}

std::optional<int> count_of(const std::string& word) {
  static const std::array<const char*, 21> names = {
      "zero",     "one",     "two",     "three",     "four",     "five",     "six",
      "seven",    "eight",   "nine",    "ten",       "eleven",   "twelve",   "thirteen",
      "fourteen", "fifteen", "sixteen", "seventeen", "eighteen", "nineteen", "twenty"};
  static const std::array<const char*, 3> tens = {"thirty", "forty", "fifty"};
  for (size_t i = 0; i < tens.size(); ++i)
    if (word == tens[i]) return 10 * static_cast<int>(i + 3);
  for (size_t i = 0; i < names.size(); ++i)
    if (word == names[i]) return static_cast<int>(i);
  if (word == "a" || word == "an") return 1;
  return number_of(word);
}

std::optional<int> weekday_of(std::string_view name) {
  static constexpr std::array<std::string_view, 7> kDays = {"monday", "tuesday",  "wednesday", "thursday",
                                                            "friday", "saturday", "sunday"};
  const auto* found = std::ranges::find(kDays, name);
  return found == kDays.end() ? std::nullopt : std::optional(static_cast<int>(found - kDays.begin()));
}

std::string duration_text(TimeNs duration) {
  const int64_t minutes = duration / kMinute;
  if (minutes < 1) return {};
  if (minutes < 60) return fmt::format("{} min", minutes);
  const int64_t hours = duration / kHour;
  if (hours < 24) return fmt::format("{} h {} min", hours, minutes % 60);
  return fmt::format("{} d {} h", hours / 24, hours % 24);
}

TimeWriter::TimeWriter(const Store& store) : zone_(store.time_zone()), with_seconds_(false) {
  constexpr size_t kJudged = 500;  // at either end: a memory may have millions
  const std::vector<TimeNs> scenes = store.scene_times_at_ends(kJudged);
  const auto day = [&](TimeNs time) { return floor_to(zone_.local(time), kDay); };
  with_date_ = scenes.empty() || day(scenes.front()) != day(scenes.back());
  for (size_t i = 0; i < scenes.size(); ++i) {
    if (scenes[i] % kMinute != 0) with_seconds_ = true;
    // Decimals only where whole seconds would not tell neighbours apart.
    if (i > 0 && scenes[i] != scenes[i - 1] && scenes[i] / kSecond == scenes[i - 1] / kSecond) decimals_ = 2;
  }
}

std::string TimeWriter::text(TimeNs time, TimeNs beside) const {
  const std::string date = zone_.format(time).substr(0, 10);
  const bool other_day = !with_date_ && date != zone_.format(beside).substr(0, 10);
  return (other_day ? date + " " : "") + text(time);
}

std::string TimeWriter::text(TimeNs time) const {
  const std::string iso = zone_.format(time);  // 2026-05-01T09:10:00.5+02:00
  std::string text = with_date_ ? iso.substr(0, 10) + " " : "";
  text += iso.substr(11, 5);
  // The last moment of a minute is the end of a time that was given in minutes.
  if (with_seconds_ || (time % kMinute != 0 && (time + 1) % kMinute != 0)) text += iso.substr(16, 3);
  if (decimals_ > 0) {
    const TimeNs rest = time - floor_to(time, kSecond);
    text += fmt::format(".{:02}", rest / (kSecond / 100));
  }
  const TimeNs local = zone_.local(time);
  if (zone_.first_moment(local) < zone_.last_moment(local)) text += iso.substr(iso.size() - kOffsetLength);
  return text;
}

std::string TimeWriter::span_text(TimeNs from, TimeNs to) const {
  const std::string a = text(from), b = text(to);
  return a == b ? "at " + a : fmt::format("from {} to {}", a, b);
}

}  // namespace loci::memory
