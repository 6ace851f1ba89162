#include "memory/sentences/intents/intent_reader.h"

#include <algorithm>
#include <optional>
#include <set>

#include "mapping/base/text/text.h"
#include "memory/questions/names/color_words.h"
#include "memory/questions/names/related_words.h"
#include "memory/sentences/clauses/relative_clause.h"
#include "memory/sentences/discourse.h"
#include "memory/sentences/intents/intent_model.h"
#include "memory/sentences/mentions.h"
#include "memory/sentences/sentence_time.h"
#include "memory/wordnet/wordnet.h"

namespace loci::memory {
namespace {

/// Set by `loci_train_intents paraphrases.txt --cross-validate`: of sentences with this probability, all of
/// whose words some paraphrase of the form has, 95 % are read right.
constexpr double kMinProbability = 0.6;

/// A part of a sentence with its names found.
struct Named {
  Tokens tokens;
  std::vector<Mention> mentions;
  std::string time;         ///< as people write it; "" = none
  bool throughout = false;  ///< "the whole day": more than a time

  /// The first object or place; with `known`, that means something in the memory.
  const Mention* first(bool place, bool known) const {
    const auto found = std::ranges::find_if(
        mentions, [&](const Mention& one) { return one.place == place && (one.known || !known); });
    return found == mentions.end() ? nullptr : &*found;
  }
};

/// A sentence with placeholders, and what they stand for.
struct Delexicalised {
  Words words;
  std::vector<std::string> objects, places;
  bool known = true;
  bool throughout = false;
};

std::string text_of(const SentencePeriod& period) {
  if (period.throughout && period.from != period.to) return "throughout " + period.from + " and " + period.to;
  if (period.throughout) return "all " + (period.from == "today" ? "day" : words_of(period.from).back());
  if (period.from.empty()) return (period.spans ? "until " : "before ") + period.to;
  if (period.to.empty() && !period.spans && period.from.ends_with(" ago"))
    return "in the last " + period.from.substr(0, period.from.size() - 4);
  if (period.to.empty()) return (period.spans ? "since " : "after ") + period.from;
  if (period.from != period.to)
    return (period.spans ? "from " : "between ") + period.from + (period.spans ? " to " : " and ") +
           period.to;
  static const std::set<std::string> complete = {"this", "today", "yesterday", "last",
                                                 "now",  "the",   "tonight"};
  const std::string first = words_of(period.from).front();
  const bool bare = complete.contains(first) || weekday_of(first) || period.from.ends_with(" ago");
  return (bare ? "" : "at ") + period.from;
}

bool is_word(const std::string& lemma) {
  return trained_intents().has_feature(lemma);
}

Named named(const SentencePart& part, const Snapshot& snapshot, const TimeReader& times) {
  Words words = part.words;
  const auto period = cut_time(words, times);
  Named result{.tokens = tokens_of(std::move(words)),
               .mentions = {},
               .time = period ? text_of(*period) : "",
               .throughout = period && period->throughout};
  result.mentions = find_mentions(result.tokens, snapshot, is_word);
  return result;
}

/// What other parts speak of: before this one, else after it.
struct Topic {
  const Mention *object = nullptr, *place = nullptr;

