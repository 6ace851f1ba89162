// Corrections of identities are evidence: whatever people say, and take back in whatever order, every answer
// at every time is what it was; and what was said holds in what is computed from it.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>
#include <random>
#include <set>

#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "memory/belief/serialization.h"
#include "memory/edits/edits.h"
#include "memory/edits/forget.h"
#include "memory/ingest/ingest.h"
#include "memory/questions/contents.h"
#include "memory/questions/events.h"
#include "memory/questions/facts.h"
#include "memory/questions/location.h"
#include "memory/questions/objects.h"
#include "memory/questions/presence.h"
#include "memory/reasoning/reason.h"
#include "memory/recorder/checkpoint.h"
#include "memory/recorder/scene_reasoning.h"
#include "memory/store/erasure/forgotten_tokens.h"
#include "memory/store/rows/merge.h"

namespace loci::memory {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kPlaces = 3;

/// A home in which cups and boxes of few colours are moved between looks at one place or two.
class RandomHome {
 public:
  explicit RandomHome(unsigned seed) : random_(seed) {
    for (int i = 0; i < 6; ++i) objects_.push_back({i % 3, random_place(), random_spot()});
  }

  /// The next scene, as a line of detections.
  std::string look() {
    minute_ += 5 + static_cast<int>(random_() % 90);
    for (Object& object : objects_)
      if (random_() % 5 == 0) object.place = random_place(), object.spot = random_spot();
    const int place = static_cast<int>(random_() % kPlaces);
    Json detections = Json::array();
    for (const Object& object : objects_) {
      if (object.place != place || random_() % 12 == 0) continue;
      const bool box = object.look == 2;
      std::normal_distribution<double> noise(0, 0.01);
      detections.push_back(
          {{"position", {3 * place + object.spot.x() + noise(random_), object.spot.y(), 0.9}},
           {"size", {0.1, 0.1, box ? 0.3 : 0.1}},
           {"color", {object.look * 110, 0.9, 0.8}},
           {"class", {{box ? "box" : "cup", 0.9}}},
           {"place", fmt::format("table_{}", place)}});
    }
    return Json{{"time", format_time(parse_time("2026-05-01T06:00:00Z") + minute_ * 60 * kSecond)},
                {"observed", {{{"place", fmt::format("table_{}", place)}, {"fraction", 1}}}},
                {"detections", detections}}
               .dump() +
           "\n";
  }

 private:
  struct Object {
    int look, place;
    Vector2d spot;
  };
  int random_place() { return static_cast<int>(random_() % (kPlaces + 1)); }  // one of them is never seen
  Vector2d random_spot() {
    return {0.25 * static_cast<double>(random_() % 5), 0.25 * static_cast<double>(random_() % 4)};
  }

  std::mt19937 random_;
  std::vector<Object> objects_;
  int64_t minute_ = 0;
};

class EditProperties : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / fmt::format("loci_edit_properties_{}", getpid());
    std::filesystem::remove_all(folder_);
    make_folder(folder_);
    file_ = folder_ / "memory.loci";
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void add_scenes(RandomHome& home, int count, const std::filesystem::path& memory) {
    std::vector<std::string> looks;
    for (int i = 0; i < count; ++i) looks.push_back(home.look());
    add_lines(looks, memory);
  }
  void add_lines(const std::vector<std::string>& looks, const std::filesystem::path& memory) {
    const std::filesystem::path lines = folder_ / fmt::format("{}.jsonl", ++files_);
    std::ofstream out(lines);
    for (const std::string& look : looks) out << look;
    out.close();
    IngestOptions options;
    options.noise_m = 0.01;
    ingest(lines, memory, options, {.now = ++known_ * kSecond}, silent_, warnings_);
  }

  template <class Change>
  auto edit(Change change) {
    Store store = Store::open_write(file_, {.now = ++known_ * kSecond});
    return change(store);
  }

