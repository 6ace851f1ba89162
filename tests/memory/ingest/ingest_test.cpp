#include "memory/ingest/ingest.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

#include "mapping/base/files.h"
#include "mapping/base/math/random.h"
#include "mapping/base/text/text.h"
#include "memory/ingest/detections.h"
#include "memory/questions/location.h"
#include "memory/questions/presence.h"
#include "memory/questions/question.h"
#include "memory/questions/replies/reply.h"
#include "tests/memory/recorder/memory_dump.h"

namespace loci::memory {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string moment(const std::string& time, const std::string& detections, const std::string& more = {}) {
  return fmt::format("{{\"time\": \"2026-05-01T{}Z\", \"detections\": [{}]{}}}\n", time, detections, more);
}
const std::string kMug = R"({"position": [1, 2, 0.8], "class": {"mug": 0.9}, "place": "table_1"})";
const std::string kBox = R"({"position": [1.5, 2, 0.8], "class": {"box": 0.9}, "place": "table_1"})";
const std::string kLooked = R"(, "observed": [{"place": "table_1", "fraction": 0.9}])";

IngestOptions strict() {
  IngestOptions options;
  options.strict = true;
  return options;
}
IngestOptions resume() {
  IngestOptions options;
  options.resume = true;
  return options;
}

class Ingest : public testing::Test {
 protected:
  void SetUp() override {
    folder = std::filesystem::temp_directory_path() / fmt::format("loci_ingest_{}", getpid());
    std::filesystem::remove_all(folder);
    make_folder(folder);
  }
  void TearDown() override { std::filesystem::remove_all(folder); }

  std::filesystem::path write(const std::string& text, const std::string& name = "detections.jsonl") const {
    std::ofstream(folder / name, std::ios::binary) << text;
    return folder / name;
  }
  IngestResult take(const std::filesystem::path& file, const IngestOptions& options = {},
                    const std::string& memory = "memory.loci") {
    return ingest(file, folder / memory, options, {}, progress, warnings);
  }
  Store memory() const { return Store::open_read(folder / "memory.loci"); }
  std::vector<std::string> events() const {
    std::vector<std::string> kinds;
    for (const EventRow& event : memory().events()) kinds.push_back(to_text(event.kind));
    return kinds;
  }

  std::filesystem::path folder;
  NoProgress progress;
  Warnings warnings;
};

TEST_F(Ingest, NeedsOnlyTimeAndPosition) {
  const auto file = write(moment("08:00:00", R"({"position": [1, 2, 0.8]})") +
                          moment("08:10:00", R"({"position": [1.003, 2, 0.8]})"));
  EXPECT_EQ(take(file).scenes, 2U);
  const Store store = memory();
  ASSERT_EQ(store.objects().size(), 1U);
  EXPECT_EQ(store.observations_of(1).size(), 2U);
  const ObservationRow row = store.observation(1);
  EXPECT_FALSE(row.size || row.hsv || row.place);  // missing, not zero
  EXPECT_EQ(store.objects().front().clock.source, "ingest");
  EXPECT_THAT(store.verify(progress).problems, IsEmpty());
}

TEST_F(Ingest, WhatIsFoundAtItsSpotHasNotMovedThoughNoViewIsStated) {
  const std::string mug = R"({"position": [1, 2, 0.8], "class": "mug", "size": [0.1, 0.1, 0.1]})";
  const std::string milk = R"({"position": [1.4, 2, 0.8], "class": "milk", "size": [0.1, 0.1, 0.25]})";
  const std::string moved = R"({"position": [2.4, 2, 0.8], "class": "milk", "size": [0.1, 0.1, 0.25]})";
  take(write(moment("08:00:00", mug + "," + milk) + moment("09:00:00", mug + "," + milk) +
             moment("10:00:00", mug + "," + milk) + moment("11:00:00", mug + "," + moved) +
             moment("12:00:00", mug + "," + moved)));
  EXPECT_THAT(events(), ElementsAre("appeared", "appeared", "moved"));
}

TEST_F(Ingest, LinesAreReadWhateverTheFileIsCalled) {
  const IngestResult result = take(write(moment("08:00:00", kMug) + moment("08:10:00", ""), "lines.json"));
  EXPECT_THAT(result.summary(), testing::StartsWith("2 scenes with 1 detection added;"));
}

TEST_F(Ingest, AnAbsentFileIsNotTakenForImages) {
  try {
    take(folder / "absent.json");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("absent.json: no such file"));
  }
}

