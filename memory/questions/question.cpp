#include "memory/questions/question.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <set>

#include "mapping/base/error.h"
#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "memory/questions/comparison.h"
#include "memory/questions/contents.h"
#include "memory/questions/emptiness.h"
#include "memory/questions/environment.h"
#include "memory/questions/events.h"
#include "memory/questions/forgotten.h"
#include "memory/questions/location.h"
#include "memory/questions/names/map_names.h"
#include "memory/questions/near.h"
#include "memory/questions/notes.h"
#include "memory/questions/objects.h"
#include "memory/questions/people.h"
#include "memory/questions/presence.h"
#include "memory/questions/replies/answer_fields.h"
#include "memory/questions/replies/reply.h"
#include "memory/questions/routines/co_occurrence.h"
#include "memory/questions/routines/digest.h"
#include "memory/questions/routines/routines.h"
#include "memory/questions/routines/tasks.h"
#include "memory/questions/search.h"

namespace loci::memory {
namespace {

std::string shell_quoted(const std::string& word) {
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

std::vector<std::string> shell_words(const std::string& text) {
  std::vector<std::string> words;
  bool inside = false;
  char quote = 0;
  for (const char c : text) {
    if (quote != 0 ? c == quote : c == '\'' || c == '"') {
      quote = quote != 0 ? char{0} : c;
      if (!inside) words.emplace_back();
      inside = true;
    } else if (quote == 0 && c == ' ') {
      inside = false;
    } else {
      if (!inside) words.emplace_back();
      inside = true;
      words.back() += c;
    }
  }
  return words;
}

std::vector<Parameter> time_parameters(bool period) {
  std::vector<Parameter> parameters = {{.name = "at",
                                        .type = ParameterType::time,
                                        .help = "What held at this time",
                                        .default_text = "the last scene"},
                                       {.name = "known-at",
                                        .type = ParameterType::time,
                                        .help = "As the memory knew it at this time",
                                        .default_text = "now"}};
  if (period) {
    parameters.push_back({.name = "from", .type = ParameterType::time, .help = "From this time on"});
    parameters.push_back({.name = "to", .type = ParameterType::time, .help = "Up to this time"});
  }
  return parameters;
}

/// Strings of an answer that are object names or names of places, and numbers of scenes.
class MentionCollector {
 public:
  explicit MentionCollector(const Store& store) {
    for (const PlaceRow& place : named_places(store)) places_.insert(place.name);
  }

  void visit(const Json& json) {
    if (json.is_string()) visit_text(json.get_ref<const std::string&>());
    if (!json.is_structured()) return;
    for (const auto& [key, value] : json.items()) {
      if (json.is_object()) visit_text(key);
      if (key == "scene" && value.is_number_integer())
        add(value.get<Id>(), mentions.scenes);
      else
        visit(value);
    }
  }

  Mentions mentions;

 private:
  template <class T>
  static void add(const T& value, std::vector<T>& values) {
    if (std::ranges::count(values, value) == 0) values.push_back(value);
  }
  void visit_text(const std::string& text) {
    if (const auto id = object_id(text)) add(*id, mentions.objects);
    if (places_.contains(text)) add(text, mentions.places);
  }

  std::set<std::string> places_;
};

/// "OBJECT [--radius LENGTH]".
std::string usage(const Question& question) {
  std::vector<std::string> parts;
  if (!question.words_help.empty()) parts.push_back(question.words_help);
  for (const Parameter& parameter : question.parameters) {
    if (parameter.positional && !question.words_help.empty()) continue;
    std::string text = upper_case(parameter.name);
    if (!parameter.positional)
      text = fmt::format("--{} {}", parameter.name, upper_case(to_text(parameter.type)));
    parts.push_back(parameter.required ? text : "[" + text + "]");
  }
  if (question.period) parts.emplace_back("[PERIOD]");
  return fmt::format("{}", fmt::join(parts, " "));
}

}  // namespace

std::string to_text(ParameterType type) {
  switch (type) {
    case ParameterType::object:
      return "object";
    case ParameterType::place:
      return "place";
    case ParameterType::part:
      return "part";
    case ParameterType::spot:
      return "spot";
    case ParameterType::time:
      return "time";
    case ParameterType::length:
      return "length";
    case ParameterType::point:
      return "point";
    case ParameterType::number:
      return "number";
    case ParameterType::text:
      return "text";
    case ParameterType::file:
      return "file";
  }
  return {};
}

std::string to_text(QuestionGroup group) {
  return group == QuestionGroup::ask ? "Ask" : "Inspect";
}

std::string Query::argument(const std::string& name) const {
  const auto found = arguments.find(name);
  return found == arguments.end() ? "" : found->second;
}

std::string Query::text() const {
  std::map<std::string, std::string> options;
  for (const auto& [name, value] : arguments) options[name] = " " + shell_quoted(value);
  std::string text = question;
  const Question* declared = find_question(question);
  bool after_object = false;
  for (const Parameter& parameter : declared == nullptr ? std::vector<Parameter>{} : declared->parameters) {
    const auto given = options.find(parameter.name);
    if (!parameter.positional || given == options.end()) continue;
    if (after_object && parameter.type == ParameterType::place) text += " on";
    text += given->second;
    options.erase(given);
    after_object = parameter.type == ParameterType::object;
  }
  if (options.contains("from") && options.contains("to")) {
    options["between"] = options["from"] + options["to"];
    options.erase("from");
    options.erase("to");
  }
  for (const auto& [name, value] : options) text.append(" --").append(name).append(value);
  return text;
}

namespace {

/// From a time to the nearest scene.
TimeNs distance_to_scene(const Store& store, const TimeSpan& time) {
  TimeNs nearest = std::numeric_limits<TimeNs>::max();
  if (const auto before = store.latest_scene({.at = time.last}))
    nearest = std::max(TimeNs{0}, time.first - before->time);
  const std::vector<SceneRow> after = store.scenes({}, time.last + 1, time.last + kDay);
  return after.empty() ? nearest : std::min(nearest, after.front().time - time.last);
}

}  // namespace

TimeSpan read_moment(const Store& store, const std::string& text) {
  const TimeReader times(store);
  const auto both = times.repeated(text);
  if (!both) return times.read(text);
  const bool is_first = distance_to_scene(store, both->first) < distance_to_scene(store, both->second);
  return is_first ? both->first : both->second;
}

AsOf read_as_of(const Store& store, const std::string& at, const std::string& known_at, AsOf as_of) {
  if (!at.empty()) as_of.at = read_moment(store, at).last;
  // Transaction times are times of the machine's clock: "yesterday" is the day before today, not before the
  // last scene.
  if (!known_at.empty()) as_of.known_at = TimeReader(now(), store.time_zone()).read(known_at).last;
  return as_of;
}

Arguments::Arguments(const Store& store, const Query& query, const AsOf& as_of)
    : store_(store),
      query_(query),
      times_(store),
      as_of_(read_as_of(store, query.argument("at"), query.argument("known-at"), as_of)) {}

std::optional<TimeNs> Arguments::time(const std::string& name) const {
  const std::string value = text(name);
  return value.empty() ? std::nullopt : std::optional(times_.read(value).first);
}

TimeSpan Arguments::end_of_period(const char* name) const {
  return text("from") == text("to") ? read_moment(store_, text(name)) : times_.read(text(name));
}

std::optional<TimeNs> Arguments::from() const {
  return text("from").empty() ? std::nullopt : std::optional(end_of_period("from").first);
}

std::optional<TimeNs> Arguments::to() const {
  return text("to").empty() ? std::nullopt : std::optional(end_of_period("to").last);
}

std::optional<double> Arguments::length(const std::string& name) const {
  const std::string value = text(name);
  return value.empty() ? std::nullopt : std::optional(read_length(value));
}

std::optional<Id> Arguments::number(const std::string& name) const {
  return read_number(text(name));
}

std::optional<int64_t> read_number(const std::string& text) {
  int64_t number = 0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (failure == std::errc() && end == text.data() + text.size()) return number;
  const bool word =
      !text.empty() && std::ranges::all_of(text, [](unsigned char c) { return std::isalpha(c) != 0; });
  return word ? count_of(lower_case(text)) : std::nullopt;
}

std::optional<Vector2d> Arguments::point(const std::string& name) const {
  const std::string value = text(name);
  if (value.empty()) return std::nullopt;
  const std::vector<double> numbers = read_point(value);
  if (numbers.size() != 2)
    throw Error(fmt::format("'{}' is no point", value), {}, "write x,y in metres, e.g. 1.0,0.5");
  return Vector2d(numbers[0], numbers[1]);
}

Json Answer::to_json() const {
  Json json;
  model_->write_json(json);
  return json;
}

Mentions Answer::mentions(const Store& store) const {
  MentionCollector collector(store);
  collector.visit(to_json());
  return collector.mentions;
}

void Question::read(const std::vector<std::string>& words, Query& query) const {
  if (words.empty()) return;
  if (read_words != nullptr) {
    read_words(words, query);
    return;
  }
  const auto positional = std::ranges::find_if(parameters, &Parameter::positional);
  if (positional == parameters.end()) throw Error(fmt::format("'{}' does not take '{}'", name, words[0]));
  query.arguments[positional->name] = fmt::format("{}", fmt::join(words, " "));
}

std::vector<Parameter> Question::all_parameters() const {
  std::vector<Parameter> all = parameters;
  for (Parameter& parameter : time_parameters(period)) all.push_back(std::move(parameter));
  return all;
}

const std::vector<Question>& questions() {
  static const std::vector<Question> all = [] {
    std::vector<Question> result;
    for (const auto& family :
         {location_questions(), presence_questions(), contents_questions(), near_questions(),
          event_questions(), routine_questions(), co_occurrence_questions(), search_questions(),
          comparison_questions(), people_questions(), emptiness_questions(), task_questions(),
          object_questions(), environment_questions(), digest_questions()})
      result.insert(result.end(), family.begin(), family.end());
    return result;
  }();
  return all;
}

const Question* find_question(const std::string& name) {
  const auto found = std::ranges::find(questions(), name, &Question::name);
  return found == questions().end() ? nullptr : &*found;
}

namespace {

/// Whether it has words for what a memory has; without any, they mean nothing.
bool is_name(const Parameter& parameter) {
  using enum ParameterType;
  return parameter.type == object || parameter.type == place || parameter.type == part ||
         parameter.type == spot;
}

}  // namespace

void check_arguments(const std::string& asked, const std::vector<Parameter>& parameters, const Query& query) {
  std::vector<std::string> names;
  for (const Parameter& parameter : parameters) names.push_back(parameter.name);
  for (const auto& [name, value] : query.arguments)
    if (std::ranges::count(names, name) == 0) {
      const std::string nearest = did_you_mean(name, names);
      const std::string takes =
          names.empty() ? "it takes nothing" : fmt::format("it takes {}", fmt::join(names, ", "));
      throw Error(fmt::format("'{}' does not take '{}'", asked, name), {}, nearest.empty() ? takes : nearest);
    }
  for (const Parameter& parameter : parameters) {
    const auto given = query.arguments.find(parameter.name);
    if (given == query.arguments.end() || given->second.empty()) {  // as Arguments reads it
      if (parameter.required)
        throw Error(fmt::format("'{}' needs '{}'{}", asked, parameter.name,
                                parameter.help.empty() ? "" : " (" + parameter.help + ")"));
      if (given == query.arguments.end()) continue;
    }
    const bool says_something = is_name(parameter) || parameter.type == ParameterType::number;
    if (says_something && trimmed(given->second).empty())
      throw Error(fmt::format("'{}' of '{}' is empty", parameter.name, asked), {}, parameter.help);
    if (given->second.empty()) continue;  // as Arguments reads it
    if (parameter.type == ParameterType::number)
      if (const auto number = read_number(given->second); !number || *number < parameter.min)
        throw Error(fmt::format("'{}' is no {}", given->second, parameter.name), {},
                    fmt::format("a whole number from {} on", parameter.min));
    if (!parameter.choices.empty() && std::ranges::count(parameter.choices, given->second) == 0)
      throw Error(fmt::format("'{}' is no {}", given->second, parameter.name), {},
                  fmt::format("one of: {}", fmt::join(parameter.choices, ", ")));
    for (const std::string& other : parameter.excludes)
      if (query.arguments.contains(other))
        throw Error(fmt::format("'{}' takes either {} or {}", asked, parameter.name, other));
  }
}

void check_period(const std::optional<TimeNs>& from, const std::optional<TimeNs>& to) {
  if (from && to && *from > *to)
    throw Error("the first time is after the second", {}, "give the earlier one first");
}

Answer Question::ask(const Store& store, const Query& query, const AsOf& as_of) const {
  check_arguments(name, all_parameters(), query);
  Arguments arguments(store, query, as_of);
  if (period) check_period(arguments.from(), arguments.to());
  const std::optional<ForgottenTime> forgotten = forgotten_time(store, query, arguments.as_of());
  if (!forgotten || !forgotten->all) return run(arguments);
  if (forgotten->before) arguments.set_at(*forgotten->before);
  try {
    return run(arguments);
  } catch (const UnknownName& error) {
    throw UnknownName(
        error.kind(),
        fmt::format("{} before; {}", error.message(), forgotten_text(forgotten->period, TimeWriter(store))),
        error.location(), error.hint());
  }
}

Reply Question::reply(const Store& store, Query query, const Answer& found) const {
  if (query.asks == Asks::summary) query.asks = asks;
  for (const Parameter& parameter : parameters)
    if (query.asks == Asks::summary && query.arguments.contains(parameter.name)) query.asks = parameter.asks;
  const AsOf as_of = read_as_of(store, query.argument("at"), query.argument("known-at"));
  Reply made = found.reply({store, query, as_of, TimeWriter(store)});
  made.notes = notes_on(Snapshot(store, as_of), query);
  return made;
}

std::string full_text(const Reply& reply, const Answer& answer, const TimeWriter& times) {
  return headed(reply, answer.to_text(times));
}

Json full_json(const Reply& reply, const Answer& answer) {
  Json json = answer.to_json();
  json["reply"] = to_json(reply);
  return json;
}

Answer ask(const Store& store, const Query& query, const AsOf& as_of) {
  const Question* question = find_question(query.question);
  if (question == nullptr) throw Error(fmt::format("'{}' is no question", query.question));
  return question->ask(store, query, as_of);
}

std::optional<Query> parse_query(const std::string& text) {
  std::vector<std::string> words = shell_words(text);
  if (!words.empty() && words[0] == "loci-memory") words.erase(words.begin());
  const Question* question = words.empty() ? nullptr : find_question(words[0]);
  if (question == nullptr) return std::nullopt;
  Query query{.question = words[0]};
  std::vector<std::string> positional;
  for (size_t i = 1; i < words.size(); ++i) {
    if (!words[i].starts_with("--")) {
      positional.push_back(words[i]);
      continue;
    }
    const std::string name = words[i].substr(2);
    const bool between = name == "between";
    if (i + (between ? 2 : 1) >= words.size())
      throw Error(fmt::format("--{} takes {}", name, between ? "two times" : "a value"));
    if (between) query.arguments["from"] = words[++i];
    query.arguments[between ? "to" : name] = words[++i];
  }
  question->read(positional, query);
  check_arguments(question->name, question->all_parameters(), query);
  return query;
}

double read_length(const std::string& text) {
  static const std::map<std::string, double> units = {{"", 1},
                                                      {"m", 1},
                                                      {"metre", 1},
                                                      {"metres", 1},
                                                      {"meter", 1},
                                                      {"meters", 1},
                                                      {"cm", 0.01},
                                                      {"centimetre", 0.01},
                                                      {"centimetres", 0.01},
                                                      {"centimeter", 0.01},
                                                      {"centimeters", 0.01},
                                                      {"mm", 0.001},
                                                      {"millimetres", 0.001},
                                                      {"millimeters", 0.001}};
  double value = 0;
  const auto [rest, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  std::string unit(rest, text.data() + text.size());
  unit.erase(0, unit.find_first_not_of(' '));
  const auto factor = units.find(unit);
  if (failure != std::errc() || factor == units.end() || !std::isfinite(value) || value <= 0)
    throw Error(fmt::format("'{}' is no length", text), {}, "for example 0.5, \"0.5 m\" or \"50 cm\"");
  return value * factor->second;
}

std::vector<double> read_point(const std::string& text) {
  std::vector<double> numbers;
  for (const std::string& part : split(text, ',')) {
    const std::string number = trimmed(part);
    const size_t sign = number.starts_with('+') ? 1 : 0;
    const char* const end = number.data() + number.size();
    const auto [rest, failure] = std::from_chars(number.data() + sign, end, numbers.emplace_back());
    if (failure != std::errc() || rest != end || !std::isfinite(numbers.back())) return {};
  }
  return numbers.size() == 2 || numbers.size() == 3 ? numbers : std::vector<double>{};
}

std::string questions_reference() {
  std::string text =
      "# Questions\n\n"
      "The output of `loci-memory questions`. Every question also takes `--at TIME` (what held then), "
      "`--known-at TIME`\n"
      "(as the memory knew it then) and `--json`; PERIOD is `--between TIME TIME`, `--from TIME` or `--to "
      "TIME`.\n"
      "[Asking](asking.md) explains the answers.\n";
  for (const QuestionGroup group : {QuestionGroup::ask, QuestionGroup::inspect}) {
    text += fmt::format("\n| {} | answers | in words |\n|---|---|---|\n", to_text(group));
    for (const Question& question : questions()) {
      if (question.group != group) continue;
      std::vector<std::string> examples;
      for (const SentenceForm& sentence : question.sentences)
        if (!sentence.example.empty()) examples.push_back(sentence.example);
      std::string command;
      for (const char c : trimmed(question.name + " " + usage(question)))
        command += c == '|' ? std::string("\\|") : std::string(1, c);  // a cell of a table
      text += fmt::format("| `{}` | {} | {} |\n", command, question.description, fmt::join(examples, "<br>"));
    }
  }
  return text;
}

Json declaration_json(const std::string& name, const std::string& description,
                      const std::vector<Parameter>& parameters) {
  Json json = {{"name", name}, {"description", description}, {"parameters", Json::array()}};
  for (const Parameter& parameter : parameters) {
    json["parameters"].push_back({{"name", parameter.name},
                                  {"type", to_text(parameter.type)},
                                  {"help", parameter.help},
                                  {"positional", parameter.positional},
                                  {"required", parameter.required}});
    Json& last = json["parameters"].back();
    if (!parameter.default_text.empty()) last["default"] = parameter.default_text;
    if (!parameter.choices.empty()) last["choices"] = parameter.choices;
  }
  return json;
}

Json questions_json() {
  Json json = Json::array(), schemas = Json::object();
  for (const Question& question : questions()) {
    Json one = declaration_json(question.name, question.description, question.all_parameters());
    for (const SentenceForm& sentence : question.sentences)
      if (!sentence.example.empty()) one["sentences"].push_back(sentence.example);
    one["answer"] = question.answer().name();
    schemas.update(question.answer().definitions());
    json.push_back(std::move(one));
  }
  schemas.update(format::reply_record().definitions());
  for (const Question& question : questions()) {  // see full_json()
    Json& schema = schemas[question.answer().name()];
    if (!schema["properties"].contains("reply")) schema["required"].push_back("reply");
    schema["properties"]["reply"] = format::reply_record().reference();
  }
  return {{"questions", json}, {"$defs", schemas}};
}

Parameter object_parameter() {
  return {.name = "object",
          .type = ParameterType::object,
          .help = "object_12, a name, a colour, a size, \"on table_1\"",
          .positional = true,
          .required = true};
}

Parameter place_parameter() {
  return {.name = "place",
          .type = ParameterType::place,
          .help = "The place, e.g. table_1 or drawer_1",
          .positional = true,
          .required = true};
}

Parameter only_object_parameter() {
  return {
      .name = "object", .type = ParameterType::object, .help = "Only these objects", .default_text = "all"};
}

Parameter only_place_parameter() {
  return {.name = "place",
          .type = ParameterType::place,
          .help = "Only at this place",
          .default_text = "everywhere"};
}

Parameter count_parameter() {
  return {.name = "count",
          .type = ParameterType::number,
          .help = "Whether there are as many",
          .min = 1,
          .asks = Asks::verdict};
}

}  // namespace loci::memory
