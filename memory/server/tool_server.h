#pragma once

#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "mapping/base/text/json_fwd.h"

namespace loci::memory {

struct EditAction;

/// Answers a program, such as a language-model agent, in the Model Context Protocol
/// (modelcontextprotocol.io, revisions 2024-11-05 to 2025-11-25; JSON-RPC 2.0). Tools are `ask` and the
/// declared questions, with their arguments as JSON Schema; resources are objects, places and images of
/// scenes. Arguments that name files are not offered: a client reads nothing else of this machine. Nothing
/// changes the memory unless edits are allowed; then the declared edits are tools, too (`edit-merge`), and
/// each opens the memory for writing as long as it lasts. Each message sees what the memory holds when it
/// comes, also while a program writes. Any number of threads may ask.
class ToolServer {
 public:
  /// `memory` finds the file, for each message anew; `version` is what clients are told. Error when the file
  /// is not a memory.
  ToolServer(std::function<std::filesystem::path()> memory, std::string version, bool allow_edits = false);
  ToolServer(std::filesystem::path memory, std::string version, bool allow_edits = false);

  /// The reply to a message, or to several (JSON-RPC batch); unset when it asks for none (a notification).
  /// Malformed messages get an error as the protocol has it; nothing is thrown for what they say.
  std::optional<Json> answer(const Json& message) const;

 private:
  std::optional<Json> answer_one(const Json& message) const;
  std::filesystem::path memory() const;
  Json list_edits(const Json& params) const;
  Json call_edit(const EditAction& action, const Json& params) const;

  mutable std::mutex finding_, editing_;  ///< of `memory_`; of edits, which take turns
  std::function<std::filesystem::path()> memory_;
  std::string version_;
  bool allow_edits_;
};

/// One client that writes its messages as lines and reads replies as lines.
class LineTransport {
 public:
  explicit LineTransport(const ToolServer& server) : server_(server) {}
  /// The reply, without a line break; unset when the message asks for none.
  std::optional<std::string> reply(std::string_view line);

 private:
  const ToolServer& server_;
  std::string version_;  ///< of the protocol, once the client initialized
};

/// What JSON-RPC 2.0 answers with to text that is no JSON, and to JSON that is no message of it.
enum class MessageError { not_json = -32700, not_a_message = -32600 };
Json error_reply(MessageError error, const std::string& text);
/// Whether the server speaks this revision of the protocol.
bool is_protocol_version(std::string_view version);
/// Whether several messages may come at once: until revision 2025-03-26.
bool takes_batches(std::string_view version);
bool is_initialize(const Json& message);
/// On one line; text that is no UTF-8 is mended.
std::string message_text(const Json& message);

}  // namespace loci::memory