TEST_F(Ingest, WhatNobodyLookedAtIsNotDeclaredGone) {
  std::string text = moment("08:00:00", kMug + "," + kBox);
  for (int minute = 10; minute < 40; ++minute) text += moment(fmt::format("08:{}:00", minute), "");
  take(write(text));
  EXPECT_THAT(events(), ElementsAre("appeared", "appeared"));
  EXPECT_EQ(memory().beliefs().front().status, ObjectStatus::out_of_view);
}

TEST_F(Ingest, WhatIsMissedWhereSomebodyLookedIsGone) {
  std::string text = moment("08:00:00", kMug + "," + kBox);
  for (int minute = 10; minute < 20; ++minute) text += moment(fmt::format("08:{}:00", minute), kBox, kLooked);
  take(write(text));
  EXPECT_THAT(events(), ElementsAre("appeared", "appeared", "gone"));
  const Store store = memory();
  const TimeNs from = parse_time("2026-05-01T08:15:00Z"), to = parse_time("2026-05-01T08:19:00Z");
  EXPECT_EQ(ask(store, WasQuestion{.subject = "mug", .place = "table_1", .from = from, .to = to}).verdict,
            Verdict::no);
  EXPECT_EQ(ask(store, WhereQuestion{.subject = "box"}).objects.front().place->name, "table_1");
}

TEST_F(Ingest, ClassesTellThingsApartThatChangePlaces) {
  const std::string mug = R"({"position": [1.5, 2, 0.8], "class": {"mug": 0.95}, "place": "table_1"})";
  const std::string box = R"({"position": [1, 2, 0.8], "class": {"box": 0.95}, "place": "table_1"})";
  take(write(moment("08:00:00", kMug + "," + kBox) + moment("09:00:00", mug + "," + box)));
  const Store store = memory();
  ASSERT_EQ(store.objects().size(), 2U);
  for (const auto& [name, x] : {std::pair{"mug", 1.5}, {"box", 1.0}})
    EXPECT_NEAR(ask(store, WhereQuestion{.subject = name}).objects.front().position->x(), x, 0.01) << name;
}

TEST_F(Ingest, BadLinesAreNamedAndSkipped) {
  const std::vector<std::pair<std::string, std::string>> bad = {
      {"{\"time\": \"2026-05-01T08:00:01Z\", \"detections\": [{\"text\": [\"\xff\xfe\"], \"position\": [1, "
       "2, 3]}]}",
       "invalid UTF-8"},
      {R"({"time": "2026-05-01T08:00:01Z", "detections": [{"position": [NaN, 2, 3]}]})",
       "detections[0].position: must be a finite number, is NaN"},
      {R"({"time": "2026-05-01T08:00:01Z", "detections": [{"position": [1, 2, 3], "class": NaN}]})",
       "class: must be text, is NaN"},
      {R"({"time": "2026-05-01T08:00:01Z", "detections": [], "note": NaN)", "not valid JSON at byte"},
      {R"({"time": "2026-05-01T08:00:01Z"})", "has no 'detections'; [] says that nothing was detected"},
      {R"({"time": "2026-05-01T08:00:01Z", "detection": []})", "write 'detections' instead of 'detection'"},
      {R"({"time": "2026-05-01T08:00:01Z", "detections": [{"position": [1e999, 2, 3]}]})", "too large"},
      {R"({"time": "2026-05-01T08:00:01Z", "detections": [{"position": [null, 2, 3]}]})", "must be a number"},
      {R"({"time": "2026-05-01T08:00:01Z", "detections": [{"class": "mug"}]})", "has no position"},
      {R"({"time": "soon", "detections": []})", "soon"},
      {R"({"time": "2200-05-01T08:00:01Z", "detections": []})", "is not a time"},
      {R"({"detections": []})", "has no time"},
      {R"({"time": "2026-04-01T08:00:01Z", "detections": []})", "lies before"},
      {"[1, 2", "not valid JSON: it is cut off at byte 6"},
      {"7", "not a JSON object"},
      {"{\"time\": \"2026-05-01T08:00:01Z\", \"x\": " + std::string(1000, '['), "nested too deeply"},
      {R"({"time": "2026-05-01T08:00:01Z", "detections": [{"position": [1, 2, 3], "color": [0, 2, 0]}]})",
       "saturation"},
      {R"({"time": "2026-05-01T08:00:01Z", "detections": [{"position": [1, 2, 3], "color": [255, 0, 0]}]})",
       "convert RGB to HSV"}};
  std::string text = moment("08:00:00", kMug);
  for (const auto& [line, reason] : bad) text += line + "\n";
  for (int minute = 10; minute < 40; ++minute) text += moment(fmt::format("09:{}:00", minute), kMug);
  const auto file = write(text);
  const IngestResult result = take(file);
  EXPECT_EQ(result.scenes, 31U);
  EXPECT_EQ(result.bad, bad.size());
  ASSERT_EQ(warnings.texts().size(), bad.size());
  for (size_t i = 0; i < bad.size(); ++i) {
    EXPECT_THAT(warnings.texts()[i], HasSubstr(fmt::format("detections.jsonl:{}", i + 2)));
    EXPECT_THAT(warnings.texts()[i], HasSubstr(bad[i].second));
  }
  try {
    take(file, strict(), "strict.loci");
    FAIL() << "bad lines were taken";
  } catch (const Error& error) {
    EXPECT_EQ(error.location().line, 2);
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "strict.loci"));
}

