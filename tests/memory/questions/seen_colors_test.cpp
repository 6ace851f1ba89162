#include "memory/questions/names/seen_colors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "memory/questions/facts.h"
#include "memory/questions/snapshot.h"
#include "memory/sentences/natural_language.h"
#include "memory/store/feature_structures.h"
#include "memory/store/scene_transaction.h"
#include "perception/types/scene_cas.h"
#include "tests/memory/store/temporary_folder.h"

namespace loci::memory {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Two bowls, white from above; the first is blue outside.
class SeenColors : public testing_support::TemporaryFolder {
 protected:
  void SetUp() override {
    TemporaryFolder::SetUp();
    Store store = Store::open_write(file_);
    const Id run = store.begin_run("test", "{}");
    {
      SceneTransaction scene(store, run);
      const Id id = scene.add_scene({.time = 60 * kSecond});
      add_bowl(scene, id, 1, {"white", "blue", "grey"}, {0.7, 0.25, 0.05});
      add_bowl(scene, id, 2, {"white", "grey"}, {0.8, 0.2});
      scene.commit();
    }
    store.finish_run(run);
    for (const char* bowl : {"object_1", "object_2"}) set_fact(store, bowl, "class", "bowl");
  }

  static void add_bowl(SceneTransaction& scene, Id id, Id object, const std::vector<std::string>& names,
                       const std::vector<double>& fractions) {
    const Id seen = scene.add_observation(
        {.scene = id, .number = object, .position = Vector3d(0, 0, 1), .color = names[0]});
    scene.add_object({});
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
                      .last_scene = id,
                      .color = names[0]});
    perception::cas::Cas cas(perception::types::type_system());
    const auto annotation = perception::types::ColorAnnotation::create(cas);
    annotation.names.set(names);
    annotation.fractions.set(fractions);
    FeatureStructureWriter writer(scene, id);
    scene.add_annotation({.scene = id,
                          .observation = seen,
                          .type = "loci.annotation.ColorAnnotation",
                          .value = names[0],
                          .feature_structure = writer.add(annotation, seen)});
  }
};

TEST_F(SeenColors, AreThoseOfATenthOrMoreTheFirstWithMost) {
  const Store store = Store::open_read(file_);
  EXPECT_THAT(seen_colors(store, 1, {}), ElementsAre("white", "blue"));
  EXPECT_THAT(seen_colors(store, 2, {}), ElementsAre("white", "grey"));
  EXPECT_THAT(seen_colors(store, 3, {}), IsEmpty());
}

TEST_F(SeenColors, ABlueBowlIsTheOneThatIsPartlyBlue) {
  const Store store = Store::open_read(file_);
  EXPECT_THAT(Snapshot(store, {}).find_objects("blue bowl"), ElementsAre(1));
  EXPECT_THROW(Snapshot(store, {}).find_objects("red bowl"), UnknownName);
}

TEST_F(SeenColors, AnswersSayBothColoursButNotTwoThatLightMakesOfOne) {
  const Store store = Store::open_read(file_);
  NaturalLanguageQuestion question;
  question.sentences = {"What colour are the bowls?", "What colour is the blue bowl?"};
  const auto answers = ask(store, question);
  EXPECT_THAT(answers[0].reply->text, HasSubstr("is white and blue and the bowl object_2 is white."));
  EXPECT_THAT(answers[1].reply->text, HasSubstr("is white and blue."));
}

}  // namespace
}  // namespace loci::memory