  /// What the pronoun at a word stands for; nullptr where it is none. "In it" is in a place.
  const Mention* meant_at(const Tokens& tokens, size_t i) const {
    const bool inside = i > 0 && (tokens.lemmas[i - 1] == "in" || tokens.lemmas[i - 1] == "on");
    const bool ends = i > 0 && i + 1 == tokens.lemmas.size();
    if (tokens.lemmas[i] == "there") return place;
    // "Where is that?", "is there one left?"
    const bool one = i > 0 && tokens.lemmas[i] == "one" && (ends || tokens.lemmas[i + 1] == "leave") &&
                     class_of(tokens.lemmas[i - 1]) != WordClass::article &&
                     class_of(tokens.lemmas[i - 1]) != WordClass::name;
    if (!is_pronoun(tokens.lemmas[i]) && !(ends && tokens.lemmas[i] == "that") && !one) return nullptr;
    return (inside && place != nullptr) || object == nullptr ? place : object;
  }
};

Topic topic_for(const std::vector<Named>& parts, size_t at) {
  Topic topic;
  const auto take = [&](const Named& part, bool known) {
    // "The bowl looked orange": a colour alone is not what is spoken of.
    const Mention* object = part.first(false, known);
    if (topic.object == nullptr && !(object != nullptr && known && is_color_word(object->text)))
      topic.object = object;
    if (topic.place == nullptr) topic.place = part.first(true, known);
  };
  for (const bool known : {true, false}) {
    for (size_t i = at; i-- > 0;) take(parts[i], known);
    for (size_t i = at + 1; i < parts.size(); ++i) take(parts[i], known);
  }
  return topic;
}

/// With placeholders for the mentions; a pronoun stands for the topic.
Delexicalised delexicalised(const Named& part, const std::vector<Mention>& mentions, const Topic& topic) {
  Delexicalised result;
  const auto add = [&](const std::string& text, bool place, bool known) {
    result.words.push_back(place ? "PLACE" : "OBJECT");
    (place ? result.places : result.objects).push_back(text);
    result.known = result.known && known;
  };
  auto next = mentions.begin();
  for (size_t i = 0; i < part.tokens.words.size(); ++i) {
    if (next != mentions.end() && next->first == i) {
      if (next->place && !result.words.empty() && lemma_of(result.words.back()) == "room")
        result.words.pop_back();
      add(next->text, next->place, next->known);
      i = next->last - 1;
      ++next;
    } else if (const Mention* meant = topic.meant_at(part.tokens, i)) {
      if (part.tokens.lemmas[i] == "there") result.words.emplace_back("on");
      add(meant->text, meant->place, meant->known);
    } else if (is_pronoun(part.tokens.lemmas[i]) && mentions.empty() && topic.object == nullptr &&
               topic.place == nullptr && result.objects.empty()) {
      add("it", false, true);  // what was spoken of before
    } else {
      result.words.push_back(part.tokens.words[i]);
    }
  }
  return result;
}

/// "Where is OBJECT?" with its names; an article where it reads well.
std::string filled(const std::string& form, const Delexicalised& names, const std::string& time) {
  static const std::set<std::string> bare = {"any", "many", "one", "which"};
  std::string text, before;
  size_t object = 0, place = 0;
  const bool order = form.ends_with('.');
  for (const std::string& word : words_of(form, " ?.")) {
    const std::string comma = word.ends_with(",") ? "," : "";
    const std::string name = word.substr(0, word.size() - comma.size());
    const bool is_object = name == "OBJECT" || name == "OTHER" || name == "THIRD";
    std::string said = name;
    if (is_object || name == "PLACE" || name == "SECOND") {
      said = is_object ? names.objects.at(object++) : names.places.at(place++);
      const bool named = said.find('_') != std::string::npos || said.find('\'') != std::string::npos ||
                         said == "it" || is_digit(said.back());
      if (!named && !bare.contains(lower_case(before))) said.insert(0, "the ");
    }
    text.append(text.empty() ? "" : " ").append(said).append(comma);
    before = name;
  }
  return text + (time.empty() ? "" : " " + time) + (order ? "." : "?");
}

/// "Furthest", "heavier": compares.
bool is_degree(const std::string& word) {
  using wordnet::PartOfSpeech;
  const auto compares = [&](PartOfSpeech part) {
    const std::vector<std::string> bases = wordnet::base_forms(word, part);
    return !bases.empty() && bases.front() != word;
  };
  return (word.ends_with("est") || word.ends_with("er")) &&
         (compares(PartOfSpeech::adjective) || compares(PartOfSpeech::adverb));
}

/// Whether a word restricts what is asked: numbers and quantities, order, comparison, exceptions, properties,
/// times, states, and question words.
bool restricts(const std::string& lemma) {
  static const std::set<std::string> restricting = word_set(
      "second third fourth two three four five six half spare once twice only every both first last most "
      "least more fewer less than other else except without never again repeated before afterwards since "
      "newsince until between during within back or together longer tomorrow predict closed close open "
      "opened "
      "empty full fresh new hide usually "
      "breakfast lunch dinner supper noon midday midnight morning afternoon evening night tonight "
      "colour shape size weight material "
      "percentage percent proportion fraction alone change "
      "will should howlong howmany howmuch howsure howfar howbig howoften when where why who whose which");
  return restricting.contains(lemma) || count_of(lemma).value_or(0) > 1 || is_digit(lemma[0]) ||
         lemma.size() == 1 || is_degree(lemma);
}

/// Whether the form says all that a sentence does. Words that it has not met are passed over where the rest
/// is certain, those that restrict what is asked never. With one word beyond the form and this probability
/// 87 % are read right in cross-validation.
bool is_covered(const IntentReading& reading, const Tokens& tokens) {
  constexpr double kCertain = 0.8;
  const Words uncovered = uncovered_words(trained_intents(), reading.form, tokens);
  return uncovered.empty() || (reading.probability >= kCertain && std::ranges::none_of(uncovered, restricts));
}

/// Whether a name has a relation that the form has no room for: "what came after OBJECT".
bool drops_relation(const std::string& form, const Tokens& tokens) {
  static const std::set<std::string> relations = {"afterwards", "before", "between",
                                                  "except",     "than",   "without"};
  const Tokens of_form = tokens_of(words_of(lower_case(form), " ?,."));
  for (size_t i = 0; i + 1 < tokens.lemmas.size(); ++i) {
    // A time that was not understood: "since Candlemas".
    const std::string& word = tokens.words[i];
    if ((word == "since" || word == "until" || word == "till") &&
        std::ranges::count(of_form.words, word) == 0)
      return true;
    if ((tokens.lemmas[i + 1] == "OBJECT" || tokens.lemmas[i + 1] == "PLACE") &&
        relations.contains(tokens.lemmas[i]) && std::ranges::count(of_form.lemmas, tokens.lemmas[i]) == 0)
      return true;
  }
  return false;
}

/// Whether a form that names nothing leaves out what the sentence names by a word that it has not met: "have
/// you seen the kitchen roll" is not "what did you see".
bool drops_name(const IntentReading& reading, const Words& words, const Tokens& tokens) {
  const std::string& form = trained_intents().forms[reading.form];
  if (form.find("OBJECT") != std::string::npos || form.find("PLACE") != std::string::npos) return false;
  const Words uncovered = uncovered_words(trained_intents(), reading.form, tokens);
  const auto is_uncovered_noun = [&](const std::string& word) {
    const Tokens one = intent_tokens({word});
    return !one.lemmas.empty() && std::ranges::count(uncovered, one.lemmas[0]) > 0 &&
           !wordnet::base_forms(word, wordnet::PartOfSpeech::noun).empty();
  };
  for (size_t i = 0; i + 1 < words.size(); ++i) {
    if (class_of(lemma_of(words[i])) != WordClass::article) continue;
    if (is_uncovered_noun(words[i + 1]) || (i + 2 < words.size() && is_uncovered_noun(words[i + 2])))
      return true;
  }
  return false;
}

bool has_event(const Tokens& tokens) {
  static const std::set<std::string> events = {"move", "change", "happen", "come", "vanish", "take", "open"};
  return std::ranges::any_of(tokens.lemmas, [](const std::string& one) { return events.contains(one); });
}

/// Whether a form asks what happened, which may be at any time of a period.
bool asks_for_event(const std::string& form) {
  return has_event(tokens_of(words_of(lower_case(form), " ?,.")));
}

/// Whether a form denies what was done, and the sentence that something was so: "what was never on PLACE" is
/// not "what never left PLACE".
bool denies_event_for_state(const Tokens& of_form, const Tokens& tokens) {
  static const std::set<std::string> more = {"leave", "go", "put", "lose"};
  const auto has = [&](const Tokens& some) {
    return has_event(some) ||
           std::ranges::any_of(some.lemmas, [](const std::string& one) { return more.contains(one); });
  };
  return std::ranges::count(of_form.lemmas, "not") > 0 && std::ranges::count(tokens.lemmas, "not") > 0 &&
         has(of_form) && !has(tokens);
}

/// Whether the sentence asks what somebody did, or does usually, and the form for a state of now or for once:
/// "what did I put away", "when do we usually open PLACE".
bool drops_deed(const std::string& form, const Tokens& tokens) {
  static const std::set<std::string> habits = {"usually", "usual", "keep", "belong"};
  const auto says = [&](const char* lemma) { return std::ranges::count(tokens.lemmas, lemma) > 0; };
  const Tokens of_form = tokens_of(words_of(lower_case(form), " ?,."));
  const bool habit =
      std::ranges::any_of(of_form.lemmas, [](const std::string& one) { return habits.contains(one); });
  const bool opens = says("open") || says("opened") || says("close");
  if (says("usually") && opens && !habit) return true;
  const bool state = form.starts_with("What is ") && form.find("OBJECT") == std::string::npos &&
                     form.find("PLACE") == std::string::npos;
  return state && says("did") && says("someone") && !asks_for_event(form);
}

/// Whether the sentence asks with one question word of what another one restricts, and the form has only the
/// other: "what stands where OBJECT was" is not "where was OBJECT".
bool drops_question(const std::string& form, const Tokens& tokens) {
  static const std::set<std::string> words = {"what", "which", "who", "when", "where", "why"};
  const Tokens of_form = tokens_of(words_of(lower_case(form), " ?,."));
  if (tokens.words.empty() || !words.contains(tokens.words[0])) return false;
  const auto asks = [](const std::string& word) { return words.contains(word); };
  const bool two = std::ranges::count_if(tokens.words, asks) > 1;
  return two && std::ranges::count(of_form.words, tokens.words[0]) == 0;
}

/// Whether the sentence denies what the form does not: "no OBJECT", "neither OBJECT", "what was not moved".
bool drops_negation(const std::string& form, const Tokens& tokens) {
  static const std::set<std::string> none = {"no", "neither"};
  static const std::set<std::string> denying = {"not", "gone", "missing", "unmoved", "without"};
  const Tokens of_form = tokens_of(words_of(lower_case(form), " ?,."));
  if (denies_event_for_state(of_form, tokens)) return true;
  if (std::ranges::any_of(of_form.words, [](const std::string& word) { return denying.contains(word); }) ||
      std::ranges::count(of_form.lemmas, "not") > 0)
    return false;
  const bool asks_which =
      form.starts_with("What") || form.starts_with("Which") || form.starts_with("How many");
  const bool asks_where = form.starts_with("Where") || form.starts_with("When") || form.starts_with("Who");
  for (size_t i = 0; i < tokens.words.size(); ++i) {
    const bool before_name = i + 1 < tokens.words.size() && tokens.words[i + 1] == "OBJECT";
    const bool denied = asks_which ? tokens.lemmas[i] == "not" : tokens.words[i] == "never" && !asks_where;
    if (denied || (none.contains(tokens.words[i]) && before_name)) return true;
  }
  return false;
}

/// "What is on PLACE?" as "What was on PLACE?"
std::string in_past(const std::string& form) {
  std::string result = form;
  for (const auto& [present, past] :
       {std::pair("Is ", "Was "), {"Are ", "Were "}, {" is ", " was "}, {" are ", " were "}})
    if (const size_t at = result.find(present); at != std::string::npos)
      return result.replace(at, std::string_view(present).size(), past);
  return result;
}

std::optional<PlainQuestion> classified(const Delexicalised& sentence, const std::string& time) {
  const Tokens tokens = intent_tokens(sentence.words);
  const IntentReading best = best_intent(trained_intents(), tokens);
  const std::string& form = trained_intents().forms[best.form];
  // "What was on the table" without a time is not what is on it now.
  const bool past_then = std::ranges::count(tokens.lemmas, "was") > 0;
  const bool past = time.empty() && past_then;
  const bool present = form.starts_with("Is ") || form.find(" is ") != std::string::npos ||
                       form.find(" are ") != std::string::npos;
  const bool placed =
      form.find("PLACE") != std::string::npos ||
      std::ranges::any_of(sentence.objects, [](const std::string& name) {
        return name.find(" on ") != std::string::npos || name.find(" in ") != std::string::npos;
      });
  const bool contents = form == "What is on PLACE?" && time.empty();
  if (past && present && placed && !contents) return std::nullopt;
  // Of a whole time only this is asked.
  const bool stays = form == "Was OBJECT on PLACE?" || form == "Is OBJECT on PLACE?";
  if (sentence.throughout && !stays && !asks_for_event(form)) return std::nullopt;
  // "How many?" says too little.
  if (tokens.lemmas.size() < 2 || best.probability < kMinProbability || form == kNoIntent)
    return std::nullopt;
  if (!is_covered(best, tokens) || drops_relation(form, tokens) || drops_negation(form, tokens) ||
      drops_deed(form, tokens) || drops_question(form, tokens) || drops_name(best, sentence.words, tokens))
    return std::nullopt;
  // "Is it on the table or on the counter?" asks for one of them.
  const bool choice = form == "Is OBJECT on PLACE?" && sentence.places[0].find(" or ") != std::string::npos;
  const bool lasts = stays && std::ranges::any_of(sentence.words, is_of_staying);
  const std::string asked = lasts                          ? "Did OBJECT stay on PLACE?"
                            : sentence.throughout && stays ? "Was OBJECT on PLACE?"
                            : choice                       ? "Where is OBJECT?"
                            : past && contents             ? "What has been on PLACE?"
                            : past_then && present         ? in_past(form)
                                                           : form;
  return PlainQuestion{filled(asked, sentence, time), true, best.probability, sentence.known};
}

/// "Be a love and tell me where OBJECT is": the question alone, where nothing is named before it; unset when
/// it is no part of another sentence.
std::optional<Delexicalised> embedded_question(const Delexicalised& sentence) {
  static const std::set<std::string> bridges = {"where", "what", "how", "why", "whose", "whether"};
  static const std::set<std::string> asking = {"what", "which", "who"};
  const Words& words = sentence.words;
  // "What stands where OBJECT was?", but "What I want to know is where OBJECT is."
  if (words.size() > 1 && asking.contains(words[0]) && class_of(lemma_of(words[1])) != WordClass::person &&
      !is_pronoun(words[1]))
    return std::nullopt;
  for (size_t i = 1; i + 1 < words.size(); ++i) {
    if (words[i] == "OBJECT" || words[i] == "PLACE") return std::nullopt;
    if (!bridges.contains(words[i])) continue;
    Delexicalised question = sentence;
    question.words.erase(
        question.words.begin(),
        question.words.begin() + static_cast<std::ptrdiff_t>(words[i] == "whether" ? i + 1 : i));
    return question;
  }
  return std::nullopt;
}

/// None for a name that means nothing.
std::vector<Id> objects_called(const std::string& name, const Snapshot& snapshot) {
  try {
    return snapshot.find_objects(name);
  } catch (const UnknownName&) {
    return {};
  }
}

/// "How far apart are the cups": of the two that are called so; unset where they are not two.
std::optional<Delexicalised> as_pair(const Delexicalised& sentence, const Snapshot& snapshot) {
  if (sentence.objects.size() != 1 || !snapshot.means_objects(sentence.objects[0])) return std::nullopt;
  const std::vector<Id> objects = objects_called(sentence.objects[0], snapshot);
  if (objects.size() != 2) return std::nullopt;
  Delexicalised pair = sentence;
  const auto at = std::ranges::find(pair.words, "OBJECT");
  pair.words.insert(at, {"OBJECT", "and"});
  pair.objects = {object_name(objects[0]), object_name(objects[1])};
  return pair;
}

/// "Is the pot grey?", "Is the cup red or blue?": asks for the colour; unset for other questions.
std::optional<PlainQuestion> colour_question(const SentencePart& part, const Snapshot& snapshot) {
  Words words = part.words;
  if (words.size() < 3 || (words[0] != "is" && words[0] != "are") || !is_color_word(words.back()))
    return std::nullopt;
  while (words.size() > 2 && (is_color_word(words.back()) || words.back() == "or")) words.pop_back();
  const std::string name = join_words(words, 1, words.size());
  if (!snapshot.means_objects(name)) return std::nullopt;
  return PlainQuestion{.text = "What colour is " + name + "?", .reworded = true};
}

/// "The milk and the bowl - how far apart are they?", "The two bottles, ...": what the pronoun of several
/// stands for; "" = not several.
std::string several(const Named& part, const Snapshot& snapshot) {
  const std::vector<Mention> joined = joined_mentions(part.mentions, part.tokens, true, false);
  const auto topic = std::ranges::find(joined, false, &Mention::place);
  if (topic == joined.end()) return "";
  if (topic->text.find(" and ") != std::string::npos) return topic->text;
  const bool two = topic->first > 0 && (part.tokens.words[topic->first - 1] == "two" ||
                                        part.tokens.lemmas[topic->first - 1] == "every");
  if (!two || !topic->known) return "";
  const std::vector<Id> objects = objects_called(topic->text, snapshot);
  return objects.size() == 2 ? object_name(objects[0]) + " and " + object_name(objects[1]) : "";
}

/// What was said, with the topic in place of its pronoun.
std::string literal(const SentencePart& part, const Topic& topic) {
  Words words = part.words;
  Tokens plain{words, {}};
  for (const std::string& word : words) plain.lemmas.push_back(lemma_of(word));
  for (size_t i = 0; i < words.size(); ++i)
    if (const Mention* meant = topic.meant_at(plain, i); meant != nullptr && words[i] != "there")
      words[i] = meant->text;
  return join_words(words, 0, words.size()) + "?";
}

bool has_verb(const SentencePart& part) {
  return std::ranges::any_of(tokens_of(part.words).words, [](const std::string& word) {
    using wordnet::PartOfSpeech;
    return class_of(lemma_of(word)) == WordClass::auxiliary ||
           (wordnet::base_forms(word, PartOfSpeech::noun).empty() &&
            !wordnet::base_forms(word, PartOfSpeech::verb).empty());
  });
}

/// Names alone belong to the part that they stand before or after: "Cups on the counter: how many?", "Which
/// is bigger, the cup or the bowl?"
std::vector<SentencePart> joined_names(std::vector<SentencePart> parts) {
  const auto has_pronoun = [](const SentencePart& part) {
    return std::ranges::any_of(part.words, is_pronoun);
  };
  for (size_t i = 1; i < parts.size();) {
    SentencePart &question = parts[i - 1], &choice = parts[i];
    const bool chooses = choice.words.size() >= 3 && choice.words.front() != "or" &&
                         std::ranges::count(choice.words, "or") > 0 && !has_verb(choice);
    const bool which =
        !question.words.empty() && (question.words.front() == "which" || question.words.front() == "what");
    if (!which || !chooses) {
      ++i;
      continue;
    }
    question.words.insert(question.words.end(), choice.words.begin(), choice.words.end());
    parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(i));
  }
  for (size_t i = 0; i + 1 < parts.size();) {
    SentencePart &name = parts[i], &next = parts[i + 1];
    if (name.asks || has_verb(name) || has_pronoun(next)) {
      ++i;
      continue;
    }
    next.words.insert(next.words.begin(), name.words.begin(), name.words.end());
    parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(i));
  }
  return parts;
}

