// The tool server and a client that others wrote.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "tests/cli/command.h"

namespace loci::apps::test {
namespace {

using testing::Contains;
using testing::HasSubstr;

/// Starts `loci-memory serve --mcp --http 0 OPTIONS` with its address in $url, runs `body`, and sends Ctrl-C;
/// the last line of stderr says how the server ended. The exit code is that of `body`.
Outcome run_with_server(const std::string& folder, const std::string& options, const std::string& body) {
  const std::string out = folder + "/address";
  return run("loci-memory serve --mcp --http 0 " + options + " > " + out +
             " & server=$!\n"
             "for i in $(seq 200); do [ -s " +
             out +
             " ] && break; sleep 0.05; done\n"
             "url=$(cut -d ' ' -f 3 " +
             out + ")\n" + body +
             "\ncode=$?; kill -INT $server; wait $server; echo \"the server ended with $?\" >&2; exit $code");
}

/// The memory of the sample's detections.
std::string sample_memory(const std::string& folder) {
  const std::string memory = folder + "/m.loci";
  EXPECT_EQ(run("loci-memory ingest apps/samples/detections.jsonl -m " + memory).exit_code, 0);
  return memory;
}

/// The protocol's own client.
class McpSdk : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fresh_folder();
    if (run("npm install --no-audit --no-fund --prefix " + folder_ + " @modelcontextprotocol/sdk@1")
            .exit_code != 0)
      GTEST_SKIP() << "needs npm and its registry";
    std::filesystem::copy(std::filesystem::path(LOCI_SOURCE_DIR) / "tests/cli/mcp_client.mjs", folder_);
    memory_ = sample_memory(folder_);
  }
  /// What every transport has to bring.
  static void expect_answers(const Json& seen) {
    EXPECT_EQ(seen["server"], "loci-memory");
    EXPECT_THAT(seen["tools"], Contains("was"));
    EXPECT_EQ(seen["unknown"], true);
    EXPECT_THAT(seen["asked"].get<std::string>(), HasSubstr("object_1"));
    EXPECT_THAT(seen["resources"], Contains("loci://object/object_1"));
    EXPECT_EQ(seen["templates"], 3);
    EXPECT_TRUE(seen["about"].is_object());
    EXPECT_EQ(seen["refused"], -32002);
  }

  std::string folder_, memory_;
};

TEST_F(McpSdk, GetsItsAnswersOverStandardInput) {
  const Outcome outcome =
      run("node " + folder_ + "/mcp_client.mjs stdio \"$(command -v loci-memory)\" " + memory_);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  expect_answers(parse_json(outcome.out, "client"));
}

TEST_F(McpSdk, GetsItsAnswersOverHttp) {
  const std::string token = folder_ + "/token";
  write_file_atomically(token, "0123456789abcdef\n");
  const Outcome outcome = run_with_server(folder_, "--token-file " + token + " -m " + memory_,
                                          "node " + folder_ + "/mcp_client.mjs http $url 0123456789abcdef");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const Json seen = parse_json(outcome.out, "client");
  expect_answers(seen);
  EXPECT_EQ(seen["version"], "2025-11-25");
  EXPECT_EQ(seen["session"], 32);
  EXPECT_EQ(seen["together"], true);
  EXPECT_EQ(seen["stranger"], 401);
  EXPECT_EQ(seen["ended"], true);
  EXPECT_THAT(outcome.error, HasSubstr("the server ended with 0"));
}

TEST(Mcp, EndsWithCtrlCAlsoWhileAClientHangs) {
  const std::string folder = fresh_folder();
  const Outcome outcome =
      run_with_server(folder, "-m " + sample_memory(folder),
                      "port=${url##*:}; bash -c \"exec 3<>/dev/tcp/127.0.0.1/${port%/mcp}; printf 'POST "
                      "/mcp' >&3; cat <&3\" & "
                      "sleep 0.5");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_THAT(outcome.error, HasSubstr("the server ended with 0"));
}

TEST(Mcp, OtherMachinesNeedAToken) {
  const std::string folder = fresh_folder(), memory = sample_memory(folder);
  const Outcome refused = run("loci-memory serve --mcp --http 0.0.0.0:0 -m " + memory);
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.error, HasSubstr("--token-file"));
  EXPECT_EQ(run("loci-memory serve --mcp --token-file x -m " + memory).exit_code, 2) << "not without --http";
  EXPECT_EQ(run("loci-memory serve --mcp --http nowhere -m " + memory).exit_code, 1);
}

TEST(Mcp, ServesUntilTheClientLeaves) {
  const std::string memory = sample_memory(fresh_folder());
  const Outcome outcome =
      run(R"(printf '{"jsonrpc":"2.0","id":1,"method":"ping"}\n\n{"jsonrpc":"2.0","id":"b","method":"ping"}')"
          " | loci-memory serve --mcp -m " +
          memory);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_EQ(
      outcome.out,
      "{\"jsonrpc\":\"2.0\",\"id\":1,\"result\":{}}\n{\"jsonrpc\":\"2.0\",\"id\":\"b\",\"result\":{}}\n");
}

}  // namespace
}  // namespace loci::apps::test
