#include "memory/sentences/discourse.h"

#include <algorithm>
#include <optional>

#include "mapping/base/text.h"
#include "memory/questions/names/related_words.h"
#include "memory/sentences/sentence_time.h"
#include "memory/sentences/spelling.h"
#include "memory/sentences/vocabulary.h"
#include "memory/wordnet/wordnet.h"

namespace loci::memory {
namespace {

using WordSet = std::set<std::string>;

WordSet word_set(const char* words) {
  const Words all = words_of(words);
  return {all.begin(), all.end()};
}

/// Words with any of these uses.
WordSet words_used(unsigned uses) {
  WordSet all;
  for (const vocabulary::SurroundingWords& one : vocabulary::surroundings())
    if ((one.uses & uses) != 0) all.merge(word_set(one.words));
  return all;
}

/// "" where compounds leave no word.
std::string first_lemma(const Words& words) {
  const Tokens tokens = tokens_of(words);
  return tokens.lemmas.empty() ? "" : tokens.lemmas[0];
}

bool all_in(const Words& lemmas, const WordSet& set) {
  return std::ranges::all_of(lemmas, [&](const std::string& lemma) { return set.contains(lemma); });
}

// ---- Fragments: what punctuation separates.

/// Sounds, and "like" before a time: "since like three".
void drop_fillers(Words& words) {
  static const WordSet sounds = {"um",  "umm",  "uh",  "uhm", "er",  "erm",  "err", "hmm",
                                 "hm",  "mm",   "ah",  "eh",  "oh",  "ooh",  "ugh", "huh",
                                 "aha", "argh", "pls", "plz", "lol", "yeah", "yep", "nah"};
  static const WordSet prepositions = {"since", "at",     "around", "on",   "in",   "from",
                                       "until", "before", "after",  "like", "there"};
  std::erase_if(words, [](const std::string& word) { return sounds.contains(word); });
  for (size_t i = 1; i < words.size(); ++i)
    if (words[i] == "like" && prepositions.contains(words[i - 1])) replace_words(words, i--, 1, {});
  // A new start: "where is where is the tea", "the the pot".
  for (size_t length = 3; length > 0; --length)
    for (size_t i = 0; i + 2 * length <= words.size(); ++i)
      if (!is_digit(words[i][0]) &&
          starts_with_words(words,
                            Words(words.begin() + static_cast<std::ptrdiff_t>(i),
                                  words.begin() + static_cast<std::ptrdiff_t>(i + length)),
                            i + length))
        replace_words(words, i--, length, {});
}

/// "The cup, the blue one": the colour belongs to the cup.
bool take_apposition(Words& before, const Words& words) {
  if (words.size() != 3 || words[0] != "the" || words[2] != "one" || !is_color_word(words[1])) return false;
  for (size_t i = before.size(); i-- > 0;)
    if (class_of(lemma_of(before[i])) == WordClass::article) {
      before.insert(before.begin() + static_cast<std::ptrdiff_t>(i) + 1, words[1]);
      return true;
    }
  return false;
}

/// "What is on the shelf, besides the jam?"
bool take_exception(Words& before, const Words& words) {
  if (words.size() < 2 || first_lemma(words) != "except") return false;
  before.insert(before.end(), words.begin(), words.end());
  return true;
}

/// "If the milk is still there, tell me where": where it is still there.
bool take_condition(Words& before, const Words& words) {
  static const std::vector<Words> orders =
      expand_form("tell me|tell us|let me know|please tell me|let us know|say|show me");
  if (before.size() < 3 || before[0] != "if" || words.size() < 2) return false;
  const Words order(words.begin(), words.end() - 1);
  if (std::ranges::count(orders, order) == 0 || class_of(lemma_of(words.back())) != WordClass::question)
    return false;
  before[0] = words.back();
  return true;
}

std::vector<Words> fragments_of(const std::string& sentence) {
  std::vector<Words> fragments;
  std::string text;
  const auto end = [&] {
    Words words = sentence_words(text);
    drop_fillers(words);
    const bool taken = !fragments.empty() &&
                       (take_exception(fragments.back(), words) || take_apposition(fragments.back(), words) ||
                        take_condition(fragments.back(), words));
    if (!words.empty() && !taken) fragments.push_back(std::move(words));
    text.clear();
  };
  for (size_t i = 0; i < sentence.size(); ++i) {
    const char c = sentence[i];
    const bool at_blank = i + 1 == sentence.size() || sentence[i + 1] == ' ';
    const bool dash = c == '-' && i > 0 && sentence[i - 1] == ' ';
    if (c == '?' || c == '!' || c == ',' || c == ';' || (at_blank && (c == '.' || c == ':' || dash)))
      end();
    else
      text.push_back(c);
  }
  end();
  return fragments;
}

/// "Excuse me", "thanks", "robot", "please".
bool is_polite(const Words& words) {
  static const WordSet lemmas = words_used(vocabulary::kAddress | vocabulary::kPolite);
  return all_in(tokens_of(words).lemmas, lemmas);
}

/// "isn't it", "was there", "or not": the end of a statement that asks whether it is so.
bool is_tag(const Words& words) {
  static const WordSet lemmas = word_set(
      "is was do did have had not it they there someone or right no yes "
      "still see know think may will correct that this true so case the");
  const Tokens tokens = tokens_of(words);
  if (tokens.lemmas.empty()) return false;
  return all_in(tokens.lemmas, lemmas) && (class_of(tokens.lemmas[0]) == WordClass::auxiliary ||
                                           tokens.lemmas[0] == "or" || tokens.lemmas[0] == "yes");
}

/// "The second drawer", "about the milk": names alone.
bool is_topic(const Words& words, const WordSet& concepts) {
  static const WordSet introductions = {"about", "as", "for", "and", "mean", "someone"};
  bool named = false;
  for (const std::string& lemma : tokens_of(words).lemmas) {
    const WordClass word_class = class_of(lemma);
    const bool name = word_class == WordClass::name && !concepts.contains(lemma) && !is_pronoun(lemma);
    named = named || name;
    if (!name && word_class != WordClass::article && (named || !introductions.contains(lemma))) return false;
  }
  return named;
}

/// Words that begin a question or an order.
bool begins_question(const Words& words, size_t at = 0) {
  if (at >= words.size()) return false;
  const std::string lemma = first_lemma(Words(words.begin() + static_cast<std::ptrdiff_t>(at), words.end()));
  const WordClass word_class = class_of(lemma);
  return word_class == WordClass::question || word_class == WordClass::auxiliary || is_order(lemma);
}

/// What a person says of themselves or of the world beside the question. Conditions, places and times are
/// none: they restrict.
bool is_statement(const Words& words) {
  static const WordSet beginnings = word_set(
      "i i've we my our he she they it it's this that there the his her their your you someone somebody "
      "everyone everybody nobody because cos cause so as oh");
  static const WordSet restricting =
      word_set("if when after before unless except without only since until while besides instead");
  if (words.size() < 2 || !beginnings.contains(words[0]) || restricting.contains(words[0])) return false;
  const Tokens tokens = tokens_of(words);
  if (words[0] == "because" || words[0] == "cos" || words[0] == "cause" || words[0] == "so" ||
      words[0] == "as")
    return tokens.lemmas.size() > 1 &&
           (class_of(tokens.lemmas[1]) == WordClass::person || tokens.words[1] == "it");
  // A statement has a verb.
  return std::ranges::any_of(tokens.lemmas, [](const std::string& lemma) {
    return class_of(lemma) == WordClass::auxiliary || class_of(lemma) == WordClass::person ||
           class_of(lemma) == WordClass::ordinary;
  });
}

/// The first "it", else a "that" that no name follows.
std::optional<size_t> find_pronoun(const Words& words) {
  const auto it = std::ranges::find_if(words, is_pronoun);
  if (it != words.end()) return static_cast<size_t>(it - words.begin());
  for (size_t i = 1; i < words.size(); ++i) {
    const bool ends =
        i + 1 == words.size() || words[i + 1] == "be" || words[i + 1] == "is" || words[i + 1] == "was";
    if ((words[i] == "that" || words[i] == "this") && ends) return i;
  }
  return std::nullopt;
}

/// Puts a phrase in the place of the first pronoun; false when there is none.
bool replace_pronoun(Words& words, const Words& topic) {
  const auto at = find_pronoun(words);
  if (at) replace_words(words, *at, 1, topic);
  return at.has_value();
}

/// Without "if", "whether"; a clause about a person asks whether they did: "whether somebody moved it".
void begin_embedded(Words& words, size_t count) {
  const std::string bridge = count > 0 ? words[count - 1] : "";
  replace_words(words, 0, count, {});
  const bool asks = bridge == "if" || bridge == "whether" || bridge == "that";
  if (asks && !words.empty() && class_of(first_lemma(words)) == WordClass::person)
    words.insert(words.begin(), "did");
}

/// What a statement is about: its first phrase of names after an article; one of a household before others.
/// "My aunt moved my tea" → "tea".
Words topic_of(const Words& statement, const WordSet& concepts) {
  const Tokens tokens = tokens_of(statement);
  Words first, topic;
  const auto end = [&] {
    if (first.empty()) first = topic;
    const bool household = !topic.empty() && is_household_noun(topic.back());
    if (!household) topic.clear();
    return household;
  };
  for (size_t i = 0; i < tokens.lemmas.size(); ++i) {
    const bool begins = i > 0 && class_of(tokens.lemmas[i - 1]) == WordClass::article;
    const bool can = tokens.words[i] == "can" && (begins || !topic.empty());
    const bool name = can || (class_of(tokens.lemmas[i]) == WordClass::name &&
                              !concepts.contains(tokens.lemmas[i]) && !is_pronoun(tokens.lemmas[i]));
    if (name && (begins || !topic.empty()))
      topic.push_back(tokens.words[i]);
    else if (end())
      return topic;
  }
  return end() ? topic : first;
}

/// Fragments without those that only make the sentence polite; topics take the place of their pronouns.
std::vector<Words> meaningful(const std::vector<Words>& fragments, const WordSet& concepts) {
  std::vector<Words> parts;
  for (const Words& fragment : fragments) {
    const bool alone = fragments.size() == 1;
    if (!alone && (is_polite(fragment) || (is_tag(fragment) && !parts.empty()))) continue;
    parts.push_back(fragment);
  }
  // "If the milk is not on the table, where else may it be?"
  if (parts.size() > 1 && parts[0][0] == "if" && std::ranges::count(parts[0], "not") > 0)
    parts[0] = Words(parts[0].begin() + 1, std::ranges::find_if(parts[0], [](const std::string& word) {
                       return word == "is" || word == "are";
                     }));
  for (size_t i = 0; i < parts.size() && parts.size() > 1; ++i) {
    if (!is_topic(parts[i], concepts)) continue;
    static const WordSet introductions = {"about", "as", "for", "and"};
    while (introductions.contains(parts[i][0])) parts[i].erase(parts[i].begin());
    for (size_t j = 0; j < parts.size(); ++j)
      if (j != i && replace_pronoun(parts[j], parts[i])) {
        parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(i));
        break;
      }
  }
  // A topic that no pronoun stands for is a phrase of its own: "milk - table or counter?"
  for (size_t i = 0; i + 1 < parts.size(); ++i)
    if (is_topic(parts[i], concepts)) parts[i].push_back(",");
  return parts;
}

Words in_one(const std::vector<Words>& parts) {
  Words words;
  for (const Words& part : parts) words.insert(words.end(), part.begin(), part.end());
  return words;
}

/// The question alone, where statements surround it; unset when none does, or when a pronoun would be left
/// without what it means.
std::optional<Words> without_statements(const std::vector<Words>& parts, const WordSet& concepts) {
  std::vector<Words> rest;
  Words topic;
  bool dropped = false;
  for (const Words& part : parts) {
    if (is_statement(part) && !begins_question(part)) {
      dropped = true;
      if (topic.empty()) topic = topic_of(part, concepts);
    } else {
      rest.push_back(part);
    }
  }
  if (!dropped || rest.empty()) return std::nullopt;
  Words words = in_one(rest);
  if (find_pronoun(words) && (topic.empty() || !replace_pronoun(words, topic))) return std::nullopt;
  return words;
}

/// The question at the end of a sentence without punctuation: "I lost my cup where is it".
std::optional<Words> last_question(const Words& words, const WordSet& concepts) {
  if (words.empty() || !is_statement(words)) return std::nullopt;
  for (size_t i = words.size(); i-- > 2;) {
    Words rest(words.begin() + static_cast<std::ptrdiff_t>(i), words.end());
    if (class_of(first_lemma(rest)) != WordClass::question) continue;
    // "on the shelf where it was" is no question.
    if (is_pronoun(lemma_of(rest[rest.size() > 1 ? 1 : 0]))) continue;
    const Words topic =
        topic_of(Words(words.begin(), words.begin() + static_cast<std::ptrdiff_t>(i)), concepts);
    if (find_pronoun(rest) && (topic.empty() || !replace_pronoun(rest, topic))) return std::nullopt;
    return rest;
  }
  return std::nullopt;
}

/// The question before a reason or an alternative that asks what to do: "…, because I am hungry", "… or do I
/// need to buy some".
std::optional<Words> without_tail(const Words& words) {
  for (size_t i = 2; i + 1 < words.size(); ++i) {
    const bool reason = words[i] == "because" || words[i] == "cos";
    const Tokens tail = tokens_of(Words(words.begin() + static_cast<std::ptrdiff_t>(i), words.end()));
    const bool advice = words[i] == "or" && tail.lemmas.size() > 2 &&
                        class_of(tail.lemmas[1]) == WordClass::auxiliary &&
                        (tail.words[2] == "i" || tail.words[2] == "we");
    const bool ending =
        words[i] == "or" && (words[i + 1] == "what" || words[i + 1] == "not") && i + 2 == words.size();
    if (reason || advice || ending)
      return Words(words.begin(), words.begin() + static_cast<std::ptrdiff_t>(i));
  }
  return std::nullopt;
}

// ---- Politeness.

/// Removes what comes before an embedded question: "could you tell me", "I was wondering", "any idea".
void strip_wrapper(Words& words) {
  static const WordSet wrapper = words_used(vocabulary::kIntroduction);
  static const WordSet claims = words_used(vocabulary::kClaim);
  const Tokens tokens = tokens_of(words);
  bool claimed = false, stated = false;
  for (size_t i = 0; i < tokens.lemmas.size(); ++i) {
    const std::string& lemma = tokens.lemmas[i];
    const bool bridge =
        (lemma == "if" || lemma == "whether" || (lemma == "that" && claimed)) && i + 1 < tokens.lemmas.size();
    const bool question = class_of(lemma) == WordClass::question;
    if (stated && (bridge || (question && !(lemma == "what" && i + 1 == tokens.lemmas.size())))) {
      words = tokens.words;
      begin_embedded(words, bridge ? i + 1 : i);
      return;
    }
    if (!wrapper.contains(lemma) || (question && lemma != "what")) return;
    claimed = claimed || claims.contains(lemma);
    stated = stated || class_of(lemma) != WordClass::relation;
  }
}

/// "My wife swears that ...", "they told me ...": asks whether it is so.
void strip_claim(Words& words) {
  static const WordSet claims = word_set(
      "say says said swear swears swore claim claims claimed insist insists insisted think thinks thought "
      "reckon reckons believe believes believed maintains told tells promised promises suspect suspects "
      "figures assume assumes");
  const auto is_person = [&](size_t i) {
    return words[i] == "they" || class_of(lemma_of(words[i])) == WordClass::person ||
           class_of(lemma_of(words[i])) == WordClass::article;
  };
  size_t verb = 0;
  while (verb < words.size() && is_person(verb)) ++verb;
  if (verb == 0 || verb == words.size() || !claims.contains(words[verb])) return;
  size_t first = verb + 1;
  if ((words[verb] == "told" || words[verb] == "tells") && first < words.size() && is_person(first)) ++first;
  const bool that = first < words.size() && words[first] == "that";
  if (that) ++first;
  if (first + 2 >= words.size() || class_of(lemma_of(words[first])) == WordClass::relation) return;
  words[first - 1] = "that";
  begin_embedded(words, first);
}

/// Removes openings and endings that ask nothing: "tell me", "for me", "do you know".
void strip_politeness(Words& words) {
  static const std::vector<Words> openings = expand_form(
      "(can|could|would|will) you [please|kindly|maybe|perhaps|possibly|just|quickly] "
      "(tell|give|show|list|name|bring|put|find|describe)|tell "
      "me|remind me|let me know|say me|tell us|"
      "[hey|hi|hello|ok|okay|excuse me|listen|so|well] "
      "(robot|computer|assistant|machine|loci|mate|dear|love)|"
      "hey|hello|hi|hiya|excuse me|sorry|ok|okay|well|so|and|but|please|thanks|now then|right|look|listen|"
      "quick question|quick|quickly|just curious|just checking|by the way|anyway|good "
      "(morning|evening|afternoon)|"
      "if|whether|[are you|i am|am i] (sure|certain|right|correct) [that|in thinking that]|is it "
      "(true|correct|right|possible|the case) that|"
      "(i|we) (think|believe|guess|suppose|reckon|bet|thought|assume) [that]|do you (think|believe|reckon) "
      "[that]|"
      "(confirm|verify|check|assert) [that|whether|if]|"
      "do you happen to|did you happen to|by any chance|by chance|in your (opinion|memory)|"
      "as far as you (know|remember|can tell)|according to (you|your memory)|to your knowledge");
  static const std::vector<Words> endings = expand_form(
      "for me|for us|robot|computer|dear|mate|love|darling|my (dear|friend)|sir|madam|thanks|thank "
      "you|cheers|"
      "as well|too|by [any] chance|exactly|or "
      "not|yes or no|true or false|right|correct|if you (know|remember|please|can|could)|if possible|"
      "please|to your knowledge|as far as you (know|remember|can tell)|according to (you|your memory)|can "
      "you "
      "(tell|say)|any idea|i wonder|in your (opinion|memory)|"
      "would you (know|say)|then|again|in total|altogether|overall|of yours|of mine|at once|all told|"
      "for sure|for certain|at all|around here|in here|round here|i think|i guess|"
      "(that|which|who) you (know|know of|know about|can see|remember)");
  // A word that nobody knows before a question: "yo, where is the jam".
  if (words.size() > 2 && !is_known_word(words[0]) && !find_pronoun(words) &&
      class_of(first_lemma(Words(words.begin() + 1, words.end()))) == WordClass::question)
    words.erase(words.begin());
  for (bool stripped = true; stripped;) {
    stripped = false;
    for (const Words& opening : openings) {
      if (words.size() <= opening.size() || !starts_with_words(words, opening)) continue;
      const std::string& next = words[opening.size()];
      const std::string& last = opening.back();
      if ((last == "me" || last == "us") && opening.front() != "excuse" &&
          (next == "about" || next == "everything" || next == "more" || next == "what" || next == "some" ||
           next == "a"))
        continue;
      // "Could you bring": the order itself stays.
      const bool order = opening.size() > 2 && opening[1] == "you" && is_order(last);
      const bool doubt = next == "about" || next == "of";  // "are you sure about that"
      if (doubt && std::ranges::count(opening, "sure") + std::ranges::count(opening, "certain") > 0) continue;
      begin_embedded(words, opening.size() - (order ? 1 : 0));
      stripped = true;
      break;
    }
    for (const Words& ending : endings)
      if (!stripped && words.size() > ending.size() &&
          starts_with_words(words, ending, words.size() - ending.size())) {
        words.resize(words.size() - ending.size());
        stripped = true;
      }
  }
}

// ---- Parts.

bool is_joint(const std::string& word) {
  static const WordSet joints = {"and", "so", "but", "because", "cos", "then"};
  return joints.contains(word);
}

/// Whether a word begins a question that needs no answer to what comes before it: "where", "is the", "did I".
bool begins_part(const Words& words, size_t at) {
  const Words rest(words.begin() + static_cast<std::ptrdiff_t>(at), words.end());
  const Tokens tokens = tokens_of(rest);
  if (tokens.lemmas.size() < 2) return false;
  const WordClass first = class_of(tokens.lemmas[0]), second = class_of(tokens.lemmas[1]);
  if (first == WordClass::question) return true;
  return first == WordClass::auxiliary && tokens.lemmas[0] != "have" &&
         (second == WordClass::article || second == WordClass::person ||
          (second == WordClass::name && tokens.lemmas[1] != "not"));
}

/// A fragment in pieces: "I lost my cup | where is it", "is it open | what is in it".
std::vector<Words> pieces_of(const Words& words) {
  std::vector<Words> pieces;
  size_t begin = 0;
  const auto cut = [&](size_t end, size_t next) {
    if (end > begin)
      pieces.emplace_back(words.begin() + static_cast<std::ptrdiff_t>(begin),
                          words.begin() + static_cast<std::ptrdiff_t>(end));
    begin = next;
  };
  for (size_t i = 1; i + 1 < words.size(); ++i) {
    const bool joined = is_joint(words[i]) && begins_part(words, i + 1);
    if (joined) cut(i, i + 1);
    const bool after_statement = i > begin + 1 && !joined &&
                                 class_of(lemma_of(words[i])) == WordClass::question && words[i] != "which" &&
                                 words[i] != "who" && words[i] != "when" &&
                                 is_statement(Words(words.begin() + static_cast<std::ptrdiff_t>(begin),
                                                    words.begin() + static_cast<std::ptrdiff_t>(i)));
    if (after_statement) cut(i, i);
  }
  cut(words.size(), words.size());
  return pieces;
}

/// "Before I go out", "if I am not mistaken": what a person is about to do restricts nothing that was seen.
bool is_own_plan(const Words& words) {
  static const WordSet links = word_set("before if while since until as when after");
  static const WordSet past = word_set("was were did had");
  if (words.size() < 3 || !links.contains(words[0]) || (words[1] != "i" && words[1] != "we")) return false;
  const std::vector<std::string> bases = wordnet::base_forms(words[2], wordnet::PartOfSpeech::verb);
  const bool present = words[2] == "am" || words[2] == "are" || std::ranges::count(bases, words[2]) > 0;
  return present && !past.contains(words[2]) &&
         std::none_of(words.begin() + 2, words.end(),
                      [](const std::string& word) { return is_household_noun(word) || is_pronoun(word); });
}

/// "When I came home", "if it is open": a restriction, not a question.
bool is_restriction(const Words& words) {
  static const WordSet beginnings =
      word_set("if unless except without only before after while since until instead");
  const Tokens tokens = tokens_of(words);
  if (!tokens.lemmas.empty() && class_of(tokens.lemmas[0]) == WordClass::question &&
      tokens.lemmas[0] != "when")
    return false;  // "since when"
  // "If I fancied a coffee" restricts nothing.
  static const WordSet wishes =
      word_set("fancied fancy wanted want needed need were was wished wish liked like");
  if (words[0] == "if" && words.size() > 2 && (words[1] == "i" || words[1] == "we") &&
      wishes.contains(words[2]))
    return false;
  if (beginnings.contains(words[0])) return true;
  return words[0] == "when" && tokens.lemmas.size() > 1 && class_of(tokens.lemmas[1]) != WordClass::auxiliary;
}

/// "Is it on the shelf where it was this morning" asks whether it is on the shelf.
void drop_old_place(Words& words) {
  static const WordSet persons = {"it", "they", "i", "we", "he", "she"};
  bool at_place = false;
  for (size_t i = 1; i + 2 < words.size(); ++i) {
    at_place = at_place || words[i] == "on" || words[i] == "in" || words[i] == "at";
    if (words[i] != "where" || !persons.contains(words[i + 1])) continue;
    words.resize(at_place ? i : 0);  // without a place it asks for a comparison, which no question makes
    return;
  }
}

/// "Name them all", "any tips", "help": asks for the answer to what else is said.
bool asks_for_answer(const Words& words) {
  static const std::vector<Words> all = expand_form(
      "help|help me [please]|(name|list|tell me) (it|them|those) [all]|which ones|tell me [please]|"
      "any (idea|ideas|tips|clue|clues|hint|hints)|just (asking|wondering|curious|checking)|"
      "i mean|go on|quick|be (quick|honest)|that is all|no rush|asap");
  return std::ranges::count(all, words) > 0;
}

}  // namespace

