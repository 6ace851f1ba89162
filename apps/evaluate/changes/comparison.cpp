#include "apps/evaluate/changes/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>

namespace loci::changes {
namespace {

constexpr const char* kTrueKinds[] = {"unchanged", "moved", "added", "removed", "uncertain"};
constexpr const char* kSaidKinds[] = {"unchanged", "moved",         "looks_different", "added",    "removed",
                                      "kept",      "identity lost", "confused",        "not found"};

/// One frame as the memory has it.
struct Frame {
  Id scene = 0;
  TimeNs time = 0;
  std::map<std::string, Id> object;            ///< of true things that were found; 0 = not attributed
  std::map<Id, std::set<std::string>> events;  ///< kinds by object
  std::set<Id> seen;                           ///< objects
};

/// Pairs true things with observations, nearest first.
void find_things(const std::vector<TrueObject>& things, const Store& store, Frame& frame) {
  struct Pair {
    double distance;
    size_t thing;
    Id observation;
  };
  std::vector<Pair> pairs;
  for (const ObservationRow& observation : store.observations(frame.scene)) {
    if (!observation.position) continue;
    for (size_t i = 0; i < things.size(); ++i) {
      const double distance = (things[i].centre - *observation.position).norm();
      const double reach = std::max(0.06, 0.6 * things[i].size.maxCoeff());
      if (distance <= reach) pairs.push_back({distance, i, observation.id});
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
    return std::tie(a.distance, a.thing, a.observation) < std::tie(b.distance, b.thing, b.observation);
  });
  std::map<Id, Id> object_of;
  for (const AssociationRow& row : store.associations(frame.scene)) {
    if (!row.chosen || !row.observation || !row.object) continue;
    object_of[*row.observation] = *row.object;
    frame.seen.insert(*row.object);
  }
  std::set<Id> used;
  for (const Pair& pair : pairs) {
    if (frame.object.contains(things[pair.thing].name) || !used.insert(pair.observation).second) continue;
    const auto object = object_of.find(pair.observation);
    frame.object[things[pair.thing].name] = object == object_of.end() ? 0 : object->second;
  }
}

std::map<int64_t, Frame> read_frames(const Truth& truth, const Store& store) {
  std::map<int64_t, Frame> frames;
  std::map<Id, int64_t> index_of_scene;
  for (const SceneRow& scene : store.scenes()) {
    if (!scene.frame_index) continue;
    Frame& frame = frames[*scene.frame_index];
    frame.scene = scene.id;
    frame.time = scene.time;
    index_of_scene[scene.id] = *scene.frame_index;
    const auto things = truth.visible.find(*scene.frame_index);
    find_things(things == truth.visible.end() ? std::vector<TrueObject>() : things->second, store, frame);
  }
  for (const EventRow& event : store.events())
    if (event.object && event.scene && index_of_scene.contains(*event.scene))
      frames[index_of_scene.at(*event.scene)].events[*event.object].insert(event.kind);
  return frames;
}

Id object_in(const Frame& frame, const std::string& thing) {
  const auto found = frame.object.find(thing);
  return found == frame.object.end() ? 0 : found->second;
}

bool happened(const std::map<int64_t, Frame>& frames, int64_t after, int64_t until, Id object,
              const char* kind) {
  for (auto frame = frames.upper_bound(after); frame != frames.end() && frame->first <= until; ++frame) {
    const auto events = frame->second.events.find(object);
    if (events != frame->second.events.end() && events->second.contains(kind)) return true;
  }
  return false;
}

class Judge {
 public:
  explicit Judge(const std::map<int64_t, Frame>& frames) : frames_(frames) {}

  JudgedTransition judge(const TrueTransition& truth) const {
    JudgedTransition judged{truth, "", 0, 0};
    const Frame& from = frames_.at(truth.from_frame);
    const Frame& to = frames_.at(truth.to_frame);
    judged.from_object = truth.kind == "added" ? 0 : object_in(from, truth.object);
    judged.to_object = truth.kind == "removed" ? 0 : object_in(to, truth.object);
    if (truth.kind == "added")
      judged.said = said_added(judged);
    else if (truth.kind == "removed")
      judged.said = said_removed(judged, to);
    else
      judged.said = said_both(judged, to);
    return judged;
  }

 private:
  std::string said_added(const JudgedTransition& j) const {
    if (j.to_object == 0) return "not found";
    const int64_t before = j.truth.from_frame == j.truth.to_frame ? j.truth.to_frame - 1 : j.truth.from_frame;
    const bool came = happened(frames_, before, last(), j.to_object, "appeared") ||
                      happened(frames_, before, j.truth.to_frame, j.to_object, "reappeared");
    return came ? "added" : "confused";
  }

  std::string said_removed(const JudgedTransition& j, const Frame& to) const {
    if (j.from_object == 0) return "not found";
    if (to.seen.contains(j.from_object)) return "confused";
    // With one look per place it may take until the camera comes back; a fixed camera sees it at once.
    const bool gone = happened(frames_, j.truth.from_frame, gone_until(j), j.from_object, "gone");
    return gone ? "removed" : "kept";
  }

  int64_t gone_until(const JudgedTransition& j) const {
    // Until the thing is seen again, or to the end.
    for (auto frame = frames_.upper_bound(j.truth.to_frame); frame != frames_.end(); ++frame)
      if (frame->second.object.contains(j.truth.object)) return frame->first - 1;
    return last();
  }

