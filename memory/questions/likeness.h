#pragma once

#include <filesystem>

#include "memory/questions/answers.h"

namespace loci {

/// Which objects look like this picture, or like this object?
struct LikeQuestion {
  std::string subject = {};            ///< an object in words; empty when a picture is given
  std::filesystem::path picture = {};  ///< what fills most of it
  AsOf as_of = {};
};
struct LikeObject {
  ObjectState object = {};
  double likeness = 0;                 ///< 0 to 1: shared part of the colour histograms of their pictures
  std::optional<SceneRef> scene = {};  ///< of its picture that is most like
};
struct LikeAnswer {
  std::string asked = {};                ///< the object's or the picture's name
  std::vector<LikeObject> objects = {};  ///< most alike first
};
/// Error when the picture cannot be read or no picture of the object was kept.
LikeAnswer ask(const Store& store, const LikeQuestion& question);

}  // namespace loci
