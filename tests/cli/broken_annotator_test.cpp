// A plugin's annotator that throws, hangs or says what is no number, under each policy.

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>

#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "tests/cli/command.h"

namespace loci::apps::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

struct Failure {
  const char* name;
  const char* how;   ///< options of the step
  const char* says;  ///< what the line on stderr must say
};

class BrokenAnnotator : public testing::TestWithParam<Failure> {
 protected:
  /// Three frames of the sample kitchen, the second of which is one too many for the annotator.
  static void SetUpTestSuite() {
    // Of each process its own: ctest runs each test in one.
    folder() = (fs::temp_directory_path() / ("loci_broken_" + std::to_string(::getpid()))).string();
    fs::create_directories(folder());
    const std::string view = R"(, view: {from: [2.0, 1.70, 1.45], at: [2.0, 0.62, 0.74]}})";
    write_file_atomically(
        fs::path(folder()) / "three.yaml",
        "world: " LOCI_SOURCE_DIR
        "/apps/samples/kitchen.urdf\nobjects:\n"
        "  milk: {model: bottle, color: [0.9, 0.9, 0.9]}\nscenes:\n"
        "  - {time: \"2026-05-01T07:00:00Z\", do: [{place: milk, on: table_1, at: [0, 0]}]" +
            view + "\n  - {time: \"2026-05-01T08:00:00Z\"" + view + "\n  - {time: \"2026-05-01T09:00:00Z\"" +
            view + "\n");
    const Outcome outcome =
        run("loci-simulate record " + folder() + "/three.yaml --quiet -o " + folder() + "/three");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  }
  static void TearDownTestSuite() { fs::remove_all(folder()); }
  static std::string& folder() {
    static std::string path;
    return path;
  }

  /// A run with a memory; `policy` beside the step.
  static Outcome with(const std::string& policy, const std::string& options = "") {
    const std::string pipeline = folder() + "/p.yaml";
    write_file_atomically(pipeline,
                          "flow:\n  - NormalEstimator\n  - KnownStructureFilter\n  - PlaneClusterExtractor\n"
                          "  - GeometryAnnotator\n  - {Broken: {frame: 1, how: " +
                              std::string(GetParam().how) + policy + "}\n");
    fs::remove(memory());
    return run("loci-perceive run " + folder() + "/three --json " + options +
               " --plugin " LOCI_BROKEN_PLUGIN " --map " + std::string(LOCI_SOURCE_DIR) +
               "/apps/samples/kitchen.urdf --pipeline " + pipeline + " -m " + memory());
  }
  static std::string memory() { return folder() + "/memory.loci"; }
  static void expect_sound_memory(int scenes) {
    const Outcome verified = run("loci-memory verify -m " + memory());
    EXPECT_EQ(verified.exit_code, 0) << verified.out << verified.error;
    const Json size = parse_json(run("loci-memory stat --json -m " + memory()).out, "stat");
    EXPECT_EQ(size["tables"]["scene"]["rows"], scenes) << size;
  }
};

TEST_P(BrokenAnnotator, EndsTheRunUnlessItsPolicySaysOtherwise) {
  const Outcome outcome = with("", "--quiet");
  EXPECT_EQ(outcome.exit_code, 1) << outcome.out;
  EXPECT_EQ(lines_of(outcome.error), 1) << outcome.error;
  EXPECT_THAT(outcome.error, HasSubstr("Broken failed at frame 1: "));
  EXPECT_THAT(outcome.error, HasSubstr(GetParam().says));
  expect_sound_memory(1);  // What came before is kept.
}

TEST_P(BrokenAnnotator, IsPassedOver) {
  const Outcome outcome = with(", on_error: skip");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_THAT(outcome.error, HasSubstr(GetParam().says));
  const Json answer = parse_json(outcome.out, "run");
  EXPECT_EQ(answer["frames"], 3);
  for (int frame = 0; frame < 3; ++frame) {
    const std::string clusters = answer["scenes"][frame]["clusters"].dump();
    EXPECT_THAT(clusters, HasSubstr("GeometryAnnotation"));
    if (frame == 1) {
      EXPECT_THAT(clusters, Not(HasSubstr("said"))) << "what it did is taken back";
    } else {
      EXPECT_THAT(clusters, HasSubstr("said"));
    }
  }
  expect_sound_memory(3);
}

TEST_P(BrokenAnnotator, LeavesOutTheScene) {
  const Outcome outcome = with(", on_error: skip_scene");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_THAT(outcome.error, HasSubstr(GetParam().says));
  const Json answer = parse_json(outcome.out, "run");
  EXPECT_EQ(answer["frames"], 2);
  EXPECT_EQ(answer["left_out"], 1);
  expect_sound_memory(2);
}

using BrokenAnnotatorOnce = BrokenAnnotator;

TEST_P(BrokenAnnotatorOnce, IsTriedAgain) {
  const Outcome outcome = with(", retry: 1");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const Json answer = parse_json(outcome.out, "run");
  EXPECT_EQ(answer["frames"], 3);
  const Json& clusters = answer["scenes"][1]["clusters"];
  ASSERT_FALSE(clusters.empty());
  for (const Json& cluster : clusters) {
    const std::string text = cluster.dump();
    EXPECT_EQ(text.find("said"), text.rfind("said")) << "what it did before it failed is taken back";
    EXPECT_NE(text.find("said"), std::string::npos) << text;
  }
  expect_sound_memory(3);
}

INSTANTIATE_TEST_SUITE_P(Once, BrokenAnnotatorOnce, testing::Values(Failure{"Throws", "throws_once}", ""}));

INSTANTIATE_TEST_SUITE_P(
    Ways, BrokenAnnotator,
    testing::Values(Failure{"Throws", "throws}", "the shelf is on fire"},
                    Failure{"ThrowsWhatIsNoException", "throws_an_int}", "an unknown exception"},
                    Failure{"Hangs", "hangs}, timeout_s: 0.3", "it took longer than 0.3 s"},
                    Failure{"SaysNoNumber", "nan}", "TextAnnotation.confidence is not a finite number"}),
    [](const auto& failure) { return std::string(failure.param.name); });

}  // namespace
}  // namespace loci::apps::test