  /// All answers at the time of every scene, and now.
  static std::string answers(const std::filesystem::path& memory) {
    const Store store = Store::open_read(memory);
    const Store::ReadTransaction reading(store);
    const TimeWriter times(store);
    std::vector<AsOf> moments = {{}};
    for (const SceneRow& scene : store.scenes()) moments.push_back({scene.time, {}});
    std::string all;
    for (const AsOf& moment : moments) {
      all += to_text(ask(store, ObjectsQuestion{{}, moment}), times);
      all += to_text(ask(store, ChangesQuestion{.as_of = moment}), times);
      for (const PlaceRow& place : store.places())
        all += to_json(ask(store, ContentsQuestion{place.name, moment, {}})).dump() + "\n";
      for (const BeliefRow& belief : store.beliefs(moment)) {
        all += to_json(ask(store, HistoryQuestion{.subject = object_name(belief.object), .as_of = moment}))
                   .dump();
        all += to_json(ask(store, WhereQuestion{object_name(belief.object), moment})).dump() + "\n";
      }
    }
    for (const FactRow& fact : store.facts())
      all += fmt::format("{} {} {}\n", *fact.object, fact.key, *fact.value);
    return all;
  }
  void expect_sound() { EXPECT_THAT(Store::open_read(file_).verify(silent_).problems, IsEmpty()); }
  static std::string belief_bytes(const std::filesystem::path& memory) {
    const Store store = Store::open_read(memory);
    std::string bytes;
    for (const auto& [name, checkpoint] : store.checkpoints("belief")) bytes += name + checkpoint.bytes;
    return bytes;
  }

  /// A random edit; whether there was one to make.
  bool random_edit(std::mt19937& random) {
    return edit([&](Store& store) {
      std::vector<Id> objects;
      for (const BeliefRow& belief : store.beliefs()) objects.push_back(belief.object);
      const Id one = objects[random() % objects.size()], other = objects[random() % objects.size()];
      try {
        switch (random() % 3) {
          case 0:
            merge_objects(store, one, other);
            break;
          case 1: {
            const std::vector<ObjectObservation> seen = store.observations_of(one);
            split_object(store, one, seen[random() % seen.size()].time);
            break;
          }
          default:
            say(store, object_name(one), random() % 2 ? "alias" : "owner",
                fmt::format("name{}", random() % 100));
        }
        return true;
      } catch (const Error&) {  // seen together, first seen then, itself
        return false;
      }
    });
  }

  std::filesystem::path folder_, file_;
  int files_ = 0;
  int64_t known_ = 1'800'000'000;
  NoProgress silent_;
  Warnings warnings_;
};

TEST_F(EditProperties, WhateverIsUndoneLeavesEveryAnswerAsItWas) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    std::filesystem::remove(file_);
    RandomHome home(seed);
    std::mt19937 random(100 + seed);
    add_scenes(home, 25, file_);
    std::vector<std::string> before = {answers(file_)}, undone;
    const std::string belief = belief_bytes(file_);
    for (int step = 0; step < 24; ++step) {
      const unsigned what = static_cast<unsigned>(random() % 4);
      if (what < 2) {
        if (!random_edit(random)) continue;
        before.push_back(answers(file_));
        undone.clear();
      } else if (what == 2 && before.size() > 1) {
        edit([](Store& store) { return undo(store); });
        undone.push_back(before.back());
        before.pop_back();
        ASSERT_EQ(answers(file_), before.back()) << "seed " << seed << " step " << step;
      } else if (what == 3 && !undone.empty()) {
        edit([](Store& store) { return redo(store); });
        before.push_back(undone.back());
        undone.pop_back();
        ASSERT_EQ(answers(file_), before.back()) << "seed " << seed << " step " << step;
      }
    }
    while (before.size() > 1) {
      edit([](Store& store) { return undo(store); });
      before.pop_back();
      ASSERT_EQ(answers(file_), before.back()) << "seed " << seed;
    }
    EXPECT_EQ(belief_bytes(file_), belief) << "what comes next is taken as if nothing had been said";
    expect_sound();
  }
}

