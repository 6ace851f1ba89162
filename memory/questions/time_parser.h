#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "memory/store/store.h"

namespace loci::memory {

/// The period that a time written by people covers: "08:30" is all of that minute, a date all of that day.
struct TimeSpan {
  TimeNs first = 0;
  TimeNs last = 0;  ///< inclusive
};

/// Parses times written by people: ISO 8601, with or without zone; a day ("2026-05-01", "today", "yesterday",
/// "the day before yesterday", "Monday", "last Monday", "this week", "last week"), a time of day ("08:30",
/// "08:30:15", "9 am", "nine", "half past nine", "quarter to ten", "noon", "morning" = 5 to 12, "afternoon" =
/// 12 to 18, "evening" = 18 to 24, "night" = 22 to 6,
/// "breakfast" = 5 to 11, "lunch" = 11 to 15, "dinner" and "supper" = 17 to 23), or both ("yesterday
/// morning", "last Monday at nine"); "last night"; "20 minutes ago", "two hours ago", "half an hour ago";
/// "now". A time of day that clocks show twice may have its offset ("02:30+02:00"). An hour without its half
/// of the day ("three") is in the morning, and in the afternoon where the memory begins more than half an
/// hour later than that of the morning and ends after that of the afternoon. Today and now are those of the
/// memory's last scene, in the memory's zone.
class TimeReader {
 public:
  explicit TimeReader(const Store& store);
  TimeReader(TimeNs last_scene, TimeZone zone, std::optional<TimeNs> first_scene = {})
      : first_scene_(first_scene), last_scene_(last_scene), zone_(zone) {}

  /// Throws Error that shows what can be written.
  TimeSpan read(std::string_view text) const;
  TimeNs now() const { return last_scene_; }
  std::optional<TimeNs> first_scene() const { return first_scene_; }
  /// Unset when it is not a time.
  std::optional<TimeSpan> try_read(std::string_view text) const;
  /// Whether an hour without its half of the day is taken as that of the morning and the memory knows that of
  /// the afternoon, too.
  bool may_be_other_half(std::string_view text) const;
  /// Whether clocks showed the beginning (or the end) of a time twice, as in the hour that they are put back
  /// by, and the text has no offset ("02:30+02:00") that says which is meant. A beginning is the first of the
  /// two, an end the second: a period covers both.
  bool is_repeated(std::string_view text, bool end) const;
  /// The two times by one name; unset for one that clocks showed once.
  std::optional<std::pair<TimeSpan, TimeSpan>> repeated(std::string_view text) const;

 private:
  /// In local time, as it is written; unset for what names a moment whatever clocks show.
  std::optional<TimeSpan> read_local(std::string_view text) const;
  TimeSpan in_utc(const TimeSpan& local) const {
    return {zone_.first_moment(local.first), zone_.last_moment(local.last)};
  }
  /// Of an hour without its half of the day; unset for other times, and where the memory ends before it.
  std::optional<TimeSpan> afternoon_of(std::string_view text) const;

  std::optional<TimeNs> first_scene_ = {};  ///< unset = not known
  TimeNs last_scene_;
  TimeZone zone_;
};

int local_hour(TimeNs time, const TimeZone& zone);     ///< 0 to 23
int local_weekday(TimeNs time, const TimeZone& zone);  ///< 0 = Monday
/// "9", "nine", "a"; unset for other words.
std::optional<int> count_of(const std::string& word);
std::optional<int> weekday_of(std::string_view name);  ///< 0 for "monday"; unset for other words
std::string duration_text(TimeNs duration);            ///< "1 h 5 min"; empty below a minute

/// Writes times for people: the date only when the memory spans more than one day, fractions of a second only
/// when its scenes have them (of a large memory the first and the last ones).
class TimeWriter {
 public:
  explicit TimeWriter(const Store& store);
  TimeWriter(TimeZone zone, bool with_date, int decimals, bool with_seconds)
      : zone_(zone), with_date_(with_date), with_seconds_(with_seconds), decimals_(decimals) {}

  /// With its offset ("02:30+02:00") where clocks showed it twice.
  std::string text(TimeNs time) const;
  /// With the date, too, where it is of another day than `beside`.
  std::string text(TimeNs time, TimeNs beside) const;
  /// "from A to B", or "at A" when both have the same text.
  std::string span_text(TimeNs from, TimeNs to) const;

 private:
  TimeZone zone_;
  bool with_date_ = true;
  bool with_seconds_ = true;
  int decimals_ = 0;
};

}  // namespace loci::memory
