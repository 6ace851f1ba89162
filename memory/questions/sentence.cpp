#include "memory/questions/sentence.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <set>

#include "mapping/base/error.h"

namespace loci::memory {
namespace {

using Words = std::vector<std::string>;

std::string join(const Words& words, size_t first, size_t last) {
  return fmt::format("{}", fmt::join(words.begin() + static_cast<std::ptrdiff_t>(first),
                                     words.begin() + static_cast<std::ptrdiff_t>(last), " "));
}

/// Lower case, without punctuation, "what's" as "what is". Times and names keep their ':', '-', '_' and '.'.
Words sentence_words(const std::string& sentence) {
  Words words(1);
  for (const char c : sentence) {
    if (std::isspace(static_cast<unsigned char>(c)) != 0 || c == '?' || c == '!' || c == ',' || c == ';' ||
        c == '"')
      words.emplace_back();
    else
      words.back().push_back(c);
  }
  Words result;
  for (std::string& word : words) {
    // ISO 8601 times keep their T and Z.
    if (!word.empty() && std::isdigit(static_cast<unsigned char>(word[0])) == 0)
      std::transform(word.begin(), word.end(), word.begin(),
                     [](unsigned char byte) { return static_cast<char>(std::tolower(byte)); });
    while (word.ends_with('.') || word.ends_with(':')) word.pop_back();
    static const std::set<std::string> contracted = {"what's",  "where's", "who's",
                                                     "there's", "it's",    "how's"};
    static const std::set<std::string> days = {"mondays", "tuesdays",  "wednesdays", "thursdays",
                                               "fridays", "saturdays", "sundays"};
    if (days.contains(word)) word.pop_back();
    if (contracted.contains(word)) {
      result.push_back(word.substr(0, word.size() - 2));
      result.emplace_back("is");
    } else if (!word.empty()) {
      result.push_back(word);
    }
  }
  return result;
}

/// A time that was cut out of a sentence.
struct Span {
  std::string from, to;  ///< "" = open
  bool moment = false;   ///< one short time
};

/// An hour alone ("nine") is a time only after a word that says so: "the red one" is none.
bool is_time(const std::string& text, const TimeReader& times, bool introduced) {
  if (!times.try_read(text)) return false;
  if (introduced) return true;
  const bool bare = text.find_first_of(" :-") == std::string::npos;
  static const std::set<std::string> names = {"now",      "today",    "yesterday", "tonight",   "noon",
                                              "midnight", "monday",   "tuesday",   "wednesday", "thursday",
                                              "friday",   "saturday", "sunday"};
  return !bare || names.contains(text) || text.ends_with("am") || text.ends_with("pm");
}

std::optional<Span> read_span(const Words& words, size_t first, size_t last, const TimeReader& times) {
  const auto time = [&](size_t a, size_t b, bool introduced) {
    return a < b && is_time(join(words, a, b), times, introduced);
  };
  const std::string& head = words[first];
  if (head == "between" || head == "from") {
    const std::string middle = head == "between" ? "and" : "to";
    for (size_t i = first + 2; i + 1 < last; ++i)
      if ((words[i] == middle || words[i] == "until" || words[i] == "till") && time(first + 1, i, true) &&
          time(i + 1, last, true))
        return Span{join(words, first + 1, i), join(words, i + 1, last)};
    return std::nullopt;
  }
  if ((head == "since" || head == "after") && time(first + 1, last, true))
    return Span{join(words, first + 1, last), ""};
  if ((head == "until" || head == "till" || head == "before" || head == "by") && time(first + 1, last, true))
    return Span{"", join(words, first + 1, last)};
  static const std::set<std::string> introductions = {"at", "around", "about", "on", "in", "during"};
  const bool introduced = introductions.contains(head);
  if (!time(first + (introduced ? 1 : 0), last, introduced && head != "in" && head != "on"))
    return std::nullopt;
  const std::string text = join(words, first + (introduced ? 1 : 0), last);
  const TimeSpan span = times.read(text);
  return Span{text, text, span.last - span.first < 3600 * kSecond};
}

/// Cuts out the longest time, the last of equally long ones.
std::optional<Span> cut_time(Words& words, const TimeReader& times) {
  for (size_t length = std::min<size_t>(words.size(), 12); length > 0; --length)
    for (size_t first = words.size() - length + 1; first-- > 0;)
      if (const auto span = read_span(words, first, first + length, times)) {
        words.erase(words.begin() + static_cast<std::ptrdiff_t>(first),
                    words.begin() + static_cast<std::ptrdiff_t>(first + length));
        return span;
      }
  return std::nullopt;
}

/// All plain sequences of words that a form stands for.
class Expander {
 public:
  explicit Expander(const std::string& form) : form_(form) {}
  std::vector<Words> expand() { return alternatives('\0'); }