TEST_F(EditProperties, WhatIsSaidHoldsNowAndLater) {
  int tried = 0;
  for (unsigned seed = 11; seed < 20 && tried < 3; ++seed) {
    std::filesystem::remove(file_);
    RandomHome home(seed);
    std::mt19937 random(seed);
    add_scenes(home, 20, file_);
    std::set<Id> one;
    for (int tries = 0; one.empty() && tries < 40; ++tries)
      edit([&](Store& store) {
        const std::vector<BeliefRow> beliefs = store.beliefs();
        const Id a = beliefs[random() % beliefs.size()].object, b = beliefs[random() % beliefs.size()].object;
        std::set<Id> all;
        for (const Id object : {a, b})
          for (const ObjectObservation& seen : store.observations_of(object)) all.insert(seen.observation.id);
        try {
          merge_objects(store, a, b);
          one = all;
        } catch (const Error&) {  // seen together
        }
        return 0;
      });
    if (one.empty()) continue;  // all were seen together
    ++tried;
    add_scenes(home, 5, file_);
    const auto expect_one = [&](const std::filesystem::path& file) {
      const Store store = Store::open_read(file);
      std::set<std::optional<Id>> objects;
      for (const SceneRow& scene : store.scenes())
        for (const AssociationRow& row : store.associations(scene.id))
          if (row.chosen && row.observation && one.contains(*row.observation)) objects.insert(row.object);
      EXPECT_EQ(objects.size(), 1U) << "seed " << seed;
    };
    expect_one(file_);
    // What is said later concerns it only where it says so.
    for (int i = 0; i < 4; ++i)
      edit([&](Store& store) {
        const std::vector<BeliefRow> beliefs = store.beliefs();
        const Id a = beliefs[random() % beliefs.size()].object, b = beliefs[random() % beliefs.size()].object;
        try {
          merge_objects(store, a, b);
        } catch (const Error&) {
        }
        return 0;
      });
    expect_one(file_);
    expect_sound();
  }
  EXPECT_EQ(tried, 3);
}

/// Scenes that come after an edit are taken in with it; when it is undone, as if it had not been.
TEST_F(EditProperties, UndoReachesScenesThatCameLater) {
  for (const unsigned seed : {21U, 22U}) {
    std::filesystem::remove(file_);
    const std::filesystem::path never = folder_ / "never.loci";
    std::filesystem::remove(never);
    RandomHome home(seed), same(seed);
    std::mt19937 random(seed);
    add_scenes(home, 15, file_);
    while (!random_edit(random)) {
    }
    add_scenes(home, 10, file_);
    edit([](Store& store) { return undo(store); });
    add_scenes(same, 15, never);
    add_scenes(same, 10, never);
    // Numbers of objects that were new after the edit may differ: what is where does not.
    const auto contents = [](const std::filesystem::path& memory) {
      const Store store = Store::open_read(memory);
      std::vector<std::string> all;
      for (const SceneRow& scene : store.scenes())
        for (const BeliefRow& row : store.beliefs({scene.time, {}}))
          all.push_back(fmt::format("{} {} {:.3f} {:.3f} {:.2f}", scene.id, row.place.value_or(0),
                                    row.position->x(), row.position->y(), row.probability));
      std::ranges::sort(all);
      return all;
    };
    EXPECT_EQ(contents(file_), contents(never)) << "seed " << seed;
    expect_sound();
  }
}

