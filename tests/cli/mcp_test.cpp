// The tool server and a client that others wrote.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "mapping/base/json.h"
#include "tests/cli/command.h"

namespace loci::apps::test {
namespace {

using testing::Contains;
using testing::HasSubstr;

TEST(Mcp, TheProtocolsOwnClientGetsItsAnswers) {
  const std::string folder = fresh_folder();
  if (run("npm install --no-audit --no-fund --prefix " + folder + " @modelcontextprotocol/sdk@1").exit_code !=
      0)
    GTEST_SKIP() << "needs npm and its registry";
  std::filesystem::copy(std::filesystem::path(LOCI_SOURCE_DIR) / "tests/cli/mcp_client.mjs", folder);
  const std::string memory = folder + "/m.loci";
  ASSERT_EQ(run("loci-memory ingest apps/samples/detections.jsonl -m " + memory).exit_code, 0);
  const Outcome outcome = run("node " + folder + "/mcp_client.mjs \"$(command -v loci-memory)\" " + memory);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const Json seen = parse_json(outcome.out, "client");
  EXPECT_EQ(seen["server"], "loci-memory");
  EXPECT_THAT(seen["tools"], Contains("was"));
  EXPECT_EQ(seen["unknown"], true);
  EXPECT_THAT(seen["asked"].get<std::string>(), HasSubstr("object_1"));
  EXPECT_THAT(seen["resources"], Contains("loci://object/object_1"));
  EXPECT_EQ(seen["templates"], 3);
  EXPECT_TRUE(seen["about"].is_object());
}

TEST(Mcp, ServesUntilTheClientLeaves) {
  const std::string folder = fresh_folder(), memory = folder + "/m.loci";
  ASSERT_EQ(run("loci-memory ingest apps/samples/detections.jsonl -m " + memory).exit_code, 0);
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
