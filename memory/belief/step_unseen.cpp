// What becomes of objects that were not seen.

#include <algorithm>
#include <cmath>

#include "memory/belief/step.h"

namespace loci::memory::belief {
namespace {

/// So probable must it have been to find an object in its place before its absence makes it gone.
constexpr double kLooked = 0.3;

}  // namespace

void Step::miss(size_t o) {
  ProtoObject& object = state_.objects[o];
  const Expectation& e = expected_[o];
  if (object.status == Status::gone && apart_)
    state_.habits.learn_returns(attention_ - object.seen_attention_s, update_.objects[o].matched, options_);
  if (e.undetectable >= 1) {  // looking elsewhere tells nothing
    update_.objects[o].explanation = Explanation::hidden;
    if (object.status == Status::present) note_hidden(object, e);
    return;
  }
  const Whether whether = whether_there(o);
  object.probability_here = whether.probability();
  if (apart_ && 1 - e.undetectable >= kLooked)
    learn_doubt(object, whether.nothing * (1 - options_.repeat_clutter), whether.there + whether.away);
  object.last_update = scene_.time;
  object.attention_s = attention_;
  // Where the look could not tell, it explains nothing: there or away, the object is out of sight.
  const double hidden = e.undetectable;
  const double missed = whether.there - e.here * e.undetectable,
               left = whether.away - (1 - e.here) * e.undetectable;
  const Explanation explanation = hidden >= missed && hidden >= left ? Explanation::hidden
                                  : missed >= left                   ? Explanation::missed
                                                                     : Explanation::disappear;
  update_.objects[o].explanation = explanation;
  if (object.leftover_of != 0) return;
  const double in_view = 1 - e.undetectable;
  if (object.status == Status::tentative) {
    const double empty = empty_share_in_hindsight(o);
    const double missed_if_object = 1 - options_.detection * in_view * (empty > 0.7 ? 1.1 : 1.0);
    object.exists_log_odds +=
        std::log(std::max(0.01, missed_if_object) / (1 - options_.repeat_clutter * in_view));
    return;
  }
  if (object.status != Status::present) return;
  // Time alone makes nothing go: what is out of view stays remembered until somebody looks.
  if (1 - object.probability_here >= options_.gone && in_view >= kLooked) {
    object.status = Status::gone;
    object.told_hidden = false;
    if (apart_) learn_from_absence(object);
    update_.events.push_back({EventKind::gone,
                              object.id,
                              scene_.time,
                              object.last_seen,
                              1 - object.probability_here,
                              object.place,
                              {},
                              e.box,
                              std::nullopt,
                              std::nullopt});
    return;
  }
  note_hidden(object, e);
}

double Step::Whether::probability() const {
  return there / std::max(1e-300, there + away);
}

Step::Whether Step::whether_there(size_t o) const {
  const Expectation& e = expected_[o];
  const EmptinessEvidence evidence = emptiness(e, empty_share_in_hindsight(o), seconds_, options_);
  const double in_view = 1 - e.undetectable;
  const double nothing = e.undetectable + in_view * std::exp(evidence.if_gone);
  return {e.here * (e.undetectable + in_view * std::exp(evidence.if_there)), (1 - e.here) * nothing, nothing};
}

double Step::empty_share_in_hindsight(size_t o) const {
  std::vector<double> other(scene_.observations.size(), snapshot_ ? 1.0 : 0.3);
  for (size_t k = 0; k < other.size(); ++k) {
    const ObservationOutcome& outcome = update_.observations[k];
    if (outcome.explanation == Explanation::clutter) other[k] = 0;
    if (!partner_of_observation_[k] || outcome.explanation == Explanation::move) continue;
    const double before = expected_[*partner_of_observation_[k]].box.volume();
    if (scene_.observations[k].box.volume() > 1.4 * before) other[k] = 0;
  }
  return empty_share(expected_[o].seen, other);
}

void Step::note_hidden(ProtoObject& object, const Expectation& e) {
  const Visibility& v = e.seen.visibility;
  object.hidden_looks = v.hidden > 0.5 && v.hidden > v.out_of_view ? object.hidden_looks + 1 : 0;
  const int looks_needed = snapshot_ ? 1 : 3;
  if (object.hidden_looks < looks_needed || object.told_hidden) return;
  object.told_hidden = true;
  update_.events.push_back({EventKind::hidden, object.id, scene_.time, object.last_seen,
                            object.probability_here, object.place, object.place, e.box, e.box, std::nullopt});
}

void Step::forget_clutter() {
  const double least = -log_odds(options_.confirm);
  std::erase_if(state_.objects, [&](const ProtoObject& object) {
    if (object.status != Status::tentative) return false;
    if (object.leftover_of != 0) return probability_here(object, state_, options_) < kMinLeftover;
    const double unseen = double(scene_.time - object.last_seen) / double(kSecond);
    return object.exists_log_odds <= least || 1 - object.probability_here >= options_.gone ||
           (!snapshot_ && unseen > options_.snapshot_gap_s);
  });
}

void Step::retire() {
  std::vector<TimeNs> gone;
  for (const ProtoObject& object : state_.objects)
    if (object.status == Status::gone) gone.push_back(object.last_seen);
  const auto most = static_cast<size_t>(options_.gone_kept);
  if (gone.size() <= most) return;
  std::ranges::nth_element(gone, gone.begin() + static_cast<std::ptrdiff_t>(gone.size() - most));
  const TimeNs oldest = gone[gone.size() - most];
  std::erase_if(state_.objects, [&](const ProtoObject& object) {
    return object.status == Status::gone && object.last_seen < oldest;
  });
}

}  // namespace loci::memory::belief
