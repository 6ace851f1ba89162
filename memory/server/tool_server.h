#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "mapping/base/json_fwd.h"

namespace loci::memory {

/// Answers a program, such as a language-model agent, in the Model Context Protocol
/// (modelcontextprotocol.io, revisions 2024-11-05 to 2025-06-18; JSON-RPC 2.0). Tools are `ask` and the
/// declared questions, with their arguments as JSON Schema; resources are objects, places and images of
/// scenes. Arguments that name files are not offered: a client reads nothing else of this machine. Nothing
/// changes the memory unless edits are allowed; then the declared edits are tools, too (`edit-merge`), and
/// each opens the memory for writing as long as it lasts. Each message sees what the memory holds when it
/// comes, also while a program writes.
class ToolServer {
 public:
  /// `memory` finds the file, for each message anew; `version` is what clients are told. Error when the file
  /// is not a memory.
  ToolServer(std::function<std::filesystem::path()> memory, std::string version, bool allow_edits = false);
  ToolServer(std::filesystem::path memory, std::string version, bool allow_edits = false);

  /// The reply to one message, one line without a line break; unset when it asks for none (a notification).
  /// Malformed messages get an error as the protocol has it; nothing is thrown for what the text says.
  std::optional<std::string> reply(std::string_view message) const;

 private:
  std::optional<Json> answer(const Json& message) const;

  std::function<std::filesystem::path()> memory_;
  std::string version_;
  bool allow_edits_;
};

}  // namespace loci::memory
