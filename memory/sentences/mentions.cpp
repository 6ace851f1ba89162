#include "memory/sentences/mentions.h"

#include <algorithm>
#include <optional>
#include <set>

#include "mapping/base/text/text.h"
#include "memory/questions/names/color_words.h"
#include "memory/questions/names/related_words.h"
#include "memory/sentences/vocabulary.h"
#include "memory/wordnet/wordnet.h"

namespace loci::memory {
namespace {

/// "red", "big": they qualify a name and are none alone.
bool is_size(const std::string& word) {
  static const std::set<std::string> sizes = word_set(
      "big small large little tall short long flat round square wooden plastic metal ceramic medium tiny "
      "huge upper lower "
      "top bottom left right middle empty full own");
  return sizes.contains(word);
}

class MentionFinder {
 public:
  MentionFinder(const Tokens& tokens, const Snapshot& snapshot,
                const std::function<bool(const std::string&)>& is_word)
      : tokens_(tokens), snapshot_(snapshot), is_word_(is_word) {}

  std::vector<Mention> find() const {
    std::vector<Mention> mentions;
    for (size_t i = 0; i < tokens_.words.size();) {
      auto mention = known_at(i);
      if (!mention) mention = unknown_at(i);
      if (mention) mentions.push_back(*mention);
      i = mention ? mention->last : i + 1;
    }
    return mentions;
  }

 private:
  /// A word of the grammar is not a name; "cans" are, and "can" is one after an article or a colour.
  bool may_be_name(size_t i) const {
    const std::string &word = tokens_.words[i], &lemma = tokens_.lemmas[i];
    if (word == "cans") return true;
    if (word == "can")
      return i > 0 && (class_of(tokens_.lemmas[i - 1]) == WordClass::article ||
                       is_household_noun(tokens_.words[i - 1]));
    return class_of(lemma) == WordClass::name && !lexicon().contains(word) && !has_meaning(lemma) &&
           lemma != "it" && lemma != "they" && lemma != "them" && lemma != "there" && lemma != "this" &&
           lemma != "that";
  }

  Mention mention(size_t first, size_t last, bool place, bool known) const {
    return {first, last, place, known, join_words(tokens_.words, first, last)};
  }

  std::optional<Mention> known_at(size_t first) const {
    constexpr size_t kMaxWords = 4;
    size_t end = first;
    while (end < tokens_.words.size() && end < first + kMaxWords &&
           (may_be_name(end) || (end > first && is_digit(tokens_.words[end][0]))))
      ++end;
    for (size_t last = end; last > first; --last) {
      // "Drawer 9" is not any drawer.
      const bool numbered = last < tokens_.words.size() && is_digit(tokens_.words[last][0]);
      if (numbered && is_furniture(tokens_.words[last - 1])) continue;
      const std::string text = join_words(tokens_.words, first, last);
      if (std::all_of(tokens_.words.begin() + static_cast<std::ptrdiff_t>(first),
                      tokens_.words.begin() + static_cast<std::ptrdiff_t>(last), is_size))
        return std::nullopt;
      // "milk table" is an object and a place, "couch table" a place.
      const bool two = last > first + 1 && is_object(tokens_.words[first]);
      if (!two && is_place(text)) return mention(first, last, true, true);
      if (!is_object(text)) continue;
      // "Red bicycle" is not whatever is red.
      const bool attribute = is_color_word(tokens_.words[last - 1]) || is_size(tokens_.words[last - 1]);
      if (attribute && last < end && is_noun_of_things(tokens_.words[last]))
        return mention(first, last + 1, false, false);
      return mention(first, with_thing(last), false, true);
    }
    return std::nullopt;
  }

  static bool is_noun_of_things(const std::string& word) {
    return !wordnet::base_forms(word, wordnet::PartOfSpeech::noun).empty() && wordnet::may_be_somewhere(word);
  }

  /// "purple objects"
  size_t with_thing(size_t last) const {
    return last < tokens_.words.size() && tokens_.lemmas[last] == "thing" ? last + 1 : last;
  }
  bool is_place(const std::string& text) const { return !snapshot_.places_meant(text).empty(); }
  bool is_object(const std::string& text) const {
    try {
      return snapshot_.means_objects(text);
    } catch (const UnknownName&) {  // an object that was forgotten
      return false;
    }
  }

  std::optional<Mention> unknown_at(size_t first) const {
    const bool introduced = first > 0 && class_of(tokens_.lemmas[first - 1]) == WordClass::article;
    const auto is_noun = [&](size_t i) {
      return i < tokens_.words.size() && may_be_name(i) && !is_digit(tokens_.words[i][0]) &&
             (is_household_noun(tokens_.words[i]) || (introduced && !is_word_(tokens_.lemmas[i])));
    };
    size_t last = first;
    while (is_noun(last)) ++last;
    if (last < tokens_.words.size() && last > first && is_digit(tokens_.words[last][0]))
      ++last;  // "drawer 9"
    if (last == first || std::all_of(tokens_.words.begin() + static_cast<std::ptrdiff_t>(first),
                                     tokens_.words.begin() + static_cast<std::ptrdiff_t>(last), is_size))
      return std::nullopt;
    const std::string& noun = tokens_.words[last - 1];
    return mention(first, last, is_furniture(is_digit(noun[0]) ? tokens_.words[last - 2] : noun), false);
  }

  const Tokens& tokens_;
  const Snapshot& snapshot_;
  const std::function<bool(const std::string&)>& is_word_;
};

}  // namespace

std::vector<Mention> find_mentions(const Tokens& tokens, const Snapshot& snapshot,
                                   const std::function<bool(const std::string& lemma)>& is_word) {
  return MentionFinder(tokens, snapshot, is_word).find();
}

std::vector<Mention> joined_mentions(const std::vector<Mention>& mentions, const Tokens& tokens,
                                     bool coordinated, bool attached) {
  std::vector<Mention> joined;
  for (const Mention& mention : mentions) {
    Mention* before = joined.empty() ? nullptr : &joined.back();
    std::string joint;
    for (size_t i = before == nullptr ? mention.first : before->last; i < mention.first; ++i)
      if (class_of(tokens.lemmas[i]) != WordClass::article)
        joint += (joint.empty() ? "" : " ") + tokens.lemmas[i];
    const bool same = before != nullptr && before->place == mention.place &&
                      (joint == "and" || joint == "or" || joint == "or on" || joint == "or in");
    const bool at = before != nullptr && !before->place && mention.place && (joint == "on" || joint == "in");
    if ((coordinated && same) || (attached && at)) {
      before->text += " " + words_of(joint).front() + " " + mention.text;
      before->last = mention.last;
      before->known = before->known && mention.known;
    } else {
      joined.push_back(mention);
    }
  }
  return joined;
}

}  // namespace loci::memory
