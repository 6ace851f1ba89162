#include <gtest/gtest.h>

#include <memory>

#include "mapping/simulation/household_scenes.h"
#include "perception/annotators/io/labelled_recording.h"
#include "perception/classification/household_model.h"

namespace loci::perception {
namespace {

/// What the shipped model says of objects on tables that it has not learned, and what they are.
std::vector<std::pair<std::string, std::string>> answers(size_t tables) {
  const auto scenes = std::make_shared<mapping::HouseholdScenes>(tables, Random(99));
  LabelledRecording labelled;
  labelled.recording = scenes;
  labelled.labels = [scenes = scenes.get()](const std::string&) { return scenes->labels(); };
  labelled.class_of = [scenes = scenes.get()](const std::string&, int object) {
    return scenes->class_of(object);
  };
  NoProgress quiet;
  Warnings warnings;
  std::vector<std::pair<std::string, std::string>> said;
  for (const LabelledSurface& each : labelled_surfaces(labelled, quiet, warnings, kObjectFlow).found) {
    const auto answer = HouseholdModel::shipped().classify(each.view);
    said.emplace_back(answer && answer->sure ? answer->label : "", each.label);
    EXPECT_TRUE(!answer || !answer->sure || (answer->probability > 0.3 && answer->probability <= 1));
  }
  return said;
}

TEST(HouseholdClassifier, NamesMostRenderedObjectsAndFewOfThemWrongly) {
  int found = 0, named = 0, right = 0;
  for (const auto& [name, truth] : answers(14)) {
    ++found;
    if (name.empty()) continue;
    ++named;
    right += household_group(name) == household_group(truth) ? 1 : 0;
  }
  ASSERT_GT(found, 40);
  EXPECT_GE(named, found / 2);
  EXPECT_GE(right, 0.85 * named);
}

TEST(HouseholdClassifier, SaysNothingOfWhatItSeesTooLittleOf) {
  EXPECT_FALSE(HouseholdModel::shipped().classify(ObjectView()).has_value());
}

}  // namespace
}  // namespace loci::perception
