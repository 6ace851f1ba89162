#include "memory/sentences/discourse.h"

#include <algorithm>
#include <optional>

#include "mapping/base/text/text.h"
#include "memory/questions/names/color_words.h"
#include "memory/questions/names/related_words.h"
#include "memory/sentences/courtesy.h"
#include "memory/sentences/sentence_time.h"
#include "memory/sentences/word_forms.h"
#include "memory/wordnet/wordnet.h"

namespace loci::memory {
namespace {

using WordSet = std::set<std::string>;

// ---- Fragments: what punctuation separates.

bool is_sound(const std::string& word) {
  static const WordSet sounds = {"um",  "umm",  "uh",  "uhm", "er",  "erm",  "err", "hmm",
                                 "hm",  "mm",   "ah",  "eh",  "oh",  "ooh",  "ugh", "huh",
                                 "aha", "argh", "pls", "plz", "lol", "yeah", "yep", "nah"};
  return sounds.contains(word);
}

/// Sounds, and "like" before a time: "since like three".
void drop_fillers(Words& words) {
  static const WordSet prepositions = {"since", "at",     "around", "on",   "in",   "from",
                                       "until", "before", "after",  "like", "there"};
  std::erase_if(words, is_sound);
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

/// Puts a phrase in the place of the first pronoun; false when there is none.
bool replace_pronoun(Words& words, const Words& topic) {
  const auto at = find_pronoun(words);
  if (at) replace_words(words, *at, 1, topic);
  return at.has_value();
}

/// Fragments without those that only make the sentence polite; topics take the place of their pronouns.
std::vector<Words> meaningful(const std::vector<Words>& fragments, const WordSet& concepts) {
  std::vector<Words> parts;
  for (const Words& fragment : fragments) {
    const bool alone = fragments.size() == 1;
    if (!alone && (is_polite(fragment) || is_introduction(fragment) || (is_tag(fragment) && !parts.empty())))
      continue;
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

/// The question at the end of a sentence without punctuation: "I would be glad to hear how many cups there
/// are".
std::optional<Words> last_question(const Words& words) {
  if (words.empty() || !is_statement(words)) return std::nullopt;
  const Tokens tokens = tokens_of(words);
  static const WordSet clauses = {"if", "whether", "is", "was", "did"};
  for (size_t i = 2; i < tokens.words.size(); ++i) {
    if (tokens.lemmas[i] == "when" &&
        std::any_of(tokens.lemmas.begin(), tokens.lemmas.begin() + static_cast<std::ptrdiff_t>(i),
                    [](const std::string& lemma) { return clauses.contains(lemma); }))
      return std::nullopt;  // "whether it was there when the drawer was opened"
    if (class_of(tokens.lemmas[i]) != WordClass::question) continue;
    Words question(tokens.words.begin() + static_cast<std::ptrdiff_t>(i), tokens.words.end());
    return find_pronoun(question) ? std::nullopt : std::optional(std::move(question));
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

// ---- Parts.

bool is_joint(const std::string& word) {
  static const WordSet joints = {"and", "so", "but", "because", "cos", "then"};
  return joints.contains(word);
}

/// Whether a point after the text ends a sentence, and no abbreviation: "3 p.m.", "Mrs."
bool ends_sentence(const std::string& text) {
  static const WordSet titles = {"mr", "mrs", "ms", "dr", "st", "no"};
  const std::string last = lower_case(text.substr(text.find_last_of(' ') + 1));
  return last.size() > 1 && last.find('.') == std::string::npos && !titles.contains(last);
}

/// With their marks.
std::vector<std::string> sentences_of(const std::string& text) {
  std::vector<std::string> sentences;
  size_t begin = 0;
  for (size_t i = 0; i < text.size(); ++i) {
    const bool mark = text[i] == '?' || text[i] == '!' || text[i] == '.';
    const bool last = i + 1 == text.size();
    if (!last && (!mark || !is_space(text[i + 1]))) continue;
    std::string sentence = text.substr(begin, i + 1 - begin);
    if (!last && text[i] == '.' && !ends_sentence(trimmed(text.substr(begin, i - begin)))) continue;
    begin = i + 1;
    if (!is_polite(sentence_words(sentence))) sentences.push_back(std::move(sentence));
  }
  return sentences;
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

/// "now I can not think where it went", "yeah she took it": a clause with a subject of its own.
bool begins_clause(const Words& words, size_t at) {
  static const WordSet adverbs = {"now", "then", "yeah", "well", "so", "today", "after", "afterwards"};
  static const WordSet subjects = {"i", "we", "he", "she", "they", "it"};
  while (at < words.size() && adverbs.contains(words[at])) ++at;
  return at + 1 < words.size() && subjects.contains(words[at]) && !is_joint(words[at + 1]);
}

/// A fragment in pieces: "is it open | and what is in it"; `at_questions`, too: "I lost my cup | where is
/// it".
std::vector<Words> pieces_of(const Words& words, bool at_questions) {
  std::vector<Words> pieces;
  size_t begin = 0;
  const auto cut = [&](size_t end, size_t next) {
    if (end > begin)
      pieces.emplace_back(words.begin() + static_cast<std::ptrdiff_t>(begin),
                          words.begin() + static_cast<std::ptrdiff_t>(end));
    begin = next;
  };
  for (size_t i = 1; i + 1 < words.size(); ++i) {
    const bool joined = is_joint(words[i]) && (begins_part(words, i + 1) || begins_clause(words, i + 1));
    if (joined) cut(i, i + 1);
    const bool after_statement = at_questions && i > begin + 1 && !joined &&
                                 class_of(lemma_of(words[i])) == WordClass::question && words[i] != "which" &&
                                 words[i] != "who" && words[i] != "when" &&
                                 is_statement(Words(words.begin() + static_cast<std::ptrdiff_t>(begin),
                                                    words.begin() + static_cast<std::ptrdiff_t>(i)));
    if (after_statement) cut(i, i);
  }
  cut(words.size(), words.size());
  return pieces;
}

/// "We have guests tonight": a statement that names nothing and asks nothing.
bool is_aside(const Words& words) {
  static const WordSet bridges = {"if", "whether"};
  return is_statement(words) && !begins_question(words) && !find_pronoun(words) &&
         std::ranges::none_of(words, [](const std::string& word) {
           return is_household_noun(word) || word.find_first_of("_0123456789") != std::string::npos ||
                  bridges.contains(word) || class_of(lemma_of(word)) == WordClass::question;
         });
}

/// Whether a question is about what happened, or what is otherwise than before.
bool asks_about_changes(const Words& question) {
  static const WordSet events = word_set("change happen move take come vanish leave miss new");
  return std::ranges::any_of(tokens_of(question).lemmas,
                             [](const std::string& lemma) { return events.contains(lemma); });
}

/// Whether a time that a statement gives is that of a question: "I was out until noon, what happened?"
bool asks_about_absence(const Words& statement, const Words& question, const TimeReader& times) {
  static const WordSet past = word_set("was were had been came went left");
  Words timeless = question;
  return std::ranges::any_of(statement, [](const std::string& word) { return past.contains(word); }) &&
         asks_about_changes(question) && !cut_time(timeless, times);
}

/// "I am in front of the shelf what is on it", as a transcript has it: statements, then a question about what
/// they name or at the time that they give; empty for other sentences.
std::vector<std::string> spoken_sentences(const std::string& text) {
  const std::vector<Words> fragments = fragments_of(text);
  if (fragments.size() != 1) return {};
  const std::vector<Words> pieces = pieces_of(fragments[0], true);
  const auto is_verb = [](const std::string& lemma) { return class_of(lemma) == WordClass::auxiliary; };
  if (!std::all_of(pieces.begin(), pieces.end() - 1, is_statement) ||
      std::ranges::none_of(tokens_of(pieces.back()).lemmas, is_verb))  // "it is in what drawer"
    return {};
  std::vector<std::string> sentences;
  for (const Words& piece : pieces) sentences.push_back(joined(piece, " "));
  return sentences;
}

/// Without asides, where the rest refers to nothing that was said.
std::vector<Words> without_asides(const std::vector<Words>& parts, const TimeReader& times) {
  std::vector<Words> asides, rest;
  for (const Words& part : parts)
    for (Words& piece : pieces_of(part, false)) (is_aside(piece) ? asides : rest).push_back(std::move(piece));
  const Words question = in_one(rest);
  if (asides.empty() || rest.empty() || find_pronoun(question) ||
      asks_about_absence(in_one(asides), question, times))
    return parts;
  return rest;
}

/// "Before I go out", "if I am not mistaken": what a person is about to do restricts nothing that was seen.
/// `refers`: what is asked refers to something, which the plan may name.
bool is_own_plan(const Words& words, bool refers) {
  static const WordSet links = word_set("before if while since until as when after");
  static const WordSet past = word_set("was were did had");
  static const WordSet alike = word_set("put set let cut shut read");  // today and yesterday
  if (words.size() < 3 || !links.contains(words[0]) || (words[1] != "i" && words[1] != "we")) return false;
  const std::vector<std::string> bases = wordnet::base_forms(words[2], wordnet::PartOfSpeech::verb);
  const bool present = words[2] == "am" || words[2] == "are" || std::ranges::count(bases, words[2]) > 0;
  const bool plain = std::none_of(words.begin() + 2, words.end(), [](const std::string& word) {
    return is_household_noun(word) || is_pronoun(word);
  });
  const bool to_do = words[0] == "before" && !refers && !alike.contains(words[2]);
  return present && !past.contains(words[2]) && (plain || to_do);
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

std::string without_sounds(const std::string& text) {
  std::vector<std::string> words = words_of(text);
  std::erase_if(words, [](std::string word) {
    if (word.ends_with(',')) word.pop_back();
    return is_sound(lower_case(word));
  });
  return words.empty() ? text : joined(words, " ");
}

std::optional<QuestionInContext> question_in_context(const std::string& text, const TimeReader& times) {
  QuestionInContext result{.statements = sentences_of(text)};
  if (result.statements.size() < 2) result.statements = spoken_sentences(text);
  if (result.statements.size() < 2) return std::nullopt;
  const auto asks = [](const std::string& sentence) {
    Words words = sentence_words(sentence);
    strip_surroundings(words);
    return sentence.ends_with('?') || (begins_question(words) && !is_restriction(words));
  };
  const auto is_time = [&](const std::string& sentence) {
    Words words = sentence_words(sentence);
    cut_time(words, times);
    return words.empty();
  };
  result.question = std::move(result.statements.back());
  result.statements.pop_back();
  if (!asks(result.question) || std::ranges::any_of(result.statements, asks) ||
      std::ranges::any_of(result.statements, is_time))
    return std::nullopt;
  return result;
}

std::optional<std::string> question_at_statements(const QuestionInContext& context,
                                                  const std::string& question, const TimeReader& times) {
  Words asked = sentence_words(question);
  const auto is_past = [](const std::string& word) { return word == "was" || word == "were"; };
  const std::string mood = first_lemma(asked);
  const bool asks_for_time = mood == "when" || mood == "sincewhen" || mood.starts_with("how");
  const bool then = std::ranges::any_of(asked, is_past);
  const bool since = !then && mood == "what" && asks_about_changes(asked);  // "what is missing now?"
  const auto said = cut_time(asked, times);
  if (asks_for_time || !(then || since) || (said && !(since && said->from == "now"))) return std::nullopt;
  std::string moment;
  for (const std::string& statement : context.statements) {
    Words words = sentence_words(statement);
    while (const auto time = cut_time(words, times)) {
      if (!time->moment || !moment.empty()) return std::nullopt;
      moment = time->from;
    }
  }
  if (moment.empty() || moment == "now") return std::nullopt;
  return joined(asked, " ") + (since ? " since " : " at ") + moment;
}

std::vector<SentencePart> sentence_parts(const std::string& sentence, const TimeReader& times) {
  std::vector<SentencePart> parts;
  Words time;  // "after breakfast, ..."
  size_t count = 0;
  const std::vector<Words> fragments = fragments_of(sentence);
  const bool refers = std::ranges::any_of(
      fragments, [](const Words& fragment) { return find_pronoun(fragment).has_value(); });
  for (const Words& fragment : fragments) {
    count += fragment.size();
    if (!parts.empty() && is_tag(fragment)) {  // "It is not there, is it?"
      Words& before = parts.back().words;
      before.insert(before.end(), fragment.begin(), fragment.end());
      continue;
    }
    if (is_polite(fragment) || is_introduction(fragment) || asks_for_answer(fragment)) continue;
    for (Words& piece : pieces_of(fragment, true)) {
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
      if (is_own_plan(timeless, refers)) continue;
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

std::vector<Words> core_words(const std::string& sentence, const std::set<std::string>& concepts,
                              const TimeReader& times) {
  const std::vector<Words> fragments = fragments_of(sentence);
  if (in_one(fragments).size() > kMaxSentenceWords) return {};
  const std::vector<Words> parts = without_asides(meaningful(fragments, concepts), times);
  std::vector<Words> candidates;
  const auto add = [&](std::optional<Words> words) {
    if (!words) return;
    strip_surroundings(*words);
    if (!words->empty() && std::ranges::count(candidates, *words) == 0)
      candidates.push_back(std::move(*words));
  };
  add(in_one(parts));
  add(last_question(in_one(parts)));
  for (size_t i = 0, count = candidates.size(); i < count; ++i) add(without_tail(candidates[i]));
  return candidates;
}

}  // namespace loci::memory
