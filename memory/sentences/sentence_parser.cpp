#include "memory/sentences/sentence_parser.h"

#include <algorithm>
#include <set>

#include "mapping/base/text/text.h"
#include "memory/questions/names/related_words.h"
#include "memory/sentences/clauses/clause.h"
#include "memory/sentences/lexicon.h"
#include "memory/sentences/spelling.h"

namespace loci::memory {
namespace {

// ---- Rules.

/// A name that a form has room for.
struct Slot {
  std::string relation;   ///< as in Phrase; "at" = on, in or at; "to" = to, into, on, in or at
  std::string parameter;  ///< that it becomes
};

/// A form, read from its text.
struct Rule {
  Words moods = {};
  std::vector<Words> required = {};  ///< of each, one has to be there
  Words optional = {}, forbidden = {};
  std::vector<Slot> slots = {};
  const Question* question = nullptr;
  const SentenceForm* form = nullptr;

  size_t specificity() const { return 2 * required.size() + slots.size(); }
};

Words alternatives(std::string_view text) {
  return words_of(text, "|");
}

void append(Words more, Words& words) {
  words.insert(words.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

bool contains(const Words& words, const std::string& word) {
  return std::ranges::find(words, word) != words.end();
}

Rule read_rule(const Question& question, const SentenceForm& form) {
  Rule rule{.question = &question, .form = &form};
  const size_t colon = form.form.find(':');
  rule.moods = alternatives(form.form.substr(0, colon));
  for (const std::string& element : words_of(form.form.substr(colon + 1))) {
    if (const size_t slot = element.find('<'); slot != std::string::npos)
      rule.slots.push_back({element.substr(0, slot), element.substr(slot + 1, element.size() - slot - 2)});
    else if (element[0] == '[')
      append(alternatives(element.substr(1, element.size() - 2)), rule.optional);
    else if (element[0] == '-')
      append(alternatives(element.substr(1)), rule.forbidden);
    else
      rule.required.push_back(alternatives(element));
  }
  return rule;
}

/// All rules; those that ask for most first.
const std::vector<Rule>& rules() {
  static const std::vector<Rule> all = [] {
    std::vector<Rule> result;
    for (const Question& question : questions())
      for (const SentenceForm& form : question.sentences) result.push_back(read_rule(question, form));
    std::ranges::stable_sort(result, std::ranges::greater(), &Rule::specificity);
    return result;
  }();
  return all;
}

/// Lemmas that rules name, and those that none may pass over.
const std::set<std::string>& grammar_concepts() {
  static const std::set<std::string> all = [] {
    std::set<std::string> result = {"not",      "every",  "everything", "thing",
                                    "quantity", "future", "room",       "hide"};
    for (const Rule& rule : rules()) {
      for (const auto& required : rule.required) result.insert(required.begin(), required.end());
      result.insert(rule.optional.begin(), rule.optional.end());
    }
    std::erase_if(result, [](const std::string& one) { return class_of(one) != WordClass::name; });
    return result;
  }();
  return all;
}

bool fits_relation(const std::string& wanted, const std::string& given) {
  static const std::map<std::string, std::set<std::string>> wider = {{"on", {"on", "at"}},
                                                                     {"at", {"on", "in", "at"}},
                                                                     {"to", {"to", "into", "on", "in", "at"}},
                                                                     {"into", {"to", "into"}},
                                                                     {"pos", {"above", "over", "between"}},
                                                                     {"like", {"like", "to"}},
                                                                     {"from", {"from", "of"}}};
  const auto found = wider.find(wanted);
  return found == wider.end() ? wanted == given : found->second.contains(given);
}

using Slots = std::map<std::string, std::string>;

/// Gives every phrase a slot, in order; empty when one is left, or a slot is.
std::optional<Slots> assigned(const std::vector<Slot>& slots, const std::vector<Phrase>& phrases) {
  if (slots.size() != phrases.size()) return std::nullopt;
  Slots result;
  std::vector<bool> taken(phrases.size(), false);
  for (const Slot& slot : slots) {
    size_t i = 0;
    while (i < phrases.size() && (taken[i] || !fits_relation(slot.relation, phrases[i].relation))) ++i;
    if (i == phrases.size()) return std::nullopt;
    taken[i] = true;
    result[slot.parameter] = phrases[i].text;
  }
  return result;
}

/// "Can you open the drawer?" asks to do it, not whether it was done.
bool is_request(const Rule& rule, const Clause& clause) {
  const auto marked = [&](const char* mark) { return clause.marks.contains(mark); };
  return clause.mood == "yes" && marked("may") && marked("person") && !marked("have") &&
         (rule.question->name == "changes" || rule.question->name == "opens");
}

std::optional<Slots> match(const Rule& rule, const Clause& clause) {
  if (!contains(rule.moods, clause.mood) || is_request(rule, clause)) return std::nullopt;
  const auto is_said = [&](const std::string& one) {
    return clause.concepts.contains(one) || clause.marks.contains(one);
  };
  for (const Words& one_of : rule.required)
    if (std::ranges::none_of(one_of, is_said)) return std::nullopt;
  for (const std::string& one : clause.concepts)
    if (!contains(rule.optional, one) &&
        std::ranges::none_of(rule.required, [&](const Words& one_of) { return contains(one_of, one); }))
      return std::nullopt;
  if (std::ranges::any_of(rule.forbidden, is_said)) return std::nullopt;
  // "except for the milk", "more than once"
  std::vector<Phrase> phrases = clause.phrases;
  Slots restrictions;
  for (const auto& [relation, parameter] : {std::pair("except", "except"), {"repeated", "times"}}) {
    const auto restriction = std::ranges::find(phrases, relation, &Phrase::relation);
    if (restriction == phrases.end()) continue;
    if (std::ranges::count(rule.question->parameters, parameter, &Parameter::name) == 0) return std::nullopt;
    restrictions[parameter] = restriction->text;
    phrases.erase(restriction);
  }
  auto slots = assigned(rule.slots, phrases);
  if (slots) slots->merge(restrictions);
  return slots;
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
  std::erase_if(query.arguments, [](const auto& one) { return one.second.empty(); });
  return query;
}

/// Whether a question takes this time, which becomes its arguments.
bool add_time(Query& query, const Question& question, SentenceTime time, std::optional<SentencePeriod> period,
              const TimeReader& times) {
  // What happened, or was somewhere, "around eight" may have been seen a little earlier or later.
  const bool listed =
      (query.asks == Asks::objects || query.asks == Asks::number || query.asks == Asks::exists) &&
      query.argument("state") != "gone";
  if (period && period->around && listed &&
      (time == SentenceTime::period || time == SentenceTime::moment_or_period)) {
    constexpr TimeNs kAround = 1800 * kSecond;
    const TimeSpan span = times.read(period->from);
    period = SentencePeriod{format_time(span.first - kAround), format_time(span.last + kAround)};
  }
  if (time == SentenceTime::since) {
    if (!period || period->from.empty()) return false;
    query.arguments["unseen-since"] = period->from;
    return true;
  }
  if (!period) return true;
  const std::string &from = period->from, &to = period->to;
  // "How long has it been there now" is not about this moment only.
  const bool lasts = query.asks == Asks::duration || query.asks == Asks::closed_for;
  if (lasts && from == "now" && to == "now") return true;
  if (time == SentenceTime::none) return false;
  if (time == SentenceTime::during) {
    if (from.empty() || to.empty()) return false;
    query.arguments["during"] = from == to ? from : from + " to " + to;
    return true;
  }
  if (time == SentenceTime::moment_or_period) {
    if (!period->moment) {
      const bool counted = query.asks == Asks::all || query.asks == Asks::only ||
                           query.arguments.contains("count") || query.arguments.contains("except");
      if (counted) return false;
      // Whether it was seen at all is a question for `was`.
      const bool together = query.asks == Asks::together;
      const bool verdict = query.asks == Asks::verdict || query.asks == Asks::exists || together;
      if (question.name == "where" && query.asks == Asks::gone) return false;
      if (question.name == "where" && verdict)
        query.question = "was";
      else if (!question.over_period.empty())
        query.question = question.over_period;
      if (query.question == "was" && !together) query.asks = Asks::verdict;
    }
    time = period->moment ? SentenceTime::at : SentenceTime::period;
  }
  if (time == SentenceTime::at) {
    query.arguments["at"] = to.empty() ? "now" : to;  // what holds "since nine" is what holds now
    return true;
  }
  if (!from.empty()) query.arguments["from"] = from;
  if (!to.empty()) query.arguments["to"] = to;
  return true;
}

bool is_past(const Clause& clause) {
  static const std::set<std::string> past = {"was", "been", "did", "had", "never"};
  return std::ranges::any_of(clause.marks, [](const std::string& mark) { return past.contains(mark); });
}

/// "Were there ever two cups on the table" is not about now, "what was the biggest object on the table today"
/// neither about the end of the day nor, as at nine, about a moment.
bool is_of_other_time(const Query& query, const Clause& clause) {
  const bool over_past = is_past(clause) && !(clause.period && clause.period->moment);
  const std::vector<std::string> object = words_of(query.argument("object"));
  const bool biggest = !object.empty() && is_superlative(object.front());
  if (biggest && query.question == "contents-history") return !over_past;
  const bool there = std::ranges::count(object, "on") > 0 || std::ranges::count(object, "in") > 0;
  if (biggest && there && query.question == "objects") return over_past;
  return over_past && !clause.period && query.arguments.contains("count");
}

/// "Has the cup been in the same place" asks whether it stayed, not whether several were together.
bool is_of_one_place(const Query& query, const Clause& clause) {
  const std::string object = query.argument("object");
  const bool several =
      object.find(" and ") != std::string::npos || object.ends_with('s') || clause.concepts.contains("every");
  return query.asks == Asks::together && is_past(clause) && !several;
}

/// The time of a clause. "Which cup was on the table" asks for all that was seen there, not for what is
/// there now.
std::optional<SentencePeriod> time_of(const Clause& clause, const Query& query, SentenceTime time) {
  static const std::set<Asks> over_time = {Asks::objects, Asks::number, Asks::verdict, Asks::exists,
                                           Asks::together};
  // "Has it been put back" asks for now.
  if (clause.period || !is_past(clause) || clause.concepts.contains("put") ||
      time != SentenceTime::moment_or_period)
    return clause.period;
  const bool asked =
      query.question == "where" ? query.asks == Asks::together : over_time.contains(query.asks);
  if (!asked) return {};
  return SentencePeriod{"", query.arguments.contains("not-at") ? "now" : ""};
}

bool same(const Query& a, const Query& b) {
  return a.question == b.question && a.arguments == b.arguments && a.asks == b.asks;
}

}  // namespace

std::vector<Clause> clauses_of(const std::string& sentence, const TimeReader& times) {
  return parse_clauses(sentence, grammar_concepts(), times);
}

std::vector<Query> parse_readings(const std::vector<Clause>& clauses, const TimeReader& times) {
  constexpr size_t kMaxReadings = 8;
  std::vector<Query> queries;
  for (const Clause& clause : clauses)
    for (const Rule& rule : rules()) {
      if (queries.size() == kMaxReadings) return queries;
      const auto slots = match(rule, clause);
      if (!slots) continue;
      Query query = query_of(rule, *slots);
      if (is_of_other_time(query, clause) || is_of_one_place(query, clause)) continue;
      // What was beside an object has no period: it was so when the object was last seen.
      if (query.question == "near" && is_past(clause) && !clause.period) query.arguments["at"] = "then";
      const SentenceTime time = rule.form->time.value_or(rule.question->time);
      if (add_time(query, *rule.question, time, time_of(clause, query, time), times) &&
          std::ranges::none_of(queries, [&](const Query& one) { return same(one, query); }))
        queries.push_back(std::move(query));
    }
  return queries;
}

namespace {

/// Shared words, and a little less for words with a similar spelling.
double similarity(const Words& a, const Words& b) {
  double shared = 0;
  for (const std::string& word : a) {
    if (std::ranges::count(b, word) > 0)
      shared += 1;
    else if (std::ranges::any_of(b, [&](const std::string& other) { return is_one_typo(word, other); }))
      shared += 0.7;
  }
  return shared / static_cast<double>(std::max<size_t>(1, a.size() + b.size()));
}

}  // namespace

std::optional<Query> parse_sentence(const std::string& sentence, const TimeReader& times) {
  std::vector<Query> queries;
  for (const Respelling& respelling : respellings(sentence, {}))
    if (queries.empty()) queries = parse_readings(clauses_of(respelling.sentence, times), times);
  return queries.empty() ? std::nullopt : std::optional(std::move(queries.front()));
}

std::optional<Query> parse_name(const std::vector<Clause>& clauses) {
  if (clauses.empty()) return std::nullopt;
  const Clause& clause = clauses.back();
  const bool alone = clause.mood == "bare" && clause.concepts.empty() && clause.phrases.size() == 1 &&
                     clause.phrases[0].relation.empty() && !clause.period;
  return alone ? std::optional(Query{"where", {{"object", clause.phrases[0].text}}, Asks::place})
               : std::nullopt;
}

namespace {

/// "Since when?", "Who?", "How often?": another question about what was spoken of.
std::optional<Query> bare_follow_up(const std::string& mood, const Query& last) {
  static const std::map<std::string, Asks> of_stay = {
      {"sincewhen", Asks::first_time}, {"untilwhen", Asks::until}, {"howlong", Asks::duration}};
  static const std::map<std::string, Asks> of_changes = {
      {"when", Asks::last_time}, {"who", Asks::agent}, {"howoften", Asks::number}};
  Query query = last;
  if (const auto asks = of_changes.find(mood); asks != of_changes.end() && last.question == "changes")
    return query.asks = asks->second, query;
  if (mood == "when" && last.question == "was") return query.asks = Asks::summary, query;
  const auto asks = of_stay.find(mood);
  const bool stays = last.question == "where" || last.question == "on" || last.question == "in" ||
                     (last.question == "was" && !last.argument("place").empty());
  if (asks == of_stay.end() || !stays || !last.arguments.contains("object") || last.arguments.contains("at"))
    return std::nullopt;
  const std::string place = last.question == "where" ? "there" : last.argument("place");
  return Query{"history", {{"object", last.argument("object")}, {"place", place}}, asks->second};
}

}  // namespace

std::vector<Query> parse_follow_up(const std::vector<Clause>& clauses, const Query& last,
                                   const TimeReader& times) {
  const Question* question = find_question(last.question);
  if (question == nullptr || clauses.empty()) return {};
  const Clause& clause = clauses.front();
  Query query = last;
  const bool doubted = std::ranges::all_of(clause.concepts, [&](const std::string& one) {
    return one == "why" || (one == "not" && clause.mood == "why");
  });
  const bool that =
      clause.phrases.empty() || (clause.phrases.size() == 1 && clause.phrases[0].text == "that");
  if (doubted && that) {
    const auto marked = [&](const char* one) { return clause.marks.contains(one); };
    if (clause.mood == "why" ||
        (clause.mood == "how" && (marked("know") || marked("think") || marked("sure"))))
      return query.asks = Asks::reason, std::vector{query};
    if (clause.mood == "howsure" || ((clause.mood == "yes" || clause.mood == "bare") && marked("sure")))
      return query.asks = Asks::probability, std::vector{query};
  }
  // "How long ago was that?"
  const bool timed = last.asks == Asks::last_time || last.asks == Asks::first_time;
  if (clause.mood == "howlong" && clause.concepts == std::set<std::string>{"ago"} && that && timed)
    return query.asks = Asks::ago, std::vector{query};
  if (clause.phrases.empty() && clause.concepts.empty() && !clause.period)
    if (auto bare = bare_follow_up(clause.mood, last)) return {*bare};
  // "And the jam?", "On the counter?", "And how many on the shelf?", "And at noon?"
  const bool leans = clause.mood == "bare" || (clause.mood == "howmany" && last.asks == Asks::number);
  // "And closed again?"
  const bool shuts = clause.concepts.contains("close"), opens = clause.concepts.contains("opened");
  if (leans && clause.phrases.empty() && (shuts || opens) && last.question == "changes" &&
      last.arguments.contains("kind")) {
    query.arguments["kind"] = shuts ? "closed" : "opened";
    return {query};
  }
  // "Is the bowl?" after "What is on the table?"
  const bool listed = (last.question == "on" || last.question == "in") && !last.arguments.contains("object");
  const bool named = clause.phrases.size() == 1 && clause.phrases[0].relation.empty() &&
                     !is_pronoun(clause.phrases[0].text) && !is_furniture(clause.phrases[0].text) &&
                     clause.phrases[0].text.find('_') == std::string::npos;
  if (listed && named && clause.concepts.empty() && (leans || clause.mood == "yes")) {
    query.arguments["object"] = clause.phrases[0].text;
    query.asks = Asks::verdict;
    return {query};
  }
  if (!leans || !clause.concepts.empty() || clause.phrases.size() > 1) return {};
  if (clause.phrases.empty()) {
    if (!clause.period) return {};
    for (const char* name : {"at", "from", "to"}) query.arguments.erase(name);
    return add_time(query, *question, question->time, clause.period, times) ? std::vector{query}
                                                                            : std::vector<Query>{};
  }
  const Phrase& phrase = clause.phrases[0];
  const bool of_place = phrase.relation == "on" || phrase.relation == "in" || phrase.relation == "at" ||
                        is_furniture(phrase.text);
  std::vector<ParameterType> types = {ParameterType::place, ParameterType::part};
  if (!of_place || phrase.relation.empty())
    types.insert(of_place ? types.end() : types.begin(), ParameterType::object);
  for (const ParameterType type : types)
    for (const Parameter& parameter : question->parameters)
      if (parameter.type == type && query.arguments.contains(parameter.name)) {
        query.arguments[parameter.name] = phrase.text;
        return {query};
      }
  return {};
}

std::vector<std::string> all_examples() {
  std::vector<std::string> examples;
  for (const Question& question : questions())
    for (const SentenceForm& form : question.sentences)
      if (!form.example.empty() && std::ranges::count(examples, form.example) == 0)
        examples.push_back(form.example);
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
