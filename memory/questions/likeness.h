#pragma once

#include <filesystem>

#include "memory/questions/answers.h"

namespace loci::memory {

/// Which objects look like this image, or like this object?
struct LikeQuestion {
  std::string subject = {};          ///< an object in words; empty when an image is given
  std::filesystem::path image = {};  ///< what fills most of it
  AsOf as_of = {};
};
struct LikeObject {
  ObjectState object = {};
  double likeness = 0;                 ///< 0 to 1: shared part of the colour histograms of their images
  std::optional<SceneRef> scene = {};  ///< of its image that is most like
};
struct LikeAnswer {
  std::string asked = {};                ///< the object's or the image's name
  std::vector<LikeObject> objects = {};  ///< most alike first
};
/// Error when the image cannot be read or no image of the object was kept.
LikeAnswer ask(const Store& store, const LikeQuestion& question);

}  // namespace loci::memory
