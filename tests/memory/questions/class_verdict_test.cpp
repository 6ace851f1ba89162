#include "memory/questions/names/class_verdict.h"

#include <gtest/gtest.h>

#include "memory/questions/facts.h"
#include "memory/questions/snapshot.h"
#include "memory/store/feature_structures.h"
#include "memory/store/scene_transaction.h"
#include "perception/types/scene_cas.h"
#include "tests/memory/store/temporary_folder.h"

namespace loci::memory {
namespace {

struct Vote {
  const char* expert;
  const char* name;
  double confidence = 0.8;
};

class ClassVerdicts : public testing_support::TemporaryFolder {
 protected:
  /// One more scene, in which each object is seen, from a camera at a place, and named by experts.
  void see(const std::vector<std::vector<Vote>>& objects, const Vector3d& camera = {1, 0, 1}) {
    Store store = Store::open_write(file_);
    if (run_ == 0) run_ = store.begin_run("test", "{}");
    {
      SceneTransaction scene(store, run_);
      time_ += 60 * kSecond;
      const Id id =
          scene.add_scene({.time = time_, .map_from_camera = Isometry3d(Eigen::Translation3d{camera})});
      for (size_t i = 0; i < objects.size(); ++i) {
        const Id seen = scene.add_observation(
            {.scene = id, .number = static_cast<int64_t>(i), .position = Vector3d(0, 0, 1)});
        const auto object = static_cast<Id>(i) + 1;
        if (time_ == 60 * kSecond) scene.add_object({});
        scene.add_association({.scene = id,
                               .observation = seen,
                               .object = object,
                               .explanation = Explanation::stay,
                               .probability = 1,
                               .chosen = true});
        scene.add_belief({.object = object,
                          .scene = id,
                          .status = ObjectStatus::seen,
                          .position = Vector3d(0, 0, 1),
                          .last_scene = id});
        for (const Vote& vote : objects[i]) annotate(scene, id, seen, vote);
      }
      scene.commit();
    }
    store.finish_run(run_);
  }

  static void annotate(SceneTransaction& scene, Id id, Id seen, const Vote& vote) {
    perception::cas::Cas cas(perception::types::type_system());
    const auto annotation = perception::types::ClassificationAnnotation::create(cas);
    annotation.source.set(vote.expert);
    annotation.label.set(vote.name);
    FeatureStructureWriter writer(scene, id);
    scene.add_annotation({.scene = id,
                          .observation = seen,
                          .type = "loci.annotation.ClassificationAnnotation",
                          .value = vote.name,
                          .confidence = vote.confidence,
                          .feature_structure = writer.add(annotation, seen)});
  }

  ClassVerdict verdict(Id object) const {
    const Store store = Store::open_read(file_);
    return Snapshot(store, {}).class_verdict(object).value();
  }

  TimeNs time_ = 0;
  Id run_ = 0;
};

TEST_F(ClassVerdicts, WhatMostViewsSayIsTheNameAndContradictionsStay) {
  see({{{"shape", "cup"}}});
  see({{{"shape", "cup"}}});
  see({{{"shape", "bowl"}}});
  const ClassVerdict one = verdict(1);
  EXPECT_EQ(one.name, "cup");
  ASSERT_EQ(one.votes.size(), 2U);
  EXPECT_EQ(one.votes[1].name, "bowl");
  EXPECT_LT(one.probability, 0.9);
  EXPECT_EQ(Snapshot(Store::open_read(file_), {}).object_ref(1).label, "cup");
}

TEST_F(ClassVerdicts, OfThePastAnObjectIsCalledAsAllLooksKnowIt) {
  see({{{"shape", "jug"}}});
  see({{{"shape", "cup"}}});
  see({{{"shape", "cup"}}});
  const Store store = Store::open_read(file_);
  const Snapshot first(store, {60 * kSecond, {}});
  EXPECT_EQ(first.object_ref(1).label, "cup");
  EXPECT_EQ(first.find_objects("cup"), std::vector<Id>{1});
}

TEST_F(ClassVerdicts, AnExpertThatPeopleCorrectLosesItsWeight) {
  std::vector<std::vector<Vote>> objects(6, {{"first", "bowl"}, {"second", "cup"}});
  see(objects);
  EXPECT_EQ(verdict(6).name, "bowl") << "equally competent: the first in order";
  {
    Store store = Store::open_write(file_);
    for (const char* object : {"object_1", "object_2", "object_3"}) set_fact(store, object, "class", "cup");
  }
  EXPECT_EQ(verdict(6).name, "cup");
  EXPECT_GT(verdict(6).votes[0].competence, 0.85);
  EXPECT_LT(verdict(6).votes[1].competence, 0.55);
}

/// What an expert does not know it names now and then, now this, now that.
TEST_F(ClassVerdicts, WhatMostViewsDoNotNameHasNoName) {
  see({{{"shape", "cup"}}, {{"shape", "cup"}}});
  for (int view = 0; view < 3; ++view) see({{}, {{"shape", "cup"}}});
  see({{{"shape", "bowl"}}, {}});
  EXPECT_EQ(verdict(1).name, "");
  EXPECT_EQ(verdict(1).votes.size(), 2U) << "what was said stays";
  EXPECT_LT(verdict(1).probability, 0.5);
  EXPECT_EQ(verdict(2).name, "cup") << "one view in five says nothing";
  const Store store = Store::open_read(file_);
  const Snapshot snapshot(store, {});
  EXPECT_FALSE(snapshot.object_ref(1).label);
  EXPECT_EQ(snapshot.find_objects("cup"), std::vector<Id>{2});
  try {
    snapshot.find_objects("bowl");
    FAIL() << "nothing is called so";
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find("'bowl'?"), std::string::npos) << error.what();
  }
}

/// No view is sure, but all sides are of one opinion; views from one side show the same again.
TEST_F(ClassVerdicts, SeveralSidesAreSureTogetherAndOneSideIsNot) {
  const Vector3d sides[] = {{1, 0, 1}, {0, 1, 1}, {-1, 0, 1}, {0, -1, 1}};
  for (const Vector3d& side : sides) see({{{"shape", "box", 0.35}}}, side);
  EXPECT_EQ(verdict(1).name, "box");
  EXPECT_GT(verdict(1).probability, 0.9);
  for (int view = 0; view < 20; ++view) see({{{"shape", "box", 0.35}}});
  EXPECT_EQ(verdict(1).name, "") << "the latest views are all from one side";
  EXPECT_NEAR(verdict(1).probability, 0.35, 0.01);
}

TEST_F(ClassVerdicts, AWordMeansWhatIsCalledSoElseWhatSomeViewsTakeForIt) {
  see({{{"shape", "cup"}}, {{"shape", "can"}}, {{"shape", "can"}}});
  see({{{"shape", "cup"}}, {{"shape", "can"}}, {{"shape", "can"}}});
  see({{{"shape", "cup"}}, {{"shape", "cup"}}, {{"shape", "bowl"}}});
  EXPECT_EQ(verdict(2).name, "can");
  const Store store = Store::open_read(file_);
  const Snapshot snapshot(store, {});
  EXPECT_EQ(snapshot.find_objects("cup"), std::vector<Id>{1});
  EXPECT_EQ(snapshot.find_objects("bowl"), std::vector<Id>{3});
}

TEST_F(ClassVerdicts, TwoExpertsThatAgreeOutvoteOne) {
  see({{{"a", "jar"}, {"b", "can"}, {"c", "can"}}});
  EXPECT_EQ(verdict(1).name, "can");
}

}  // namespace
}  // namespace loci::memory
