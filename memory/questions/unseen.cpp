#include "memory/questions/unseen.h"

#include <algorithm>

namespace loci::memory {

ObjectsAnswer ask_unseen_since(const Store& store, const ObjectsQuestion& question, TimeNs since) {
  ObjectsAnswer answer = ask(store, question);
  std::erase_if(answer.objects,
                [&](const ObjectState& state) { return state.last_seen && state.last_seen->time >= since; });
  return answer;
}

}  // namespace loci::memory
