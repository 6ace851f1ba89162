// What was taken for moved and may have stayed: two things that are alike must not become one that goes to
// and fro. The earlier story is kept beside the one that was acted on until somebody looks at the place
// again.

#include <algorithm>

#include "memory/belief/step.h"

namespace loci::memory::belief {

void Step::reclaim_leftovers() {
  for (size_t o = 0; o < partner_of_object_.size(); ++o)
    if (state_.objects[o].leftover_of != 0 && partner_of_object_[o]) reclaim(o, *partner_of_object_[o]);
}

void Step::reclaim(size_t o, size_t k) {
  ProtoObject& stayed = state_.objects[o];
  const auto found = std::ranges::find(state_.objects, stayed.leftover_of, &ProtoObject::key);
  stayed.leftover_of = 0;
  if (found == state_.objects.end()) return;
  ProtoObject& other = *found;
  stayed.status = Status::present;
  update_.events.push_back(
      {other.status == Status::gone ? EventKind::reappeared : EventKind::moved, other.id, scene_.time,
       other.last_seen, probability(o, k), other.place, scene_.observations[k].place,
       expected_[static_cast<size_t>(found - state_.objects.begin())].box, scene_.observations[k].box, k});
  stayed.id = other.id;
  stayed.first_seen = other.first_seen;
  // What was followed instead is told when it is seen once more, as something of its own.
  other.id = 0;
  other.status = Status::tentative;
  other.pending.clear();
  other.handling = {};
  other.doubt = state_.habits.false_share(other.place, options_);
  std::erase_if(other.looks, [&](const Look& look) { return look.time <= stayed.last_seen; });
  other.exists_log_odds = log_odds(options_.first_sight);
  for (ProtoObject& object : state_.objects)
    if (object.leftover_of == other.key) object.leftover_of = stayed.key;
}

void Step::leave_behind(size_t o, size_t k) {
  const ProtoObject& object = state_.objects[o];
  // The story that is acted on is no less probable than another, and never certain.
  const double other = std::clamp(1 - probability(o, k), 0.001, 0.5);
  const double here = other * whether_there(o).probability();
  if (here < kMinLeftover) return;
  ProtoObject& leftover = leftovers_.emplace_back(object);
  leftover.id = 0;
  leftover.status = Status::tentative;
  leftover.leftover_of = object.key;
  leftover.probability_here = here;
  leftover.attention_s = attention_;
  leftover.last_update = scene_.time;
  leftover.alternatives.clear();
}

}  // namespace loci::memory::belief
