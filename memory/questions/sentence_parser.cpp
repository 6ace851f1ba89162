#include "memory/questions/sentence_parser.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "mapping/base/error.h"
#include "mapping/base/text.h"
#include "memory/questions/lexicon.h"

namespace loci::memory {
namespace {

std::ptrdiff_t offset(size_t index) {
  return static_cast<std::ptrdiff_t>(index);
}

std::string join(const Words& words, size_t first, size_t last) {
  return fmt::format("{}", fmt::join(words.begin() + offset(first), words.begin() + offset(last), " "));
}

// ---- Times.

/// A time that was cut out of a sentence.
struct SentencePeriod {
  std::string from, to;  ///< "" = open
  bool moment = false;   ///< one short time
};

constexpr TimeNs kLongSpan = 3600 * kSecond;  ///< of what is no moment
constexpr size_t kMaxWords = 60;              ///< of a sentence

/// An hour alone ("nine") is a time only after a preposition: "the red one" is not a time.
bool is_time(const std::string& text, const TimeReader& times, bool introduced) {
  if (!times.try_read(text)) return false;
  if (introduced) return true;
  const bool bare = text.find_first_of(" :-") == std::string::npos;
  static const std::set<std::string> names = {"now", "today", "yesterday", "tonight", "noon", "midnight"};
  return !bare || names.contains(text) || weekday_of(text) || text.ends_with("am") || text.ends_with("pm");
}

/// "in the last hour", "for the past 20 minutes" as the time ago.
std::optional<SentencePeriod> read_last(const Words& words, size_t first, size_t last,
                                        const TimeReader& times) {
  static const std::set<std::string> introductions = {"in", "within", "during", "for", "over"};
  if (introductions.contains(words[first])) ++first;
  if (first < last && words[first] == "the") ++first;
  if (first + 1 >= last || (words[first] != "last" && words[first] != "past")) return std::nullopt;
  std::string amount = join(words, first + 1, last);
  if (last - first == 2) amount = (amount == "hour" ? "an " : "a ") + amount;
  if (!times.try_read(amount + " ago")) return std::nullopt;
  return SentencePeriod{amount + " ago", ""};
}

std::optional<SentencePeriod> read_period(const Words& words, size_t first, size_t last,
                                          const TimeReader& times) {
  const auto time = [&](size_t a, size_t b, bool introduced) {
    return a < b && is_time(join(words, a, b), times, introduced);
  };
  if (const auto period = read_last(words, first, last, times)) return period;
  const std::string& head = words[first];
  if (head == "between" || head == "from") {
    const std::string middle = head == "between" ? "and" : "to";
    for (size_t i = first + 2; i + 1 < last; ++i)
      if ((words[i] == middle || words[i] == "until" || words[i] == "till") && time(first + 1, i, true) &&
          time(i + 1, last, true))
        return SentencePeriod{join(words, first + 1, i), join(words, i + 1, last)};
    return std::nullopt;
  }
  static const std::set<std::string> begins = {"since", "after"}, ends = {"until", "till", "before", "by"};
  if ((begins.contains(head) || ends.contains(head)) && time(first + 1, last, true)) {
    const std::string text = join(words, first + 1, last);
    const TimeSpan span = times.read(text);
    const bool is_long = span.last - span.first >= kLongSpan;
    if (begins.contains(head))
      return SentencePeriod{head == "after" && is_long ? format_time(span.last) : text, ""};
    return SentencePeriod{"", head == "before" && is_long ? format_time(span.first) : text};
  }
  static const std::vector<std::pair<Words, std::string>> wholes = {{{"all"}, ""}, {{"the", "whole"}, ""}};
  for (const auto& [whole, none] : wholes)
    if (starts_with_words(words, whole, first) && first + whole.size() + 1 == last) {
      const std::string text = words[last - 1] == "day" ? "today" : "this " + words[last - 1];
      if (times.try_read(text)) return SentencePeriod{text, text};
    }
  static const std::set<std::string> introductions = {"at", "around", "about", "on", "in", "during"};
  const bool introduced = introductions.contains(head);
  if (!time(first + (introduced ? 1 : 0), last, introduced && head != "in" && head != "on"))
    return std::nullopt;
  const std::string text = join(words, first + (introduced ? 1 : 0), last);
  const TimeSpan span = times.read(text);
  return SentencePeriod{text, text, span.last - span.first < kLongSpan};
}

/// Cuts out the longest time, the last of equally long ones.
std::optional<SentencePeriod> cut_time(Words& words, const TimeReader& times) {
  for (size_t length = std::min<size_t>(words.size(), 12); length > 0; --length)
    for (size_t first = words.size() - length + 1; first-- > 0;)
      if (const auto period = read_period(words, first, first + length, times)) {
        replace_words(words, first, length, {});
        return period;
      }
  return std::nullopt;
}

// ---- Rules.

/// Sets of words that many rules use, as $name.
const std::map<std::string, std::string>& word_sets() {
  static const std::map<std::string, std::string> sets = {
      {"be", "(is|was)"},
      {"which", "(what|which)"},
      {"what", "(what|which) [thing]"},
      {"on", "on"},
      {"in", "in"},
      {"at", "(on|in|at)"},
      {"to", "[to|on|in|into|at]"},
      {"that", "[that]"},
      {"last", "[last|lately|recently]"},
  };
  return sets;
}

/// All plain sequences of words that a form stands for.
class FormExpander {
 public:
  explicit FormExpander(std::string form) : form_(std::move(form)) {
    for (size_t begin = form_.find('$'); begin != std::string::npos; begin = form_.find('$', begin)) {
      const size_t end = std::min(form_.find_first_of(" |)]", begin), form_.size());
      form_.replace(begin, end - begin, word_sets().at(form_.substr(begin + 1, end - begin - 1)));
    }
  }
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

