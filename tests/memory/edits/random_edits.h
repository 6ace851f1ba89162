#pragma once

#include <fmt/format.h>

#include "memory/edits/edits.h"
#include "tests/support/random_memory.h"

namespace loci::memory::testing_support {

/// Some edits; those that are refused are as good as none. `day` = of the first one, after the memory's.
inline void edit_at_random(const std::filesystem::path& file, loci::testing_support::RandomMemory& random,
                           int max_count = 7, int day = 1) {
  const int count = int(random.draw(0, max_count));
  for (int i = 0; i < count; ++i) {
    Store store = Store::open_write(
        file, {.now = loci::testing_support::RandomMemory::kStart + (day + i) * 86400 * kSecond});
    const auto beliefs = store.beliefs();
    const auto scenes = store.scenes();
    if (beliefs.empty()) return;
    const auto any = [&](const auto& list) {
      return list.at(size_t(random.draw(0, double(list.size()) - 0.001)));
    };
    try {
      switch (int(random.draw(0, 6))) {
        case 0:
          merge_objects(store, any(beliefs).object, any(beliefs).object);
          break;
        case 1:
          split_object(store, any(beliefs).object, any(scenes).time);
          break;
        case 2:
          label_observation(store, any(scenes).id, 0, fmt::format("label{}", i));
          break;
        case 3:
          say(store, object_name(any(beliefs).object), "alias", fmt::format("alias{}", i));
          break;
        case 4:
          undo(store);
          break;
        default:
          redo(store);
      }
    } catch (const Error&) {
    }
  }
}

}  // namespace loci::memory::testing_support
