#include "memory/server/http_transport.h"

#include <gmock/gmock.h>
#include <httplib.h>

#include <list>
#include <set>
#include <thread>

#include "mapping/base/files.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/text/json.h"
#include "memory/questions/facts.h"
#include "tests/memory/questions/day_fixture.h"
#include "tests/support/raw_connection.h"

namespace loci::memory {
namespace {

using ::loci::testing_support::RawConnection;

constexpr const char* kType = "application/json";

Json message_of(const std::string& method, const Json& params = Json::object()) {
  return {{"jsonrpc", "2.0"}, {"id", 7}, {"method", method}, {"params", params}};
}

Json call_of(const std::string& tool, const Json& arguments) {
  return message_of("tools/call", {{"name", tool}, {"arguments", arguments}});
}

class HttpTransportTest : public testing_support::DayFixture {
 protected:
  void SetUp() override {
    DayFixture::SetUp();
    serve();
  }
  void TearDown() override {
    http_.reset();
    DayFixture::TearDown();
  }

  void serve(const mapping::HttpLimits& limits = {}, bool allow_edits = false) {
    http_.reset();
    server_ = std::make_unique<ToolServer>(file_, "1.2.3", allow_edits);
    transport_ = std::make_unique<HttpTransport>(*server_);
    http_ = std::make_unique<mapping::HttpServer>(
        "127.0.0.1", 0, limits,
        [this](const mapping::HttpRequest& request) { return transport_->reply(request); });
  }
  httplib::Result post(const std::string& body, const httplib::Headers& headers = {}) const {
    return httplib::Client(http_->url()).Post("/mcp", headers, body, kType);
  }
  int status(const httplib::Result& result) const { return result ? result->status : 0; }
  /// The code of an error of JSON-RPC; 0 = none.
  int error(const httplib::Result& result) const {
    const Json json = parse_json(result->body, "reply");
    return json.contains("error") ? json["error"]["code"].get<int>() : 0;
  }
  /// A session of a revision, as the header that names it.
  httplib::Headers begin(const std::string& version = "2025-06-18") const {
    const httplib::Result result = post(message_of("initialize", {{"protocolVersion", version}}).dump());
    return {{"Mcp-Session-Id", result->get_header_value("Mcp-Session-Id")}};
  }
  /// The header of a session, and another one.
  static httplib::Headers with(httplib::Headers session, const std::string& name, const std::string& value) {
    session.emplace(name, value);
    return session;
  }

