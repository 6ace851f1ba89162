#include "memory/sentences/natural_language.h"

#include <fmt/format.h>

#include <algorithm>
#include <regex>
#include <set>

#include "mapping/base/text/text.h"
#include "memory/questions/events.h"
#include "memory/questions/names/related_words.h"
#include "memory/questions/presence.h"
#include "memory/questions/replies/reply_parts.h"
#include "memory/questions/snapshot.h"
#include "memory/questions/visits.h"
#include "memory/sentences/clauses/absence_clause.h"
#include "memory/sentences/clauses/contents_clause.h"
#include "memory/sentences/clauses/coordination.h"
#include "memory/sentences/clauses/event_clause.h"
#include "memory/sentences/discourse.h"
#include "memory/sentences/intents/intent_reader.h"
#include "memory/sentences/intents/rephrasing.h"
#include "memory/sentences/lexicon.h"
#include "memory/sentences/mentions.h"
#include "memory/sentences/name_check.h"
#include "memory/sentences/query_answerer.h"
#include "memory/sentences/references.h"
#include "memory/sentences/sentence_parser.h"
#include "memory/sentences/sentence_time.h"
#include "memory/sentences/spelling.h"

namespace loci::memory {

namespace {

std::string without_mark(std::string sentence) {
  while (!sentence.empty() && (sentence.back() == '?' || sentence.back() == ' ')) sentence.pop_back();
  return sentence;
}

constexpr size_t kMaxSentence = 1000;  ///< characters: readings are tried for all parts of a sentence

/// Answers sentences, one after the other.
class Conversation {
 public:
  Conversation(const Store& store, const NaturalLanguageQuestion& question)
      : snapshot_(store, question.as_of),
        times_(store),
        writer_(store),
        references_(store, question.as_of, question.about),
        answerer_(store, question.as_of, snapshot_, times_, writer_, references_),
        names_(store, snapshot_) {}

  NaturalLanguageAnswer answer(const std::string& sentence) {
    if (sentence.size() > kMaxSentence) {
      NaturalLanguageAnswer refused = not_understood(sentence);
      refused.why_not->hint = fmt::format("a question has at most {} characters", kMaxSentence);
      return refused;
    }
    const std::string named =
        snapshot_.with_names_joined(joined(words_of(at_time_of_last(without_sounds(sentence))), " "));
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
      if (references_.last_subject().empty() && find_pronoun(sentence_words(sentence)))
        answer.why_not->hint = "nothing was spoken of before: say what is meant";
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

  /// "In the last look" with the times of the last visit, which may be several looks; others as they are.
  std::string at_last_visit(const std::string& sentence) const {
    static const std::set<std::string> articles = {"the", "your", "my", "our"}, orders = {"last", "latest"},
                                       looks = {"look", "looks", "visit"},
                                       introductions = {"in", "at", "on", "during"};
    Words words = sentence_words(sentence);
    for (size_t i = 0; i + 3 < words.size(); ++i) {
      if (!introductions.contains(words[i]) || !articles.contains(words[i + 1]) ||
          !orders.contains(words[i + 2]) || !looks.contains(words[i + 3]))
        continue;
      const auto last = snapshot_.store().latest_scene(snapshot_.as_of());
      const auto begin = last_visit_begin(snapshot_.store(), snapshot_.as_of());
      if (!begin) return sentence;
      replace_words(words, i, 4, {"between", format_time(*begin), "and", format_time(last->time)});
      return join_words(words, 0, words.size());
    }
    return sentence;
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
      answerer_.try_reading(std::move(query), most);
      answer = std::move(most);
    } else if (!answer.reply->not_known || !answer.reply->objects.empty()) {
      answer.reply = among(*answer.reply, them, asks, snapshot_);
    }
    if (answer.reply) references_.remember(*answer.query, *answer.reply);
    return answer;
  }

  /// What the next sentence may lean on.
  void keep(const Query& query, const Reply& reply) {
    references_.remember(query, reply);
    last_ = query;
    denied_ = reply.verdict == Verdict::no;
  }

