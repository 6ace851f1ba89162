#include "memory/sentences/intents/pattern.h"

#include <algorithm>
#include <map>
#include <set>

#include "mapping/base/text/text.h"
#include "memory/questions/names/color_words.h"
#include "memory/questions/names/related_words.h"
#include "memory/sentences/word_forms.h"
#include "memory/wordnet/wordnet.h"

namespace loci::memory {
namespace {

/// Where a pattern matches, and which words its variables take.
class Matcher {
 public:
  Matcher(const Words& elements, const Words& words, const IsName& is_name)
      : elements_(elements), words_(words), is_name_(is_name) {}

  bool matches_at(size_t first) { return matches(0, first); }
  size_t end() const { return end_; }
  std::pair<size_t, size_t> taken(const std::string& variable) const { return taken_.at(variable); }

 private:
  bool matches(size_t element, size_t at) {
    if (element == elements_.size()) return end_ = at, true;
    const std::string& one = elements_[element];
    if (one == "^") return (at == 0 || is_mark(words_[at - 1])) && matches(element + 1, at);
    if (one == "$") return (at == words_.size() || is_mark(words_[at])) && matches(element + 1, at);
    if (one[0] == '<') return captures(element, at);
    const bool optional = one.size() > 1 && one.ends_with('?');
    const Words alternatives = words_of(optional ? one.substr(0, one.size() - 1) : one, "|");
    const bool fits = at < words_.size() && std::ranges::count(alternatives, words_[at]) > 0;
    if (fits && matches(element + 1, at + 1)) return true;
    return optional && matches(element + 1, at);
  }

  bool captures(size_t element, size_t at) {
    const std::string inner = elements_[element].substr(1, elements_[element].size() - 2);
    const size_t colon = inner.find(':');
    const std::string kind = colon == std::string::npos ? "" : inner.substr(colon + 1);
    for (size_t end = at + 1; end <= words_.size() && !is_mark(words_[end - 1]); ++end) {
      taken_[inner.substr(0, colon)] = {at, end};
      // What names mean is only asked where the rest fits.
      if (matches(element + 1, end) && is_of_kind(kind, at, end)) return true;
    }
    return false;
  }

  bool is_of_kind(const std::string& kind, size_t first, size_t last) const {
    const bool single = last == first + 1;
    if (kind.empty()) return true;
    if (kind == "name") {
      const bool article = class_of(lemma_of(words_[first])) == WordClass::article;
      return first + (article ? 1 : 0) < last &&
             is_name_(join_words(words_, first + (article ? 1 : 0), last));
    }
    if (kind == "colour") return single && is_color_word(words_[first]);
    if (kind == "asking") return single && may_begin_question(words_[first]);
    if (kind == "furniture") return single && is_furniture(words_[first]);
    if (kind == "doing")
      return single && words_[first].ends_with("ing") &&
             !wordnet::base_forms(words_[first], wordnet::PartOfSpeech::verb).empty();
    if (kind == "noun")
      return single && class_of(lemma_of(words_[first])) == WordClass::name &&
             !wordnet::base_forms(words_[first], wordnet::PartOfSpeech::noun).empty();
    if (kind == "plural")
      return is_of_kind("noun", first, last) && words_[first].ends_with('s') &&
             singular_of(words_[first]) != words_[first];
    if (kind == "courtesy") return is_courtesy(first, last);
    return kind == "matrix" && is_matrix(first, last);
  }

  /// "it is not too much trouble", "you do not mind": what restricts nothing.
  bool is_courtesy(size_t first, size_t last) const {
    static const std::set<std::string> all = [] {
      const Words some = words_of(
          "it this that you i we are is am was were be not no would do does may might can could too so very "
          "much great big any a of the all to me us ask mind bother trouble imposition inconvenience "
          "problem fine alright ok okay right possible kind good please like wrong mistaken remember recall "
          "happen know allowed convenient with correctly rightly");
      return std::set<std::string>(some.begin(), some.end());
    }();
    return std::all_of(words_.begin() + static_cast<std::ptrdiff_t>(first),
                       words_.begin() + static_cast<std::ptrdiff_t>(last),
                       [](const std::string& word) { return all.contains(word); });
  }

  /// "Perhaps you could enlighten me as to": persons who want to know something, and no name.
  bool is_matrix(size_t first, size_t last) const {
    bool person = false;
    for (size_t i = first; i < last; ++i) {
      const std::string& word = words_[i];
      person = person || word == "me" || word == "us" || word == "i" || word == "we" || word == "you";
      if (is_household_noun(word) || is_pronoun(word) || is_name_(word)) return false;
    }
    return person;
  }

  const Words& elements_;
  const Words& words_;
  const IsName& is_name_;
  std::map<std::string, std::pair<size_t, size_t>> taken_;
  size_t end_ = 0;
};

}  // namespace

bool may_begin_question(const std::string& word) {
  const WordClass word_class = class_of(lemma_of(word));
  return word_class == WordClass::question || word_class == WordClass::auxiliary;
}

bool is_mark(const std::string& word) {
  static const std::set<std::string> marks = {",", "?", "!", ".", ";"};
  return marks.contains(word);
}

Pattern::Pattern(const char* form, const char* by) : elements_(words_of(form)), by_(words_of(by)) {}

bool Pattern::apply(Words& words, const IsName& is_name) const {
  for (size_t first = 0; first < words.size(); ++first) {
    Matcher matcher(elements_, words, is_name);
    if (!matcher.matches_at(first)) continue;
    Words by;
    for (const std::string& word : by_)
      if (word[0] == '<') {
        const auto [begin, end] = matcher.taken(word.substr(1, word.size() - 2));
        by.insert(by.end(), words.begin() + static_cast<std::ptrdiff_t>(begin),
                  words.begin() + static_cast<std::ptrdiff_t>(end));
      } else {
        by.push_back(word);
      }
    replace_words(words, first, matcher.end() - first, by);
    return true;
  }
  return false;
}

bool apply_all(const std::vector<Pattern>& patterns, Words& words, const IsName& is_name) {
  bool changed = false;
  for (const Pattern& pattern : patterns) changed = pattern.apply(words, is_name) || changed;
  return changed;
}

}  // namespace loci::memory
