#pragma once

#include <string>
#include <vector>

#include "memory/store/store.h"

namespace loci::memory {

/// Questions to suggest for this memory: about its objects first, then an example of each form.
std::vector<std::string> suggested_questions(const Store& store);

/// Names of objects, places and parts, with aliases and classes: the words to complete in a question.
std::vector<std::string> known_names(const Store& store);

}  // namespace loci::memory
