#include "memory/sentences/natural_language.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "mapping/base/text/text.h"
#include "memory/questions/environment.h"
#include "memory/questions/events.h"
#include "memory/questions/names/map_names.h"
#include "memory/questions/names/names.h"
#include "memory/questions/names/related_words.h"
#include "memory/questions/objects.h"
#include "memory/questions/presence.h"
#include "memory/questions/snapshot.h"
#include "memory/sentences/clauses/absence_clause.h"
#include "memory/sentences/clauses/contents_clause.h"
#include "memory/sentences/clauses/coordination.h"
#include "memory/sentences/clauses/event_clause.h"
#include "memory/sentences/discourse.h"
#include "memory/sentences/intents/intent_reader.h"
#include "memory/sentences/intents/rephrasing.h"
#include "memory/sentences/lexicon.h"
#include "memory/sentences/mentions.h"
#include "memory/sentences/references.h"
#include "memory/sentences/sentence_parser.h"
#include "memory/sentences/spelling.h"
#include "memory/wordnet/wordnet.h"

namespace loci::memory {

namespace {

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
  const auto sentence = [](std::string text) { return capitalised(std::move(text)) + "."; };
  if (error.kind() == UnknownName::Kind::place)
    return {"unknown_place", sentence(error.message()), error.hint()};
  if ((as_of.at || query.arguments.contains("at")) && is_answered_later(store, query, as_of))
    return {"not_yet_seen", sentence(error.message() + " at that time; it was first seen later"), {}};
  return {"never_seen", sentence(error.message()), error.hint()};
}

/// "grown", "drank": a form of a verb, and no noun.
bool is_inflected_verb(const std::string& word) {
  using wordnet::PartOfSpeech;
  const std::vector<std::string> bases = wordnet::base_forms(word, PartOfSpeech::verb);
  return !bases.empty() && std::ranges::count(bases, word) == 0 &&
         wordnet::base_forms(word, PartOfSpeech::noun).empty();
}

std::string without_mark(std::string sentence) {
  while (!sentence.empty() && (sentence.back() == '?' || sentence.back() == ' ')) sentence.pop_back();
  return sentence;
}

/// Answers sentences, one after the other.
class Conversation {
 public:
  Conversation(const Store& store, const NaturalLanguageQuestion& question)
      : store_(store),
        question_(question),
        snapshot_(store, question.as_of),
        times_(store),
        writer_(store),
        references_(store, question.as_of, question.about) {}

  NaturalLanguageAnswer answer(const std::string& sentence) {
    const std::string named = snapshot_.with_names_joined(joined(words_of(at_time_of_last(sentence)), " "));
    const std::vector<Id> spoken_of = references_.last_objects();
    if (auto among = answer_of_them(named)) {
      among->sentence = sentence;
      return *among;
    }
    NaturalLanguageAnswer answer = answer_text(named);
    if (!answer.reply)
      if (auto respelled = answer_respelled(named)) answer = std::move(*respelled);
    const auto loses_choice = [&] { return answer.reply && names_nothing(*answer.query) && chooses(named); };
    if (loses_choice()) answer = {};
    if (!answer.reply && chooses(named)) answer = answer_choice(named, spoken_of);
    if (loses_choice()) answer = {};
    answer.sentence = sentence;
    if (!answer.query) {
      set_not_understood(answer);
      answer.nearest = nearest_examples(sentence);
    }
    return answer;
  }

 private:
  /// "And ten minutes later?" with the time that it means after the question before; others as they are.
  std::string at_time_of_last(const std::string& sentence) const {
    Words words = sentence_words(sentence);
    if (!words.empty() && words[0] == "and") words.erase(words.begin());
    const std::string base = last_ ? last_->argument("at") : "";
    if (words.size() < 3 || base.empty() || (words.back() != "later" && words.back() != "earlier"))
      return sentence;
    const auto ago = times_.try_read(join_words(words, 0, words.size() - 1) + " ago");
    const auto time = times_.try_read(base);
    if (!ago || !time) return sentence;
    const TimeNs passed = times_.now() - ago->first;
    return "and at " + format_time(time->first + (words.back() == "later" ? passed : -passed)) + "?";
  }

