#include "mapping/http/http_server.h"

#include <gmock/gmock.h>
#include <httplib.h>

#include <filesystem>

#include "mapping/base/error.h"
#include "mapping/base/files.h"

namespace loci::mapping {
namespace {

using testing::HasSubstr;

TEST(HttpAddress, IsReadAsPeopleWriteIt) {
  const auto read = [](const std::string& text) {
    const HttpAddress address = read_http_address(text);
    return address.address + " " + std::to_string(address.port);
  };
  EXPECT_EQ(read("8642"), "127.0.0.1 8642");
  EXPECT_EQ(read("0"), "127.0.0.1 0");
  EXPECT_EQ(read("0.0.0.0:8642"), "0.0.0.0 8642");
  EXPECT_EQ(read("localhost:1"), "localhost 1");
  EXPECT_EQ(read("[::1]:8642"), "::1 8642");
  for (const char* text : {"", ":", ":8642", "localhost", "localhost:", "127.0.0.1:http", "127.0.0.1:65536",
                           "127.0.0.1:-1", "::1:8642", "[]:1", "http://127.0.0.1:8642"})
    EXPECT_THROW(read_http_address(text), Error) << text;
}

TEST(HttpServer, PassesHeadersBothWays) {
  const HttpServer server("127.0.0.1", 0, {}, [](const HttpRequest& request) {
    return HttpReply{202, "", "text/plain", {{"X-Seen", request.header("x-given") + request.header("none")}}};
  });
  httplib::Client client(server.url());
  const httplib::Result result = client.Get("/", {{"X-Given", "a, b"}});
  ASSERT_TRUE(result);
  EXPECT_EQ(result->status, 202);
  EXPECT_EQ(result->get_header_value("X-Seen"), "a, b");
  EXPECT_FALSE(result->has_header("Content-Type")) << "nothing has no type";
}

TEST(HttpServer, WebPagesAreRefusedAlsoWithTheToken) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "http_token.txt";
  write_file_atomically(file, "0123456789abcdef\n");
  const HttpServer server("127.0.0.1", 0, {.token_file = file.string()},
                          [](const HttpRequest&) { return HttpReply{}; });
  httplib::Client client(server.url());
  const auto status = [&](const httplib::Headers& headers) { return client.Get("/", headers)->status; };
  const std::pair<std::string, std::string> token = {"Authorization", "Bearer 0123456789abcdef"};
  EXPECT_EQ(status({token}), 200);
  EXPECT_EQ(status({token, {"Host", "kitchen.example.org"}}), 200)
      << "who has the token may call it anything";
  EXPECT_EQ(status({token, {"Origin", "http://example.org"}}), 403);
  EXPECT_EQ(status({token, {"Origin", "null"}}), 403);
  EXPECT_EQ(status({{"Origin", "http://example.org"}}), 401);
}

}  // namespace
}  // namespace loci::mapping
