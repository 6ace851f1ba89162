#include "gui/data/browser_data.h"

#include <algorithm>

namespace loci::gui {

const BelievedObject* BelievedScene::find(int64_t object) const {
  const auto found =
      std::find_if(objects.begin(), objects.end(), [&](const BelievedObject& o) { return o.id == object; });
  return found == objects.end() ? nullptr : &*found;
}

const SceneEntry* BrowserData::scene_at(TimeNs time) const {
  const auto& all = scenes();
  if (all.empty()) return nullptr;
  const auto after = std::upper_bound(all.begin(), all.end(), time,
                                      [](TimeNs t, const SceneEntry& scene) { return t < scene.time; });
  return after == all.begin() ? &all.front() : &*(after - 1);
}

}  // namespace loci::gui