  /// "Which of those is the biggest?" asks of what the last answer named.
  NaturalLanguageAnswer answer_choice(const std::string& sentence, const std::vector<Id>& objects) {
    constexpr size_t kMaxChoices = 10;
    std::vector<std::string> names;
    for (const Id id : objects) names.push_back(object_name(id));
    if (names.size() < 2 || names.size() > kMaxChoices) return {};
    NaturalLanguageAnswer answer = answer_text(with_choice(sentence, joined(names, " or ")));
    if (answer.reply || names.size() < 3) return answer;  // a choice of two has another form
    const std::string without_choice = without_mark(with_choice(sentence, " "));  // "which is the biggest"
    return answer_text(fmt::format("{} of {}", without_choice, joined(names, ", ")));
  }

  /// "How many of them are boxes?" asks of what the last answer named; unset for other sentences, and where
  /// it asks for more than which of them.
  std::optional<NaturalLanguageAnswer> answer_of_them(const std::string& sentence) {
    const std::vector<Id> them = references_.last_objects();
    const std::string whole = without_partitive(sentence);
    if (whole.empty() || them.empty()) return std::nullopt;
    NaturalLanguageAnswer answer = answer_text(whole);
    if (!answer.reply) return std::nullopt;
    const Asks asks = answer.query->asks;
    if (asks != Asks::objects && asks != Asks::number && asks != Asks::exists) return std::nullopt;
    const std::vector<std::string> object = words_of(answer.query->argument("object"));
    if (!object.empty() && is_superlative(object.front())) {
      std::vector<std::string> names;
      for (const Id id : them) names.push_back(object_name(id));
      answer.query->arguments["object"] += " " + joined(names, " or ");
      Query query = *answer.query;
      NaturalLanguageAnswer most{.sentence = sentence};
      try_reading(std::move(query), most);
      answer = std::move(most);
    } else if (!answer.reply->not_known || !answer.reply->objects.empty()) {
      answer.reply = among(*answer.reply, them, asks, snapshot_);
    }
    if (answer.reply) references_.remember(*answer.query, *answer.reply);
    return answer;
  }

  /// A question and what is said around it.
  NaturalLanguageAnswer answer_text(const std::string& text) {
    const std::string meant = as_meant(text, [&](const std::string& words) { return is_name(words); });
    NaturalLanguageAnswer answer;
    if (const auto context = question_in_context(meant, times_); context && remember(*context)) {
      const std::string question = with_choice(context->question, references_.last_subject());
      if (const std::string time = time_of_statements(*context, times_); !time.empty())
        answer = answer_sentence(fmt::format("{} at {}", without_mark(question), time));
      if (!answer.reply) answer = answer_sentence(question);
    }
    if (!answer.query) answer = answer_sentence(meant);
    return answer;
  }

  /// With English words of which the grammar knows none taken as typos; unset where that has no answer
  /// either.
  std::optional<NaturalLanguageAnswer> answer_respelled(const std::string& text) {
    constexpr size_t kMaxTried = 3;
    const std::vector<Respelling> spellings = respellings(text, names(), true);
    for (size_t i = 0; i < std::min(kMaxTried, spellings.size()); ++i) {
      if (spellings[i].notes.empty()) break;
      NaturalLanguageAnswer answer = answer_text(spellings[i].sentence);
      if (!answer.reply) continue;
      answer.notes.insert(answer.notes.begin(), spellings[i].notes.begin(), spellings[i].notes.end());
      return answer;
    }
    return std::nullopt;
  }

  /// One question, or several in one sentence.
  NaturalLanguageAnswer answer_sentence(const std::string& meant) {
    if (auto compared = answer_compared(meant)) return *compared;
    if (auto absence = answer_absence(meant)) return *absence;
    const auto elided = elided_question(meant);
    NaturalLanguageAnswer answer = answer_or_rephrase(elided ? elided->question : meant);
    if (elided && answer.reply) add_more(elided->more, answer);
    if (elided && !answer.query) answer = answer_or_rephrase(meant);
    if (!answer.query) answer = answer_two(meant);
    if (!answer.reply)
      if (auto both = answer_both(meant)) return *both;
    return answer;
  }

