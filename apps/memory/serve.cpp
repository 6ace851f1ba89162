// A memory for other programs: serve.

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <thread>

#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"
#include "mapping/base/text/json.h"
#include "mapping/http/http_server.h"
#include "memory/fleet/fleet_database.h"
#include "memory/server/http_transport.h"
#include "memory/server/tool_server.h"

namespace loci::apps {
namespace {

constexpr double kMaxMessage_mb = 4;
constexpr size_t kMaxMessage = static_cast<size_t>(kMaxMessage_mb * 1e6);  ///< bytes

/// Replies to lines from standard input until it ends.
class LineServer {
 public:
  explicit LineServer(const memory::ToolServer& server) : transport_(server) {}

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
      } else if (line_.size() <= kMaxMessage) {  // The rest of one that is too long is passed over.
        line_ += c;
      }
    }
  }

  void answer() {
    std::optional<std::string> reply;
    if (line_.size() > kMaxMessage)
      reply = memory::message_text(
          memory::error_reply(memory::MessageError::not_a_message,
                              fmt::format("a message is longer than {} bytes", kMaxMessage)));
    else if (line_.find_first_not_of(" \t\r") != std::string::npos)
      reply = transport_.reply(line_);
    line_.clear();
    if (!reply) return;
    fmt::print("{}\n", *reply);
    std::fflush(stdout);
  }

  memory::LineTransport transport_;
  std::string line_;
};

/// Replies to messages at an address until Ctrl-C.
void serve_http(const memory::ToolServer& server, const std::string& address, mapping::HttpLimits& limits,
                Session& session) {
  table_of(limits).validate();
  const mapping::HttpAddress at = mapping::read_http_address(address);
  memory::HttpTransport transport(server);
  const mapping::HttpServer http(at.address, at.port, limits, [&](const mapping::HttpRequest& request) {
    return transport.reply(request);
  });
  const std::string url = http.url() + memory::HttpTransport::kPath;
  session.answer(fmt::format("answering at {} (Ctrl-C stops)\n", url), {{"url", url}, {"port", http.port()}});
  std::fflush(stdout);
  while (!interrupted()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
}

}  // namespace

Command serve_command() {
  return {
      .name = "serve",
      .description = "Answer programs and language models in the Model Context Protocol (MCP)",
      .examples = {R"(echo '{"jsonrpc": "2.0", "id": 1, "method": "tools/list"}' | )"
                   "loci-memory serve --mcp -m demo-output/memory.loci",
                   R"(echo '{"jsonrpc": "2.0", "id": 1, "method": "tools/call", "params": {"name": "ask", )"
                   R"("arguments": {"question": "Where is the red cup?"}}}' | )"
                   "loci-memory serve --mcp -m demo-output/memory.loci",
                   "timeout --preserve-status -s INT 3 "
                   "loci-memory serve --mcp --http 0 -m demo-output/memory.loci"},
      .declare = [](ArgumentTable& table) {
        struct Arguments {
          std::string memory, http;
          bool mcp = false, allow_edits = false;
          mapping::HttpLimits limits{.max_mb = kMaxMessage_mb};
        };
        auto arguments = std::make_shared<Arguments>();
        table.memory(arguments->memory);
        table.flag("--mcp", arguments->mcp,
                   "Read messages from standard input and write replies to standard output, a line each",
                   {.required = true});
        table.option("--http ADDRESS", &arguments->http,
                     "Answer over HTTP instead, at ADDRESS:PORT (127.0.0.1:8642); a port alone is at "
                     "127.0.0.1, 0 = any that is free");
        table.flag("--allow-edits", arguments->allow_edits,
                   "Offer the corrections of `loci-memory edit` as tools; without it nothing is written");
        table.options(table_of(arguments->limits), "HTTP");
        for (const char* limit : {"--max-mb", "--request-s", "--connections", "--token-file"})
          table.at(limit).needs = {"--http"};
        return [arguments](Session& session) {
          if (arguments->allow_edits && memory::is_fleet_url(arguments->memory))
            throw UsageError("--allow-edits needs a file: a memory in a database changes by pushes alone");
          const memory::ToolServer server(memory_source(arguments->memory, session), kVersion,
                                          arguments->allow_edits);
          if (arguments->http.empty())
            LineServer(server).run();
          else
            serve_http(server, arguments->http, arguments->limits, session);
        };
      }};
}

}  // namespace loci::apps