/// Every question that says where an object is says the same, at the time of every scene, corrected or not.
TEST_F(EditProperties, AllQuestionsAgreeOnWhereAnObjectIs) {
  for (const unsigned seed : {31U, 32U, 33U}) {
    std::filesystem::remove(file_);
    RandomHome home(seed);
    std::mt19937 random(seed);
    add_scenes(home, 20, file_);
    for (int i = 0; i < 4; ++i) random_edit(random);
    expect_sound();
    const Store store = Store::open_read(file_);
    for (const SceneRow& scene : store.scenes()) {
      const AsOf now{scene.time, {}};
      std::map<Id, std::set<Id>> listed;
      for (const PlaceRow& place : store.places()) {
        const ContentsAnswer on = ask(store, ContentsQuestion{place.name, now, {}});
        for (const ObjectBelief& one : on.places.at(0).there) listed[one.object.id].insert(place.id);
      }
      for (const ObjectBelief& object : ask(store, ObjectsQuestion{{}, now}).objects) {
        const std::string where_asked =
            fmt::format("seed {} scene {} {}", seed, scene.id, object.object.name);
        const ObjectBelief where = ask(store, WhereQuestion{object.object.name, now}).objects.at(0);
        EXPECT_EQ(where.status, object.status) << where_asked;
        EXPECT_EQ(where.probability, object.probability) << where_asked;
        ASSERT_TRUE(where.place && object.place) << where_asked;
        EXPECT_EQ(where.place->id, object.place->id) << where_asked;
        const bool gone = where.status == ObjectStatus::gone;
        EXPECT_EQ(listed[object.object.id], gone ? std::set<Id>() : std::set<Id>{where.place->id})
            << where_asked;
        const ObjectHistory history =
            ask(store, HistoryQuestion{.subject = object.object.name, .as_of = now}).objects.at(0);
        EXPECT_EQ(history.now.probability, where.probability) << where_asked;
        ASSERT_FALSE(history.stays.empty()) << where_asked;
        EXPECT_EQ(history.stays.back().place->id, where.place->id) << where_asked;
        EXPECT_EQ(history.now.last_seen->time, history.stays.back().scenes.back().time) << where_asked;
        for (const PlaceRow& place : store.places()) {
          const Verdict was =
              ask(store, WasQuestion{object.object.name, place.name, scene.time, scene.time, now})
                  .objects.at(0)
                  .verdict;
          const bool there = !gone && where.place->id == place.id && where.probability >= 0.5;
          EXPECT_FALSE(there ? was == Verdict::no : was == Verdict::yes)
              << where_asked << " on " << place.name;
        }
      }
    }
  }
}

/// What is forgotten takes the edits along that were about it; others stay, and whatever is undone then
/// leaves the memory sound.
TEST_F(EditProperties, ForgettingLeavesEditsOfOthers) {
  size_t left_edits = 0;
  for (unsigned seed = 41; seed < 53; ++seed) {
    SCOPED_TRACE(seed);
    std::filesystem::remove(file_);
    RandomHome home(seed);
    std::mt19937 random(seed);
    add_scenes(home, 18, file_);
    for (int step = 0; step < 12; ++step) {
      const unsigned what = static_cast<unsigned>(random() % 6);
      const std::vector<Edit> done = edits(Store::open_read(file_)).done;
      if (what < 3) {
        random_edit(random);
      } else if (what < 5 && !done.empty()) {
        edit([](Store& store) { return undo(store); });
      } else if (what == 5) {
        const std::vector<BeliefRow> beliefs = Store::open_read(file_).beliefs();
        if (beliefs.size() < 3) break;
        const Id object = beliefs[random() % beliefs.size()].object;
        const ForgetResult result = forget(file_, {.object = object});
        std::vector<std::string> texts;
        for (const Edit& still : edits(Store::open_read(file_)).done) texts.push_back(still.text);
        for (const Edit& one : done) {
          const bool is_about = std::ranges::any_of(result.object_ids, [&](Id id) {
            return (one.text + " ").find(object_name(id) + " ") != std::string::npos ||
                   one.text.find(object_name(id) + ":") != std::string::npos;
          });
          if (is_about) continue;
          EXPECT_THAT(texts, testing::Contains(one.text));
          ++left_edits;
        }
      }
      ASSERT_THAT(Store::open_read(file_).verify(silent_).problems, IsEmpty())
          << "step " << step << ": " << what;
    }
    while (!edits(Store::open_read(file_)).done.empty()) {
      edit([](Store& store) { return undo(store); });
      ASSERT_THAT(Store::open_read(file_).verify(silent_).problems, IsEmpty());
    }
  }
  EXPECT_GT(left_edits, 5U);
}

