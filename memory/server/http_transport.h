#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>

#include "mapping/http/http_server.h"
#include "memory/server/tool_server.h"

namespace loci::memory {

/// The protocol's streamable HTTP transport, for an HttpServer: a message is POSTed to /mcp and its reply is
/// JSON, or status 202 where it asks for none. The server sends nothing by itself, so GET is 405.
///
/// `initialize` begins a session, whose name (Mcp-Session-Id) all other requests have to give, and DELETE
/// ends it; of more than kMaxSessions the one that was used last is ended. Batches are for sessions of
/// revision 2025-03-26, which alone has them. Status 400: no message, no session, or an unknown
/// MCP-Protocol-Version; 404: another path, or a session that was ended; 405, 406 and 415: another method,
/// Accept or Content-Type.
class HttpTransport {
 public:
  static constexpr const char* kPath = "/mcp";
  static constexpr size_t kMaxSessions = 1000;

  /// `server` stays with the caller.
  explicit HttpTransport(const ToolServer& server) : server_(server) {}

  /// Any number of threads may call it.
  mapping::HttpReply reply(const mapping::HttpRequest& request);

 private:
  struct Session {
    std::string version;  ///< of the protocol
    uint64_t used = 0;    ///< when it was used last, counted in requests
  };

  mapping::HttpReply post(const mapping::HttpRequest& request);
  mapping::HttpReply initialize(const Json& message);
  mapping::HttpReply end_session(const std::string& name);
  std::string begin_session(const std::string& version);
  /// The version of the session; empty = there is no such session.
  std::string use_session(const std::string& name);

  const ToolServer& server_;
  std::mutex mutex_;
  std::map<std::string, Session> sessions_;
  uint64_t requests_ = 0;
};

}  // namespace loci::memory
