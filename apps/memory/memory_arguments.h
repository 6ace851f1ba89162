#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/cli/program.h"
#include "mapping/base/json.h"
#include "memory/questions/words.h"

namespace loci::apps {

/// What every question takes: the file and the two clocks.
struct MemoryArguments {
  std::string memory;
  std::string at;
  std::string known_at;

  void declare(ArgumentTable& table);
  /// The clocks, read against the open memory.
  memory::AsOf as_of(const memory::Store& store) const;
};

/// --between A B, --from A, --to B.
struct SpanArguments {
  std::vector<std::string> between;
  std::string from;
  std::string to;

  void declare(ArgumentTable& table);
  std::optional<TimeNs> first(const memory::Store& store) const;
  std::optional<TimeNs> last(const memory::Store& store) const;
};

/// "the", "red", "cup" given as one or several arguments.
std::string joined(const std::vector<std::string>& words);

/// Asks and writes the answer.
template <class Question>
void answer_question(Session& session, const memory::Store& store, const Question& question) {
  const auto answer = ask(store, question);
  session.answer(to_text(answer, memory::TimeWriter(store)), memory::to_json(answer));
}

/// What a question command takes, and what it does: open, read the clocks, ask, answer.
using Declare = std::function<std::function<void(Session&)>(ArgumentTable&)>;

/// A question about an object in words.
template <class Question>
Declare about_object() {
  return [](ArgumentTable& table) {
    struct Arguments {
      MemoryArguments memory;
      std::vector<std::string> subject;
    };
    auto arguments = std::make_shared<Arguments>();
    arguments->memory.declare(table);
    table.positional("OBJECT...", &arguments->subject, "object_12, a name, a colour, a size, \"on table_1\"");
    return [arguments](Session& session) {
      const memory::Store store = memory::Store::open_read(arguments->memory.memory);
      const memory::AsOf as_of = arguments->memory.as_of(store);
      answer_question(session, store, Question{.subject = joined(arguments->subject), .as_of = as_of});
    };
  };
}

/// A question about a span of time.
template <class Question>
Declare about_span() {
  return [](ArgumentTable& table) {
    struct Arguments {
      MemoryArguments memory;
      SpanArguments span;
    };
    auto arguments = std::make_shared<Arguments>();
    arguments->memory.declare(table);
    arguments->span.declare(table);
    return [arguments](Session& session) {
      const memory::Store store = memory::Store::open_read(arguments->memory.memory);
      const memory::AsOf as_of = arguments->memory.as_of(store);
      answer_question(
          session, store,
          Question{.from = arguments->span.first(store), .to = arguments->span.last(store), .as_of = as_of});
    };
  };
}

/// What is on or in a place.
Declare about_place();

}  // namespace loci::apps
