#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "memory/questions/people_time.h"

namespace loci::memory {

/// A command of loci-memory, without the name of the memory.
struct CommandLine {
  std::string verb = {};                                         ///< "where"
  std::vector<std::string> words = {};                           ///< "tea cup"
  std::map<std::string, std::vector<std::string>> options = {};  ///< {"at", {"08:30"}}

  /// As it is typed: where 'tea cup' --at 08:30.
  std::string text() const;
  std::string joined_words() const;
  /// The first value of an option, or "".
  std::string option(const std::string& name) const;
};

/// How a time in a sentence goes into its command.
enum class Period {
  none,     ///< the command takes no time
  at,       ///< one moment: --at
  between,  ///< a while: --between
  either,   ///< a moment stays; over a while the question becomes that of the history
  during,   ///< hours or days of the week, again and again: --during
};

/// One form of sentence and the command that it becomes: the grammar is a table of these, read from the top.
/// In a sentence (a|b) is one of them, [a] may be missing, <X> is an object and <P> a place in words, <O> an
/// occasion; articles and "please" are left out before. In a command {X} stands for the words of <X>.
struct SentencePattern {
  std::string sentence;
  std::string command;
  Period period = Period::none;
  std::string example = {};  ///< what to show people of it; "" = a form of the one before
};
const std::vector<SentencePattern>& sentence_patterns();

/// The command that an English sentence means; unset when no form fits. Times are cut out first, wherever in
/// the sentence they stand: "this morning", "between nine and ten", "since 9:00", "two hours ago".
std::optional<CommandLine> understand(const std::string& sentence, const TimeReader& times);

/// The examples of the forms that are nearest to a sentence, nearest first.
std::vector<std::string> nearest_sentences(const std::string& sentence, size_t count = 3);

}  // namespace loci::memory