TEST_F(Ingest, FilesOfOtherFormatsAreRefused) {
  const std::string row =
      R"({"object":"object_1","time":"2026-05-01T07:10:00Z","scene":1,"place":"counter_1","x":1.2,"y":2.7})";
  const std::string scenes =
      "[" + trimmed(moment("08:00:00", kMug)) + "," + trimmed(moment("09:00:00", kMug)) + "]";
  const std::vector<std::tuple<std::string, std::string, std::string>> others = {
      {row + "\n" + row + "\n", "rows.jsonl",
       "2 of 2 lines are bad, nothing is added; it looks like a table"},
      {moment("08:00:00", kMug) + row + "\n" + row + "\n", "mixed.jsonl", "2 of 3 lines are bad"},
      {"0 0.5 0.5 0.1 0.1\n1 0.2 0.2 0.1 0.1 0.9\n", "yolo.txt", "looks like YOLO"},
      {"time,x,y\n2026,1,2\n", "table.csv", "one JSON object per line is expected"},
      {scenes, "scenes.json", "write one scene per line"},
      {scenes, "scenes.jsonl", "write one scene per line"},
      {"[\n" + scenes + "\n", "cut.json", "cut.json:3: is not valid JSON: it is cut off at byte"},
      {R"({"images": [], "annotations": [{"image_id": 1}], "categories": []})", "coco.txt",
       "call it *.json"}};
  for (const auto& [text, name, reason] : others) try {
      take(write(text, name));
      ADD_FAILURE() << name << " was taken";
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr(reason));
      EXPECT_FALSE(std::filesystem::exists(folder / "memory.loci"));
    }
}

TEST_F(Ingest, WhatNoOtherSceneConfirmsIsReported) {
  const auto file = write(moment("08:00:00", kMug + "," + kBox) + moment("08:00:01", kMug, kLooked) +
                          moment("08:00:02", kMug, kLooked));
  const IngestResult result = take(file);
  EXPECT_EQ(memory().objects().size(), 1U);
  EXPECT_EQ(result.unconfirmed, 1);
  EXPECT_THAT(result.summary(), HasSubstr("4 detections added, 1 of them not confirmed by other scenes"));

  const IngestResult single =
      take(write(moment("08:00:00", kMug) + moment("08:00:01", "", kLooked)), {}, "single.loci");
  EXPECT_EQ(single.unconfirmed, 1);
  const Store store = Store::open_read(folder / "single.loci");
  const Query query{.question = "objects"};
  const Answer answer = ask(store, query, {});
  EXPECT_EQ(full_text(find_question("objects")->reply(store, query, answer), answer, TimeWriter(store)),
            "No objects are known: 1 observation is not confirmed by another scene.\n");
}

TEST_F(Ingest, MessagesCallTheFileAsTheCallerDoes) {
  IngestOptions options;
  options.called = "detections";
  take(write(moment("08:00:00", kMug) + moment("08:10:00", R"({"position": [1, 2]})") +
             moment("08:20:00", kMug)),
       options);
  EXPECT_THAT(warnings.texts(), ElementsAre(testing::StartsWith("detections:2: detections[0].position")));
}

TEST_F(Ingest, TwoScenesAtOneTimeAreBothKeptAndRepeatedLinesOnce) {
  const std::string first = moment("08:00:00", kMug), second = moment("08:00:00", kBox);
  const IngestResult result = take(write(first + first + second));
  EXPECT_EQ(result.scenes, 2U);
  EXPECT_EQ(result.repeated, 1U);
  EXPECT_THAT(memory().verify(progress).problems, IsEmpty());
}