 private:
  std::vector<Words> alternatives(char end) {
    std::vector<Words> all, current = {{}};
    std::string word;
    const auto append = [&](const std::vector<Words>& tails) {
      std::vector<Words> longer;
      for (const Words& head : current)
        for (const Words& tail : tails) {
          longer.push_back(head);
          longer.back().insert(longer.back().end(), tail.begin(), tail.end());
        }
      current = std::move(longer);
    };
    const auto end_word = [&] {
      if (!word.empty()) append({{word}});
      word.clear();
    };
    while (next_ < form_.size() && form_[next_] != end) {
      const char c = form_[next_++];
      if (c == ' ') {
        end_word();
      } else if (c == '|') {
        end_word();
        all.insert(all.end(), current.begin(), current.end());
        current = {{}};
      } else if (c == '(' || c == '[') {
        std::vector<Words> inner = alternatives(c == '(' ? ')' : ']');
        ++next_;
        if (c == '[') inner.emplace_back();
        append(inner);
      } else {
        word.push_back(c);
      }
    }
    end_word();
    all.insert(all.end(), current.begin(), current.end());
    return all;
  }

  const std::string& form_;
  size_t next_ = 0;
};

using Slots = std::map<std::string, std::string>;

/// Words that say nothing about which object or place is meant.
const std::set<std::string> kSlotFillers = {"any",  "some",  "all", "my",    "our",
                                            "your", "still", "of",  "those", "these"};

bool match(const Words& form, size_t f, const Words& words, size_t w, Slots& slots) {
  if (f == form.size()) return w == words.size();
  if (!form[f].starts_with('<'))
    return w < words.size() && words[w] == form[f] && match(form, f + 1, words, w + 1, slots);
  // As few words as possible: "<X> on <P>" is parted at the first "on".
  for (size_t end = w + 1; end <= words.size(); ++end) {
    if (!match(form, f + 1, words, end, slots)) continue;
    size_t first = w;
    while (first + 1 < end && kSlotFillers.contains(words[first])) ++first;
    slots[form[f].substr(1, form[f].size() - 2)] = join(words, first, end);
    return true;
  }
  return false;
}

/// A form with everything that it stands for.
struct Form {
  const SentencePattern* pattern;
  std::vector<Words> sequences;
};

const std::vector<Form>& forms() {
  static const std::vector<Form> all = [] {
    std::vector<Form> result;
    for (const SentencePattern& pattern : sentence_patterns())
      result.push_back({&pattern, Expander(pattern.sentence).expand()});
    return result;
  }();
  return all;
}

CommandLine fill(const std::string& command, const Slots& slots) {
  CommandLine line;
  Words tokens(1);
  for (const char c : command)
    if (c == ' ')
      tokens.emplace_back();
    else
      tokens.back().push_back(c);
  for (size_t i = 0; i < tokens.size(); ++i) {
    const auto value = [&](const std::string& token) {
      return token.starts_with('{') ? slots.at(token.substr(1, token.size() - 2)) : token;
    };
    if (i == 0)
      line.verb = tokens[i];
    else if (tokens[i].starts_with("--")) {
      line.options[tokens[i].substr(2)] = {value(tokens[i + 1])};
      ++i;
    } else
      line.words.push_back(value(tokens[i]));
  }
  return line;
}

void add_time(CommandLine& line, Period period, const Span& span) {
  if (period == Period::during) {
    line.options["during"] = {span.from == span.to ? span.from : span.from + " to " + span.to};
    return;
  }
  if (period == Period::either && !span.moment) line.verb = "history";
  const bool one_moment = period == Period::at || (period == Period::either && span.moment);
  if (one_moment && !span.to.empty())
    line.options["at"] = {span.to};
  else if (one_moment)
    line.options["at"] = {"now"};  // "since nine" of what is the case is what is the case now
  else if (!span.from.empty() && !span.to.empty())
    line.options["between"] = {span.from, span.to};
  else if (!span.from.empty())
    line.options["from"] = {span.from};
  else
    line.options["to"] = {span.to};
}

/// How alike two sentences are: shared words, and a little for shared letters in the others.
double likeness(const Words& a, const Words& b) {
  double shared = 0;
  for (const std::string& word : a) {
    if (std::find(b.begin(), b.end(), word) != b.end())
      shared += 1;
    else if (!nearest_name(word, b).empty())
      shared += 0.7;
  }
  return shared / static_cast<double>(std::max<size_t>(1, a.size() + b.size()));
}

std::string quoted(const std::string& word) {
  const bool plain = !word.empty() && word.find_first_not_of(
                                          "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                          "0123456789_-:.+,/") == std::string::npos;
  if (plain) return word;
  std::string escaped;
  for (const char c : word) {
    if (c == '\'') escaped.append("'\\'");
    escaped.push_back(c);
  }
  return fmt::format("'{}'", escaped);
}

}  // namespace

std::string CommandLine::text() const {
  std::string text = verb;
  for (const std::string& word : words) text.append(" ").append(quoted(word));
  for (const auto& [name, values] : options) {
    text.append(" --").append(name);
    for (const std::string& value : values) text.append(" ").append(quoted(value));
  }
  return text;
}

std::string CommandLine::joined_words() const {
  return join(words, 0, words.size());
}

std::string CommandLine::option(const std::string& name) const {
  const auto found = options.find(name);
  return found == options.end() || found->second.empty() ? "" : found->second.front();
}

std::optional<CommandLine> understand(const std::string& sentence, const TimeReader& times) {
  Words words = sentence_words(sentence);
  if (words.size() > 60) return std::nullopt;
  for (size_t i = 0; i + 1 < words.size(); ++i)
    if (words[i] == "right" && words[i + 1] == "now")
      words.erase(words.begin() + static_cast<std::ptrdiff_t>(i));
  const std::optional<Span> span = cut_time(words, times);
  static const std::set<std::string> articles = {"the", "a", "an", "please"};
  std::erase_if(words, [&](const std::string& word) { return articles.contains(word); });
  static const std::vector<Words> openings = {{"can", "you", "tell", "me"},
                                              {"could", "you", "tell", "me"},
                                              {"do", "you", "know"},
                                              {"do", "you", "remember"},
                                              {"tell", "me"},
                                              {"can", "you"},
                                              {"could", "you"},
                                              {"would", "you"},
                                              {"will", "you"},
                                              {"robot"},
                                              {"hey"},
                                              {"hello"}};
  // Openings are left out where the rest is a sentence: "do you know where the milk is".
  std::vector<Words> tries;
  for (const Words& opening : openings)
    if (words.size() > opening.size() && std::equal(opening.begin(), opening.end(), words.begin()))
      tries.emplace_back(words.begin() + static_cast<std::ptrdiff_t>(opening.size()), words.end());
  tries.push_back(words);
  for (const Words& tried : tries)
    for (const Form& form : forms())
      for (const Words& sequence : form.sequences) {
        Slots slots;
        if (!match(sequence, 0, tried, 0, slots)) continue;
        const bool open = span && (span->from.empty() || span->to.empty());
        if (span && form.pattern->period == Period::none) continue;
        if (open && form.pattern->period == Period::during) continue;
        const bool since = form.pattern->command.ends_with("{T}");  // takes the beginning of the time itself
        if (since && (!span || span->from.empty())) continue;
        if (since) slots["T"] = span->from;
        CommandLine line = fill(form.pattern->command, slots);
        if (span && !since) add_time(line, form.pattern->period, *span);
        return line;
      }
  return std::nullopt;
}

std::vector<std::string> nearest_sentences(const std::string& sentence, size_t count) {
  const Words asked = sentence_words(sentence);
  std::vector<std::pair<double, std::string>> ranked;
  for (const SentencePattern& pattern : sentence_patterns())
    if (!pattern.example.empty())
      ranked.emplace_back(-likeness(asked, sentence_words(pattern.example)), pattern.example);
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> nearest;
  for (size_t i = 0; i < std::min(count, ranked.size()); ++i) nearest.push_back(ranked[i].second);
  return nearest;
}

}  // namespace loci::memory
