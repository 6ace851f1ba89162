#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/cli/program.h"
#include "memory/questions/words.h"

namespace loci {

/// What every question takes: the file and the two clocks.
struct MemoryArguments {
  std::string memory;
  std::string at;
  std::string known_at;

  void declare(CLI::App& app);
  /// The clocks, read against the open memory.
  AsOf as_of(const Store& store) const;
};

/// --between A B, --from A, --to B.
struct SpanArguments {
  std::vector<std::string> between;
  std::string from;
  std::string to;

  void declare(CLI::App& app);
  std::optional<TimeNs> first(const Store& store) const;
  std::optional<TimeNs> last(const Store& store) const;
};

/// "the", "red", "cup" given as one or several arguments.
std::string joined(const std::vector<std::string>& words);

/// Asks and writes the answer.
template <class Question>
void answer_question(Session& session, const Store& store, const Question& question) {
  const auto answer = ask(store, question);
  session.answer(to_text(answer, TimeWriter(store)), to_json(answer));
}

}  // namespace loci
