// A memory for other programs: serve.

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>

#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"
#include "memory/fleet/fleet_database.h"
#include "memory/server/tool_server.h"

namespace loci::apps {
namespace {

constexpr size_t kMaxMessage = 4'000'000;  ///< bytes

/// Replies to lines from standard input until it ends.
class LineServer {
 public:
  explicit LineServer(const memory::ToolServer& server) : server_(server) {}

  void run() {
    std::string bytes(65536, '\0');
    while (!interrupted()) {
      pollfd input{STDIN_FILENO, POLLIN, 0};
      if (poll(&input, 1, 200) <= 0) continue;
      const ssize_t count = read(STDIN_FILENO, bytes.data(), bytes.size());
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) break;
      take(std::string_view(bytes).substr(0, static_cast<size_t>(count)));
    }
    if (!line_.empty()) answer();
  }

 private:
  void take(std::string_view bytes) {
    for (const char c : bytes) {
      if (c == '\n') {
        answer();
      } else if (line_.size() < kMaxMessage) {
        line_ += c;
      } else {
        throw Error(fmt::format("a message is longer than {} bytes", kMaxMessage));
      }
    }
  }

  void answer() {
    const std::optional<std::string> reply =
        line_.find_first_not_of(" \t\r") == std::string::npos ? std::nullopt : server_.reply(line_);
    line_.clear();
    if (!reply) return;
    fmt::print("{}\n", *reply);
    std::fflush(stdout);
  }

  const memory::ToolServer& server_;
  std::string line_;
};

}  // namespace

Command serve_command() {
  return {
      .name = "serve",
      .description = "Answer programs and language models in the Model Context Protocol (MCP)",
      .examples = {R"(echo '{"jsonrpc": "2.0", "id": 1, "method": "tools/list"}' | )"
                   "loci-memory serve --mcp -m demo-output/memory.loci",
                   R"(echo '{"jsonrpc": "2.0", "id": 1, "method": "tools/call", "params": {"name": "ask", )"
                   R"("arguments": {"question": "Where is the red cup?"}}}' | )"
                   "loci-memory serve --mcp -m demo-output/memory.loci"},
      .declare = [](ArgumentTable& table) {
        struct Arguments {
          std::string memory;
          bool mcp = false, allow_edits = false;
        };
        auto arguments = std::make_shared<Arguments>();
        table.memory(arguments->memory);
        table.flag("--mcp", arguments->mcp,
                   "Read messages from standard input and write replies to standard output, a line each",
                   {.required = true});
        table.flag("--allow-edits", arguments->allow_edits,
                   "Offer the corrections of `loci-memory edit` as tools; without it nothing is written");
        return [arguments](Session& session) {
          if (arguments->allow_edits && memory::is_fleet_url(arguments->memory))
            throw UsageError("--allow-edits needs a file: a memory in a database changes by pushes alone");
          const memory::ToolServer server(memory_source(arguments->memory, session), kVersion,
                                          arguments->allow_edits);
          LineServer(server).run();
        };
      }};
}

}  // namespace loci::apps