  std::unique_ptr<ToolServer> server_;
  std::unique_ptr<HttpTransport> transport_;
  std::unique_ptr<mapping::HttpServer> http_;
};

TEST_F(HttpTransportTest, InitializeBeginsASession) {
  std::set<std::string> names;
  for (const char* version : {"2025-11-25", "2025-06-18", "2025-03-26"}) {
    const httplib::Result result = post(message_of("initialize", {{"protocolVersion", version}}).dump());
    ASSERT_EQ(status(result), 200);
    EXPECT_EQ(result->get_header_value("Content-Type"), kType);
    EXPECT_EQ(parse_json(result->body, "reply")["result"]["protocolVersion"], version);
    names.insert(result->get_header_value("Mcp-Session-Id"));
    EXPECT_EQ(names.rbegin()->size(), 32U);
  }
  EXPECT_EQ(names.size(), 3U);
  const httplib::Result notified =
      post(R"({"jsonrpc": "2.0", "method": "notifications/initialized"})", begin());
  EXPECT_EQ(status(notified), 202);
  EXPECT_EQ(notified->body, "");
  const httplib::Result failed = post(message_of("initialize").dump());
  EXPECT_EQ(error(failed), -32602);
  EXPECT_FALSE(failed->has_header("Mcp-Session-Id")) << "an error begins no session";
}

TEST_F(HttpTransportTest, AnswersAsOverStandardInput) {
  const httplib::Headers session = begin();
  for (const Json& message :
       {message_of("ping"), message_of("tools/list"), message_of("resources/list"),
        message_of("resources/templates/list"),
        message_of("resources/read", {{"uri", "loci://object/object_1"}}),
        message_of("resources/read", {{"uri", "loci://object/zebra"}}),
        call_of("where", {{"object", "object_1"}}), call_of("where", {{"object", "zebra"}}),
        call_of("erase", Json::object()), message_of("tools/delete")}) {
    const httplib::Result result = post(message.dump(), session);
    ASSERT_EQ(status(result), 200) << message;
    EXPECT_EQ(result->body, LineTransport(*server_).reply(message.dump())) << message;
  }
  EXPECT_EQ(error(post(message_of("tools/delete").dump(), session)), -32601);
}

TEST_F(HttpTransportTest, SessionsAreAskedForAndEnd) {
  const std::string ping = message_of("ping").dump();
  EXPECT_EQ(status(post(ping)), 400);
  EXPECT_EQ(status(post(ping, {{"Mcp-Session-Id", "0123456789abcdef0123456789abcdef"}})), 404);
  const httplib::Headers one = begin(), other = begin();
  httplib::Client client(http_->url());
  EXPECT_EQ(status(client.Delete("/mcp")), 400);
  EXPECT_EQ(status(client.Delete("/mcp", one)), 204);
  EXPECT_EQ(status(client.Delete("/mcp", one)), 404);
  EXPECT_EQ(status(post(ping, one)), 404);
  EXPECT_EQ(status(post(ping, other)), 200);
}

TEST_F(HttpTransportTest, OfTooManySessionsTheOneUsedLongestAgoEnds) {
  const std::string ping = message_of("ping").dump();
  const httplib::Headers first = begin(), second = begin();
  EXPECT_EQ(status(post(ping, first)), 200);
  const mapping::HttpRequest another = {
      .method = "POST",
      .path = "/mcp",
      .host = "",
      .client = "",
      .headers = {{"Content-Type", kType}},
      .body = message_of("initialize", {{"protocolVersion", "2025-06-18"}}).dump()};
  for (size_t i = 2; i <= HttpTransport::kMaxSessions; ++i) transport_->reply(another);
  EXPECT_EQ(status(post(ping, first)), 200);
  EXPECT_EQ(status(post(ping, second)), 404);
}

TEST_F(HttpTransportTest, OtherMethodsPathsAndTypesAreRefused) {
  const std::string ping = message_of("ping").dump();
  const httplib::Headers session = begin();
  httplib::Client client(http_->url());
  const httplib::Result stream = client.Get("/mcp", with(session, "Accept", "text/event-stream"));
  EXPECT_EQ(status(stream), 405);
  EXPECT_EQ(stream->get_header_value("Allow"), "POST, DELETE");
  EXPECT_EQ(status(client.Put("/mcp", session, ping, kType)), 405);
  EXPECT_EQ(status(client.Post("/", session, ping, kType)), 404);
  EXPECT_EQ(status(client.Post("/mcp", session, ping, "text/plain")), 415);
  EXPECT_EQ(status(client.Post("/mcp", session, ping, "application/json; charset=utf-8")), 200);
  EXPECT_EQ(status(post(ping, with(session, "Accept", "text/html"))), 406);
  EXPECT_EQ(status(post(ping, with(session, "Accept", "application/json, text/event-stream"))), 200);
  EXPECT_EQ(status(post(ping, with(session, "MCP-Protocol-Version", "2025-06-18"))), 200);
  EXPECT_EQ(status(post(ping, with(session, "MCP-Protocol-Version", "1999-01-01"))), 400);
}

TEST_F(HttpTransportTest, MalformedMessagesAreRefused) {
  const httplib::Headers session = begin();
  for (const auto& [body, code] : std::vector<std::pair<std::string, int>>{
           {"", -32700},
           {"{", -32700},
           {std::string(100000, '['), -32700},
           {R"({"jsonrpc": "2.0", "id": 1, "method": "ping", "params": )" + std::string(200, '[') +
                std::string(200, ']') + "}",
            -32700},
           {"7", -32600},
           {R"({"jsonrpc": "1.0", "id": 1, "method": "ping"})", -32600},
           {R"({"jsonrpc": "2.0", "id": {}, "method": "ping"})", -32600}}) {
    const httplib::Result result = post(body, session);
    EXPECT_EQ(status(result), 400) << body.substr(0, 80);
    EXPECT_EQ(error(result), code) << body.substr(0, 80);
  }
}

TEST_F(HttpTransportTest, BatchesAreForTheRevisionThatHasThem) {
  const Json batch = {message_of("ping"),
                      {{"jsonrpc", "2.0"}, {"method", "notifications/initialized"}},
                      message_of("tools/delete")};
  EXPECT_EQ(error(post(batch.dump(), begin("2025-06-18"))), -32600);
  const httplib::Headers session = begin("2025-03-26");
  const httplib::Result result = post(batch.dump(), session);
  ASSERT_EQ(status(result), 200);
  const Json replies = parse_json(result->body, "replies");
  ASSERT_EQ(replies.size(), 2U) << "a notification has no reply";
  EXPECT_EQ(replies[0]["result"], Json::object());
  EXPECT_EQ(replies[1]["error"]["code"], -32601);
  EXPECT_EQ(status(post(Json::array({batch[1]}).dump(), session)), 202);
  EXPECT_EQ(error(post("[]", session)), -32600);
  EXPECT_EQ(error(post(Json(std::vector<Json>(51, batch[0])).dump(), session)), -32600);
}

TEST_F(HttpTransportTest, WhoHasNoTokenIsRefusedAndSoIsWhatIsTooLarge) {
  const std::string ping = message_of("ping").dump();
  EXPECT_EQ(status(post(ping, {{"Origin", "http://example.org"}})), 403);
  EXPECT_EQ(status(post(ping, {{"Host", "example.org"}})), 403);
  const std::filesystem::path token = folder_ / "token";
  write_file_atomically(token, "0123456789abcdef\n");
  serve({.max_mb = 0.01, .token_file = token.string()});
  const std::string hello = message_of("initialize", {{"protocolVersion", "2025-06-18"}}).dump();
  EXPECT_EQ(status(post(hello)), 401);
  EXPECT_EQ(status(post(hello, {{"Authorization", "Bearer 0123456789abcdee"}})), 401);
  const httplib::Headers right = {{"Authorization", "Bearer 0123456789abcdef"}};
  EXPECT_EQ(status(post(hello, with(right, "Origin", "http://127.0.0.1"))), 403);
  const httplib::Result begun = post(hello, right);
  ASSERT_EQ(status(begun), 200);
  const httplib::Headers session = {{"Mcp-Session-Id", begun->get_header_value("Mcp-Session-Id")}};
  EXPECT_EQ(status(post(ping, session)), 401) << "a session is no secret";
  EXPECT_EQ(status(post(std::string(20000, ' ') + ping, right)), 413);
}

TEST_F(HttpTransportTest, SlowClientsDelayNobody) {
  serve({.request_s = 30, .connections = 8});
  std::list<RawConnection> slow;
  for (int i = 0; i < 40; ++i)
    slow.emplace_back(http_->port())
        .send("POST /mcp HTTP/1.1\r\nHost: localhost\r\nContent-Length: 50\r\n\r\n{");
  const Stopwatch watch;
  EXPECT_EQ(status(post(message_of("ping").dump(), begin())), 200);
  EXPECT_LT(watch.seconds(), 10) << "far less than the time limit of the slow ones";
}

TEST_F(HttpTransportTest, AnswersManyAtOnce) {
  const Json call = call_of("where", {{"object", "object_1"}}),
             words = call_of("ask", {{"question", "What is on table_1?"}});
  LineTransport lines(*server_);
  const auto expected = std::pair(lines.reply(call.dump()), lines.reply(words.dump()));
  std::vector<std::thread> clients;
  std::vector<int> wrong(8, 0);
  for (int& mistakes : wrong)
    clients.emplace_back([&] {
      const httplib::Headers session = begin();
      for (int i = 0; i < 10; ++i) {
        mistakes += post(call.dump(), session)->body != expected.first;
        mistakes += post(words.dump(), session)->body != expected.second;
      }
    });
  for (std::thread& client : clients) client.join();
  EXPECT_THAT(wrong, ::testing::Each(0));
}

TEST_F(HttpTransportTest, EditsOfManyTakeTurns) {
  store_.reset();
  serve({}, true);
  std::vector<std::thread> clients;
  std::vector<int> done(6, 0);
  for (size_t i = 0; i < done.size(); ++i)
    clients.emplace_back([&, i] {
      const Json said = call_of(
          "edit-say", {{"about", "table_1"}, {"key", "alias"}, {"value", "bench " + std::to_string(i)}});
      const Json reply = parse_json(post(said.dump(), begin())->body, "reply");
      done[i] = reply["result"]["isError"] == false;
    });
  for (std::thread& client : clients) client.join();
  EXPECT_THAT(done, ::testing::Each(1));
  EXPECT_EQ(ask(Store::open_read(file_), FactsQuestion{.about = "table_1"}).facts.size(), done.size());
}

TEST_F(HttpTransportTest, NothingIsWritten) {
  const std::string before = read_file(file_);
  const httplib::Headers session = begin();
  EXPECT_EQ(error(post(call_of("edit-undo", Json::object()).dump(), session)), -32602);
  post(call_of("objects", Json::object()).dump(), session);
  EXPECT_EQ(read_file(file_), before);
}

}  // namespace
}  // namespace loci::memory