  /// "What was on the table at noon that is gone now?": both contents, then their difference.
  std::optional<NaturalLanguageAnswer> answer_compared(const std::string& sentence) {
    const auto comparison = find_contents_comparison(sentence, snapshot_, times_);
    if (!comparison) return std::nullopt;
    NaturalLanguageAnswer first{.sentence = sentence}, second = first;
    for (const auto& [query, answer] :
         {std::pair(&comparison->first, &first), std::pair(&comparison->second, &second)}) {
      try_reading(*query, *answer);
      if (answer->reply) continue;
      const bool unknown = answer->why_not && answer->why_not->reason == "never_seen";
      return unknown ? std::optional(*answer) : std::nullopt;
    }
    first.reply = compared(*comparison, *first.reply, *second.reply, snapshot_);
    references_.remember(*first.query, *first.reply);
    last_ = first.query;
    return first;
  }

  /// "Is the spoon on the table and the cup in the drawer?": yes where both are so.
  std::optional<NaturalLanguageAnswer> answer_both(const std::string& sentence) {
    const auto halves = two_statements(sentence);
    if (!halves) return std::nullopt;
    NaturalLanguageAnswer first = answer_or_rephrase(halves->first),
                          second = answer_or_rephrase(halves->second);
    for (const NaturalLanguageAnswer* half : {&first, &second})
      if (!half->reply || !half->reply->verdict) return std::nullopt;
    first.reply = combined({*first.reply, *second.reply}, {{*first.query, *second.query}, "and"});
    first.notes.insert(first.notes.end(), second.notes.begin(), second.notes.end());
    return first;
  }

  /// "Is the tea back, and when was it put there?": both answers; none where one is not understood.
  NaturalLanguageAnswer answer_two(const std::string& sentence) {
    const auto two = two_questions(sentence);
    if (!two) return not_understood(sentence);
    NaturalLanguageAnswer answer = answer_or_rephrase(two->question);
    if (!answer.reply) return not_understood(sentence);
    const NaturalLanguageAnswer more = answer_or_rephrase(two->more);
    if (!more.reply) return not_understood(sentence);
    answer.reply = in_lines({*answer.reply, *more.reply});
    return answer;
  }

  /// "How long was the tea away?": when it left, then when it came back.
  std::optional<NaturalLanguageAnswer> answer_absence(const std::string& sentence) {
    auto absence = find_absence(sentence, snapshot_);
    NaturalLanguageAnswer left{.sentence = sentence}, came = left;
    if (!absence || !try_reading(absence->left, left) || !left.reply) return std::nullopt;
    if (!left.reply->time) return left;  // it was not seen to leave
    absence->came.arguments["from"] = format_time(left.reply->time->last);
    try_reading(absence->came, came);
    left.reply =
        absence_reply(*left.reply->time, came.reply ? came.reply->time : std::nullopt, times_.now(), writer_);
    references_.remember(*left.query, *left.reply);
    last_ = left.query;
    return left;
  }

  /// What statements speak of: the last one first, and what is known before other nouns of households. False
  /// where they restrict a question that refers to nothing: "For soup I need the pot. What is missing?"
  bool remember(const QuestionInContext& context) {
    std::string subject, place;
    for (const bool known : {true, false})
      for (auto statement = context.statements.rbegin(); statement != context.statements.rend(); ++statement)
        for (const Mention& mention : mentions_of(tokens_of(sentence_words(*statement)))) {
          std::string& text = mention.place ? place : subject;
          if (mention.known == known && text.empty()) text = mention.text;
        }
    const Words question = sentence_words(context.question);
    const bool refers =
        std::ranges::any_of(question, is_reference) || !mentions_of(tokens_of(question)).empty();
    if (!refers && !subject.empty()) return false;
    references_.remember(subject, place);
    return true;
  }

