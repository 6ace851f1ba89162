#pragma once

#include <string>

#include "memory/store/store.h"

namespace loci::memory {

/// What a thing is and who says so: "label" (a person, of one image), "fact" (a person, of the object),
/// "catalogue", "annotators", or "" when nobody does.
struct SaidClass {
  std::string name, by;
};

/// The class that facts give an object, else what annotators call it most of all, by their confidence.
SaidClass class_of(const Store& store, Id object);

}  // namespace loci::memory
