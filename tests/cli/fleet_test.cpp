// A memory in PostgreSQL in the programs: named by its URL it is read as the robot's file is.

#include <gmock/gmock.h>

#include <filesystem>

#include "mapping/base/text/json.h"
#include "tests/cli/command.h"
#include "tests/support/postgres_server.h"

namespace loci::apps::test {
namespace {

using testing::HasSubstr;

class FleetCli : public testing::Test {
 protected:
  void SetUp() override {
    std::string why_not;
    server_ = loci::testing_support::PostgresServer::start(why_not);
    if (!server_) GTEST_SKIP() << why_not;
    server_->create_database("loci");
    folder_ = fresh_folder();
    file_ = folder_ + "/robot.loci";
    url_ = "'" + server_->url("loci") + "'";
    memory_ = "'" + server_->url("loci", "postgres", "&robot=r1") + "'";
    expect_works("loci-memory ingest apps/samples/detections.jsonl -m '" + file_ + "'");
    expect_works("loci-memory push " + url_ + " --robot r1 -m '" + file_ + "'");
  }
  Outcome run_here(const std::string& command) const {
    return run("export XDG_CACHE_HOME='" + folder_ + "/cache'; " + command);
  }
  std::string expect_works(const std::string& command) const {
    const Outcome outcome = run_here(command);
    EXPECT_EQ(outcome.exit_code, 0) << command << "\n" << outcome.error;
    return outcome.out;
  }

  std::unique_ptr<loci::testing_support::PostgresServer> server_;
  std::string folder_, file_, url_, memory_;
};

TEST_F(FleetCli, EveryProgramReadsItByItsUrl) {
  for (const char* question :
       {"objects", "where mug", "on table_1", "changes", "timeline", "ask 'Where is the mug?'", "digest",
        "why object_1", "report -o {}", "stat", "catalogue export {}"}) {
    const auto command = [&](const std::string& memory, const std::string& output) {
      std::string text = std::string("loci-memory ") + question + " -m " + memory;
      if (const size_t at = text.find("{}"); at != std::string::npos)
        text.replace(at, 2, "'" + folder_ + output + "'");
      return text;
    };
    const std::string of_file = expect_works(command("'" + file_ + "'", "/of_file"));
    const std::string of_url = expect_works(command(memory_, "/of_url"));
    const bool prints = std::string_view(question).find("{}") == std::string_view::npos;
    if (prints && question != std::string_view("stat")) {
      EXPECT_EQ(of_url, of_file) << question;
    }
  }
  expect_works("loci-memory verify -m " + memory_);
  expect_works("loci-memory export -o '" + folder_ + "/exported' -m " + memory_);
  expect_works("loci-memory backup -o '" + folder_ + "/backup.loci' -m " + memory_);
  expect_works("loci-memory edit say object_1 owner me -m '" + folder_ + "/backup.loci'");
  expect_works("LOCI_MEMORY=" + memory_ + " loci-memory objects");
  EXPECT_THAT(
      expect_works(
          R"(echo '{"jsonrpc": "2.0", "id": 1, "method": "tools/call", "params": {"name": "objects", )"
          R"("arguments": {}}}' | loci-memory serve --mcp -m )" +
          memory_),
      HasSubstr("object_1"));
  const std::string python = LOCI_BIN_DIR "/../python";
  if (run("ls '" + python + "'/loci/_loci*.so").exit_code == 0) {
    const std::string printed = expect_works("PYTHONPATH='" + python +
                                             "' /usr/bin/python3 -c 'import loci, sys; "
                                             "print(loci.open(sys.argv[1]).objects(), end=\"\")' " +
                                             memory_);
    EXPECT_THAT(printed, HasSubstr("object_4"));
    EXPECT_THAT(expect_works("loci-memory objects --details -m '" + file_ + "'"), testing::EndsWith(printed));
  }
}

TEST_F(FleetCli, NothingIsWrittenThroughIt) {
  for (const char* command :
       {"edit say object_1 owner me", "forget object_1", "reason -o none.loci", "retain --keep-images 1d",
        "serve --mcp --allow-edits", "ingest apps/samples/detections.jsonl"}) {
    const Outcome outcome =
        run_here(std::string("loci-memory ") + command + " -m " + memory_ + " < /dev/null");
    EXPECT_NE(outcome.exit_code, 0) << command;
    EXPECT_EQ(lines_of(outcome.error), 1) << command << "\n" << outcome.error;
  }
}

TEST_F(FleetCli, FollowsTheFileAndForgets) {
  expect_works("loci-memory edit say object_1 owner Quigley -m '" + file_ + "'");
  const Json pushed =
      parse_json(expect_works("loci-memory push " + url_ + " --robot r1 --json -m '" + file_ + "'"), "");
  EXPECT_EQ(pushed.at("added_by_table").at("fact"), 1);
  EXPECT_THAT(expect_works("loci-memory fact list -m " + memory_), HasSubstr("Quigley"));
  expect_works("loci-memory forget object_1 --tokens '" + folder_ + "/tokens.json' -m '" + file_ + "'");
  expect_works("loci-memory push " + url_ + " --robot r1 -m '" + file_ + "'");
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // a replica is trusted for a second
  EXPECT_THAT(expect_works("loci-memory verify --forgotten '" + folder_ + "/tokens.json' -m " + memory_),
              HasSubstr("None of"));
}

}  // namespace
}  // namespace loci::apps::test
