#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "memory/sentences/lexicon.h"

namespace loci::memory {

// Forms of several words with (a|b) and [optional] parts.

/// All plain sequences of words that a form stands for.
std::vector<Words> expand_form(const std::string& form);
/// How many words from words[at] on the form stands for, at most; 0 = it does not stand there. Nothing is
/// written out for it: a sentence has few words, the forms have thousands.
size_t longest_match(std::string_view form, const Words& words, size_t at);
/// Words that a form may begin with.
std::vector<std::string_view> first_words(std::string_view form);

}  // namespace loci::memory