  std::vector<Mention> mentions_of(const Tokens& tokens) const {
    const auto is_word = [](const std::string&) { return true; };
    return joined_mentions(find_mentions(tokens, snapshot_, is_word), tokens, true, false);
  }

  /// What is not understood is said in plainer words, once.
  NaturalLanguageAnswer answer_or_rephrase(const std::string& sentence) {
    if (const auto contrary = contrary_question(sentence)) {
      NaturalLanguageAnswer other = answer_or_rephrase(contrary->question);
      if (other.reply && other.reply->verdict) {
        other.reply = contrary_of(*other.reply);
        return other;
      }
      if (contrary->only_reading) return not_understood(sentence);
    }
    NaturalLanguageAnswer answer = answer_with_names(sentence);
    if (answer.query && !(answer.why_not && !answer.reply)) return answer;
    const auto plain = rephrased(sentence, [&](const std::string& words) { return is_name(words); });
    if (!plain) return answer;
    NaturalLanguageAnswer other = answer_with_names(plain->sentence);
    if (!other.reply && (answer.query || plain->contrary)) return answer;
    if (!other.query || (plain->contrary && !other.reply->verdict)) return answer;
    if (plain->contrary) other.reply = contrary_of(*other.reply);
    if (other.understood_as.empty()) other.understood_as = plain->sentence;
    return other;
  }

  /// The answer to "and when?" as another line.
  void add_more(const std::string& question, NaturalLanguageAnswer& answer) {
    const NaturalLanguageAnswer more = answer_by_rules(question);
    if (more.reply) answer.reply = in_lines({*answer.reply, *more.reply});
  }

  /// Whether a query is about all objects, or the biggest of all.
  static bool names_nothing(const Query& query) {
    const std::string object = query.argument("object");
    return object.empty() || is_superlative(object);
  }

  bool is_name(const std::string& words) const {
    return !snapshot_.places_meant(words).empty() || snapshot_.means_objects(words);
  }

  NaturalLanguageAnswer answer_with_names(const std::string& sentence) {
    NaturalLanguageAnswer answer = answer_by_rules(with_choices_joined(sentence));
    // A name of several words that nothing is called by may be more than a name: "the bowl land".
    const bool failed = answer.query && answer.why_not && !answer.reply;
    const bool misplaced =
        failed && ((answer.why_not->reason == "unknown_place" && is_object_for_place(*answer.query)) ||
                   (answer.why_not->reason == "never_seen" && is_place_for_object(*answer.query)));
    const bool doubtful = misplaced || (failed && has_unknown_word(*answer.query));
    if (!answer.query || doubtful) {
      auto other = answer_in_parts(sentence);
      if (!other) other = answer_at_event(sentence);
      if (other && (!doubtful || other->reply)) {
        answer = std::move(*other);
      } else if (misplaced) {
        answer = {.sentence = sentence};
        set_not_understood(answer);
      }
    }
    if (!answer.query) return answer;
    references_.remember(*answer.query, answer.reply.value_or(Reply{}));
    last_ = answer.query;
    return answer;
  }

  /// What the rules make of a whole sentence.
  NaturalLanguageAnswer answer_by_rules(const std::string& sentence) {
    NaturalLanguageAnswer answer{.sentence = sentence};
    std::vector<Query> readings;
    std::vector<std::string> notes;
    for (const Respelling& respelling : likely_spellings(sentence)) {
      readings = readings_of(respelling.sentence);
      notes = respelling.notes;
      if (!readings.empty()) break;
    }
    for (const Query& reading : readings)
      if (try_reading(reading, answer)) break;
    if (readings.empty() || (answer.why_not && is_strange(*answer.query))) {
      answer = {.sentence = sentence};
      set_not_understood(answer);
      return answer;
    }
    if (answer.why_not) answer.why_not->text = shortened(answer.why_not->text);
    answer.notes.insert(answer.notes.begin(), notes.begin(), notes.end());
    return answer;
  }

