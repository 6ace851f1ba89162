#include "memory/server/http_transport.h"

#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/text/hash.h"
#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"

namespace loci::memory {
namespace {

using mapping::HttpReply;
using mapping::HttpRequest;

constexpr const char* kMessageType = "application/json";
constexpr const char* kSession = "Mcp-Session-Id";
constexpr const char* kVersion = "MCP-Protocol-Version";
constexpr int kNameWords = 4;  ///< 128 bits

HttpReply refusal(int status, const std::string& why) {
  return {status, why + "\n"};
}

HttpReply bad_message(MessageError error, const std::string& why) {
  return {400, message_text(error_reply(error, why)), kMessageType};
}

HttpReply message_reply(const std::optional<Json>& message) {
  if (!message) return {202};
  const bool is_accepted = message->is_array() || !message->at("id").is_null();
  return {is_accepted ? 200 : 400, message_text(*message), kMessageType};
}

/// Of a POST, before its body is looked at.
std::optional<HttpReply> header_refusal(const HttpRequest& request) {
  const std::string type = lower_case(request.header("Content-Type"));
  if (trimmed(type.substr(0, type.find(';'))) != kMessageType)
    return refusal(415, "messages are of type application/json");
  const std::string accepted = lower_case(request.header("Accept"));
  const auto accepts = [&](const char* range) { return accepted.find(range) != std::string::npos; };
  if (!accepted.empty() && !accepts(kMessageType) && !accepts("application/*") && !accepts("*/*"))
    return refusal(406, "replies are of type application/json");
  return std::nullopt;
}

}  // namespace

HttpReply HttpTransport::reply(const HttpRequest& request) {
  if (request.path != kPath) return refusal(404, fmt::format("there is nothing here but {}", kPath));
  if (request.method != "POST" && request.method != "DELETE")
    return {405, "messages are POSTed\n", "text/plain", {{"Allow", "POST, DELETE"}}};
  const std::string version = request.header(kVersion);
  if (!version.empty() && !is_protocol_version(version))
    return bad_message(MessageError::not_a_message, fmt::format("unknown {} '{}'", kVersion, version));
  return request.method == "POST" ? post(request) : end_session(request.header(kSession));
}

HttpReply HttpTransport::post(const HttpRequest& request) {
  if (const auto refused = header_refusal(request)) return *refused;
  Json message;
  try {
    message = parse_json(request.body, "");
  } catch (const Error& error) {
    return bad_message(MessageError::not_json, error.what());
  }
  if (is_initialize(message)) return initialize(message);
  const std::string session = request.header(kSession);
  if (session.empty())
    return bad_message(MessageError::not_a_message,
                       fmt::format("{} is missing; 'initialize' begins a session", kSession));
  const std::string version = use_session(session);
  if (version.empty()) return refusal(404, "there is no such session; 'initialize' begins a new one");
  if (message.is_array() && !takes_batches(version))
    return bad_message(MessageError::not_a_message, "one message at a time");
  return message_reply(server_.answer(message));
}

HttpReply HttpTransport::initialize(const Json& message) {
  const std::optional<Json> answer = server_.answer(message);
  HttpReply reply = message_reply(answer);
  if (answer && answer->contains("result"))
    reply.headers.emplace_back(kSession,
                               begin_session(answer->at("result").at("protocolVersion").get<std::string>()));
  return reply;
}

HttpReply HttpTransport::end_session(const std::string& name) {
  if (name.empty()) return refusal(400, fmt::format("{} is missing", kSession));
  const std::lock_guard lock(mutex_);
  return sessions_.erase(name) > 0 ? HttpReply{204} : refusal(404, "there is no such session");
}

std::string HttpTransport::begin_session(const std::string& version) {
  std::string name = unguessable_hex(kNameWords);
  const std::lock_guard lock(mutex_);
  if (sessions_.size() >= kMaxSessions)
    sessions_.erase(
        std::ranges::min_element(sessions_, {}, [](const auto& entry) { return entry.second.used; }));
  sessions_[name] = {version, ++requests_};
  return name;
}

std::string HttpTransport::use_session(const std::string& name) {
  const std::lock_guard lock(mutex_);
  const auto found = sessions_.find(name);
  if (found == sessions_.end()) return {};
  found->second.used = ++requests_;
  return found->second.version;
}

}  // namespace loci::memory
