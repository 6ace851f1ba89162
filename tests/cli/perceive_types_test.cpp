#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "tests/cli/command.h"

namespace loci::apps::test {
namespace {

using testing::HasSubstr;

TEST(PerceiveTypes, ListsOurTypes) {
  const Outcome outcome = run("loci-perceive types perception/types/belief.xml --json");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const Json json = parse_json(outcome.out, "answer");
  EXPECT_GT(json.at("types").get<int>(), 40);
  EXPECT_THAT(run("loci-perceive types perception/types/scene.xml").out,
              HasSubstr("loci.scene.Scene : loci.core"));
}

TEST(PerceiveTypes, ListsAUsersTypesWithOurs) {
  EXPECT_EQ(run("loci-perceive types tests/data/climate.xml").exit_code, 0);
  EXPECT_THAT(run("loci-perceive types tests/data/climate.xml --with-loci").out,
              HasSubstr("loci.belief.Object"));
}

TEST(PerceiveTypes, TakesFoldersForImportsBeforeAndAfterTheFile) {
  const std::string folder = fresh_folder();
  write_file_atomically(folder + "/user.xml",
                        "<typeSystemDescription><imports><import name=\"perception.types.core\"/></imports>"
                        "</typeSystemDescription>");
  EXPECT_EQ(run("loci-perceive types " + folder + "/user.xml").exit_code, 1);
  EXPECT_EQ(run("loci-perceive types " + folder + "/user.xml --path .").exit_code, 0);
  EXPECT_EQ(run("loci-perceive types --path /tmp --path . " + folder + "/user.xml").exit_code, 0);
}

TEST(PerceiveTypes, RefusesBadOnesInOneLineWithFileAndLine) {
  const std::string folder = fresh_folder();
  const std::vector<std::pair<std::string, std::string>> table = {
      {"<typeSystemDescription><types>\n<typeDescription><name>A</name><supertypeName>B</supertypeName>"
       "</typeDescription>\n<typeDescription><name>B</name><supertypeName>A</supertypeName></typeDescription>"
       "</types></typeSystemDescription>",
       "inherits from itself"},
      {"<typeSystemDescription><types>\n<typeDescription><name>A</name><supertypeName>Nothing</supertypeName>"
       "</typeDescription></types></typeSystemDescription>",
       "unknown type Nothing"},
      {"<typeSystemDescription>\n<types>", "well-formed"},
      {"<robot/>", "typeSystemDescription"},
  };
  for (const auto& [xml, expected] : table) {
    write_file_atomically(folder + "/bad.xml", xml);
    const Outcome outcome = run("loci-perceive types " + folder + "/bad.xml");
    EXPECT_EQ(outcome.exit_code, 1) << xml;
    EXPECT_EQ(lines_of(outcome.error), 1) << outcome.error;
    EXPECT_THAT(outcome.error, HasSubstr(expected));
    EXPECT_THAT(outcome.error, testing::ContainsRegex("bad.xml:[0-9]+"));
    EXPECT_EQ(outcome.out, "");
  }
  EXPECT_EQ(run("loci-perceive types " + folder + "/none.xml").exit_code, 1);
  EXPECT_EQ(run("loci-perceive types").exit_code, 2);
}

TEST(PerceiveTypes, ListsTypeSystemsOfOtherProjects) {
  LOCI_NEEDS_SHARED("data/uima_types");
  const Outcome outcome =
      run("loci-perceive types " + shared("data/uima_types/robosherlock/scene_types.xml"));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr("uima.cas.FSList of rs.core.Annotation"));
}

}  // namespace
}  // namespace loci::apps::test
