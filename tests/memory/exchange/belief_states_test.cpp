#include "memory/exchange/belief_states.h"

#include <gmock/gmock.h>

#include "mapping/base/text/json.h"
#include "tests/memory/exchange/mug_and_box.h"

namespace loci::memory {
namespace {

using testing::Contains;

class BeliefStates : public testing_support::MugAndBox {
 protected:
  void SetUp() override {
    MugAndBox::SetUp();
    NoProgress silent;
    for_each_belief_state(Store::open_read(file_), silent,
                          [&](const Json& state) { states_.push_back(state); });
  }

  std::vector<Json> states_;
};

TEST_F(BeliefStates, TellWhatIsSeenKnownAndPersists) {
  ASSERT_EQ(states_.size(), 2U);
  EXPECT_EQ(states_[0].at("current_clusters").size(), 2U);
  EXPECT_TRUE(states_[0].at("previous_clusters").empty());
  EXPECT_TRUE(states_[0].at("persisting_objects").empty());
  EXPECT_EQ(states_[1].at("previous_clusters"), states_[0].at("current_clusters"));
  EXPECT_EQ(states_[1].at("known_objects").size(), 2U);
  EXPECT_EQ(states_[1].at("persisting_objects"), Json({"object_2"}));
}

TEST_F(BeliefStates, TellWhereThingsAreToEachOther) {
  const auto relation = [](const char* predicate, const char* subject, const char* object) {
    return Json{{"predicate", predicate}, {"subject", subject}, {"object", object}};
  };
  EXPECT_THAT(states_[0].at("relations"), Contains(relation("on", "object_1", "table_1")));
  EXPECT_THAT(states_[0].at("relations"), Contains(relation("next_to", "object_1", "object_2")));
  EXPECT_THAT(states_[1].at("relations"), Contains(relation("on", "object_1", "shelf_1")));
  EXPECT_EQ(states_[1].at("relations").size(), 2U) << "they are apart now";
}

TEST_F(BeliefStates, DistributionsAreOverObjectsAndEarlierClusters) {
  const Json& identity = states_[1].at("identities").at(0);
  double sum = identity.at("new").get<double>() + identity.at("false").get<double>();
  for (const auto& [object, probability] : identity.at("candidates").items())
    sum += probability.get<double>();
  EXPECT_NEAR(sum, 1, 0.02);
  EXPECT_GT(identity.at("candidates").at("object_1").get<double>(), 0.5);
  const Json& tracking = states_[1].at("tracking").at(0).at("candidates");
  EXPECT_GT(tracking.at("cluster_1_0").get<double>(), 0.4) << "it is the mug that stood on the table";
  EXPECT_EQ(states_[0].at("identities").at(0).at("candidates").size(), 0U) << "nothing was known before";
}

}  // namespace
}  // namespace loci::memory
