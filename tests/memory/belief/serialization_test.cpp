#include "memory/belief/serialization.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/memory/belief/synthetic_scene.h"

namespace loci::memory::belief {
namespace {

/// A belief and the reasoning of its last scene.
struct Example {
  Example() {
    SyntheticKitchen kitchen;
    kitchen.objects = {{"mug", SyntheticKitchen::on_table(0, 0)},
                       {"box", SyntheticKitchen::on_table(0.3, 0.1), {0.2, 0.1, 0.1}, {0.2F, 0.2F, 0.8F}}};
    advance(state, kitchen.scene(0));
    kitchen.objects[0].centre = SyntheticKitchen::on_table(-0.3, 0.1);
    reasoning.evidence = kitchen.scene(600, 0.1 + 0.2);
    reasoning.evidence.view.observed = {{"table_1", 0.7}};
    reasoning.evidence.places = {{"drawer_1", SyntheticKitchen::look_from({0, -1, 1.4}, {0, 0, 0.72})}};
    reasoning.evidence.observations[0].sigma_m = 0.01;
    reasoning.evidence.observations[0].descriptors.push_back({"class", {0.9F}, {"m\xfcg"}});
    const BeliefUpdate update = advance(state, reasoning.evidence);
    reasoning.decisions = decisions_of(update);
    reasoning.matrices = matrices_of(update, reasoning.decisions);
  }

  BeliefState state;
  SceneReasoning reasoning;
};

template <class Read>
void expect_refused_when_cut(const std::string& bytes, Read read) {
  EXPECT_NO_THROW(read(bytes));
  for (size_t size = 0; size < bytes.size(); ++size)
    EXPECT_THROW(read(std::string_view(bytes).substr(0, size)), Error) << size;
  EXPECT_THROW(read(bytes + "x"), Error);
}

TEST(Serialization, RefusesBytesThatEndTooEarly) {
  const Example example;
  expect_refused_when_cut(to_bytes(example.state), state_from_bytes);
  expect_refused_when_cut(to_bytes(example.state.objects.at(0)), object_from_bytes);
  expect_refused_when_cut(to_bytes(example.reasoning), reasoning_from_bytes);
  expect_refused_when_cut(to_bytes(print_on({}, 1)), texture_from_bytes);
}

TEST(Serialization, NumbersComeBackBitByBit) {
  Example example;
  ProtoObject& object = example.state.objects.at(0);
  object.variance = std::numeric_limits<double>::denorm_min();
  object.exists_log_odds = -0.0;
  object.probability_here = 0.1 + 0.2;
  object.last_seen = -1;
  object.views.at(0).descriptors.at(0).values.at(0) = std::nanf("");
  const ProtoObject back = object_from_bytes(to_bytes(object));
  EXPECT_EQ(to_bytes(back), to_bytes(object));
  EXPECT_EQ(back.variance, object.variance);
  EXPECT_TRUE(std::signbit(back.exists_log_odds));
  EXPECT_EQ(back.probability_here, object.probability_here);
  EXPECT_EQ(back.last_seen, object.last_seen);
  EXPECT_EQ(back.map_from_camera.matrix(), object.map_from_camera.matrix());
  EXPECT_TRUE(std::isnan(back.views.at(0).descriptors.at(0).values.at(0)));
  EXPECT_EQ(stored(restored(stored(example.state))), stored(example.state));
}

TEST(Serialization, RefusesPositionsThatAreNoneAndListsThatDoNotFit) {
  Example example;
  ProtoObject object = example.state.objects.at(0);
  object.box.centre.x() = std::numeric_limits<double>::infinity();
  EXPECT_THROW(object_from_bytes(to_bytes(object)), Error);
  SceneReasoning more = example.reasoning;
  more.decisions.observations.resize(more.evidence.observations.size() + 1,
                                     more.decisions.observations.front());
  EXPECT_THROW(reasoning_from_bytes(to_bytes(more)), Error);
}

TEST(Serialization, ReasoningComesBack) {
  const Example example;
  const SceneReasoning back = reasoning_from_bytes(to_bytes(example.reasoning));
  EXPECT_EQ(to_bytes(back), to_bytes(example.reasoning));
  EXPECT_EQ(back.evidence.seconds_to_next, 0.1 + 0.2);
  EXPECT_EQ(back.evidence.view.observed->front().fraction, 0.7);
  EXPECT_EQ(back.evidence.observations.at(0).sigma_m, 0.01);
  EXPECT_FALSE(back.evidence.observations.at(1).sigma_m.has_value());
  EXPECT_EQ(back.evidence.observations.at(0).descriptors.back().names, std::vector<std::string>{"m\xfcg"});
  EXPECT_EQ(back.decisions.observations.at(0).explanation, Explanation::move);
  EXPECT_EQ(back.matrices.offsets, example.reasoning.matrices.offsets);
}

TEST(Serialization, RefusesInvalidEnumeratorsAndSizes) {
  const Example good;
  Example bad = good;
  bad.state.objects.at(0).status = static_cast<Status>(3);
  EXPECT_THROW(object_from_bytes(to_bytes(bad.state.objects.at(0))), Error);
  bad.reasoning.decisions.observations.at(0).explanation = static_cast<Explanation>(8);
  EXPECT_THROW(reasoning_from_bytes(to_bytes(bad.reasoning)), Error);
  bad = good;
  bad.reasoning.decisions.observations.at(0).candidates.at(0).distances.pop_back();
  EXPECT_THROW(reasoning_from_bytes(to_bytes(bad.reasoning)), Error);
  bad = good;
  bad.reasoning.matrices.rows = 1'000'000'000;
  EXPECT_THROW(reasoning_from_bytes(to_bytes(bad.reasoning)), Error);
  bad = good;
  bad.reasoning.matrices.distances.at(0).pop_back();
  EXPECT_THROW(reasoning_from_bytes(to_bytes(bad.reasoning)), Error);
  bad = good;
  bad.reasoning.evidence.observations.at(0).descriptors.back().names.emplace_back("cup");
  EXPECT_THROW(reasoning_from_bytes(to_bytes(bad.reasoning)), Error);
}

}  // namespace
}  // namespace loci::memory::belief