/// What is believed of objects at a time, without their numbers. Looks before a period are followed as they
/// were decided: rates learned from them differ a little from those of the probabilities.
std::multiset<std::string> believed(const Store& store, const AsOf& as_of) {
  std::multiset<std::string> all;
  std::map<Id, std::string> place_of;
  for (const PlaceRow& place : store.places()) place_of[place.id] = place.name;
  for (const BeliefRow& row : store.beliefs(as_of))
    all.insert(fmt::format("{} {} {} {:.1f}", to_text(row.status), row.probability >= 0.5,
                           row.place ? place_of[*row.place] : "",
                           row.position.value_or(Vector3d::Zero()).x()));
  return all;
}

/// The reasoning that `why` explains is that of the rows.
void expect_explained(const Store& store, const SceneRow& scene) {
  const std::optional<SceneReasoning> reasoning = load_reasoning(store, scene.id);
  ASSERT_TRUE(reasoning);
  std::map<Id, Id> objects;
  for (const AssociationRow& row : store.associations(scene.id))
    if (row.chosen && row.observation && row.probability > 0)
      objects[*row.observation] = row.object.value_or(0);
  for (size_t k = 0; k < reasoning->decisions.observations.size(); ++k)
    if (const Id decided = reasoning->decisions.observations[k].object; decided != 0) {
      EXPECT_EQ(decided, objects[reasoning->evidence.observations[k].id]);
    }
}

/// The looks that follow a forgotten period are believed as if nothing had been seen in it, and rows that
/// were computed from it are gone, not only superseded.
TEST_F(EditProperties, WhatFollowsAForgottenPeriodIsReasonedAnew) {
  size_t compared = 0;
  // Homes in which looking back over the later looks decides as looking back over all of them does.
  for (const unsigned seed : {71U, 73U, 74U, 75U, 76U}) {
    SCOPED_TRACE(seed);
    std::filesystem::remove(file_);
    RandomHome home(seed);
    std::vector<std::string> looks;
    for (int i = 0; i < 20; ++i) looks.push_back(home.look());
    add_lines(looks, file_);
    looks.erase(looks.begin() + 5, looks.begin() + 11);
    const std::filesystem::path never = folder_ / "never.loci";
    std::filesystem::remove(never);
    add_lines(looks, never);
    const std::vector<SceneRow> scenes = Store::open_read(file_).scenes();
    const ForgetResult result = forget(file_, {.from = scenes[5].time, .to = scenes[10].time});
    EXPECT_GT(result.observations, 0);
    expect_sound();
    EXPECT_THAT(find_forgotten(file_, result.tokens, silent_), IsEmpty());
    const Store store = Store::open_read(file_), other = Store::open_read(never);
    // Later looks may have corrected what was decided before the period.
    if (believed(store, {.at = scenes[4].time}) != believed(other, {.at = scenes[4].time})) continue;
    EXPECT_EQ(store.scenes_without_reasoning(), 0U) << "edits reason about what is left";
    for (size_t i = 11; i < scenes.size(); ++i) {
      EXPECT_EQ(believed(store, {.at = scenes[i].time}), believed(other, {.at = scenes[i].time})) << i;
      EXPECT_EQ(believed(store, {.at = scenes[i].time, .known_at = scenes[i].known_from}),
                believed(other, {.at = scenes[i].time}))
          << i << ", as it was known before";
      expect_explained(store, scenes[i]);
      ++compared;
    }
    EXPECT_EQ(believed(store, {}), believed(other, {}));
  }
  EXPECT_GT(compared, 30U);
}