std::vector<SentencePart> sentence_parts(const std::string& sentence, const TimeReader& times) {
  std::vector<SentencePart> parts;
  Words time;  // "after breakfast, ..."
  size_t count = 0;
  for (const Words& fragment : fragments_of(sentence)) {
    count += fragment.size();
    if (!parts.empty() && is_tag(fragment)) {  // "It is not there, is it?"
      Words& before = parts.back().words;
      before.insert(before.end(), fragment.begin(), fragment.end());
      continue;
    }
    if (is_polite(fragment) || asks_for_answer(fragment)) continue;
    for (Words& piece : pieces_of(fragment)) {
      for (size_t i = 0; i + 1 < piece.size(); ++i)  // "the box, is that one on the table?"
        if ((piece[i] == "that" || piece[i] == "this") && piece[i + 1] == "one")
          replace_words(piece, i, 2, {"it"});
      while (piece.size() > 1 && is_joint(piece[0])) piece.erase(piece.begin());
      if (const auto whether = std::ranges::find(piece, "whether");
          whether != piece.end() && whether + 1 != piece.end())
        piece.erase(piece.begin(), whether + 1);
      Words timeless = piece;
      cut_time(timeless, times);
      if (timeless.empty()) {
        time = piece;
        continue;
      }
      if (is_own_plan(timeless)) continue;
      if (is_restriction(timeless)) return {};
      strip_surroundings(piece);
      if (piece.empty()) continue;
      drop_old_place(piece);
      if (piece.empty()) return {};
      const bool asks = begins_question(piece) && !(is_statement(piece) && !begins_part(piece, 0));
      if (asks && !time.empty()) piece.insert(piece.end(), time.begin(), time.end());
      parts.push_back({std::move(piece), asks});
    }
  }
  return count > kMaxSentenceWords ? std::vector<SentencePart>{} : parts;
}

