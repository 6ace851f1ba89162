// Bad input: one clear line on stderr, exit code 1, and nothing lost. A table: input → what the line must
// say.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "mapping/base/files.h"
#include "mapping/image/image_io.h"
#include "tests/cli/command.h"

namespace loci::apps::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using namespace std::string_literals;

void expect_refused(const std::string& command, const std::vector<std::string>& parts) {
  const Outcome outcome = run(command);
  EXPECT_EQ(outcome.exit_code, 1) << command << "\n" << outcome.out << outcome.error;
  EXPECT_EQ(lines_of(outcome.error), 1) << command << "\n" << outcome.error;
  for (const std::string& part : parts) EXPECT_THAT(outcome.error, HasSubstr(part)) << command;
}

class BadInput : public testing::Test {
 protected:
  void SetUp() override { folder_ = fresh_folder(); }
  std::string path(const std::string& name) const { return (fs::path(folder_) / name).string(); }
  std::string write(const std::string& name, const std::string& text) const {
    make_folder(fs::path(path(name)).parent_path());
    write_file_atomically(path(name), text);
    return path(name);
  }
  /// A recording of two small frames, as the simulator makes it.
  std::string recording() const {
    const std::string scenario = write("two.yaml", R"(
world: )" LOCI_SOURCE_DIR R"(/apps/samples/kitchen.urdf
scenes:
  - {time: "2026-05-01T07:00:00Z", view: {from: [1.5, 1.5, 1.5], at: [0.5, 2.5, 0.8]}}
  - {time: "2026-05-01T08:00:00Z", view: {from: [1.5, 1.5, 1.5], at: [0.5, 2.5, 0.8]}}
)");
    const Outcome outcome = run("loci-simulate record " + scenario + " --quiet -o " + path("rec"));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    return path("rec");
  }
  std::string folder_;
};

struct Case {
  const char* name;
  const char* urdf;
  std::vector<std::string> says;
};

class BadUrdf : public testing::TestWithParam<Case> {};

TEST_P(BadUrdf, IsRefusedWithTheReason) {
  const std::string file = fresh_folder() + "/bad.urdf";
  write_file_atomically(file, GetParam().urdf);
  expect_refused("loci-map check " + file, GetParam().says);
}

const std::vector<Case> kBadUrdfs = {
    {"NotXml", "hello", {"bad.urdf"}},
    {"Empty", "", {"bad.urdf"}},
    {"Cycle",
     R"(<robot name="r"><link name="a"/><link name="b"/>
        <joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint>
        <joint name="k" type="fixed"><parent link="b"/><child link="a"/></joint></robot>)",
     {"bad.urdf", "cycle"}},
    {"MissingParent",
     R"(<robot name="r"><link name="b"/>
        <joint name="j" type="fixed"><parent link="nowhere"/><child link="b"/></joint></robot>)",
     {"nowhere", "j"}},
    {"TwoRoots",
     R"(<robot name="r"><link name="first"/><link name="second"/></robot>)",
     {"first", "second", "root"}},
    {"NanSize",
     R"(<robot name="r"><link name="a"><visual><geometry><box size="nan 1 1"/></geometry></visual></link></robot>)",
     {"bad.urdf", "a"}},
    {"NegativeRadius",
     R"(<robot name="r"><link name="a"><visual><geometry><sphere radius="-1"/></geometry></visual></link></robot>)",
     {"bad.urdf", "a"}},
    {"DuplicateLink", R"(<robot name="r"><link name="twin"/><link name="twin"/></robot>)", {"twin"}}};

INSTANTIATE_TEST_SUITE_P(Urdf, BadUrdf, testing::ValuesIn(kBadUrdfs),
                         [](const auto& case_info) { return std::string(case_info.param.name); });

TEST_F(BadInput, MissingFile) {
  expect_refused("loci-map check " + path("none.urdf"), {"none.urdf", "no such file"});
  expect_refused("loci-perceive info " + path("none"), {"none"});
  expect_refused("loci-memory objects -m " + path("none.loci"), {"none.loci"});
  expect_refused("loci-simulate record " + path("none.yaml") + " -o " + path("out"), {"none.yaml"});
  expect_refused("loci-memory resolve " + path("none.json"), {"none.json"});
  expect_refused("loci-perceive list -m " + path("none.loci"), {"none.loci", "no such file"});
  expect_refused("loci-perceive describe ColorName -m " + path("none.loci"), {"none.loci", "no such file"});
}