  /// A question and what is said around it.
  NaturalLanguageAnswer answer_text(const std::string& text) {
    const std::string meant = as_meant(text, [&](const std::string& words) { return is_name(words); });
    NaturalLanguageAnswer answer;
    if (const auto context = question_in_context(meant, times_); context && remember(*context)) {
      const std::string question = with_choice(context->question, references_.last_subject());
      if (const auto then = question_at_statements(*context, question, times_))
        answer = answer_sentence(*then);
      if (!answer.reply) answer = answer_sentence(question);
    }
    if (!answer.query) answer = answer_sentence(meant);
    return answer;
  }

  /// With English words of which the grammar knows none taken as typos; unset where that has no answer
  /// either.
  std::optional<NaturalLanguageAnswer> answer_respelled(const std::string& text) {
    constexpr size_t kMaxTried = 3;
    const std::vector<Respelling> spellings = respellings(text, names_.words(), true);
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
    const auto two = two_questions(meant);
    const bool elided = two && two->elided;
    NaturalLanguageAnswer answer = answer_or_rephrase(elided ? two->question : meant);
    if (elided && answer.reply) add_more(two->more, answer);
    if (elided && !answer.query) answer = answer_or_rephrase(meant);
    if (!answer.query) answer = two && !elided ? answer_two(*two, meant) : not_understood(meant);
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
      answerer_.try_reading(*query, *answer);
      if (answer->reply) continue;
      const bool unknown = answer->why_not && answer->why_not->reason == "never_seen";
      return unknown ? std::optional(*answer) : std::nullopt;
    }
    first.reply = compared(*comparison, *first.reply, *second.reply, snapshot_);
    keep(*first.query, *first.reply);
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
  NaturalLanguageAnswer answer_two(const TwoQuestions& two, const std::string& sentence) {
    NaturalLanguageAnswer answer = answer_or_rephrase(two.question);
    if (!answer.reply) return not_understood(sentence);
    const NaturalLanguageAnswer more = answer_or_rephrase(two.more);
    if (!more.reply) return not_understood(sentence);
    answer.reply = in_lines({*answer.reply, *more.reply});
    return answer;
  }

  /// "How long was the tea away?": when it left, then when it came back.
  std::optional<NaturalLanguageAnswer> answer_absence(const std::string& sentence) {
    auto absence = find_absence(sentence, snapshot_);
    NaturalLanguageAnswer left{.sentence = sentence}, came = left;
    if (!absence || !answerer_.try_reading(absence->left, left) || !left.reply) return std::nullopt;
    if (!left.reply->time) return left;  // it was not seen to leave
    absence->came.arguments["from"] = format_time(left.reply->time->last);
    answerer_.try_reading(absence->came, came);
    left.reply =
        absence_reply(*left.reply->time, came.reply ? came.reply->time : std::nullopt, times_.now(), writer_);
    keep(*left.query, *left.reply);
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
    const auto is_known = [&](const std::string& words) { return is_name(words); };
    if (const auto contrary = contrary_question(sentence, is_known)) {
      NaturalLanguageAnswer other = answer_or_rephrase(contrary->question);
      if (other.reply && other.reply->verdict) {
        other.reply = contrary_of(*other.reply);
        return other;
      }
      if (contrary->only_reading) return not_understood(sentence);
    }
    NaturalLanguageAnswer answer = answer_with_names(sentence);
    if (answer.query && !(answer.why_not && !answer.reply)) return answer;
    const auto plain = rephrased(sentence, is_known);
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
    if (auto state = answer_state_before(sentence)) {
      if (state->reply) keep(*state->query, *state->reply);
      return *state;
    }
    NaturalLanguageAnswer answer = answer_by_rules(with_choices_joined(at_last_visit(sentence)));
    // A name of several words that nothing is called by may be more than a name: "the bowl land".
    const bool failed = answer.query && answer.why_not && !answer.reply;
    const bool misplaced =
        failed && ((answer.why_not->reason == "unknown_place" && names_.is_object_for_place(*answer.query)) ||
                   (answer.why_not->reason == "never_seen" && names_.is_place_for_object(*answer.query)));
    const bool doubtful = misplaced || (failed && names_.has_unknown_word(*answer.query));
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
    note_owners_left_out(sentence, answer);
    note_habit_left_out(sentence, answer);
    keep(*answer.query, answer.reply.value_or(Reply{}));
    return answer;
  }

