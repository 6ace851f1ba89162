#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <typeinfo>
#include <utility>
#include <vector>

#include "mapping/base/text/json_fwd.h"
#include "memory/questions/time_parser.h"

namespace loci::memory {

// A question is declared once: its parameters, the function that answers it, and the sentences that mean it.
// The command line, natural-language queries, the browser and docs/questions.md are derived from the
// declarations.
//
// To add a question: write its struct, ask(), to_text() and its record of fields in the files of its family,
// declare it in the family's list (for example location_questions()), and regenerate docs/questions.md with
// `loci-memory questions`.

/// What a parameter means. Values are given as text and read against the memory that is asked.
enum class ParameterType {
  object,  ///< words for objects: "object_12", an alias, a colour, a size, a class, "on table_1"
  place,   ///< words for places: "table_1", "drawer 1", an alias, a class
  part,    ///< a link of the map, a place, an alias, a class
  spot,    ///< "x,y" or "x,y,z" in the map, an object, or a place
  time,    ///< "08:30", "yesterday 9:00", "2 hours ago", ISO 8601
  length,  ///< metres, or "50 cm"
  point,   ///< "x,y" in the map
  number,
  text,
  file,
};
std::string to_text(ParameterType type);

/// What people want to know of an answer: the type of the reply.
enum class Asks {
  summary,      ///< what the question is about
  verdict,      ///< yes, no or not observed: whether it is so
  exists,       ///< a verdict on whether there is any
  empty,        ///< a verdict on whether there is none
  gone,         ///< a verdict on whether it has left
  open,         ///< a verdict on whether it is open
  closed,       ///< a verdict on whether it is closed
  number,       ///< how many
  objects,      ///< which objects
  place,        ///< where
  last_time,    ///< when, the last time
  first_time,   ///< when, the first time
  duration,     ///< how long
  ago,          ///< how long ago
  probability,  ///< how sure
  reason,       ///< why
  why_not,      ///< why it is not so
  property,     ///< a colour, a size, …
  agent,        ///< who did it
  motive,       ///< why somebody did it
  until,        ///< when it ended
  all,          ///< a verdict on whether all of them are so
  only,         ///< a verdict on whether nothing else is so
  throughout,   ///< a verdict on whether it was so all the time
  lasted,       ///< a verdict on whether it was so from its beginning on
  together,     ///< a verdict on whether they have one place, colour or size
  most,         ///< which of them most often
  earliest,     ///< which of them first
  latest,       ///< which of them last
  longest,      ///< which of them longest
  looks,        ///< how often it was looked at
  closed_for,   ///< how long it was closed
};

struct Parameter {
  std::string name;  ///< kebab-case: the option --NAME, or a positional argument
  ParameterType type = ParameterType::text;
  std::string help = {};  ///< one line
  bool positional = false;
  bool required = false;
  std::string default_text = {};           ///< what holds when it is not given, for people
  std::vector<std::string> choices = {};   ///< empty = any
  std::vector<std::string> excludes = {};  ///< parameters that may not be given together with it
  int64_t min = 0;                         ///< of a number
  Asks asks = Asks::summary;               ///< of a query in which it is given
};

/// A question with its arguments as text.
struct Query {
  std::string question = {};                          ///< "where"
  std::map<std::string, std::string> arguments = {};  ///< by name of the parameter
  Asks asks = Asks::summary;                          ///< of the reply

  std::string argument(const std::string& name) const;  ///< "" = not given
  /// As it is typed after "loci-memory": where 'tea cup' --at 08:30.
  std::string text() const;
};

/// A whole number in digits or in words ("two"); unset for anything else.
std::optional<int64_t> read_number(const std::string& text);

/// Error for arguments that `parameters` do not have, for required ones that are missing, for names that are
/// empty, and for what is not the number that a parameter takes; `asked` is for the message.
void check_arguments(const std::string& asked, const std::vector<Parameter>& parameters, const Query& query);

/// Error for a period that ends before it begins: nothing is within it, and "nothing" would answer another
/// question.
void check_period(const std::optional<TimeNs>& from, const std::optional<TimeNs>& to);

/// A moment as people write it. Of two that clocks showed by one name it is the one nearer to a scene, the
/// second where both are as near.
TimeSpan read_moment(const Store& store, const std::string& text);

/// `as_of` with the times of --at and --known-at, where they are not empty.
AsOf read_as_of(const Store& store, const std::string& at, const std::string& known_at, AsOf as_of = {});

/// The arguments of a query, read against a memory.
class Arguments {
 public:
  /// `as_of` holds where the query says no time of its own.
  Arguments(const Store& store, const Query& query, const AsOf& as_of);

