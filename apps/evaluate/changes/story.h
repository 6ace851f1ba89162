#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "memory/belief/scene.h"
#include "memory/store/store.h"

namespace loci::apps::changes {

/// Something that was observed in a frame.
struct Sight {
  memory::Id observation = 0;
  Vector3d position = Vector3d::Zero();
  std::optional<std::array<int, 4>> pixels;  ///< x, y, width, height in the depth image
  memory::belief::Observation evidence;      ///< what it looked like; of observations with kept evidence
};

/// One frame as the memory observed it.
struct Moment {
  memory::Id scene = 0;
  std::vector<Sight> sights;
  std::optional<memory::SceneCamera> camera;
  Isometry3d map_from_camera = Isometry3d::Identity();
};

/// What somebody makes of one frame.
struct Told {
  std::map<memory::Id, memory::Id> object_of;  ///< of observations; false clusters are not in it
  std::map<memory::Id, std::set<std::string>>
      events;  ///< by object: appeared, moved, looks_different, gone, ...
  /// Of observations: that it is of this object. Only of methods that state one.
  std::map<memory::Id, double> probability = {};
  std::vector<memory::AssociationRow> alternatives = {};  ///< of a memory: all that it considered
};

using Moments = std::map<int64_t, Moment>;  ///< by frame index of the recording
using Story = std::map<int64_t, Told>;

/// Of all recordings, or of one. Error when the memory has no frame of a recording.
Moments read_moments(const memory::Store& store, std::optional<memory::Id> recording = {});

/// What the memory itself says.
Story memory_story(const memory::Store& store, const Moments& moments);

/// RoboSherlock's matcher: the mutual best of half similarity, half proximity is the same, if alike
/// enough. What stays alone is gone when the place of its centre is in the image.
Story greedy_story(const Moments& moments);

/// The nearest first, whatever it looks like.
Story nearest_story(const Moments& moments);

}  // namespace loci::apps::changes
