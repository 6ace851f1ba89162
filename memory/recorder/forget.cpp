#include "memory/recorder/forget.h"

#include <algorithm>

#include "memory/recorder/carried_belief.h"

namespace loci::memory {

ForgetResult forget(Store& store, const ForgetRequest& request, Id run) {
  if (request.object && !store.belief(*request.object))
    throw Error("there is no " + object_name(*request.object), {store.path().string(), 0, {}});
  if (const std::optional<SceneRow> last = store.last_scene()) {
    belief::BeliefState state = load_belief(store);
    const auto then = [&](TimeNs time) {
      return request.from && request.to && time >= *request.from && time <= *request.to;
    };
    std::erase_if(state.objects, [&](const belief::ProtoObject& object) {
      return (request.object && object.id == *request.object) ||
             (then(object.first_seen) && then(object.last_seen));
    });
    std::set<std::string> kinds;
    for (belief::ProtoObject& object : state.objects) {
      std::erase_if(object.looks, [&](const belief::Look& look) { return then(look.time); });
      kinds.insert(object.kind);
    }
    state.habits.keep_kinds(kinds);  // else what a forgotten object was called would stay in the file
    SceneTransaction transaction(store, run);
    CarriedBelief().save(transaction, last->id, state);
    transaction.commit();
  }
  return store.forget(request, run);
}

}  // namespace loci::memory
