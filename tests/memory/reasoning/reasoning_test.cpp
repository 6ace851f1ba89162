#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>

#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "memory/ingest/ingest.h"
#include "memory/reasoning/pair_matrices.h"
#include "memory/reasoning/reason.h"
#include "memory/reasoning/why.h"
#include "memory/recorder/checkpoint.h"
#include "memory/recorder/scene_reasoning.h"

namespace loci::memory {
namespace {

using testing::HasSubstr;

/// A mug and a box; the mug goes to the counter, then the box is gone.
const std::string kDay =
    R"({"time": "2026-05-01T08:00:00Z", "observed": [{"place": "table_1", "fraction": 1}], "detections": [)"
    R"({"position": [1, 2, 0.8], "size": [0.1, 0.1, 0.1], "color": [10, 0.9, 0.8], "class": {"mug": 0.9}, "place": "table_1"},)"
    R"({"position": [1.5, 2, 0.8], "size": [0.2, 0.1, 0.3], "color": [200, 0.9, 0.8], "class": {"box": 0.9}, "place": "table_1"}]})"
    "\n"
    R"({"time": "2026-05-01T09:00:00Z", "observed": [{"place": "counter_1", "fraction": 1}], "detections": [)"
    R"({"position": [3, 2, 0.9], "size": [0.1, 0.1, 0.1], "color": [12, 0.9, 0.8], "class": {"mug": 0.9}, "place": "counter_1"}]})"
    "\n"
    R"({"time": "2026-05-01T10:00:00Z", "observed": [{"place": "table_1", "fraction": 1}], "detections": []})"
    "\n";

class Reasoning : public testing::Test {
 protected:
  void SetUp() override {
    folder = std::filesystem::temp_directory_path() / fmt::format("loci_reasoning_{}", getpid());
    std::filesystem::remove_all(folder);
    make_folder(folder);
    std::ofstream(folder / "day.jsonl", std::ios::binary) << kDay;
    ingest(folder / "day.jsonl", folder / "memory.loci", {}, {}, progress, warnings);
  }
  void TearDown() override { std::filesystem::remove_all(folder); }

  Store memory() const { return Store::open_read(folder / "memory.loci"); }
  HistoryDifference anew(const belief::BeliefOptions& options) {
    const std::filesystem::path other = folder / "other.loci";
    std::filesystem::remove(other);
    reason(memory(), other, options, {}, progress);
    return compare_histories(memory(), Store::open_read(other));
  }