/// Whether what is said around a question restricts it: "the mug that is not on the island, where is it?",
/// "how many mugs are there, grey and black?"
bool restricts_by_other_parts(const std::vector<SentencePart>& parts, const Snapshot& snapshot) {
  if (parts.size() < 2) return false;
  for (const SentencePart& part : parts) {
    if (part.asks) continue;
    for (size_t i = 0; i + 2 < part.words.size(); ++i)
      if ((part.words[i] == "that" || part.words[i] == "which") && part.words[i + 2] == "not" &&
          class_of(lemma_of(part.words[i + 1])) == WordClass::auxiliary)
        return true;
  }
  const SentencePart& last = parts.back();
  const bool refers = std::ranges::any_of(parts, [](const SentencePart& part) {
    return std::ranges::any_of(part.words, is_pronoun) || std::ranges::count(part.words, "one") > 0;
  });
  return !last.asks && !has_verb(last) && !refers &&
         std::ranges::any_of(last.words,
                             [&](const std::string& word) { return snapshot.means_objects(word); });
}

}  // namespace

std::vector<std::vector<PlainQuestion>> plain_questions(const std::string& sentence, const Snapshot& snapshot,
                                                        const TimeReader& times) {
  std::vector<SentencePart> parts = joined_names(sentence_parts(sentence, times));
  if (restricts_by_other_parts(parts, snapshot)) return {};
  std::vector<Named> all;
  for (SentencePart& part : parts) {
    part.words = without_relative_clauses(std::move(part.words), snapshot, times);
    all.push_back(named(part, snapshot, times));
  }
  // A statement asks whether it is so, where nothing else is asked; names alone ask nothing.
  if (std::ranges::none_of(parts, &SentencePart::asks)) {
    const auto stated = std::ranges::find_if(parts.rbegin(), parts.rend(), [&](const SentencePart& part) {
      return parts.size() == 1 || has_verb(part);
    });
    if (stated != parts.rend())
      stated->asks = true;
    else
      for (SentencePart& part : parts) part.asks = true;
  }
  std::vector<std::vector<PlainQuestion>> questions;
  for (size_t i = 0; i < parts.size(); ++i) {
    if (!parts[i].asks) continue;
    const Topic topic = topic_for(all, i);
    // A question alone is about nouns of households even where the memory knows none of them.
    const bool known = parts.size() > 1 || std::ranges::all_of(all[i].mentions, &Mention::known);
    std::vector<PlainQuestion> readings = {{.text = literal(parts[i], topic), .names_known = known}};
    if (const std::string text = i == 0 ? "" : several(all[i - 1], snapshot); !text.empty()) {
      const Mention both{.known = true, .text = text};
      readings.insert(readings.begin(), {literal(parts[i], {&both, topic.place})});
    }
    if (auto colour = colour_question(parts[i], snapshot)) readings.push_back(std::move(*colour));
    const auto add_readings = [&](const std::vector<Mention>& mentions) {
      Delexicalised sentence_of = delexicalised(all[i], mentions, topic);
      sentence_of.throughout = all[i].throughout;
      if (auto reading = classified(sentence_of, all[i].time))
        readings.push_back(std::move(*reading));
      else if (const auto question = embedded_question(sentence_of))
        if (auto part = classified(*question, all[i].time)) readings.push_back(std::move(*part));
      if (const auto pair = as_pair(sentence_of, snapshot))
        if (auto reading = classified(*pair, all[i].time)) readings.push_back(std::move(*reading));
      // "I need the milk, any idea where?", "Peek into the drawer, what is inside?"
      const auto add_topic = [&](const Mention* mention, std::vector<std::string>& names, const char* kind) {
        if (mention == nullptr || !names.empty()) return;
        sentence_of.words.emplace_back(kind);
        names.push_back(mention->text);
        if (auto reading = classified(sentence_of, all[i].time)) readings.push_back(std::move(*reading));
      };
      if (sentence_of.objects.empty() && sentence_of.places.empty()) {
        Delexicalised bare = sentence_of;
        add_topic(topic.object, sentence_of.objects, "OBJECT");
        std::swap(bare, sentence_of);
        add_topic(topic.place, sentence_of.places, "PLACE");
      } else {
        add_topic(topic.object, sentence_of.objects, "OBJECT");
      }
    };
    for (const auto& [coordinated, attached] :
         {std::pair(false, false), {true, false}, {false, true}, {true, true}}) {
      const auto mentions = joined_mentions(all[i].mentions, all[i].tokens, coordinated, attached);
      if ((coordinated || attached) && mentions.size() == all[i].mentions.size()) continue;
      add_readings(mentions);
    }
    // "I popped round with the shopping and ...": names that mean nothing may be words, but not "cup".
    const bool household = std::ranges::any_of(all[i].mentions, [](const Mention& mention) {
      return !mention.known && is_household_noun(singular_of(words_of(mention.text).back()));
    });
    if (!household && std::ranges::none_of(readings, &PlainQuestion::reworded)) {
      std::vector<Mention> meant;
      std::ranges::copy_if(all[i].mentions, std::back_inserter(meant), &Mention::known);
      if (!meant.empty() && meant.size() < all[i].mentions.size()) add_readings(meant);
    }
    std::stable_sort(
        readings.begin() + 1, readings.end(),
        [](const PlainQuestion& a, const PlainQuestion& b) { return a.probability > b.probability; });
    questions.push_back(std::move(readings));
  }
  return questions;
}

}  // namespace loci::memory
