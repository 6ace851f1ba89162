#include "memory/questions/natural_language.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <set>

#include "mapping/base/json.h"
#include "mapping/base/text.h"
#include "memory/questions/events.h"
#include "memory/questions/map_names.h"
#include "memory/questions/objects.h"
#include "memory/questions/snapshot.h"

namespace loci::memory {
namespace {

using Words = std::vector<std::string>;

std::string join(const Words& words, size_t first, size_t last) {
  return fmt::format("{}", fmt::join(words.begin() + static_cast<std::ptrdiff_t>(first),
                                     words.begin() + static_cast<std::ptrdiff_t>(last), " "));
}

/// Lower case, without punctuation, "what's" as "what is". Times and names keep their ':', '-', '_' and '.'.
Words sentence_words(const std::string& sentence) {
  static const std::set<std::string> contracted = {"what's", "where's", "who's", "there's", "it's", "how's"};
  Words result;
  for (std::string& word : words_of(sentence, " \t\n\v\f\r?!,;\"")) {
    // ISO 8601 times keep their T and Z.
    if (std::isdigit(static_cast<unsigned char>(word[0])) == 0) word = lower_case(word);
    while (word.ends_with('.') || word.ends_with(':')) word.pop_back();
    if (word.ends_with("days") && weekday_of(word.substr(0, word.size() - 1))) word.pop_back();
    if (contracted.contains(word)) {
      result.push_back(word.substr(0, word.size() - 2));
      result.emplace_back("is");
    } else if (!word.empty()) {
      result.push_back(word);
    }
  }
  return result;
}

// ---- Times.

/// A time that was cut out of a sentence.
struct SentencePeriod {
  std::string from, to;  ///< "" = open
  bool moment = false;   ///< one short time
};

/// An hour alone ("nine") is a time only after a preposition: "the red one" is no time.
bool is_time(const std::string& text, const TimeReader& times, bool introduced) {
  if (!times.try_read(text)) return false;
  if (introduced) return true;
  const bool bare = text.find_first_of(" :-") == std::string::npos;
  static const std::set<std::string> names = {"now", "today", "yesterday", "tonight", "noon", "midnight"};
  return !bare || names.contains(text) || weekday_of(text) || text.ends_with("am") || text.ends_with("pm");
}

std::optional<SentencePeriod> read_period(const Words& words, size_t first, size_t last,
                                          const TimeReader& times) {
  const auto time = [&](size_t a, size_t b, bool introduced) {
    return a < b && is_time(join(words, a, b), times, introduced);
  };
  const std::string& head = words[first];
  if (head == "between" || head == "from") {
    const std::string middle = head == "between" ? "and" : "to";
    for (size_t i = first + 2; i + 1 < last; ++i)
      if ((words[i] == middle || words[i] == "until" || words[i] == "till") && time(first + 1, i, true) &&
          time(i + 1, last, true))
        return SentencePeriod{join(words, first + 1, i), join(words, i + 1, last)};
    return std::nullopt;
  }
  if ((head == "since" || head == "after") && time(first + 1, last, true))
    return SentencePeriod{join(words, first + 1, last), ""};
  if ((head == "until" || head == "till" || head == "before" || head == "by") && time(first + 1, last, true))
    return SentencePeriod{"", join(words, first + 1, last)};
  static const std::set<std::string> introductions = {"at", "around", "about", "on", "in", "during"};
  const bool introduced = introductions.contains(head);
  if (!time(first + (introduced ? 1 : 0), last, introduced && head != "in" && head != "on"))
    return std::nullopt;
  const std::string text = join(words, first + (introduced ? 1 : 0), last);
  const TimeSpan span = times.read(text);
  return SentencePeriod{text, text, span.last - span.first < 3600 * kSecond};
}

/// Cuts out the longest time, the last of equally long ones.
std::optional<SentencePeriod> cut_time(Words& words, const TimeReader& times) {
  for (size_t length = std::min<size_t>(words.size(), 12); length > 0; --length)
    for (size_t first = words.size() - length + 1; first-- > 0;)
      if (const auto period = read_period(words, first, first + length, times)) {
        words.erase(words.begin() + static_cast<std::ptrdiff_t>(first),
                    words.begin() + static_cast<std::ptrdiff_t>(first + length));
        return period;
      }
  return std::nullopt;
}

// ---- Forms.

/// Sets of words that many forms use, as $name.
const std::map<std::string, std::string>& word_sets() {
  static const std::map<std::string, std::string> sets = {
      {"be", "(is|are|was|were)"},
      {"is", "(is|are|was|were|stands|stand|lies|lie)"},
      {"what", "(what|which) [things|objects|items]"},
      {"things", "(objects|object|things|thing|items|item)"},
      {"someone", "(anyone|someone|anybody|somebody)"},
      {"witness", "(you|we|i|anyone|someone|anybody|somebody|robot)"},
      {"usually", "(usually|normally|always|mostly|typically)"},
      {"moved", "(moved|taken|took|used|removed|touched)"},
      {"move", "(move|take|use|remove|touch)"},
      {"open", "(open|opened|close|closed|shut)"},
      {"room", "(room|kitchen|flat|apartment|house)"},
      {"on", "(on|upon|onto|on top of)"},
      {"in", "(in|inside|within)"},
      {"beside", "(near|close to|next to|beside|around)"},
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

/// One sequence of literal words and <slots>.
struct Pattern {
  Words words;
  const Question* question;
  const SentenceForm* form;
  size_t literals = 0;
};

/// All patterns; those with most literal words first.
const std::vector<Pattern>& patterns() {
  static const std::vector<Pattern> all = [] {
    std::vector<Pattern> result;
    for (const Question& question : questions())
      for (const SentenceForm& form : question.sentences)
        for (Words& words : FormExpander(form.form).expand()) {
          const auto literals = static_cast<size_t>(
              std::ranges::count_if(words, [](const std::string& word) { return word[0] != '<'; }));
          result.push_back({std::move(words), &question, &form, literals});
        }
    std::ranges::stable_sort(result, std::ranges::greater(), &Pattern::literals);
    return result;
  }();
  return all;
}

using Slots = std::map<std::string, std::string>;

/// Words that do not tell which object or place is meant.
const std::set<std::string> kSlotFillers = {"any",  "some",  "all", "my",    "our",
                                            "your", "still", "of",  "those", "these"};

bool match(const Words& pattern, size_t p, const Words& words, size_t w, Slots& slots) {
  if (p == pattern.size()) return w == words.size();
  if (pattern[p][0] != '<')
    return w < words.size() && words[w] == pattern[p] && match(pattern, p + 1, words, w + 1, slots);
  // As few words as possible: "<object> on <place>" is split at the first "on".
  for (size_t end = w + 1; end <= words.size(); ++end) {
    if (!match(pattern, p + 1, words, end, slots)) continue;
    size_t first = w;
    while (first + 1 < end && kSlotFillers.contains(words[first])) ++first;
    slots[pattern[p].substr(1, pattern[p].size() - 2)] = join(words, first, end);
    return true;
  }
  return false;
}

/// The query of a matched pattern, without its time.
Query query_of(const Pattern& pattern, const Slots& slots) {
  Query query{.question = pattern.question->name};
  for (const Parameter& parameter : pattern.question->parameters)
    if (const auto slot = slots.find(parameter.name); slot != slots.end())
      query.arguments[parameter.name] = slot->second;
  for (auto [name, value] : pattern.form->arguments) {
    if (const size_t begin = value.find('{'); begin != std::string::npos)
      value.replace(begin, std::string::npos, slots.at(value.substr(begin + 1, value.find('}') - begin - 1)));
    query.arguments[name] = value;
  }
  return query;
}

/// Whether a question takes this time, which becomes its arguments.
bool add_time(Query& query, SentenceTime time, const std::optional<SentencePeriod>& period) {
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
  if (time == SentenceTime::moment_or_history) {
    if (!moment) query.question = "history";
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

/// The words without articles, and before them the same without an opening such as "can you tell me".
std::vector<Words> readings_of(Words words) {
  static const std::set<std::string> articles = {"the", "a", "an", "please"};
  std::erase_if(words, [](const std::string& word) { return articles.contains(word); });
  static const std::vector<Words> openings =
      FormExpander(
          "(can|could) you [tell me]|do you (know|remember)|tell me|(would|will) you|robot|hey|hello")
          .expand();
  std::vector<Words> readings;
  for (const Words& opening : openings)
    if (words.size() > opening.size() && std::equal(opening.begin(), opening.end(), words.begin()))
      readings.emplace_back(words.begin() + static_cast<std::ptrdiff_t>(opening.size()), words.end());
  readings.push_back(std::move(words));
  return readings;
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

std::vector<std::string> all_examples() {
  std::vector<std::string> examples;
  for (const Question& question : questions())
    for (const SentenceForm& form : question.sentences)
      if (!form.example.empty()) examples.push_back(form.example);
  return examples;
}

}  // namespace

std::optional<Query> parse_sentence(const std::string& sentence, const TimeReader& times) {
  Words words = sentence_words(sentence);
  if (words.size() > 60) return std::nullopt;
  for (size_t i = 0; i + 1 < words.size(); ++i)
    if (words[i] == "right" && words[i + 1] == "now")
      words.erase(words.begin() + static_cast<std::ptrdiff_t>(i));
  const std::optional<SentencePeriod> period = cut_time(words, times);
  for (const Words& reading : readings_of(std::move(words)))
    for (const Pattern& pattern : patterns()) {
      Slots slots;
      if (!match(pattern.words, 0, reading, 0, slots)) continue;
      Query query = query_of(pattern, slots);
      if (add_time(query, pattern.form->time.value_or(pattern.question->time), period)) return query;
    }
  return std::nullopt;
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

// ---- References: "it", "there", "this drawer".

namespace {

const std::set<std::string> kPronouns = {"it", "them", "that",     "this",    "they",
                                         "he", "she",  "that one", "this one"};

/// Replaces "it", "there" and "this drawer" by what they mean.
class ReferenceResolver {
 public:
  ReferenceResolver(const Store& store, const NaturalLanguageQuestion& question)
      : snapshot_(store, question.as_of), last_subject_(question.about ? object_name(*question.about) : "") {}

  /// Keeps what the last sentence was about.
  void remember(const Query& query) {
    if (const auto subject = argument_of(query, {ParameterType::object, ParameterType::spot}))
      last_subject_ = *subject;
    if (const auto place = argument_of(query, {ParameterType::place})) last_place_ = *place;
  }

  void resolve(Query& query, std::vector<std::string>& notes) {
    for (const Parameter& parameter : find_question(query.question)->parameters) {
      const auto given = query.arguments.find(parameter.name);
      if (given == query.arguments.end() || !names_something(parameter.type)) continue;
      std::string& text = given->second;
      if (kPronouns.contains(text)) replace_pronoun(text, notes);
      if (text.starts_with("this ") || text.starts_with("that ")) replace_demonstrative(text, notes);
      if (parameter.type == ParameterType::place && text == "there") replace_there(query, parameter, notes);
    }
  }

  /// Notes which place an unknown name is taken for.
  void note_places(const Query& query, std::vector<std::string>& notes) const {
    for (const Parameter& parameter : find_question(query.question)->parameters) {
      const std::string name = query.argument(parameter.name);
      if (parameter.type != ParameterType::place || name.empty() || !snapshot_.places_called(name).empty())
        continue;
      try {
        const auto places = snapshot_.find_places(name);
        notes.push_back(
            fmt::format("no place is called '{}'; {} is meant", name,
                        places.size() == 1 ? places[0].name : "any " + name.substr(name.rfind(' ') + 1)));
      } catch (const UnknownName&) {
        continue;  // reported by the answer
      }
    }
  }

 private:
  static bool names_something(ParameterType type) {
    return type == ParameterType::object || type == ParameterType::place || type == ParameterType::part ||
           type == ParameterType::spot;
  }
  static std::optional<std::string> argument_of(const Query& query, const std::set<ParameterType>& types) {
    for (const Parameter& parameter : find_question(query.question)->parameters)
      if (types.contains(parameter.type) && query.arguments.contains(parameter.name))
        return query.argument(parameter.name);
    return std::nullopt;
  }

  void replace_pronoun(std::string& text, std::vector<std::string>& notes) const {
    if (!last_subject_.empty()) {
      notes.push_back(fmt::format("'{}' is taken as '{}'", text, last_subject_));
      text = last_subject_;
      return;
    }
    const BeliefRow* latest = nullptr;
    const auto seen = [&](const BeliefRow& row) {
      const SceneRow* scene = row.last_scene ? snapshot_.scene(*row.last_scene) : nullptr;
      return scene == nullptr ? TimeNs{0} : scene->time;
    };
    for (const BeliefRow& row : snapshot_.beliefs())
      if (latest == nullptr || seen(row) > seen(*latest)) latest = &row;
    if (latest == nullptr) return;
    notes.push_back(fmt::format("nothing was spoken of before: '{}' is taken as {}, which was seen last",
                                text, object_name(latest->object)));
    text = object_name(latest->object);
  }

  /// The place of the most probable object that is meant; "" = unknown.
  std::string place_of(const std::string& subject) const {
    try {
      const Id object = snapshot_.find_objects(subject).front();
      const auto place = snapshot_.place_ref(snapshot_.belief(object)->place);
      return place ? place->name : "";
    } catch (const UnknownName&) {
      return "";  // reported by the answer
    }
  }

  /// "there" is the place named last, else where the object was seen last.
  void replace_there(Query& query, const Parameter& parameter, std::vector<std::string>& notes) const {
    const auto subject = argument_of(query, {ParameterType::object});
    const std::string place = !last_place_.empty() ? last_place_ : subject ? place_of(*subject) : "";
    if (!place.empty()) {
      notes.push_back(fmt::format("'there' is taken as {}", place));
      query.arguments[parameter.name] = place;
    } else if (!parameter.required) {
      query.arguments.erase(parameter.name);  // anywhere
    }
  }

  /// "this drawer" is the drawer that was seen last.
  void replace_demonstrative(std::string& text, std::vector<std::string>& notes) const {
    const std::string name = text.substr(5);
    std::vector<PlaceRow> places;
    try {
      places = snapshot_.find_places(name);
    } catch (const UnknownName&) {
      text = name;
      return;
    }
    const PlaceRow* chosen = nullptr;
    TimeNs latest = 0;
    for (const PlaceRow& place : places)
      for (const VisibilityRow& view : snapshot_.store().visibility_of_place(place.id)) {
        const SceneRow* scene = snapshot_.scene(view.scene);
        if (scene == nullptr || view.fraction.value_or(0) <= 0 || scene->time < latest) continue;
        latest = scene->time;
        chosen = &place;
      }
    if (chosen == nullptr) chosen = &places[0];
    notes.push_back(fmt::format("'{}' is taken as {}, {}", text, chosen->name,
                                latest == 0 ? "the first of that name" : "which was looked at last"));
    text = chosen->name;
  }

  Snapshot snapshot_;
  std::string last_subject_, last_place_;
};

/// Whether the query has an answer without its time.
bool is_answered_later(const Store& store, Query query, AsOf as_of) {
  query.arguments.erase("at");
  as_of.at.reset();
  try {
    ask(store, query, as_of);
    return true;
  } catch (const Error&) {
    return false;
  }
}

NoAnswer why_not(const Store& store, const Query& query, const AsOf& as_of, const UnknownName& error) {
  const std::string hint = error.hint().empty() ? "" : " (" + error.hint() + ")";
  if (error.kind() == UnknownName::Kind::place)
    return {"unknown_place", fmt::format("Not known: {}{}.", error.message(), hint)};
  if ((as_of.at || query.arguments.contains("at")) && is_answered_later(store, query, as_of))
    return {"not_yet_seen",
            fmt::format("Not known then: {} at that time; it was first seen later.", error.message())};
  return {"never_seen", fmt::format("Never seen: {}{}.", error.message(), hint)};
}

}  // namespace

std::vector<NaturalLanguageAnswer> ask(const Store& store, const NaturalLanguageQuestion& question) {
  const TimeReader times(store);
  ReferenceResolver references(store, question);
  std::vector<NaturalLanguageAnswer> answers;
  for (const std::string& sentence : question.sentences) {
    NaturalLanguageAnswer answer{.sentence = sentence, .query = parse_sentence(sentence, times)};
    if (!answer.query) {
      answer.why_not = NoAnswer{"not_understood", fmt::format("'{}' is not understood.", sentence)};
      answer.nearest = nearest_examples(sentence);
    } else {
      references.resolve(*answer.query, answer.notes);
      references.remember(*answer.query);
      references.note_places(*answer.query, answer.notes);
      try {
        answer.answer = ask(store, *answer.query, question.as_of);
      } catch (const UnknownName& error) {
        answer.why_not = why_not(store, *answer.query, question.as_of, error);
      } catch (const Error& error) {
        answer.why_not = NoAnswer{"not_possible", fmt::format("Not possible: {}.", error.message())};
      }
    }
    answers.push_back(std::move(answer));
  }
  return answers;
}

std::string to_text(const NaturalLanguageAnswer& answer, const TimeWriter& times) {
  std::string text;
  if (answer.query) text += "= loci-memory " + answer.query->text() + "\n";
  for (const std::string& note : answer.notes) text += "(" + note + ")\n";
  if (answer.why_not) text += answer.why_not->text + "\n";
  if (!answer.nearest.empty()) text += "What is understood, for example:\n";
  for (const std::string& sentence : answer.nearest) text += "  " + sentence + "\n";
  return text + (answer.answer ? answer.answer->to_text(times) : "");
}

Json to_json(const NaturalLanguageAnswer& answer) {
  Json json = {{"sentence", answer.sentence}, {"understood", answer.query.has_value()}};
  if (answer.query) json["command"] = answer.query->text();
  if (!answer.notes.empty()) json["notes"] = answer.notes;
  if (answer.answer) json["answer"] = answer.answer->to_json();
  if (answer.why_not) json["why_not"] = {{"reason", answer.why_not->reason}, {"text", answer.why_not->text}};
  if (!answer.nearest.empty()) json["nearest"] = answer.nearest;
  return json;
}

std::vector<std::string> suggested_questions(const Store& store) {
  std::vector<std::string> suggestions;
  const auto name = [](const ObjectRef& object) {
    return object.label ? "the " + *object.label : object.name;
  };
  const std::vector<ObjectBelief> objects = ask(store, ObjectsQuestion{}).objects;
  if (!objects.empty()) suggestions.push_back(fmt::format("Where is {}?", name(objects.front().object)));
  const std::vector<Change> moves = ask(store, ChangesQuestion{.kind = "moved"}).changes;
  if (!moves.empty() && moves.back().object)
    suggestions.push_back(fmt::format("Where has {} been?", name(*moves.back().object)));
  if (!objects.empty() && objects.front().place)
    suggestions.push_back(fmt::format("What is {} {}?", objects.front().place->container ? "in" : "on",
                                      objects.front().place->name));
  for (std::string& example : all_examples()) suggestions.push_back(std::move(example));
  return suggestions;
}

std::vector<std::string> known_names(const Store& store) {
  std::set<std::string> words;
  for (const ObjectRow& object : store.objects()) words.insert(object_name(object.id));
  for (const PlaceRow& place : named_places(store)) words.insert(place.name);
  const PartNames names = part_names(store);
  for (const auto* parts : {&names.links, &names.joints})
    for (const auto& [in_map, name] : *parts) words.insert(name);
  for (const FactRow& fact : store.facts())
    if (fact.value && (fact.key == "alias" || fact.key == "class")) words.insert(*fact.value);
  return {words.begin(), words.end()};
}

}  // namespace loci::memory