  const Store& store() const { return store_; }
  const AsOf& as_of() const { return as_of_; }
  /// From now on as of another time.
  void set_at(TimeNs at) { as_of_.at = at; }
  std::string text(const std::string& name) const { return query_.argument(name); }
  /// When the time given begins.
  std::optional<TimeNs> time(const std::string& name) const;
  std::optional<TimeNs> from() const;
  std::optional<TimeNs> to() const;  ///< the end of the time given
  std::optional<double> length(const std::string& name) const;
  std::optional<Id> number(const std::string& name) const;
  std::optional<Vector2d> point(const std::string& name) const;

 private:
  /// A period that is one time by its name is that moment.
  TimeSpan end_of_period(const char* name) const;

  const Store& store_;
  const Query& query_;
  TimeReader times_;
  AsOf as_of_;
};

/// Objects, places and scenes that an answer names, each once, in order.
struct Mentions {
  std::vector<Id> objects = {};
  std::vector<std::string> places = {};
  std::vector<Id> scenes = {};
};

namespace format {
class RecordSchema;  // answer_fields.h
}
struct Reply;         // reply.h
struct ReplyContext;  // reply.h

namespace detail {
template <class T>
std::string answer_text(const T& answer, const TimeWriter& times) {
  return to_text(answer, times);
}
template <class T>
void write_answer_json(const T& answer, Json& json) {
  json = to_json(answer);
}
/// False when the answer has no reply of its own: its text is shortened to one.
template <class T>
bool write_answer_reply(const T& answer, const ReplyContext& context, Reply& reply) {
  if constexpr (requires { write_reply(answer, context, reply); }) {
    write_reply(answer, context, reply);
    return true;
  }
  return false;
}
}  // namespace detail

/// The answer to any question. Holds an answer struct for which to_text(answer, times) and to_json(answer)
/// exist.
class Answer {
 public:
  template <class T>
  requires(!std::is_same_v<T, Answer>) Answer(T answer)
      : model_(std::make_shared<const Model<T>>(std::move(answer))) {}

  std::string to_text(const TimeWriter& times) const { return model_->to_text(times); }
  /// One sentence and its evidence (reply.h).
  Reply reply(const ReplyContext& context) const;
  Json to_json() const;
  Mentions mentions(const Store& store) const;

  /// The answer struct; nullptr when it is of another type.
  template <class T>
  const T* get_if() const {
    const auto* model = dynamic_cast<const Model<T>*>(model_.get());
    return model == nullptr ? nullptr : &model->answer;
  }
  /// The answer struct; std::bad_cast when it is of another type.
  template <class T>
  const T& get() const {
    return dynamic_cast<const Model<T>&>(*model_).answer;
  }

 private:
  struct Concept {
    virtual ~Concept() = default;
    virtual std::string to_text(const TimeWriter& times) const = 0;
    virtual void write_json(Json& json) const = 0;
    virtual bool write_reply(const ReplyContext& context, Reply& reply) const = 0;
  };
  template <class T>
  struct Model final : Concept {
    explicit Model(T value) : answer(std::move(value)) {}
    std::string to_text(const TimeWriter& times) const override { return detail::answer_text(answer, times); }
    void write_json(Json& json) const override { detail::write_answer_json(answer, json); }
    bool write_reply(const ReplyContext& context, Reply& reply) const override {
      return detail::write_answer_reply(answer, context, reply);
    }
    T answer;
  };
  /// Whatever was forgotten.
  Reply written(const ReplyContext& context) const;

