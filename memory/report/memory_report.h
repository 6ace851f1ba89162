#pragma once

#include <optional>
#include <string>

#include "memory/store/store.h"

namespace loci {

/// A self-contained page about a memory: what is where, a card per object with its picture and history, what
/// happened scene by scene, and questions with their answers.
///
/// `page`, when given, is a page made by the map's report (or an earlier one of this): the memory's sections
/// are added to it, or take the place of those that it has.
std::string memory_report(const Store& store, const std::optional<std::string>& page = {});

}  // namespace loci
