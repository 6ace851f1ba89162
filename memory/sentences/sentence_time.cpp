#include "memory/sentences/sentence_time.h"
#include "memory/sentences/word_forms.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "mapping/base/text/text.h"
#include "memory/wordnet/wordnet.h"

namespace loci::memory {
namespace {

constexpr TimeNs kLongSpan = kHour;  ///< from which on it is not a moment
constexpr size_t kMaxWordsOfTime = 12;

using WordSet = std::set<std::string>;

/// Reads each text that may be a time once: spans of a sentence overlap.
class TimesOfSentence {
 public:
  explicit TimesOfSentence(const TimeReader& times) : times_(times) {}
  std::optional<TimeSpan> try_read(const std::string& text) {
    const auto [slot, fresh] = known_.try_emplace(text);
    if (fresh) slot->second = times_.try_read(text);
    return slot->second;
  }
  TimeSpan read(const std::string& text) { return times_.read(text); }

 private:
  const TimeReader& times_;
  std::map<std::string, std::optional<TimeSpan>> known_;
};

/// Words [first, last) of a sentence that may be a time.
class PeriodReader {
 public:
  PeriodReader(const Words& words, size_t first, size_t last, TimesOfSentence& times)
      : words_(words), first_(first), last_(last), times_(times) {}

  std::optional<SentencePeriod> read() const {
    if (auto period = read_last()) return period;
    if (auto period = read_length()) return period;
    if (auto period = read_whole()) return period;
    if (auto period = read_throughout()) return period;
    if (auto period = read_next_to()) return period;
    const std::string& head = words_[first_];
    if (head == "between") return read_between("and");
    if (head == "from") return spanning(read_between("to"));
    static const WordSet begins = {"since", "after"}, ends = {"until", "till", "before", "by", "to"};
    const bool up_to =
        starts_with_words(words_, {"up", "to"}, first_) || starts_with_words(words_, {"up", "until"}, first_);
    if ((begins.contains(head) || (ends.contains(head) && head != "to")) || up_to)
      return read_open(up_to ? "until" : head, first_ + (up_to ? 2 : 1), begins.contains(head));
    return read_moment();
  }

 private:
  std::string join(size_t first, size_t last) const { return join_words(words_, first, last); }
  bool is_time(size_t first, size_t last, bool introduced) const {
    if (first >= last) return false;
    const std::string text = join(first, last);
    if (!times_.try_read(text)) return false;
    // "the morning" is a time, "the two" none.
    if (words_[first] == "the" && last - first == 2)
      return times_.try_read("this " + words_[first + 1]).has_value();
    // An hour alone ("nine") is a time only after a preposition: "the red one" is not a time.
    static const WordSet names = {"now",  "today",  "yesterday", "tonight",
                                  "noon", "midday", "midnight",  "lunchtime"};
    const bool date = is_digit(text[0]) && text.find('-') != std::string::npos;
    return introduced || date || text.find_first_of(" :") != std::string::npos || names.contains(text) ||
           weekday_of(text) || (is_digit(text[0]) && (text.ends_with("am") || text.ends_with("pm")));
  }

  /// "in the last hour", "for the past 20 minutes" as the time ago.
  std::optional<SentencePeriod> read_last() const {
    static const WordSet introductions = {"in", "within", "during", "for", "over"};
    size_t first = first_;
    if (introductions.contains(words_[first])) ++first;
    if (first < last_ && words_[first] == "the") ++first;
    if (first + 1 >= last_ || (words_[first] != "last" && words_[first] != "past")) return std::nullopt;
    std::string amount = join(first + 1, last_);
    if (last_ - first == 2) amount = (amount == "hour" ? "an " : "a ") + amount;
    if (amount == "half hour") amount = "half an hour";
    if (!times_.try_read(amount + " ago")) return std::nullopt;
    SentencePeriod period{amount + " ago", ""};
    period.spans = words_[first_] == "for";
    return period;
  }

  /// "Has it been there for two hours", "for more than an hour": since so long ago.
  std::optional<SentencePeriod> read_length() const {
    const bool perfect = words_[0] == "has" || words_[0] == "have";
    if (!perfect || words_[first_] != "for") return std::nullopt;
    size_t first = first_ + 1;
    for (const Words& least : {Words{"more", "than"}, {"at", "least"}, {"over"}})
      if (starts_with_words(words_, least, first)) first += least.size();
    if (first >= last_ || !times_.try_read(join(first, last_) + " ago")) return std::nullopt;
    return spanning(SentencePeriod{join(first, last_) + " ago", ""});
  }