  /// By both readers, without clauses of time.
  NaturalLanguageAnswer answer_plainly(const std::string& sentence) {
    NaturalLanguageAnswer answer = answer_by_rules(sentence);
    if (!answer.query)
      if (auto in_parts = answer_in_parts(sentence)) answer = std::move(*in_parts);
    return answer;
  }

  /// "Where was the cup when the drawer was opened?": first when that was; unset when this is not understood.
  std::optional<NaturalLanguageAnswer> answer_at_event(const std::string& sentence) {
    const auto clause = find_event_clause(sentence, snapshot_);
    if (!clause) return std::nullopt;
    const bool condition = clause->link == EventClause::Link::condition;
    NaturalLanguageAnswer event = answer_plainly((condition ? "" : "when ") + clause->event);
    if (!event.reply || !(condition ? event.reply->verdict.has_value() : event.reply->time.has_value()))
      return std::nullopt;
    // A state that lasts names a period: "while the milk was on the table". Not where it ended in between.
    if (const WasAnswer* state = event.answer ? event.answer->get_if<WasAnswer>() : nullptr;
        state != nullptr && clause->link == EventClause::Link::at && was_interrupted(*state))
      return std::nullopt;
    const bool lasts = event.query->question == "was";
    const std::string note = event.reply->text;
    NaturalLanguageAnswer answer = std::move(event);
    if (!condition || answer.reply->verdict == Verdict::yes) {
      answer =
          answer_plainly(condition ? clause->question : question_at(*clause, *answer.reply->time, lasts));
      if (!answer.query) return std::nullopt;
      answer.notes.insert(answer.notes.begin(), clause->event + ": " + note);
    }
    answer.sentence = sentence;
    return answer;
  }

  /// Whether one of the objects was elsewhere between two of its sightings there.
  static bool was_interrupted(const WasAnswer& state) {
    return std::ranges::any_of(state.objects, [](const WasObject& object) {
      return !object.seen_there.empty() && std::ranges::any_of(object.absent, [&](TimeNs time) {
        return time > object.seen_there.front().time && time < object.seen_there.back().time;
      });
    });
  }

  /// Each question of the sentence by itself, in plain words; unset when none is understood.
  std::optional<NaturalLanguageAnswer> answer_in_parts(const std::string& sentence) {
    const Respelling spelling = likely_spellings(sentence).front();
    std::vector<NaturalLanguageAnswer> answers;
    for (const std::vector<PlainQuestion>& question : plain_questions(spelling.sentence, snapshot_, times_))
      if (auto one = answer_plain(question)) answers.push_back(std::move(*one));
    if (answers.empty()) return std::nullopt;
    NaturalLanguageAnswer all = answers.front();
    all.sentence = sentence;
    std::vector<Reply> replies;
    all.understood_as.clear();
    for (const NaturalLanguageAnswer& one : answers) {
      all.understood_as += (all.understood_as.empty() ? "" : " ") + one.sentence;
      if (one.reply) replies.push_back(*one.reply);
    }
    if (!replies.empty()) all.reply = in_lines(replies);
    all.notes.insert(all.notes.begin(), spelling.notes.begin(), spelling.notes.end());
    return all;
  }

  /// The first reading that the memory answers. A name that it does not know is only taken for one where the
  /// reading is certain.
  std::optional<NaturalLanguageAnswer> answer_plain(const std::vector<PlainQuestion>& readings) {
    constexpr double kCertain = 0.9;
    for (const PlainQuestion& reading : readings) {
      NaturalLanguageAnswer answer = answer_by_rules(reading.text);
      if (!answer.query) continue;
      const bool unknown = answer.why_not && !answer.reply;
      if (unknown && (reading.names_known || reading.probability < kCertain)) continue;
      return answer;
    }
    return std::nullopt;
  }

  static NaturalLanguageAnswer not_understood(const std::string& sentence) {
    NaturalLanguageAnswer answer{.sentence = sentence};
    set_not_understood(answer);
    return answer;
  }

  static void set_not_understood(NaturalLanguageAnswer& answer) {
    answer.why_not = NoAnswer{
        "not_understood", fmt::format("'{}' is not understood.", shortened(answer.sentence, 80)), {}};
  }

