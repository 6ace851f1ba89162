#pragma once

#include "mapping/base/text/json.h"
#include "memory/store/store.h"

namespace loci::memory {

/// An explanation of what the memory decided.
struct Why {
  std::string text;
  Json json;
};

/// Why the memory believes what it does about an object at `as_of.at`: the decision at its last sighting with
/// evidence and alternatives, and what was concluded from looks at its place since. Error when there is no
/// such object, or not yet.
Why why_object(const Store& store, Id object, const AsOf& as_of = {});

/// Why each observation of a scene was taken for what it was, with the matrices that it rests on
/// (pair_matrices.h). Error when there is no such scene.
Why why_scene(const Store& store, Id scene);

}  // namespace loci::memory