TEST_F(BadInput, EmptyFolder) {
  make_folder(path("empty"));
  expect_refused("loci-perceive info " + path("empty"), {"empty"});
  expect_refused("loci-map fuse " + path("empty") + " -o " + path("scans"), {"empty"});
  expect_refused("loci-map interpret " + path("empty") + " -o " + path("map"), {"empty"});
}

TEST_F(BadInput, TruncatedImage) {
  const fs::path rec = recording();
  for (const auto& entry : fs::recursive_directory_iterator(rec))
    if (entry.path().string().find("depth") != std::string::npos && entry.path().extension() == ".png")
      fs::resize_file(entry.path(), fs::file_size(entry.path()) / 2);
  expect_refused("loci-perceive run " + rec.string() + " -m " + path("m.loci"), {".png"});
}

TEST_F(BadInput, AnEmptyDepthImageIsSaidAndTheRestIsSeen) {
  const fs::path rec = recording();
  for (const auto& entry : fs::recursive_directory_iterator(rec))
    if (entry.path().string().find("000001_depth") != std::string::npos)
      mapping::write_image(entry.path(), cv::Mat::zeros(480, 640, CV_16U));
  for (const std::string& map : {std::string(), " --map " LOCI_SOURCE_DIR "/apps/samples/kitchen.urdf"s}) {
    const Outcome outcome = run("loci-perceive run " + rec.string() + map);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    EXPECT_THAT(outcome.error, HasSubstr("frame 1: the depth image is empty")) << map;
    EXPECT_THAT(outcome.out, HasSubstr("2 frames"));
  }
}

TEST_F(BadInput, ANanPoseCostsItsFrameOnly) {
  const fs::path rec = recording();
  std::string csv = read_file(rec / "frames.csv");
  const size_t second = csv.find('\n', csv.find('\n') + 1) + 1;
  const size_t cell = csv.rfind(',', csv.find('\n', second) - 1) + 1;
  csv.replace(cell, csv.find('\n', second) - cell, "nan");
  write_file_atomically(rec / "frames.csv", csv);
  const Outcome outcome = run("loci-perceive info " + rec.string());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr("1 of 2 frames have no pose"));
  EXPECT_THAT(outcome.out, HasSubstr("frames.csv:3"));
}

TEST_F(BadInput, UnknownRecordingKeyIsNamedWithTheNearest) {
  const fs::path rec = recording();
  write_file_atomically(rec / "recording.yaml", read_file(rec / "recording.yaml") + "deph_scale: 0.001\n");
  expect_refused("loci-perceive info " + rec.string(), {"recording.yaml", "deph_scale", "depth_scale"});
}

TEST_F(BadInput, UnknownAnnotatorAndOptionAreNamedWithTheNearest) {
  const std::string rec = recording();
  const std::string annotator = write("a.yaml", "flow:\n  - NormalEstimater\n");
  expect_refused("loci-perceive run " + rec + " --pipeline " + annotator,
                 {"NormalEstimater", "NormalEstimator"});
  const std::string option = write("b.yaml", "flow:\n  - PlaneClusterExtractor: {tolerence_m: 0.02}\n");
  expect_refused("loci-perceive run " + rec + " --pipeline " + option,
                 {"b.yaml:2", "tolerence_m", "tolerance_m"});
  const std::string needs = write("c.yaml", "flow:\n  - ColorHistogram\n");
  expect_refused("loci-perceive run " + rec + " --pipeline " + needs,
                 {"ColorHistogram", "PlaneClusterExtractor"});
}

TEST_F(BadInput, TypeSystems) {
  const std::string begin =
      R"(<?xml version="1.0"?><typeSystemDescription xmlns="http://uima.apache.org/resourceSpecifier"><types>)";
  const std::string end = "</types></typeSystemDescription>";
  const auto type = [](const std::string& name, const std::string& super, const std::string& range) {
    return "\n<typeDescription><name>" + name + "</name><supertypeName>" + super +
           "</supertypeName><features><featureDescription><name>f</name><rangeTypeName>" + range +
           "</rangeTypeName></featureDescription></features></typeDescription>";
  };
  expect_refused(
      "loci-perceive types " + write("unknown.xml", begin + type("my.A", "uima.cas.TOP", "my.Missing") + end),
      {"unknown.xml:2", "my.Missing"});
  expect_refused(
      "loci-perceive types " + write("cycle.xml", begin + type("my.A", "my.B", "uima.cas.Integer") +
                                                      type("my.B", "my.A", "uima.cas.Integer") + end),
      {"cycle.xml", "my.A"});
  expect_refused("loci-perceive types " + write("broken.xml", begin + "<typeDescription>"), {"broken.xml"});
}

