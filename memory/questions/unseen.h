#pragma once

#include "memory/questions/answers.h"

namespace loci::memory {

/// Of the objects that are asked for those that no scene has seen since a time, gone ones among them.
ObjectsAnswer ask_unseen_since(const Store& store, const ObjectsQuestion& question, TimeNs since);

}  // namespace loci::memory