  static std::optional<SentencePeriod> spanning(std::optional<SentencePeriod> period) {
    if (period) period->spans = true;
    return period;
  }

  /// "all day", "throughout the morning", "all day yesterday", "all of Monday".
  std::optional<SentencePeriod> read_whole() const {
    static const std::vector<Words> wholes = {{"all"},
                                              {"all", "of"},
                                              {"the", "whole", "of"},
                                              {"the", "whole"},
                                              {"all", "through", "the"},
                                              {"throughout", "the"},
                                              {"during", "the"},
                                              {"through", "the"},
                                              {"in", "the", "course", "of", "the"},
                                              {"over", "the", "course", "of", "the"},
                                              {"over", "the"},
                                              {"that"}};
    static const WordSet within = {"that", "during", "in", "over"};
    for (const Words& whole : wholes)
      if (starts_with_words(words_, whole, first_))
        if (const std::string text = day_or_part(first_ + whole.size()); !text.empty())
          return SentencePeriod{text, text, false, !within.contains(whole[0])};
    return std::nullopt;
  }

  /// From a word on, "day", "morning", "yesterday", "day on Monday", "morning yesterday"; "" = none.
  std::string day_or_part(size_t first) const {
    if (first >= last_) return "";
    const std::string& part = words_[first];
    size_t day = first + 1;
    if (day + 1 < last_ && (words_[day] == "on" || words_[day] == "of")) ++day;
    std::string text = join(day, last_);
    if (day == last_)
      text = part == "day" ? "today" : part == "yesterday" || weekday_of(part) ? part : "this " + part;
    else if (part != "day")
      text += " " + part;
    const auto span = times_.try_read(text);
    return span && span->last - span->first >= kLongSpan ? text : "";
  }

  /// "the whole time from ten to two".
  std::optional<SentencePeriod> read_throughout() const {
    if (words_[first_] != "throughout") return std::nullopt;
    auto period = read_between("and");
    if (!period) period = read_between("to");
    if (period) period->throughout = true;
    return period;
  }

  /// "right after lunch", "just before noon": the hour next to it.
  std::optional<SentencePeriod> read_next_to() const {
    static const WordSet near = {"right",       "just",    "straight", "directly",
                                 "immediately", "shortly", "soon",     "briefly"};
    if (last_ - first_ < 3 || !near.contains(words_[first_]) || !is_time(first_ + 2, last_, true))
      return std::nullopt;
    const TimeSpan span = times_.read(join(first_ + 2, last_));
    if (words_[first_ + 1] == "after")
      return SentencePeriod{format_time(span.last), format_time(span.last + kHour)};
    if (words_[first_ + 1] == "before")
      return SentencePeriod{format_time(span.first - kHour), format_time(span.first)};
    return std::nullopt;
  }

  std::optional<SentencePeriod> read_between(const std::string& middle) const {
    for (size_t i = first_ + 2; i + 1 < last_; ++i) {
      if ((words_[i] != middle && words_[i] != "until" && words_[i] != "till") ||
          !is_time(first_ + 1, i, true) || !is_time(i + 1, last_, true))
        continue;
      std::string from = join(first_ + 1, i);
      std::string to = join(i + 1, last_);
      // "from ten to two" ends in the afternoon.
      constexpr TimeNs kMaxHours = 8 * kLongSpan;
      const TimeNs begin = times_.read(from).first;
      if (times_.read(to).last < begin && times_.try_read(to + " pm") &&
          times_.read(to + " pm").last < begin + kMaxHours)
        to += " pm";
      // "between 2 and 3 pm" begins in the afternoon, too.
      for (const char* half : {"am", "pm"})
        if (to.ends_with(half) && i == first_ + 2 && times_.try_read(from + " " + half)) {
          const std::string same_half = from + " " + half;
          if (times_.read(same_half).first <= times_.read(to).last) from = same_half;
        }
      return SentencePeriod{from, to};
    }
    return std::nullopt;
  }

  /// "since nine", "before noon", "up to 14:00".
  std::optional<SentencePeriod> read_open(const std::string& head, size_t first, bool begins) const {
    if (!is_time(first, last_, true)) return std::nullopt;
    const std::string text = join(first, last_);
    const TimeSpan span = times_.read(text);
    const bool is_long = span.last - span.first >= kLongSpan;
    SentencePeriod period{"", head == "before" && is_long ? format_time(span.first) : text};
    if (begins) period = {head == "after" && is_long ? format_time(span.last) : text, ""};
    period.spans = head == "since" || head == "until" || head == "till";
    return period;
  }