TEST_F(BadInput, DatabasesThatAreNone) {
  const std::string text =
      write("text.loci", "this is not a database, but long enough to look at its first bytes\n");
  expect_refused("loci-memory objects -m " + text, {"text.loci"});
  const std::string rec = recording();
  ASSERT_EQ(run("loci-perceive run " + rec + " --quiet -m " + path("m.loci")).exit_code, 0);
  fs::copy(path("m.loci"), path("cut.loci"));
  fs::resize_file(path("cut.loci"), fs::file_size(path("m.loci")) / 2 + 100);
  expect_refused("loci-memory verify -m " + path("cut.loci"), {"cut.loci"});
  // Byte 60 of an SQLite file is its user_version: 9000 is major version 9.
  std::string bytes = read_file(path("m.loci"));
  bytes[62] = static_cast<char>(9000 >> 8);
  bytes[63] = static_cast<char>(9000 & 0xff);
  write("new.loci", bytes);
  expect_refused("loci-memory objects -m " + path("new.loci"), {"new.loci", "9"});
  EXPECT_EQ(run("loci-memory verify -m " + path("m.loci")).exit_code, 0);
}

TEST_F(BadInput, MapsThatAreNoneLeaveNoMemoryBehind) {
  const std::string map = write("map.urdf", "no robot");
  expect_refused("loci-memory ingest " LOCI_SOURCE_DIR "/apps/samples/detections.jsonl -m " + path("i.loci") +
                     " --map " + map,
                 {"map.urdf"});
  expect_refused("loci-perceive run " + recording() + " -m " + path("r.loci") + " --map " + map,
                 {"map.urdf"});
  EXPECT_FALSE(fs::exists(path("i.loci")) || fs::exists(path("r.loci")));
}

TEST_F(BadInput, ATaxonomyThatNamesNothingDoesNotReplaceTheOldOne) {
  const std::string memory = path("m.loci");
  ASSERT_EQ(run("loci-memory ingest " LOCI_SOURCE_DIR "/apps/samples/detections.jsonl --quiet -m " + memory)
                .exit_code,
            0);
  ASSERT_EQ(
      run("loci-memory taxonomy load " LOCI_SOURCE_DIR "/apps/samples/household.yaml -m " + memory).exit_code,
      0);
  const std::string known = run("loci-memory taxonomy list -m " + memory).out;
  expect_refused("loci-memory taxonomy load " + write("empty.yaml", "") + " -m " + memory, {"empty.yaml"});
  EXPECT_EQ(run("loci-memory taxonomy list -m " + memory).out, known);
}

TEST_F(BadInput, MalformedVectors) {
  expect_refused("loci-memory resolve " + write("a.json", "{"), {"a.json"});
  expect_refused(
      "loci-memory resolve " +
          write("b.json",
                R"({"old": 1, "new": 1, "similar": [[2]], "proximity": [[0.5]], "out_of_view": [0]})"),
      {"b.json", "invalid_value"});
  expect_refused(
      "loci-memory resolve " +
          write("c.json",
                R"({"old": 1, "new": 1, "similar": [[0.5]], "proximity": [[0.5, 0.5]], "out_of_view": [0]})"),
      {"c.json", "invalid_shape"});
}

TEST_F(BadInput, FullDiskLosesNothing) {
  // A shell limit on the size of files stands for a full disk.
  ASSERT_EQ(run("loci-simulate record apps/samples/day.yaml --quiet -o " + path("rec")).exit_code, 0);
  ASSERT_EQ(run("loci-perceive run " + path("rec") + " --quiet -m " + path("m.loci")).exit_code, 0);
  const std::string before = read_file(path("m.loci"));
  const Outcome outcome =
      run("trap '' XFSZ; ulimit -f 8; loci-memory report -m " + path("m.loci") + " -o " + path("r.html"));
  EXPECT_EQ(outcome.exit_code, 1) << outcome.error;
  EXPECT_FALSE(fs::exists(path("r.html")));
  EXPECT_EQ(read_file(path("m.loci")), before);
}

}  // namespace
}  // namespace loci::apps::test