  /// Whether a name has a word before its noun that nobody knows, or ends like a verb or an adverb, or is
  /// nothing that could stand somewhere ("meeting"): then it is likelier that the sentence was not understood
  /// than that something is called so.
  bool is_strange(const Query& query) const {
    const auto known = [&](const std::string& word) {
      return is_known_word(word) || word.find_first_of("_0123456789'") != std::string::npos ||
             std::ranges::count(names(), word) > 0;
    };
    for (const Parameter& parameter : find_question(query.question)->parameters) {
      if (parameter.type != ParameterType::object && parameter.type != ParameterType::place &&
          parameter.type != ParameterType::part && parameter.type != ParameterType::spot)
        continue;
      const std::vector<std::string> words = words_of(lower_case(query.argument(parameter.name)));
      if (words.empty()) continue;
      const std::string& noun = words.back();
      const bool is_noun = !wordnet::base_forms(noun, wordnet::PartOfSpeech::noun).empty();
      if (is_noun && !known(noun) && !wordnet::may_be_somewhere(noun)) return true;
      // "Uncertain", "unusual": English, and no noun.
      if (!is_noun && wordnet::is_word(noun) && !is_household_noun(noun) && names().count(noun) == 0)
        return true;
      for (size_t i = 0; i < words.size(); ++i) {
        if (known(words[i])) continue;
        const bool verb = words[i].ends_with("ed") || words[i].ends_with("ing") || words[i].ends_with("ly") ||
                          is_inflected_verb(words[i]);
        if (verb || (i + 1 < words.size() && means_something(words.back()))) return true;
      }
    }
    return false;
  }

  /// Whether an object stands where a question has a place: "when was the jam opened".
  bool is_object_for_place(const Query& query) const {
    return std::ranges::any_of(find_question(query.question)->parameters, [&](const Parameter& parameter) {
      const bool place = parameter.type == ParameterType::place || parameter.type == ParameterType::part;
      const std::string name = query.argument(parameter.name);
      return place && !name.empty() && snapshot_.places_meant(name).empty() && snapshot_.means_objects(name);
    });
  }

  /// Whether a place stands where a question has an object: "where did the shelf go".
  bool is_place_for_object(const Query& query) const {
    const std::string name = query.argument("object");
    return !name.empty() && !snapshot_.places_meant(name).empty() && !snapshot_.means_objects(name);
  }

  /// Whether a name of several words has one that means nothing in this memory.
  bool has_unknown_word(const Query& query) const {
    for (const Parameter& parameter : find_question(query.question)->parameters) {
      const std::vector<std::string> words = words_of(lower_case(query.argument(parameter.name)));
      const bool is_name = parameter.type == ParameterType::object ||
                           parameter.type == ParameterType::place || parameter.type == ParameterType::part ||
                           parameter.type == ParameterType::spot;
      if (is_name && words.size() > 1 &&
          std::ranges::any_of(words, [&](const std::string& word) { return names().count(word) == 0; }))
        return true;
    }
    return false;
  }

  bool means_something(const std::string& noun) const {
    return lemma_of(noun) == "thing" || is_known({"where", {{"object", noun}}, Asks::place});
  }

  /// The words of this memory for its objects and places.
  const std::set<std::string>& names() const {
    if (!names_) {
      names_.emplace();
      for (const std::string& name : known_names(store_))
        for (const std::string& word : words_of(lower_case(name))) names_->insert(word);
      for (const std::string& name : snapshot_.known_names())
        for (const std::string& word : words_of(lower_case(name))) names_->insert(word);
    }
    return *names_;
  }

  /// With the words of this memory only where the grammar does not know all words.
  std::vector<Respelling> likely_spellings(const std::string& sentence) const {
    std::vector<Respelling> spellings = respellings(sentence, {});
    return spellings.size() == 1 ? spellings : respellings(sentence, names());
  }