  /// "Every day", "usually": of a time and not of a habit is what follows.
  static void note_habit_left_out(const std::string& sentence, NaturalLanguageAnswer& answer) {
    static const std::set<std::string> of_habits = {"usual",  "life-cycle", "co-occurrence", "missing",
                                                    "digest", "scene-type", "task"};
    static const std::regex habit(
        R"(\b(every|each) (day|morning|noon|afternoon|evening|night|week|weekend)\b|\b(daily|usually|normally)\b)");
    const Query& query = *answer.query;
    std::smatch said;
    const std::string text = lower_case(sentence);
    if (of_habits.contains(query.question) || !std::regex_search(text, said, habit)) return;
    // What was seen at any time is what usually is there, but not that of each morning.
    if (query.question == "contents-history" && query.argument("from").empty() &&
        (!said[1].matched || !query.argument("during").empty()))
      return;
    answer.notes.push_back(fmt::format("'{}' is left out: the answer is not of a habit", said.str()));
  }

  /// "Bob's cup": whose it is restricts what is asked for.
  static void note_owners_left_out(const std::string& sentence, NaturalLanguageAnswer& answer) {
    const std::string read = lower_case(answer.query->text());
    for (const std::string& word : words_of(lower_case(sentence))) {
      if (!word.ends_with("'s")) continue;
      const std::string owner = word.substr(0, word.size() - 2);
      const bool is_owner = class_of(lemma_of(owner)) == WordClass::name && !lexicon().contains(owner) &&
                            !lexicon().contains(word) && !weekday_of(owner);
      if (is_owner && read.find(owner) == std::string::npos)
        answer.notes.push_back(fmt::format("'{}' is left out: nothing is known to be of {}", word, owner));
    }
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
      if (answerer_.try_reading(reading, answer)) break;
    if (readings.empty() || (answer.why_not && names_.is_strange(*answer.query))) {
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

  /// "Was the cup on the table before the bottle came?": at any time before, not which of them came first.
  std::optional<NaturalLanguageAnswer> answer_state_before(const std::string& sentence) {
    static const std::set<std::string> events = {"come", "vanish", "leave", "move", "take", "bring"};
    const Words words = sentence_words(sentence);
    if (words.empty() || (words[0] != "was" && words[0] != "were")) return std::nullopt;
    const auto clause = find_event_clause(sentence, snapshot_);
    if (!clause || clause->link != EventClause::Link::before) return std::nullopt;
    const auto happens = [&](const std::string& text) {
      return std::ranges::any_of(tokens_of(sentence_words(text)).lemmas,
                                 [&](const std::string& one) { return events.contains(one); });
    };
    if (!happens(clause->event) || happens(clause->question)) return std::nullopt;
    NaturalLanguageAnswer event = event_of(*clause);
    if (event.why_not && event.why_not->reason == "never_seen") return event;
    return answer_with_event(*clause, std::move(event), sentence);
  }

  /// "Where was the cup when the drawer was opened?": first when that was; unset when this is not understood.
  std::optional<NaturalLanguageAnswer> answer_at_event(const std::string& sentence) {
    const auto clause = find_event_clause(sentence, snapshot_);
    if (!clause) return std::nullopt;
    // "Was it empty at 9:50, when it stood open?": the clause says more of a time that is given.
    if (Words timeless = sentence_words(clause->question); clause->link == EventClause::Link::at)
      if (const auto time = cut_time(timeless, times_); time && time->moment && time->from != "now")
        return answer_plainly(clause->question);
    return answer_with_event(*clause, event_of(*clause), sentence);
  }

  /// When the event was, or whether it was so.
  NaturalLanguageAnswer event_of(const EventClause& clause) {
    return answer_plainly((clause.link == EventClause::Link::condition ? "" : "when ") + clause.event);
  }

  std::optional<NaturalLanguageAnswer> answer_with_event(const EventClause& clause,
                                                         NaturalLanguageAnswer event,
                                                         const std::string& sentence) {
    const bool condition = clause.link == EventClause::Link::condition;
    if (!event.reply || !(condition ? event.reply->verdict.has_value() : event.reply->time.has_value()))
      return std::nullopt;
    // A state that lasts names a period: "while the milk was on the table". Not where it ended in between.
    if (const WasAnswer* state = event.answer ? event.answer->get_if<WasAnswer>() : nullptr;
        state != nullptr && clause.link == EventClause::Link::at && was_interrupted(*state))
      return std::nullopt;
    const bool lasts = event.query->question == "was";
    const std::string note = event.reply->text;
    const std::optional<Change> when = change_of(event);
    NaturalLanguageAnswer answer = std::move(event);
    if (!condition || answer.reply->verdict == Verdict::yes) {
      answer = answer_plainly(condition ? clause.question : question_at(clause, *answer.reply->time, lasts));
      if (!answer.query) return std::nullopt;
      if (!condition && when && clause.link != EventClause::Link::at)
        check_order(bounds_of(*when), clause.link == EventClause::Link::before, answer);
      answer.notes.insert(answer.notes.begin(), clause.event + ": " + note);
    }
    answer.sentence = sentence;
    return answer;
  }

  /// The change whose time a reply names.
  static std::optional<Change> change_of(const NaturalLanguageAnswer& event) {
    const ChangesAnswer* changes = event.answer ? event.answer->get_if<ChangesAnswer>() : nullptr;
    if (changes == nullptr || !event.reply || !event.reply->time) return std::nullopt;
    const auto found = std::ranges::find(changes->changes, event.reply->time->last, &Change::time);
    return found == changes->changes.end() ? std::nullopt : std::optional(*found);
  }

  /// Whether something happened before or after an event is not observed where it may have been either.
  void check_order(const TimeSpan& event, bool before, NaturalLanguageAnswer& answer) const {
    if (!answer.reply || answer.query->question != "changes" || answer.query->asks != Asks::verdict) return;
    Query at_any_time = *answer.query;
    at_any_time.arguments.erase(before ? "to" : "from");
    const Answer all = loci::memory::ask(snapshot_.store(), at_any_time, snapshot_.as_of());
    std::vector<Change> perhaps;
    for (const Change& change : all.get<ChangesAnswer>().changes) {
      const std::partial_ordering order = order_of(bounds_of(change), event);
      if (before ? order < 0 : order > 0) return;
      if (order == std::partial_ordering::unordered) perhaps.push_back(change);
    }
    if (perhaps.empty()) return;
    TimeSpan both = hull_of(perhaps);
    both = {std::min(both.first, event.first), std::max(both.last, event.last)};
    answer.reply->verdict = Verdict::not_observed;
    answer.reply->text = fmt::format("Not observed which was first: both happened {}.",
                                     uncapitalised(replies::between_text(both, writer_)));
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

  /// With the words of this memory only where the grammar does not know all words.
  std::vector<Respelling> likely_spellings(const std::string& sentence) const {
    std::vector<Respelling> spellings = respellings(sentence, {});
    return spellings.size() == 1 ? spellings : respellings(sentence, names_.words());
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
    // How sure it is that something is not there: that it has gone, or is elsewhere.
    for (Query& one : readings)
      if (denied_ && last_ && one.asks == Asks::probability && one.arguments == last_->arguments &&
          one.arguments.contains("object")) {
        one.question = "where";
        one.arguments.erase("place");
      }
    if (readings.empty())
      if (auto named = parse_name(clauses); named && names_.is_known(*named)) readings = {*named};
    return readings;
  }

  const Snapshot snapshot_;  ///< shared by all readings: what it found out is not found out again
  TimeReader times_;
  TimeWriter writer_;
  ReferenceResolver references_;
  QueryAnswerer answerer_;
  NameCheck names_;
  std::optional<Query> last_;
  bool denied_ = false;  ///< the answer to it was no
};

}  // namespace

std::vector<NaturalLanguageAnswer> ask(const Store& store, const NaturalLanguageQuestion& question) {
  Conversation conversation(store, question);
  std::vector<NaturalLanguageAnswer> answers;
  for (const std::string& sentence : question.sentences) answers.push_back(conversation.answer(sentence));
  return answers;
}

}  // namespace loci::memory