  std::optional<SentencePeriod> read_moment() const {
    static const WordSet introductions = {"at", "around", "about", "on", "in", "during", "over", "for"};
    static const WordSet vague = {"exactly", "about", "around", "roughly", "precisely", "sharp"};
    const std::string& head = words_[first_];
    size_t first = first_;
    if (introductions.contains(head)) ++first;
    const bool introduced = first > first_ && head != "in" && head != "on" && head != "for";
    if (introduced && first < last_ && vague.contains(words_[first])) ++first;
    if (!is_time(first, last_, introduced)) return std::nullopt;
    const std::string text = join(first, last_);
    const TimeSpan span = times_.read(text);
    SentencePeriod period{text, text, span.last - span.first < kLongSpan};
    const auto is_about = [](const std::string& word) { return word == "around" || word == "about"; };
    period.around = period.moment && (is_about(head) || (first > first_ && is_about(words_[first - 1])));
    return period;
  }

  const Words& words_;
  size_t first_, last_;
  TimesOfSentence& times_;
};

using Rewording = std::pair<Words, Words>;  ///< what stands for what

/// The longest first.
std::vector<Rewording> rewordings_of_times() {
  static constexpr std::pair<const char*, const char*> kForms[] = {
      {"(right|just|by|even|as of) now", "now"},
      {"(at|in) (the|this) [very|present|current] (moment|instant|second|minute)", "now"},
      {"at present|at this (point|time)|this (instant|very moment)|at the present time|nowadays|these days",
       "now"},
      {"(up to|until|till|up until) now", ""},
      {"(so|thus) far|to date|until today", ""},
      {"as (of|at)", "at"},
      {"at all", ""},
      {"(at|in) any (point|time|stage)|at (some|one) (point|time|stage)|at any (point|time) in time", "ever"},
      {"earlier (today|on today|in the day)", "today"},
      {"some time today|sometime today|in the course of (the|this) day|over the day|(during|in) the day",
       "today"},
      {"(in|at) the (last|latest|current|final|present) (scene|frame|image|snapshot)", "now"},
      {"(this|the) (very|same) day|on (this|that) day", "today"},
      {"earlier this", "this"},
      {"earlier on", "earlier"},
      {"sometime (this|in the)", "this"},
      {"(the (whole|entire|full) time|all the time|all that time|continuously|without a break) "
       "(from|between)",
       "throughout"},
      {"(the (whole|entire) time|all the time|continuously|the (whole|entire) day|all day long)", "all day"},
      {"(compared|comparing) (with|to)|in comparison (with|to)|relative to|as (against|opposed to)", "since"},
      {"breakfast time", "breakfast"},
      {"lunch time", "lunch"},
      {"(dinner|supper) time", "dinner"},
      {"breakfasttime", "breakfast"},
      {"of today|for today|on today", "today"},
      {"(go|goes|going|went|gone) on today", "happened today"},
      {"(when|while) (i|we|someone) (had|ate|made|was having|were having|prepared) (breakfast)",
       "at breakfast"},
      {"(when|while) (i|we|someone) (had|ate|made|was having|were having|prepared) (lunch)", "at lunch"},
      {"(when|while) (i|we|someone) (had|ate|made|was having|were having|prepared|cooked) (dinner|supper)",
       "at dinner"},
      {"after (i|we|someone) (had|ate|finished|had had) breakfast", "after breakfast"},
      {"after (i|we|someone) (had|ate|finished|had had) lunch", "after lunch"},
      {"after (i|we|someone) (had|ate|finished|had had) (dinner|supper)", "after dinner"},
      {"before (i|we|someone) (had|ate|made) breakfast", "before breakfast"},
      {"before (i|we|someone) (had|ate|made) lunch", "before lunch"},
      {"before (i|we|someone) (had|ate|made) (dinner|supper)", "before dinner"},
      {"(when|while) breakfast (began|started|was on)", "at breakfast"},
      {"(when|while) lunch (began|started|was on)", "at lunch"},
      {"(when|while) (dinner|supper) (began|started|was on)", "at dinner"},
      {"(a|the) couple of", "two"},
      {"couple of", "two"},
      {"(a few|several|some) (minutes|mins)", "5 minutes"},
      {"(an hour and a half|one and a half hours|1 1/2 hours|1.5 hours)", "90 minutes"},
      {"(a quarter of an hour|quarter of an hour)", "15 minutes"},
      {"three quarters of an hour", "45 minutes"},
      {"the last half an hour", "the last 30 minutes"},
      {"the last half hour", "the last 30 minutes"},
      {"the past half hour", "the last 30 minutes"},
      {"first thing (in the|this) morning|in the early hours", "this early morning"},
      {"early (in the|this) morning", "this early morning"},
      {"(late|later) [on] (in the|this) morning", "this late morning"},
      {"early (in the|this) afternoon", "this early afternoon"},
      {"(late|later) [on] (in the|this) afternoon", "this late afternoon"},
      {"early (in the|this) evening", "this early evening"},
      {"(late|later) [on] (in the|this) evening", "this late evening"},
      {"noonish|noontime|high noon|12 noon|twelve noon", "noon"},
      {"in the middle of the day", "at noon"},
      {"in the middle of the (morning)", "in the morning"},
      {"in the middle of the (afternoon)", "in the afternoon"},
      {"in the middle of the (evening)", "in the evening"},
      {"12 midnight|twelve midnight", "midnight"},
      {"overnight|over night|(during|in|through|throughout) the night|during last night", "last night"},
      {"[in|during|over] the night (to|before) monday|[in|during|over] the night from sunday to monday",
       "sunday night"},
      {"[in|during|over] the night (to|before) tuesday|[in|during|over] the night from monday to tuesday",
       "monday night"},
      {"[in|during|over] the night (to|before) wednesday|[in|during|over] the night from tuesday to "
       "wednesday",
       "tuesday night"},
      {"[in|during|over] the night (to|before) thursday|[in|during|over] the night from wednesday to "
       "thursday",
       "wednesday night"},
      {"[in|during|over] the night (to|before) friday|[in|during|over] the night from thursday to friday",
       "thursday night"},
      {"[in|during|over] the night (to|before) saturday|[in|during|over] the night from friday to saturday",
       "friday night"},
      {"[in|during|over] the night (to|before) sunday|[in|during|over] the night from saturday to sunday",
       "saturday night"},
      {"(hrs|hr)", "hours"},
      {"mins", "minutes"},
      {"o'clock|oclock|o clock", ""},
      {"o'clock sharp", ""},
  };
  std::vector<Rewording> all;
  for (const auto& [form, by] : kForms)
    for (Words& from : expand_form(form)) all.emplace_back(std::move(from), words_of(by));
  std::ranges::stable_sort(all, std::ranges::greater(),
                           [](const Rewording& one) { return one.first.size(); });
  return all;
}

/// "seventeen hundred [hours]" is 17:00.
void read_hundreds(Words& words) {
  for (size_t i = 0; i + 1 < words.size(); ++i)
    if (const auto hour = count_of(words[i]); hour && *hour <= 24 && words[i + 1] == "hundred") {
      const bool named = i + 2 < words.size() && words[i + 2] == "hours";
      replace_words(words, i, named ? 3 : 2, {fmt::format("{:02}:00", *hour)});
    }
}

/// "... first thing" ends what happened early.
void read_first_of_day(Words& words) {
  static const WordSet articles = {"the", "a", "which", "what", "very"};
  if (words.size() > 3 && words[words.size() - 1] == "thing" && words[words.size() - 2] == "first" &&
      !articles.contains(words[words.size() - 3]))
    replace_words(words, words.size() - 2, 2, {"this", "early", "morning"});
}

/// "9 a.m" is "9 am" (its last point is gone before), "8.30" is 8:30.
void read_points(Words& words) {
  for (std::string& word : words) {
    if (word == "a.m" || word == "p.m") word.erase(1, 1);
    if (word.size() > 4 && (word.ends_with("a.m") || word.ends_with("p.m"))) word.erase(word.size() - 2, 1);
    if ((word.size() == 4 || word.size() == 5) && word[word.size() - 3] == '.' &&
        word.find_first_not_of("0123456789.") == std::string::npos)
      word[word.size() - 3] = ':';
  }
}

/// Times in the words that TimeReader knows: "at the moment" is now, "earlier today" is today.
void normalize_times(Words& words) {
  static const std::vector<Rewording> rewordings = rewordings_of_times();
  for (const auto& [from, to] : rewordings)
    for (size_t i = 0; i < words.size(); ++i)
      if (starts_with_words(words, from, i)) replace_words(words, i, from.size(), to);
  read_hundreds(words);
  read_first_of_day(words);
  read_points(words);
}

/// "After my wife came home at five" is "after five", "while I was out from nine to ten" "from nine to ten":
/// what a person did, beside when.
void drop_activities(Words& words, const TimeReader& times) {
  static const WordSet spans = {"since", "after", "before", "until", "till"}, moments = {"when", "while"},
                       prepositions = {"at", "around", "about", "between", "from"};
  constexpr size_t kMaxWords = 8, kMaxTime = 4;
  const auto is_name = [](const std::string& word) { return is_household_noun(word) || word == "it"; };
  const auto begins_time = [&](size_t first) {
    for (size_t count = std::min(kMaxTime, words.size() - first); count > 0; --count)
      if (times.try_read(join_words(words, first, first + count))) return true;
    return false;
  };
  for (size_t i = 0; i + 3 < words.size(); ++i) {
    const bool span = spans.contains(words[i]);
    const bool article = class_of(lemma_of(words[i + 1])) == WordClass::article;
    const std::string& subject = words[article ? i + 2 : i + 1];
    const bool person = class_of(lemma_of(subject)) == WordClass::person || subject == "they" ||
                        (article && wordnet::is_person(subject));
    if ((!span && !moments.contains(words[i])) || !person) continue;
    for (size_t j = i + 2; j + 1 < std::min(words.size(), i + kMaxWords) && !is_name(words[j]); ++j) {
      const bool range = words[j] == "between" || words[j] == "from";
      if (!prepositions.contains(words[j]) || (span && range) || !begins_time(j + 1)) continue;
      const size_t first = span ? i + 1 : i, last = span ? j + 1 : j;
      replace_words(words, first, last - first, {});
      break;
    }
  }
}

std::optional<SentencePeriod> cut_longest(Words& words, TimesOfSentence& times) {
  for (size_t length = std::min(words.size(), kMaxWordsOfTime); length > 0; --length)
    for (size_t first = words.size() - length + 1; first-- > 0;) {
      if (first > 0 && is_digit(words[first][0]) && is_furniture(words[first - 1]))
        continue;  // "drawer 1 in the morning"
      if (auto period = PeriodReader(words, first, first + length, times).read()) {
        replace_words(words, first, length, {});
        return period;
      }
    }
  return std::nullopt;
}

/// "between 8 and 9" with "yesterday"; unset when both cannot hold.
std::optional<SentencePeriod> combined(const SentencePeriod& inner, const SentencePeriod& outer,
                                       const TimeReader& times) {
  // "After lunch and before dinner".
  if (inner.to.empty() && outer.from.empty() && times.read(inner.from).first <= times.read(outer.to).last)
    return SentencePeriod{inner.from, outer.to};
  if (outer.from != outer.to) return std::nullopt;
  const TimeSpan day = times.read(outer.from);
  SentencePeriod period = inner;
  for (std::string* text : {&period.from, &period.to}) {
    if (text->empty()) continue;
    if (const auto on_day = times.try_read(outer.from + " " + *text)) *text = outer.from + " " + *text;
    const TimeSpan span = times.read(*text);
    if (span.first < day.first || span.last > day.last) return std::nullopt;
  }
  return period;
}

}  // namespace

std::optional<SentencePeriod> cut_time(Words& words, const TimeReader& times) {
  normalize_times(words);
  drop_activities(words, times);
  TimesOfSentence texts(times);
  auto first = cut_longest(words, texts);
  if (!first) return std::nullopt;
  Words rest = words;
  const auto second = cut_longest(rest, texts);
  if (!second) return first;
  auto both = combined(*first, *second, times);
  if (!both) both = combined(*second, *first, times);
  if (both) words = rest;
  if (both && !words.empty() && words.back() == "and") words.pop_back();
  return both ? both : first;
}

std::optional<SentencePeriod> time_at(const Words& words, size_t& at, const TimeReader& times) {
  constexpr size_t kMaxWords = 6;
  for (size_t count = std::min(kMaxWords, words.size() - at); count > 0; --count) {
    Words time(words.begin() + static_cast<std::ptrdiff_t>(at),
               words.begin() + static_cast<std::ptrdiff_t>(at + count));
    auto period = cut_time(time, times);
    if (!period || !time.empty()) continue;
    at += count;
    return period;
  }
  return std::nullopt;
}

}  // namespace loci::memory