  std::string said_both(const JudgedTransition& j, const Frame& to) const {
    if (j.from_object == 0 || j.to_object == 0) return "not found";
    if (j.from_object != j.to_object)
      return to.seen.contains(j.from_object) ||
                     !happened(frames_, j.truth.from_frame, j.truth.to_frame, j.to_object, "appeared")
                 ? "confused"
                 : "identity lost";
    if (happened(frames_, j.truth.from_frame, j.truth.to_frame, j.to_object, "moved")) return "moved";
    if (happened(frames_, j.truth.from_frame, j.truth.to_frame, j.to_object, "looks_different"))
      return "looks_different";
    return "unchanged";
  }

  int64_t last() const { return frames_.rbegin()->first; }

  const std::map<int64_t, Frame>& frames_;
};

/// Things that were removed and came back: recognised as the same?
void count_returns(const std::vector<JudgedTransition>& transitions, Comparison& comparison) {
  std::map<std::string, Id> removed;
  for (const JudgedTransition& t : transitions) {
    if (t.truth.kind == "removed") removed[t.truth.object] = t.from_object;
    if (t.truth.kind != "added" || !removed.contains(t.truth.object)) continue;
    ++comparison.returned;
    comparison.recognised += t.to_object != 0 && removed.at(t.truth.object) == t.to_object ? 1 : 0;
    removed.erase(t.truth.object);
  }
}

size_t count_of(const std::vector<JudgedTransition>& transitions, const std::string& kind,
                const std::string& said) {
  return static_cast<size_t>(
      std::count_if(transitions.begin(), transitions.end(),
                    [&](const JudgedTransition& t) { return t.truth.kind == kind && t.said == said; }));
}

}  // namespace

Comparison compare(const Truth& truth, const Store& store) {
  Comparison comparison;
  const std::map<int64_t, Frame> frames = read_frames(truth, store);
  if (frames.empty()) throw Error("the memory has no frame of the recording", {store.path().string(), 0, {}});
  std::set<Id> true_objects;
  for (const auto& [index, frame] : frames) {
    if (const auto things = truth.visible.find(index); things != truth.visible.end())
      comparison.visible += things->second.size();
    comparison.found += frame.object.size();
    for (const auto& [name, object] : frame.object) true_objects.insert(object);
  }
  for (const ObjectRow& object : store.objects())
    comparison.phantoms += true_objects.contains(object.id) ? 0 : 1;
  const Judge judge(frames);
  for (const TrueTransition& transition : truth.transitions) {
    if (!frames.contains(transition.from_frame) || !frames.contains(transition.to_frame)) continue;
    const JudgedTransition judged = judge.judge(transition);
    if (judged.from_object != 0 && judged.to_object != 0) {
      ++comparison.same_pairs;
      comparison.same_kept += judged.from_object == judged.to_object ? 1 : 0;
    }
    comparison.transitions.push_back(judged);
  }
  count_returns(comparison.transitions, comparison);
  return comparison;
}

size_t Comparison::certain() const {
  return static_cast<size_t>(
      std::count_if(transitions.begin(), transitions.end(),
                    [](const JudgedTransition& t) { return t.truth.kind != "uncertain"; }));
}

size_t Comparison::right() const {
  return static_cast<size_t>(std::count_if(transitions.begin(), transitions.end(),
                                           [](const JudgedTransition& t) { return t.right(); }));
}

std::string Comparison::text(bool verbose) const {
  std::string out = fmt::format("{:<12}", "truth \\ said");
  for (const char* said : kSaidKinds) out += fmt::format(" {:>15}", said);
  out += "\n";
  for (const char* kind : kTrueKinds) {
    out += fmt::format("{:<12}", kind);
    for (const char* said : kSaidKinds) out += fmt::format(" {:>15}", count_of(transitions, kind, said));
    out += "\n";
  }
  out += fmt::format("right: {} of {} certain transitions\n", right(), certain());
  out += fmt::format(
      "found: {} of {} visible things; identity kept: {} of {}; recognised on return: {} of {}; "
      "objects that are no true thing: {}\n",
      found, visible, same_kept, same_pairs, recognised, returned, phantoms);
  if (!verbose) return out;
  for (const JudgedTransition& t : transitions) {
    const auto name = [](Id id) { return id == 0 ? std::string("-") : object_name(id); };
    out += fmt::format("{:>4} -> {:<4} {:<16} {:<10} {:<16} {} -> {}{}\n", t.truth.from_frame,
                       t.truth.to_frame, t.truth.object, t.truth.kind, t.said, name(t.from_object),
                       name(t.to_object), t.right() || t.truth.kind == "uncertain" ? "" : "   WRONG");
  }
  return out;
}

Json Comparison::to_json() const {
  Json table = Json::object();
  for (const char* kind : kTrueKinds)
    for (const char* said : kSaidKinds) table[kind][said] = count_of(transitions, kind, said);
  Json list = Json::array();
  for (const JudgedTransition& t : transitions)
    list.push_back({{"from_frame", t.truth.from_frame},
                    {"to_frame", t.truth.to_frame},
                    {"object", t.truth.object},
                    {"truth", t.truth.kind},
                    {"said", t.said},
                    {"right", t.right()},
                    {"memory_from", t.from_object == 0 ? Json() : Json(object_name(t.from_object))},
                    {"memory_to", t.to_object == 0 ? Json() : Json(object_name(t.to_object))}});
  return {{"table", table},
          {"certain", certain()},
          {"right", right()},
          {"visible", visible},
          {"found", found},
          {"identity_pairs", same_pairs},
          {"identity_kept", same_kept},
          {"returned", returned},
          {"recognised", recognised},
          {"phantoms", phantoms},
          {"transitions", list}};
}

}  // namespace loci::changes
