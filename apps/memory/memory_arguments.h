#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/cli/program.h"
#include "mapping/base/text/json.h"
#include "memory/questions/question.h"

namespace loci::apps {

/// The memory, valid time and transaction time.
struct MemoryArguments {
  std::string memory;
  std::string at;
  std::string known_at;

  void declare(ArgumentTable& table);
  /// The times, read against the open memory.
  memory::AsOf as_of(const memory::Store& store) const;
};

/// A period, open where a side is unset.
struct Span {
  std::optional<TimeNs> first = {}, last = {};
};

/// --between A B, --from A, --to B.
struct SpanArguments {
  std::vector<std::string> between;
  std::string from;
  std::string to;

  void declare(ArgumentTable& table);
  /// Error when it ends before it begins.
  Span read(const memory::Store& store) const;
};

/// The file of a memory: as named, or a local replica of what postgresql:// names, at most a second old.
std::filesystem::path memory_file(const std::string& memory, Session& session);
/// The same for a program that asks again and again: of a database the connection stays open.
std::function<std::filesystem::path()> memory_source(const std::string& memory, Session& session);
/// Opens it for reading.
memory::Store open_memory(const std::string& memory, Session& session);

/// Opens a memory for writing that is there already: a mistyped name does not make one. Warns where it was
/// migrated.
memory::Store open_to_change(const std::string& memory, Session& session);

}  // namespace loci::apps
