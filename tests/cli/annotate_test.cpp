#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "mapping/base/text/json.h"
#include "tests/cli/command.h"

namespace loci::apps::test {
namespace {

using ::testing::HasSubstr;

/// The sample day in a memory, seen without names of colours.
class Annotate : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fresh_folder();
    memory_ = folder_ + "/memory.loci";
    std::ofstream(folder_ + "/p.yaml")
        << "flow: [NormalEstimator, KnownStructureFilter, PlaneClusterExtractor, GeometryAnnotator]\n";
    ASSERT_EQ(run("loci-simulate record apps/samples/day.yaml --quiet -o " + folder_ + "/day").exit_code, 0);
    const Outcome seen =
        run("loci-perceive run " + folder_ + "/day --quiet --map apps/samples/kitchen.urdf --every 4 " +
            "--pipeline " + folder_ + "/p.yaml -m " + memory_);
    ASSERT_EQ(seen.exit_code, 0) << seen.error;
  }
  Json annotate(const std::string& with) const {
    const Outcome outcome = run("loci-perceive annotate --json -m " + memory_ + " --annotator " + with);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    return parse_json(outcome.out, "annotate");
  }
  std::string folder_, memory_;
};

TEST_F(Annotate, LateAnnotationsBelongToTheOldClustersAndTheirObjects) {
  EXPECT_THAT(run("loci-memory where red -m " + memory_).out, ::testing::Not(HasSubstr("object_")));
  const Json first = annotate("ColorName");
  EXPECT_GT(first["annotations"].get<int>(), 0);
  EXPECT_EQ(first["annotations"], first["clusters"]);
  EXPECT_THAT(run("loci-memory where red -m " + memory_).out, HasSubstr("object_"));
  EXPECT_EQ(run("loci-memory verify -m " + memory_).exit_code, 0);
  // Who has answered is not asked again, unless that is wanted.
  EXPECT_EQ(annotate("ColorName")["clusters"], 0);
  EXPECT_EQ(annotate("ColorName --again")["clusters"], first["clusters"]);
}

TEST_F(Annotate, CloudsAreMadeOfThePointsThatWereKept) {
  const Outcome outcome = run("loci-perceive annotate -m " + memory_ + " --annotator GeometryAnnotator");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.error, HasSubstr("GeometryAnnotator needs view:cloud"));
  EXPECT_THAT(outcome.error, HasSubstr("put NormalEstimator before it"));
  EXPECT_EQ(lines_of(outcome.error), 1);
  const Json shapes = annotate("NormalEstimator --annotator \"PclFeature: {features: [GaussImage]}\"");
  EXPECT_GT(shapes["clusters"].get<int>(), 0);
  EXPECT_EQ(shapes["annotations"], shapes["clusters"]);
  const Json boxes = annotate("NormalEstimator --annotator GeometryAnnotator --again");
  EXPECT_EQ(boxes["annotations"], boxes["clusters"]);
  EXPECT_EQ(run("loci-memory verify -m " + memory_).exit_code, 0);
}

TEST_F(Annotate, ThingsThatStoodStillAreAskedAboutOnce) {
  const std::string alike = "PerceptualHash --annotator \"{unless_alike: {}, do: [ColorHistogram]}\"";
  const Json first = annotate(alike);
  EXPECT_EQ(first["annotations"], first["clusters"]);
  const Outcome told = run("loci-perceive describe ColorHistogram -m " + memory_);
  EXPECT_THAT(told.out, HasSubstr("clusters looked as before"));
  // Who has answered is not asked again, whatever stands around it.
  EXPECT_EQ(annotate(alike)["clusters"], 0);
}

TEST_F(Annotate, NothingIsAddedTwice) {
  annotate("ColorName");
  // An annotator that found nothing is asked again, those beside it are not.
  EXPECT_EQ(annotate("BarcodeReader --annotator ColorName")["annotations"], 0);
  EXPECT_EQ(annotate("ColorName --again")["annotations"], 0);
  EXPECT_GT(annotate("Relations")["annotations"].get<int>(), 0);
  EXPECT_EQ(annotate("Relations")["annotations"], 0);
  EXPECT_EQ(annotate("Relations --again")["annotations"], 0);
  EXPECT_EQ(run("loci-memory verify -m " + memory_).exit_code, 0);
}

TEST_F(Annotate, MakesNoMemory) {
  const Outcome outcome = run("loci-perceive annotate --annotator ColorName -m " + folder_ + "/absent.loci");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_FALSE(std::filesystem::exists(folder_ + "/absent.loci"));
}

}  // namespace
}  // namespace loci::apps::test
