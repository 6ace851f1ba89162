#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "gui/data/open_memory.h"

namespace loci::memory {
class Store;
}  // namespace loci::memory

namespace loci::gui {

/// A believed object as an explanation of an observation.
struct ConsideredObject {
  int64_t key = 0;     ///< distinguishes objects without an id
  int64_t object = 0;  ///< 0 = tentative
  std::string name = {};
  double probability = 0;    ///< that the observation is it
  double alike = 0;          ///< similarity of appearance, 0 to 1: 0.5 is neutral
  double near = 0;           ///< by its position, likewise
  std::string against = {};  ///< why it was not taken; empty = it was
};

/// What one observation of a scene was taken for.
struct DecidedObservation {
  int64_t number = 0;  ///< within the scene
  int64_t object = 0;  ///< 0 = a false cluster, or tentative
  int64_t key = 0;     ///< of what it was taken for
  std::string name = {};
  std::string explanation = {};  ///< stay, move, newview, appear, clutter
  double probability = 0, appear = 0, clutter = 0;
  cv::Mat crop = {};  ///< CV_8UC3, BGR; empty = not stored
  std::vector<ConsideredObject> considered = {};
};

/// An object that was known and not seen.
struct UnseenObject {
  int64_t key = 0, object = 0;
  std::string name = {};
  double disappear = 0, missed = 0, hidden = 0;  ///< probabilities
};

/// Every decision of one scene.
struct SceneDecisions {
  memory::SceneRow scene = {};
  bool kept = false;            ///< whether the memory has its reasoning
  std::string unreadable = {};  ///< why it has it and it cannot be read, and what to do; empty = it can
  std::vector<DecidedObservation> observations = {};
  std::vector<UnseenObject> unseen = {};
};

/// Of one scene. Without stored reasoning only the associations of the MAP hypothesis.
SceneDecisions read_decisions(const memory::Store& store, const Names& names, const memory::SceneRow& scene);

}  // namespace loci::gui