  std::shared_ptr<const Concept> model_;
};

/// Where the time in a sentence goes.
enum class SentenceTime {
  none,              ///< a sentence with a time does not mean this question
  at,                ///< a moment: --at
  period,            ///< --between, --from, --to
  moment_or_period,  ///< a moment: --at; with a period the sentence means the question `over_period`
  during,            ///< hours or days of the week: --during
  since,             ///< a period that begins: --unseen-since
};

/// A rule of the grammar: a form of English sentence, in the lemmas of sentence_parser.cpp: "see" stands for
/// saw, seen, noticed, … (a|b) is one of them, [a] may be missing, $be, $one, … are sets of words. <object>,
/// <place>, … are phrases of that type and become the parameter of that name. Articles and fillers ("please",
/// "still") are left out. Of several rules that match a sentence the one with most literal words comes first,
/// then the one declared first; the first whose names mean something in the memory is taken.
struct SentenceForm {
  std::string form;
  Asks asks = Asks::summary;
  std::string example = {};  ///< shown to people; "" = a variant of the form before
  std::map<std::string, std::string> arguments =
      {};                                 ///< given by the form; "{place}" = the words of <place>, "" = none
  std::optional<SentenceTime> time = {};  ///< unset = as for the question
};

enum class QuestionGroup { ask, inspect };
std::string to_text(QuestionGroup group);  ///< "Ask"

struct Question {
  std::string name;  ///< kebab-case: the command
  QuestionGroup group = QuestionGroup::ask;
  std::string description;  ///< one line
  /// Beside --at and --known-at, which every question takes.
  std::vector<Parameter> parameters = {};
  bool period = false;  ///< takes --between, --from and --to
  /// The positional words, where they are not those of the one positional parameter, and how they become
  /// arguments.
  std::string words_help = {};
  void (*read_words)(std::vector<std::string> words, Query& query) = nullptr;
  Asks asks = Asks::summary;          ///< of the command
  std::vector<std::string> examples;  ///< as typed after the name, without -m
  /// How its answer is written as JSON; nullptr = in no declared form, outside of questions().
  const format::RecordSchema& (*answer)();
  Answer (*run)(const Arguments& arguments);
  SentenceTime time = SentenceTime::at;
  std::string over_period = {};  ///< the question that a sentence with a period means
  std::vector<SentenceForm> sentences = {};
  /// Whether --at asks for what held at that moment; else for all up to it.
  bool of_moment = true;

  /// Positional arguments as they are typed; Error when the question takes none.
  void read(const std::vector<std::string>& words, Query& query) const;
  /// All parameters: its own, then those of time.
  std::vector<Parameter> all_parameters() const;
  /// Error for unknown or missing arguments, and for names that mean nothing in this memory. Of a moment that
  /// was forgotten it is what was known before.
  Answer ask(const Store& store, const Query& query, const AsOf& as_of = {}) const;
  /// The answer to a query in one sentence with its evidence.
  Reply reply(const Store& store, Query query, const Answer& found) const;
};

/// What programs get of an answer: its sentence, and then all of it.
std::string full_text(const Reply& reply, const Answer& answer, const TimeWriter& times);
/// The same as data: the fields of the answer, and its sentence as "reply".
Json full_json(const Reply& reply, const Answer& answer);

/// All questions, in the order in which they are listed.
const std::vector<Question>& questions();
/// nullptr when there is none of that name.
const Question* find_question(const std::string& name);

/// Asks. Error for an unknown question, unknown or missing arguments, and names that mean nothing in this
/// memory.
Answer ask(const Store& store, const Query& query, const AsOf& as_of = {});

/// A query as typed after "loci-memory", with quotes as in a shell; unset when the first word is no question.
/// Error for an option that the question does not take.
std::optional<Query> parse_query(const std::string& text);

/// Metres of "0.5", "0.5 m", "50 cm" or "300 mm". Error for anything else and for what is not above 0.
double read_length(const std::string& text);
/// "1.2,0.4" or "1.2,0.4,0.9"; empty for anything else.
std::vector<double> read_point(const std::string& text);

/// docs/questions.md.
std::string questions_reference();
/// A declaration for programs: name, description and parameters.
Json declaration_json(const std::string& name, const std::string& description,
                      const std::vector<Parameter>& parameters);
/// Names, parameters and examples of all questions, and what they answer: its JSON Schema, by name.
Json questions_json();

// Parameters that several questions take.
Parameter object_parameter();       ///< positional, required
Parameter place_parameter();        ///< positional, required
Parameter only_object_parameter();  ///< --object
Parameter only_place_parameter();   ///< --place
Parameter count_parameter();        ///< --count

}  // namespace loci::memory
