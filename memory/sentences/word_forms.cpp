#include "memory/sentences/word_forms.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>

namespace loci::memory {
namespace {

/// All plain sequences of words that a form stands for.
class FormExpander {
 public:
  explicit FormExpander(const std::string& form) : form_(form) {}
  std::vector<Words> expand() { return alternatives('\0'); }

 private:
  std::vector<Words> alternatives(char end) {
    std::vector<Words> all, current = {{}};
    std::string word;
    const auto append = [&](const std::vector<Words>& tails) {
      std::vector<Words> longer;
      for (const Words& head : current)
        for (const Words& tail : tails) {
          longer.push_back(head);
          longer.back().insert(longer.back().end(), tail.begin(), tail.end());
        }
      current = std::move(longer);
    };
    const auto end_word = [&] {
      if (!word.empty()) append({{word}});
      word.clear();
    };
    while (next_ < form_.size() && form_[next_] != end) {
      const char c = form_[next_++];
      if (c == ' ') {
        end_word();
      } else if (c == '|') {
        end_word();
        all.insert(all.end(), current.begin(), current.end());
        current = {{}};
      } else if (c == '(' || c == '[') {
        std::vector<Words> inner = alternatives(c == '(' ? ')' : ']');
        ++next_;
        if (c == '[') inner.emplace_back();
        append(inner);
      } else {
        word.push_back(c);
      }
    }
    end_word();
    all.insert(all.end(), current.begin(), current.end());
    return all;
  }

  const std::string& form_;
  size_t next_ = 0;
};

/// How many words of a sentence a form takes: what it stands for is compared as it is read, not written out
/// first. Sets of numbers of words are bits.
class FormMatcher {
 public:
  FormMatcher(std::string_view form, std::span<const std::string> words) : form_(form), words_(words) {}
  /// The most; 0 = none.
  size_t match() { return static_cast<size_t>(std::bit_width(alternatives('\0', 1) >> 1)); }

 private:
  using Counts = uint64_t;

  Counts alternatives(char end, Counts begins) {
    Counts all = 0, current = begins;
    while (next_ < form_.size() && form_[next_] != end) {
      const size_t word_end = std::min(form_.find_first_of(" |()[]", next_), form_.size());
      const char c = form_[next_];
      if (word_end > next_) {
        current = after(form_.substr(next_, word_end - next_), current);
        next_ = word_end;
        continue;
      }
      ++next_;
      if (c == '|') {
        all |= current;
        current = begins;
      } else if (c == '(' || c == '[') {
        const Counts inner = alternatives(c == '(' ? ')' : ']', current);
        current = c == '[' ? current | inner : inner;
        ++next_;
      }
    }
    return all | current;
  }

  Counts after(std::string_view word, Counts begins) const {
    constexpr size_t kMaxWords = 63;
    Counts ends = 0;
    for (size_t count = 0; count < std::min(words_.size(), kMaxWords); ++count)
      if ((begins >> count & 1) != 0 && words_[count] == word) ends |= Counts{2} << count;
    return ends;
  }

  std::string_view form_;
  std::span<const std::string> words_;
  size_t next_ = 0;
};

/// Adds the words that a form may begin with, from form[next] to its end or `end`; false where it may also
/// stand for nothing.
bool add_first_words(std::string_view form, size_t& next, char end, std::vector<std::string_view>& words) {
  bool begun = false, all_begin = true;
  while (next < form.size() && form[next] != end) {
    const size_t word_end = std::min(form.find_first_of(" |()[]", next), form.size());
    const char c = form[next];
    if (word_end > next) {
      if (!begun) words.push_back(form.substr(next, word_end - next));
      begun = true;
      next = word_end;
      continue;
    }
    ++next;
    if (c == '|') {
      all_begin = all_begin && begun;
      begun = false;
    } else if (c == '(' || c == '[') {
      std::vector<std::string_view> inner;
      const bool begins = add_first_words(form, next, c == '(' ? ')' : ']', inner);
      if (!begun) words.insert(words.end(), inner.begin(), inner.end());
      begun = begun || (c == '(' && begins);
      ++next;
    }
  }
  return all_begin && begun;
}

}  // namespace

std::vector<Words> expand_form(const std::string& form) {
  return FormExpander(form).expand();
}

size_t longest_match(std::string_view form, const Words& words, size_t at) {
  return FormMatcher(form, std::span(words).subspan(at)).match();
}

std::vector<std::string_view> first_words(std::string_view form) {
  std::vector<std::string_view> words;
  size_t next = 0;
  add_first_words(form, next, '\0', words);
  return words;
}

}  // namespace loci::memory