void strip_surroundings(Words& words) {
  strip_politeness(words);
  strip_claim(words);
  strip_wrapper(words);
  strip_politeness(words);
}

bool is_pronoun(const std::string& lemma) {
  return lemma == "it" || lemma == "they" || lemma == "them";
}

bool is_order(const std::string& lemma) {
  static const WordSet verbs = word_set(
      "show list name give describe find bring fetch get put set lay make prepare clean empty wipe stow "
      "pack keep take move carry hand pass want lose tell explain summarize place print output display "
      "enumerate return report");
  return verbs.contains(lemma);
}

std::vector<Words> core_words(const std::string& sentence, const std::set<std::string>& concepts) {
  const std::vector<Words> fragments = fragments_of(sentence);
  if (in_one(fragments).size() > kMaxSentenceWords) return {};
  const std::vector<Words> parts = meaningful(fragments, concepts);
  std::vector<Words> candidates;
  const auto add = [&](std::optional<Words> words) {
    if (!words) return;
    strip_surroundings(*words);
    if (!words->empty() && std::ranges::count(candidates, *words) == 0)
      candidates.push_back(std::move(*words));
  };
  add(in_one(parts));
  if (parts.size() > 1) add(without_statements(parts, concepts));
  add(last_question(in_one(parts), concepts));
  for (size_t i = 0, count = candidates.size(); i < count; ++i) add(without_tail(candidates[i]));
  return candidates;
}

}  // namespace loci::memory
