// The workflow of docs/many-recordings.md: recordings, memories, one merged memory.

#include <gtest/gtest.h>

#include "mapping/base/text/json.h"
#include "tests/cli/command.h"

namespace loci::apps::test {
namespace {

TEST(ManyRecordings, ArePerceivedSideBySideAndMerged) {
  if (run("snakemake --version").exit_code != 0) GTEST_SKIP() << "snakemake is not installed";
  const std::string folder = fresh_folder();
  for (const std::string day : {"01", "02"}) {
    const Outcome recorded = run("sed -e 's/2026-05-02T/2026-06-" + day +
                                 "T/' -e \"s#kitchen.urdf#$PWD/apps/samples/kitchen.urdf#\" "
                                 "apps/samples/cups.yaml > '" +
                                 folder + "/day.yaml' && loci-simulate record '" + folder +
                                 "/day.yaml' -o '" + folder + "/recordings/day " + day + "' --quiet");
    ASSERT_EQ(recorded.exit_code, 0) << recorded.error;
  }
  const std::string command = "XDG_CACHE_HOME='" + folder +
                              "/cache' snakemake -s docs/examples/recordings/Snakefile -d '" + folder +
                              "' --cores 2 --config recordings='" + folder + "/recordings' map=\"$PWD/" +
                              "apps/samples/kitchen.urdf\" memory=home.loci";
  const Outcome made = run(command);
  ASSERT_EQ(made.exit_code, 0) << made.error;
  const auto scenes = [&](const std::string& memory) {
    return parse_json(run("loci-memory stat --json -m '" + folder + "/" + memory + "'").out, memory)
        .at("tables")
        .at("scene")
        .at("rows")
        .get<int>();
  };
  EXPECT_GT(scenes("memories/day 01.perceived.loci"), 0);
  EXPECT_EQ(scenes("home.loci"),
            scenes("memories/day 01.perceived.loci") + scenes("memories/day 02.perceived.loci"));
  EXPECT_EQ(run("loci-memory verify -m '" + folder + "/home.loci'").exit_code, 0);
  const Outcome again = run(command);
  EXPECT_NE(again.error.find("Nothing to be done"), std::string::npos) << again.error;
}

}  // namespace
}  // namespace loci::apps::test