  std::vector<Query> readings_of(const std::string& sentence) const {
    std::vector<Query> readings;
    const std::vector<Clause> clauses = clauses_of(sentence, times_);
    // "What about the jam?" asks what was asked of the milk.
    const Words words = sentence_words(sentence);
    const size_t first = starts_with_words(words, {"and"}) || starts_with_words(words, {"so"}) ? 1 : 0;
    if (last_ && (starts_with_words(words, {"what", "about"}, first) ||
                  starts_with_words(words, {"how", "about"}, first)))
      readings =
          parse_follow_up(clauses_of(join_words(words, first + 2, words.size()), times_), *last_, times_);
    if (readings.empty()) readings = parse_readings(clauses, times_);
    if (readings.empty() && last_) readings = parse_follow_up(clauses, *last_, times_);
    if (readings.empty())
      if (auto named = parse_name(clauses); named && is_known(*named)) readings = {*named};
    return readings;
  }

  bool is_known(const Query& query) const {
    try {
      snapshot_.find_objects(query.argument("object"));
      return true;
    } catch (const UnknownName&) {
      return false;
    }
  }

  /// Whether the names of a reading mean something. The first reading is kept where none does.
  bool try_reading(Query query, NaturalLanguageAnswer& answer) {
    const bool first = !answer.query, then = query.argument("at") == "then";
    std::vector<std::string> notes;
    references_.resolve(query, notes);
    if (query.argument("object") == "one") return false;  // of what was not said
    // The name of a place means what is there, but "where is the table" asks for the table.
    if (query.question == "where" && query.asks == Asks::place &&
        std::ranges::count(snapshot_.places(), query.argument("object"), &PlaceRow::name) > 0)
      query = {"room", {{"part", query.argument("object")}}, Asks::place};
    NaturalLanguageAnswer tried{.sentence = answer.sentence};
    try {
      set_answer(query, tried);
      if (then && tried.reply && tried.reply->verdict == Verdict::no) tried.reply = not_then(*tried.reply);
    } catch (const UnknownName& error) {
      if (first && error.kind() == UnknownName::Kind::place) tried.reply = not_looked_into(query);
      if (first && error.kind() == UnknownName::Kind::object) tried.reply = none_coloured(query);
      if (!first) return false;
      if (const auto part = of_part(query)) {
        query = *part;
        set_answer(query, tried);
      } else {
        tried.why_not = why_not(store_, query, question_.as_of, error);
      }
    } catch (const Error& error) {
      tried.why_not =
          NoAnswer{"not_possible", fmt::format("Not possible: {}.", error.message()), error.hint()};
    }
    note_hours(query, notes);
    references_.note_places(query, notes);
    references_.note_related(query, notes);
    const bool answered =
        tried.answer.has_value() || !tried.why_not || tried.why_not->reason == "not_possible";
    if (!answered && !first) return false;
    tried.query = std::move(query);
    tried.notes = std::move(notes);
    answer = std::move(tried);
    return answered;
  }

  /// That something was not so when an object was last seen says nothing of the time before.
  static Reply not_then(Reply reply) {
    reply.verdict = Verdict::not_observed;
    if (reply.text.starts_with("No: ")) reply.text.replace(0, 4, "Not observed: at last ");
    return reply;
  }

  /// Which half of the day an hour is taken for, where both were observed.
  void note_hours(const Query& query, std::vector<std::string>& notes) const {
    std::string noted;
    for (const char* name : {"at", "from", "to", "unseen-since"}) {
      const std::string time = query.argument(name);
      if (time.empty() || time == noted || !times_.may_be_other_half(time)) continue;
      notes.push_back(fmt::format("'{}' is taken as {}", time, writer_.text(times_.read(time).first)));
      noted = time;
    }
  }

  /// What is in a part of the map that no scene has shown from inside; unset for other places.
  std::optional<Reply> not_looked_into(const Query& query) const {
    const std::string place = query.argument("place");
    const std::string part = place.empty() ? "" : find_part_without_place(snapshot_, place);
    if (part.empty()) return std::nullopt;
    return Reply{.text = shortened(fmt::format("Not observed: no look has shown what is in {}.", place)),
                 .verdict = Verdict::not_observed,
                 .not_known = true};
  }

