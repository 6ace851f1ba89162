#include <gtest/gtest.h>

#include <fmt/format.h>

#include "mapping/simulation/household_scenes.h"
#include "perception/annotators/io/labelled_recording.h"

namespace loci::perception {
namespace {

/// Tables that the network of tests/data/detector has not learned.
LabelledRecording unseen_tables(size_t count) {
  const auto scenes = std::make_shared<mapping::HouseholdScenes>(count, Random(77));
  LabelledRecording labelled;
  labelled.recording = scenes;
  labelled.labels = [scenes = scenes.get()](const std::string&) { return scenes->labels(); };
  labelled.class_of = [scenes = scenes.get()](const std::string&, int object) {
    return scenes->class_of(object);
  };
  return labelled;
}

LabelledSurfaces found_by(const std::string& flow, size_t tables) {
  NoProgress quiet;
  Warnings warnings;
  return labelled_surfaces(unseen_tables(tables), quiet, warnings, flow);
}

TEST(NetworkDetector, ItsDetectionsBecomeClustersInSpace) {
  const std::string network = LOCI_SOURCE_DIR "/tests/data/detector/household.yaml";
  const LabelledSurfaces found =
      found_by(fmt::format("[NormalEstimator, NetworkDetector: {{network: {}}}]", network), 8);
  ASSERT_GT(found.objects, 30U);
  // Half of both, in the pixels of the depth image.
  EXPECT_GE(static_cast<double>(found.found.size()), 0.5 * static_cast<double>(found.objects));
}

TEST(NetworkDetector, NeedsANetwork) {
  EXPECT_THROW(found_by("[NormalEstimator, NetworkDetector]", 1), Error);
}

}  // namespace
}  // namespace loci::perception