  std::string form_;
  size_t next_ = 0;
};

/// One sequence of lemmas and <slots>.
struct Rule {
  Words words;
  const Question* question;
  const SentenceForm* form;
  size_t literals = 0;
};

/// All rules; those with most literal words first.
const std::vector<Rule>& rules() {
  static const std::vector<Rule> all = [] {
    std::vector<Rule> result;
    for (const Question& question : questions())
      for (const SentenceForm& form : question.sentences)
        for (Words& words : FormExpander(form.form).expand()) {
          const auto literals = static_cast<size_t>(
              std::ranges::count_if(words, [](const std::string& word) { return word[0] != '<'; }));
          result.push_back({std::move(words), &question, &form, literals});
        }
    std::ranges::stable_sort(result, std::ranges::greater(), &Rule::literals);
    return result;
  }();
  return all;
}

using Slots = std::map<std::string, std::string>;

bool match(const Words& rule, size_t r, const Tokens& tokens, size_t t, Slots& slots) {
  if (r == rule.size()) return t == tokens.words.size();
  if (rule[r][0] != '<')
    return t < tokens.words.size() && tokens.lemmas[t] == rule[r] && match(rule, r + 1, tokens, t + 1, slots);
  // As few words as possible: "<object> on <place>" is split at the first "on".
  for (size_t end = t + 1; end <= tokens.words.size() && !is_closed_word(tokens.words[end - 1]); ++end) {
    if (!match(rule, r + 1, tokens, end, slots)) continue;
    const size_t first = tokens.words[t] == "of" && t + 1 < end ? t + 1 : t;
    slots[rule[r].substr(1, rule[r].size() - 2)] = join(tokens.words, first, end);
    return true;
  }
  return false;
}

/// "{object} in {part}" with the words of the slots.
std::string filled(std::string value, const Slots& slots) {
  for (size_t begin = value.find('{'); begin != std::string::npos; begin = value.find('{', begin)) {
    const size_t end = value.find('}', begin);
    value.replace(begin, end - begin + 1, slots.at(value.substr(begin + 1, end - begin - 1)));
  }
  return value;
}

/// The query of a rule that matched, without its time.
Query query_of(const Rule& rule, const Slots& slots) {
  Query query{.question = rule.question->name, .asks = rule.form->asks};
  for (const Parameter& parameter : rule.question->parameters)
    if (const auto slot = slots.find(parameter.name); slot != slots.end())
      query.arguments[parameter.name] = slot->second;
  for (const auto& [name, value] : rule.form->arguments) query.arguments[name] = filled(value, slots);
  return query;
}

/// Whether a question takes this time, which becomes its arguments.
bool add_time(Query& query, const Question& question, SentenceTime time,
              const std::optional<SentencePeriod>& period) {
  if (time == SentenceTime::since) {
    if (!period || period->from.empty()) return false;
    query.arguments["unseen-since"] = period->from;
    return true;
  }
  if (!period) return true;
  const auto& [from, to, moment] = *period;
  if (time == SentenceTime::none) return false;
  if (time == SentenceTime::during) {
    if (from.empty() || to.empty()) return false;
    query.arguments["during"] = from == to ? from : from + " to " + to;
    return true;
  }
  if (time == SentenceTime::moment_or_period) {
    if (!moment) query.question = question.over_period;
    time = moment ? SentenceTime::at : SentenceTime::period;
  }
  if (time == SentenceTime::at) {
    query.arguments["at"] = to.empty() ? "now" : to;  // what holds "since nine" is what holds now
    return true;
  }
  if (!from.empty()) query.arguments["from"] = from;
  if (!to.empty()) query.arguments["to"] = to;
  return true;
}

/// Openings and endings that only make a sentence polite.
const std::vector<Words>& openings() {
  static const std::vector<Words> all = FormExpander(
                                            "(can|could|would|will) you [tell me|show me]|(do|would) you "
                                            "(know|remember|happen to know)|you know|"
                                            "tell me|say|i wonder|i (want|need|would like) to "
                                            "know|robot|hey|hello|hi|dear|excuse me|sorry|ok|well|"
                                            "so|and|but|if|whether|that|have you an idea|idea")
                                            .expand();
  return all;
}
const std::vector<Words>& endings() {
  static const std::vector<Words> all =
      FormExpander("for me|robot|thanks|thank you|as well|too|by chance|do you know|at moment|exactly")
          .expand();
  return all;
}

/// The words as they are, and before them the same without openings and endings.
std::vector<Words> without_politeness(Words words) {
  std::vector<Words> readings = {words};
  for (bool stripped = true; stripped;) {
    stripped = false;
    for (const Words& opening : openings())
      if (!stripped && words.size() > opening.size() && starts_with_words(words, opening)) {
        replace_words(words, 0, opening.size(), {});
        stripped = true;
      }
    for (const Words& ending : endings())
      if (!stripped && words.size() > ending.size() &&
          starts_with_words(words, ending, words.size() - ending.size())) {
        words.resize(words.size() - ending.size());
        stripped = true;
      }
    if (stripped) readings.insert(readings.begin(), words);
  }
  return readings;
}

/// A sentence cut into its time and the readings of the rest.
struct Sentence {
  std::optional<SentencePeriod> period;
  std::vector<Tokens> readings;
};

Sentence analysed(Words words, const TimeReader& times) {
  Sentence sentence;
  if (words.size() > kMaxWords) return sentence;
  for (size_t i = 0; i + 1 < words.size(); ++i)
    if (words[i] == "right" && words[i + 1] == "now") words.erase(words.begin() + offset(i));
  sentence.period = cut_time(words, times);
  std::erase_if(words, [](const std::string& word) { return is_empty_word(word); });
  for (Words& reading : without_politeness(std::move(words)))
    sentence.readings.push_back(tokens_of(std::move(reading)));
  return sentence;
}

bool same(const Query& a, const Query& b) {
  return a.question == b.question && a.arguments == b.arguments && a.asks == b.asks;
}

std::vector<Query> matching(const Sentence& sentence) {
  constexpr size_t kMaxReadings = 6;
  std::vector<Query> queries;
  for (const Tokens& reading : sentence.readings)
    for (const Rule& rule : rules()) {
      Slots slots;
      if (queries.size() == kMaxReadings || !match(rule.words, 0, reading, 0, slots)) continue;
      Query query = query_of(rule, slots);
      if (add_time(query, *rule.question, rule.form->time.value_or(rule.question->time), sentence.period) &&
          std::ranges::none_of(queries, [&](const Query& one) { return same(one, query); }))
        queries.push_back(std::move(query));
    }
  return queries;
}

/// The sentence with one word of the grammar that was misspelt by one letter, in all ways.
std::vector<Words> respellings(const Words& words) {
  constexpr size_t kMinLength = 4;  // of words that are corrected
  static const std::set<std::string> known = [] {
    std::set<std::string> all;
    const auto add = [&](const std::string& word) {
      if (word.size() >= kMinLength && word[0] != '<') all.insert(word);
    };
    for (const auto& [word, lemma] : lexicon()) add(word);
    for (const Rule& rule : rules())
      for (const std::string& word : rule.words) add(word);
    return all;
  }();
  std::vector<Words> all;
  for (size_t i = 0; i < words.size(); ++i) {
    if (words[i].size() < kMinLength || known.contains(words[i])) continue;
    for (const std::string& word : known)
      if (is_one_typo(words[i], word)) {
        all.push_back(words);
        all.back()[i] = word;
      }
  }
  return all;
}

/// Shared words, and a little less for words with a similar spelling.
double similarity(const Words& a, const Words& b) {
  double shared = 0;
  for (const std::string& word : a) {
    if (std::ranges::count(b, word) > 0)
      shared += 1;
    else if (!nearest_name(word, b).empty())
      shared += 0.7;
  }
  return shared / static_cast<double>(std::max<size_t>(1, a.size() + b.size()));
}

}  // namespace

std::vector<Query> parse_readings(const std::string& sentence, const TimeReader& times) {
  const Words words = sentence_words(sentence);
  std::vector<Query> queries = matching(analysed(words, times));
  if (queries.empty() && words.size() < kMaxWords)
    for (const Words& other : respellings(words))
      if (queries.empty()) queries = matching(analysed(other, times));
  return queries;
}

std::optional<Query> parse_sentence(const std::string& sentence, const TimeReader& times) {
  std::vector<Query> queries = parse_readings(sentence, times);
  return queries.empty() ? std::nullopt : std::optional(std::move(queries.front()));
}

std::vector<Query> parse_follow_up(const std::string& sentence, const Query& last, const TimeReader& times) {
  const Question* question = find_question(last.question);
  const Sentence parsed = analysed(sentence_words(sentence), times);
  if (question == nullptr || parsed.readings.empty()) return {};
  const Tokens& tokens = parsed.readings.front();
  const std::string text = join(tokens.lemmas, 0, tokens.lemmas.size());
  static const std::map<std::string, Asks> asked_again = {{"why", Asks::reason},
                                                          {"why that", Asks::reason},
                                                          {"how do someone know", Asks::reason},
                                                          {"howsure is someone", Asks::probability},
                                                          {"is someone sure", Asks::probability}};
  Query query = last;
  if (const auto found = asked_again.find(text); found != asked_again.end()) {
    query.asks = found->second;
    return {query};
  }
  const bool is_short =
      sentence_words(sentence).front() == "and" || sentence_words(sentence).front() == "what about";
  if (!is_short || std::ranges::any_of(tokens.words, [](const std::string& w) { return is_closed_word(w); }))
    return {};
  const bool of_place = tokens.words.size() > 1 && (tokens.lemmas[0] == "on" || tokens.lemmas[0] == "in");
  const auto wanted = of_place ? ParameterType::place : ParameterType::object;
  for (const Parameter& parameter : question->parameters)
    if (parameter.type == wanted && query.arguments.contains(parameter.name)) {
      query.arguments[parameter.name] = join(tokens.words, of_place ? 1 : 0, tokens.words.size());
      return {query};
    }
  return {};
}

std::vector<std::string> all_examples() {
  std::vector<std::string> examples;
  for (const Question& question : questions())
    for (const SentenceForm& form : question.sentences)
      if (!form.example.empty()) examples.push_back(form.example);
  return examples;
}

std::vector<std::string> nearest_examples(const std::string& sentence, size_t count) {
  const Words asked = sentence_words(sentence);
  std::vector<std::pair<double, std::string>> ranked;
  for (const std::string& example : all_examples())
    ranked.emplace_back(similarity(asked, sentence_words(example)), example);
  std::ranges::stable_sort(ranked, std::ranges::greater(), &std::pair<double, std::string>::first);
  std::vector<std::string> nearest;
  for (size_t i = 0; i < std::min(count, ranked.size()); ++i) nearest.push_back(ranked[i].second);
  return nearest;
}

}  // namespace loci::memory