  std::filesystem::path folder;
  NoProgress progress;
  Warnings warnings;
};

TEST_F(Reasoning, EvidenceComesBackAsItWasTold) {
  const Store store = memory();
  const auto scenes = store.scenes();
  const auto reasoning = load_reasoning(store, scenes[0].id);
  ASSERT_TRUE(reasoning);
  EXPECT_EQ(reasoning->evidence.time, scenes[0].time);
  EXPECT_NEAR(reasoning->evidence.seconds_to_next.value_or(0), 3600, 1e-6);
  ASSERT_EQ(reasoning->evidence.observations.size(), 2U);
  EXPECT_EQ(reasoning->evidence.observations[1].box.size, Vector3d(0.2, 0.1, 0.3));
  EXPECT_EQ(reasoning->evidence.observations[0].place, "table_1");
}

/// As version 1 of the belief wrote it: its number is the last field.
std::string of_version_one(std::string bytes) {
  EXPECT_EQ(bytes.substr(bytes.size() - 3), "\xA0\x06\x02");
  bytes.back() = 1;
  return bytes;
}

TEST_F(Reasoning, WhatAnotherVersionBelievedIsComputedAgain) {
  {
    Store store = Store::open_write(folder / "memory.loci");
    SceneTransaction rows(store, store.begin_run("test", "{}"));
    for (const auto& [name, checkpoint] : store.checkpoints("belief"))
      rows.set_checkpoint(name, of_version_one(checkpoint.bytes), checkpoint.scene);
    rows.commit();
    SQLite::Database database((folder / "memory.loci").string(), SQLite::OPEN_READWRITE);
    for (const SceneRow& scene : store.scenes()) {
      SQLite::Statement change(database, "UPDATE reasoning SET encoding = 0, content = ? WHERE scene = ?");
      const std::string bytes = of_version_one(*store.reasoning(scene.id));
      change.bind(1, bytes.data(), static_cast<int>(bytes.size()));
      change.bind(2, scene.id);
      change.exec();
    }
  }
  const std::optional<Error> unreadable = unreadable_belief(memory());
  ASSERT_TRUE(unreadable);
  EXPECT_THAT(unreadable->message(), HasSubstr("another version of loci wrote it"));
  EXPECT_THAT(unreadable->hint(), HasSubstr("loci-memory reason -m "));
  EXPECT_TRUE(anew({}).observations.empty());
  EXPECT_FALSE(unreadable_belief(Store::open_read(folder / "other.loci")));
}

TEST_F(Reasoning, ProbabilitiesOfADecisionSumToOne) {
  const Store store = memory();
  for (const SceneRow& scene : store.scenes()) {
    const std::optional<SceneReasoning> reasoning = load_reasoning(store, scene.id);
    ASSERT_TRUE(reasoning);
    for (const belief::ObservationDecision& d : reasoning->decisions.observations) {
      double sum = d.appear + d.clutter;
      for (const belief::Candidate& candidate : d.candidates) sum += candidate.probability();
      EXPECT_NEAR(sum, 1, 0.05);
    }
  }
}

TEST_F(Reasoning, WhyAnObjectIsWhereItIs) {
  const Store store = memory();
  const Why why = why_object(store, 1);
  EXPECT_EQ(why.json.at("last_seen").at("explanation"), "move");
  const Json& candidates = why.json.at("last_seen").at("candidates");
  EXPECT_EQ(candidates.at(0).at("object"), "object_1");
  EXPECT_GT(candidates.at(0).at("evidence").at("mean_color").at("log_ratio"), 0);
  EXPECT_TRUE(candidates.at(0).at("against").is_null());
  ASSERT_EQ(candidates.size(), 2U);
  EXPECT_TRUE(candidates.at(1).at("against").is_string()) << "the box is no mug";
}

TEST_F(Reasoning, WhyAnObjectIsGone) {
  const Store store = memory();
  const Why why = why_object(store, 2);
  EXPECT_EQ(why.json.at("since").at("explanation"), "disappear");
  EXPECT_GT(why.json.at("since").at("place").at("searched"), 0.9);
  const Why before = why_object(store, 2, {.at = parse_time("2026-05-01T09:30:00Z")});
  EXPECT_FALSE(before.json.contains("since")) << "nobody had looked";
}

TEST_F(Reasoning, MatricesOfASceneAreKeptWithIt) {
  const Store store = memory();
  const auto matrices = pair_matrices(store, store.scenes()[1].id);
  ASSERT_TRUE(matrices);
  ASSERT_EQ(matrices->rows.size(), 1U) << "the mug on the counter";
  ASSERT_EQ(matrices->columns.size(), 2U);
  EXPECT_EQ(matrices->columns[0].name, "object_1");
  EXPECT_NEAR(matrices->distance(0, 0), Vector3d(2, 0, 0.1).norm(), 1e-3);
  EXPECT_GT(matrices->similar(0, 0), 0.9);
  EXPECT_LT(matrices->similar(0, 1), 0.1) << "the box";
  EXPECT_GT(matrices->is(0, 0), 0.5);
  EXPECT_EQ(matrices->rows[0].column, 0U);
  for (const PairMatrices::Kind& kind : matrices->kinds)
    EXPECT_LE(kind.distance(0, 0), kind.distance(0, 1) + 1e-9) << kind.name;
  const Json json = why_scene(store, store.scenes()[1].id).json.at("matrices");
  EXPECT_EQ(json.at("objects").size(), 2U);
  EXPECT_EQ(json.at("annotations").at("mean_color").at("distance").at(0).size(), 2U);
}

TEST_F(Reasoning, WhyOfWhatIsUnknownSaysSo) {
  const Store store = memory();
  EXPECT_THROW(why_object(store, 99), Error);
  EXPECT_THROW(why_object(store, 1, {.at = parse_time("2026-05-01T07:00:00Z")}), Error);
  EXPECT_THROW(why_scene(store, 99), Error);
}

TEST_F(Reasoning, OneThingIsInOnePlace) {
  belief::Decisions decisions;
  decisions.observations.resize(2);
  decisions.observations[0].key = 7;
  decisions.observations[0].probability = 0.9F;
  belief::Candidate candidate;
  candidate.key = 7;
  EXPECT_THAT(belief::rejection_reason(decisions, 1, candidate), HasSubstr("it is observation 0"));
}

TEST_F(Reasoning, TheSameParametersMakeTheSameHistory) {
  const HistoryDifference difference = anew({});
  EXPECT_EQ(difference.compared, 3U);
  EXPECT_TRUE(difference.observations.empty());
  for (const auto& [kind, counts] : difference.events) EXPECT_EQ(counts.first, counts.second) << kind;
}

TEST_F(Reasoning, OtherParametersMakeAnotherHistoryThatCanBeCompared) {
  belief::BeliefOptions nobody_home;
  nobody_home.move_time_s = 1e9;
  const HistoryDifference difference = anew(nobody_home);
  EXPECT_EQ(difference.observations.size(), 1U) << "the mug on the counter is another one";
  EXPECT_EQ(difference.objects_second, 3U);
  EXPECT_EQ(difference.events.at("appeared"), std::pair(size_t{2}, size_t{3}));
}

TEST_F(Reasoning, WhatIsSaidOfPlacesComesAlong) {
  {
    Store store = Store::open_write(folder / "memory.loci");
    FactRow fact{.place = store.places().front().id, .key = "alias", .value = "breakfast table"};
    store.add_fact(fact, store.begin_run("test", "{}"));
  }
  anew({});
  const Store other = Store::open_read(folder / "other.loci");
  const std::vector<FactRow> facts = other.facts();
  ASSERT_EQ(facts.size(), 1U);
  EXPECT_EQ(facts[0].value, "breakfast table");
  EXPECT_EQ(facts[0].place, other.places().front().id);
}

TEST_F(Reasoning, WhatIsSaidOfObjectsGoesWithThem) {
  {
    Store store = Store::open_write(folder / "memory.loci");
    const Id run = store.begin_run("test", "{}");
    store.add_fact({.object = 2, .key = "alias", .value = "muesli"}, run);
    store.add_fact({.object = 1, .key = "owner", .value = "Ada"}, run);
  }
  belief::BeliefOptions nobody_home;
  nobody_home.move_time_s = 1e9;  // the mug on the counter is another one
  const ReasonResult result = reason(memory(), folder / "other.loci", nobody_home, {}, progress);
  EXPECT_EQ(result.facts, 2U);
  EXPECT_TRUE(result.unplaced.empty());
  const Store other = Store::open_read(folder / "other.loci");
  for (const FactRow& fact : other.facts())
    EXPECT_EQ(other.observations_of(*fact.object).front().observation.number, fact.key == "alias" ? 1 : 0);
}

TEST_F(Reasoning, CorrectionsHoldAfterwards) {
  // Nobody is home: without the correction the mug on the counter is another one.
  belief::BeliefOptions nobody_home;
  nobody_home.move_time_s = 1e9;
  const Id here = memory().observations(1).at(0).id, there = memory().observations(2).at(0).id;
  reason(memory(), folder / "other.loci", nobody_home, {}, progress, {{here, 7}, {there, 7}});
  const Store other = Store::open_read(folder / "other.loci");
  EXPECT_EQ(other.objects().size(), 2U);
  EXPECT_EQ(other.observations_of(1).size(), 2U);
  KnownIdentities known;
  for (const RunRow& run : other.runs()) read_identities(parse_json(run.configuration, "run"), known);
  EXPECT_EQ(known.size(), 2U);
}

/// Three equal mugs on the table; at nine one stands on the counter, at ten `missing` is not on the table.
std::string three_mugs(size_t missing) {
  const auto mugs = [](const std::vector<double>& at, const char* place) {
    std::string list;
    for (const double x : at)
      list +=
          fmt::format(R"({}{{"position": [{}, 2, 0.8], "size": [0.1, 0.1, 0.1], "color": [10, 0.9, 0.8], )"
                      R"("place": "{}"}})",
                      list.empty() ? "" : ", ", x, place);
    return list;
  };
  std::vector<double> all = {1, 1.4, 1.8}, left = all;
  left.erase(left.begin() + static_cast<std::ptrdiff_t>(missing));
  const auto scene = [](int hour, const char* place, const std::string& detections) {
    return fmt::format(
        R"({{"time": "2026-05-01T{:02}:00:00Z", "observed": [{{"place": "{}", "fraction": 1}}], )"
        R"("detections": [{}]}})"
        "\n",
        hour, place, detections);
  };
  return scene(8, "table_1", mugs(all, "table_1")) + scene(9, "counter_1", mugs({4}, "counter_1")) +
         scene(10, "table_1", mugs(left, "table_1")) + scene(11, "counter_1", mugs({4}, "counter_1"));
}

TEST_F(Reasoning, ALaterLookDecidesWhichOfEqualObjectsWasMoved) {
  size_t changed = 0;
  for (size_t missing = 0; missing < 3; ++missing) {
    SCOPED_TRACE(missing);
    const std::filesystem::path file = folder / fmt::format("mugs_{}.loci", missing);
    std::ofstream(folder / "mugs.jsonl", std::ios::binary) << three_mugs(missing);
    ingest(folder / "mugs.jsonl", file, {}, {}, progress, warnings);
    const Store store = Store::open_read(file);
    const Id moved = static_cast<Id>(missing) + 1;  // they appeared in the order of the file
    EXPECT_EQ(store.observations_of(moved).size(), 3U) << "on the table once, on the counter twice";
    EXPECT_EQ(store.beliefs().size(), 3U);
    EXPECT_TRUE(store.verify(progress).problems.empty());
    const TimeNs half_past = parse_time("2026-05-01T09:30:00Z");
    const auto belief = store.belief(moved, {.at = half_past});
    ASSERT_TRUE(belief);
    EXPECT_NEAR(belief->position->x(), 4, 1e-6);
    if (belief->clock.source != "hindsight") continue;
    ++changed;
    const auto before = store.belief(moved, {.at = half_past, .known_at = belief->clock.known_from - 1});
    ASSERT_TRUE(before);
    EXPECT_LT(before->position->x(), 2) << "what was believed before can still be asked";
  }
  EXPECT_EQ(changed, 2U) << "one of three guesses was right";
}

TEST_F(Reasoning, OverwritesNothing) {
  EXPECT_THROW(reason(memory(), folder / "memory.loci", {}, {}, progress), Error);
}

}  // namespace
}  // namespace loci::memory