/// What was forgotten does not come back by reasoning anew into another memory, and merging that with an
/// older copy.
TEST_F(EditProperties, WhatWasForgottenStaysForgottenInAMemoryReasonedAnew) {
  for (const unsigned seed : {81U, 82U, 83U}) {
    SCOPED_TRACE(seed);
    for (const char* name : {"memory", "older", "anew", "merged_1", "merged_2"})
      std::filesystem::remove(folder_ / fmt::format("{}.loci", name));
    const std::filesystem::path older = folder_ / "older.loci", anew = folder_ / "anew.loci";
    RandomHome home(seed);
    add_scenes(home, 16, file_);
    std::filesystem::copy_file(file_, older);
    const std::vector<SceneRow> scenes = Store::open_read(file_).scenes();
    const Id first = Store::open_read(file_).beliefs().front().object;
    const std::vector<ForgetResult> results = {forget(file_, {.object = first}),
                                               forget(file_, {.from = scenes[4].time, .to = scenes[7].time})};
    {
      const Store store = Store::open_read(file_);
      reason(store, anew, {}, {}, silent_, known_identities(store));
    }
    const auto expect_forgotten = [&](const std::filesystem::path& memory) {
      EXPECT_THAT(Store::open_read(memory).verify(silent_).problems, IsEmpty());
      for (const ForgetResult& result : results)
        EXPECT_THAT(find_forgotten(memory, result.tokens, silent_), IsEmpty());
      const Store store = Store::open_read(memory);
      EXPECT_EQ(store.forgotten().size(), 2U);
      const std::vector<SceneRow> there = store.scenes();
      ASSERT_EQ(there.size(), scenes.size());
      size_t observations = 0;
      for (const SceneRow& scene : there) {
        const bool gone = scene.time >= scenes[4].time && scene.time <= scenes[7].time;
        EXPECT_EQ(was_forgotten(store.forgotten(), scene.time), gone);
        observations += store.observations(scene.id).size();
        EXPECT_TRUE(!gone || store.observations(scene.id).empty());
      }
      size_t remaining = 0;
      for (const SceneRow& scene : scenes) remaining += Store::open_read(file_).observations(scene.id).size();
      EXPECT_EQ(observations, remaining);
    };
    expect_forgotten(file_);
    expect_forgotten(anew);
    const ScenesAnswer listed = ask(Store::open_read(anew), ScenesQuestion{});
    EXPECT_EQ(std::ranges::count_if(listed.scenes, [](const auto& scene) { return scene.forgotten; }), 4);
    merge(anew, older, folder_ / "merged_1.loci", std::nullopt, silent_);
    merge(older, anew, folder_ / "merged_2.loci", std::nullopt, silent_);
    expect_forgotten(folder_ / "merged_1.loci");
    expect_forgotten(folder_ / "merged_2.loci");
  }
}

TEST_F(EditProperties, AMergeThatStaysIsUndoneAfterAnotherObjectWasForgotten) {
  for (const unsigned seed : {61U, 62U, 63U}) {
    SCOPED_TRACE(seed);
    std::filesystem::remove(file_);
    RandomHome home(seed);
    std::mt19937 random(seed);
    add_scenes(home, 20, file_);
    std::optional<std::pair<Id, Id>> merged;  // the one that goes, and the one that stays
    for (int tries = 0; !merged && tries < 60; ++tries)
      edit([&](Store& store) {
        const std::vector<BeliefRow> beliefs = store.beliefs();
        const Id a = beliefs[random() % beliefs.size()].object, b = beliefs[random() % beliefs.size()].object;
        try {
          merge_objects(store, a, b);
          merged = {std::max(a, b), std::min(a, b)};
        } catch (const Error&) {  // seen together
        }
        return 0;
      });
    if (!merged) continue;
    std::optional<Id> other;
    for (const BeliefRow& belief : Store::open_read(file_).beliefs())
      if (belief.object != merged->second) other = belief.object;
    ASSERT_TRUE(other);
    forget(file_, {.object = *other});
    ASSERT_EQ(edits(Store::open_read(file_)).done.size(), 1U);
    EXPECT_TRUE(Store::open_read(file_).observations_of(merged->first).empty());
    edit([](Store& store) { return undo(store); });
    expect_sound();
    EXPECT_FALSE(Store::open_read(file_).observations_of(merged->first).empty()) << "they are two again";
  }
}

}  // namespace
}  // namespace loci::memory