TEST_F(Ingest, SameFileIsRecognisedAndOneThatHasGrownGoesOn) {
  std::string text = moment("08:00:00", kMug) + moment("08:10:00", kMug);
  take(write(text));
  EXPECT_THROW(take(write(text)), Error);
  const std::string before = memory_dump(folder / "memory.loci");
  EXPECT_EQ(take(write(text), resume()).scenes, 0U);
  EXPECT_EQ(memory_dump(folder / "memory.loci"), before);
  EXPECT_EQ(take(write(text + moment("08:20:00", kMug)), resume()).scenes, 1U);
  EXPECT_EQ(memory().scenes().size(), 3U);
}

TEST_F(Ingest, ResumeTakesASecondSceneWithAnEqualStamp) {
  const std::string first = moment("08:00:00", kMug), second = moment("08:00:00", kBox);
  take(write(first));
  EXPECT_EQ(take(write(first + second), resume()).scenes, 1U);
  EXPECT_EQ(memory().scenes().size(), 2U);
  EXPECT_EQ(take(write(first + second), resume()).scenes, 0U);
}

TEST_F(Ingest, ResumeKnowsARepeatedLineAgain) {
  const std::string first = moment("08:00:00", kMug), second = moment("08:10:00", kBox);
  take(write(first + first + second));
  const IngestResult again = take(write(first + first + second), resume());
  EXPECT_EQ(again.scenes, 0U);
  EXPECT_EQ(again.repeated, 1U);
  EXPECT_EQ(again.bad, 0U);
}

TEST_F(Ingest, LongLinesAreNotHeld) {
  const auto file = write("short\n" + std::string(3000, 'x') + "\nlast");
  LineReader reader(file, 1000);
  std::string line;
  EXPECT_EQ(reader.next(line), LineReader::Status::line);
  EXPECT_EQ(reader.next(line), LineReader::Status::too_long);
  EXPECT_LT(line.capacity(), 1000U);
  EXPECT_EQ(reader.next(line), LineReader::Status::line);
  EXPECT_EQ(line, "last");
  EXPECT_EQ(reader.number(), 3);
  EXPECT_EQ(reader.next(line), LineReader::Status::end);
}

TEST_F(Ingest, NoiseIsEstimatedFromWhatStays) {
  Random random(7);
  PositionNoise noise;
  for (int n = 0; n < 100; ++n) {
    DetectedScene scene;
    for (int i = 0; i < 5; ++i) {
      Detection detection;
      // One of five is somewhere else each time.
      detection.position = i == 0 ? Vector3d(random.uniform(-3, 3), -3, 0) : Vector3d(i, 0, 0);
      for (int axis = 0; axis < 3; ++axis) detection.position[axis] += 0.03 * random.normal();
      scene.detections.push_back(detection);
    }
    noise.add(scene);
  }
  ASSERT_TRUE(noise.sigma_m());
  EXPECT_NEAR(*noise.sigma_m(), 0.03, 0.003);
}

TEST_F(Ingest, KilledAtAnyMomentItGoesOnAsIfItHadNotBeen) {
  Random random(3);
  std::string text;
  for (int n = 0; n < 200; ++n) {
    std::string detections;
    for (int i = 0; i < 4; ++i)
      detections += fmt::format(R"({}{{"position": [{}, 1, 0.8], "place": "table_1"}})", i > 0 ? "," : "",
                                i + 0.01 * random.normal());
    text += fmt::format(R"({{"time": "{}", "detections": [{}]{}}})",
                        format_time((1'800'000'000 + 60 * n) * kSecond), detections, kLooked) +
            "\n";
  }
  const auto file = write(text);
  take(file, {}, "whole.loci");
  size_t kills = 0;
  for (int attempt = 0; attempt < 8; ++attempt) {
    const pid_t child = fork();
    if (child == 0) {
      try {
        take(file, resume());
      } catch (...) {
        _exit(1);
      }
      _exit(0);
    }
    usleep(static_cast<useconds_t>(random.uniform(5'000, 60'000)));
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    kills += WIFSIGNALED(status) ? 1 : 0;
  }
  EXPECT_GT(kills, 0U);
  take(file, resume());
  EXPECT_THAT(memory().verify(progress).problems, IsEmpty());
  EXPECT_EQ(memory_dump(folder / "memory.loci"), memory_dump(folder / "whole.loci"));
}

}  // namespace
}  // namespace loci::memory