  /// "Anything blue?" names nothing that is unknown where nothing is blue; unset for other questions.
  std::optional<Reply> none_coloured(const Query& query) const {
    const std::string object = query.argument("object");
    const size_t end = object.find(' ');
    const std::string colour = object.substr(0, end);
    std::string kind = end == std::string::npos ? "" : object.substr(end + 1);
    if (lemma_of(kind) == "thing") kind.clear();
    // Of what was before only the last colour is known.
    const bool now = !query.arguments.contains("at") && !query.arguments.contains("from") &&
                     !query.arguments.contains("to") && query.question != "was";
    const bool counts = query.asks == Asks::verdict || query.asks == Asks::exists ||
                        query.asks == Asks::objects || query.asks == Asks::number;
    if (!is_color_word(colour) || !now || !counts) return std::nullopt;
    if (!kind.empty() && !snapshot_.means_objects(kind)) return std::nullopt;
    return Reply{.text = kind.empty() ? fmt::format("No: nothing {} is known.", colour)
                                      : fmt::format("No: of what is called '{}' nothing is known to be {}.",
                                                    kind, colour),
                 .verdict = Verdict::no,
                 .number = 0};
  }

  /// "Is there a fridge?" asks for a piece of furniture where no object is called so.
  std::optional<Query> of_part(const Query& query) const {
    const std::string name = query.argument("object");
    const bool exists = query.asks == Asks::exists || query.asks == Asks::verdict;
    if (query.question != "where" || !exists || name.empty() || name.find(' ') != std::string::npos)
      return std::nullopt;
    try {
      ask(store_, RoomQuestion{.part = name, .as_of = question_.as_of});
    } catch (const UnknownName&) {
      return std::nullopt;
    }
    return Query{"room", {{"part", name}}, Asks::exists};
  }

  /// Of a time after the last look or before the first one nothing is known.
  std::optional<Reply> out_of_time(const Query& query) const {
    const auto from = times_.try_read(query.argument("from")), to = times_.try_read(query.argument("to"));
    const std::optional<TimeNs> first = times_.first_scene();
    const bool late = from && from->first > times_.now(), early = to && first && to->last < *first;
    if (!late && !early) return std::nullopt;
    return Reply{.text = fmt::format("Not observed: the {} look was at {}.", late ? "last" : "first",
                                     writer_.text(late ? times_.now() : *first)),
                 .verdict = Verdict::not_observed,
                 .not_known = true};
  }

  void set_answer(const Query& query, NaturalLanguageAnswer& answer) const {
    answer.reply = out_of_time(query);
    if (answer.reply) return;
    const AsOf as_of = read_as_of(store_, query.argument("at"), query.argument("known-at"), question_.as_of);
    const Coordination coordination = coordination_of(query);
    std::vector<Reply> replies;
    for (const Query& one : coordination.queries) {
      answer.answer = ask(store_, one, question_.as_of);
      ReplyContext context{store_, one, as_of, writer_};
      if (lower_case(answer.sentence).find(" else ") != std::string::npos)
        context.except = references_.last_objects();
      replies.push_back(answer.answer->reply(context));
    }
    answer.reply = combined(replies, coordination);
  }

  const Store& store_;
  const NaturalLanguageQuestion& question_;
  const Snapshot snapshot_;  ///< shared by all readings: what it found out is not found out again
  TimeReader times_;
  TimeWriter writer_;
  ReferenceResolver references_;
  std::optional<Query> last_;
  mutable std::optional<std::set<std::string>> names_;  ///< read when first asked for
};

}  // namespace

std::vector<NaturalLanguageAnswer> ask(const Store& store, const NaturalLanguageQuestion& question) {
  Conversation conversation(store, question);
  std::vector<NaturalLanguageAnswer> answers;
  for (const std::string& sentence : question.sentences) answers.push_back(conversation.answer(sentence));
  return answers;
}

std::vector<std::string> suggested_questions(const Store& store) {
  std::vector<std::string> suggestions;
  const auto name = [](const ObjectRef& object) {
    return object.label ? with_article(*object.label) : object.name;
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
