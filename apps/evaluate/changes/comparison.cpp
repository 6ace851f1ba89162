#include "apps/evaluate/changes/comparison.h"

#include <algorithm>

#include "mapping/base/text/json.h"
#include "memory/identity/matchings.h"
#include "memory/recorder/scene_reasoning.h"

namespace loci::apps::changes {
namespace {

/// One frame: which object each true object is taken for.
struct Frame {
  std::map<std::string, memory::Id> object;       ///< of true objects that were found; 0 = not attributed
  std::map<std::string, memory::Id> observation;  ///< of true objects that were found
  std::map<std::string, double> probability;      ///< of true objects: stated, of being this object
  std::map<memory::Id, std::set<std::string>> events;
  std::set<memory::Id> seen;     ///< objects
  std::set<memory::Id> clutter;  ///< of these, what the room's clutter was taken for
  size_t attributed = 0;
};

/// How far an object and what was observed are from each other; unset = they have nothing to do with each
/// other. Where both have pixels, these tell: of an object that is cut off, the visible part's centre lies
/// elsewhere.
std::optional<double> gap(const TrueObject& true_object, const Sight& sight) {
  if (true_object.pixels && sight.pixels) {
    const auto [x, y, width, height] = *true_object.pixels;
    const auto [u, v, columns, rows] = *sight.pixels;
    const double shared = std::max(0, std::min(x + width, u + columns) - std::max(x, u)) *
                          double(std::max(0, std::min(y + height, v + rows) - std::max(y, v)));
    const double overlap = shared / (double(width) * height + double(columns) * rows - shared);
    if (overlap >= 0.5) return 1 - overlap;
  }
  const double distance = (true_object.centre - sight.position).norm();
  const double reach = std::max(0.06, 0.6 * true_object.size.maxCoeff());
  return distance <= reach ? std::optional(1 + distance) : std::nullopt;
}

}  // namespace

std::map<size_t, size_t> find_true_objects(const std::vector<TrueObject>& true_objects,
                                           const Moment& moment) {
  std::vector<std::tuple<double, size_t, size_t>> candidates;
  for (size_t k = 0; k < moment.sights.size(); ++k)
    for (size_t i = 0; i < true_objects.size(); ++i)
      if (const std::optional<double> distance = gap(true_objects[i], moment.sights[k]))
        candidates.emplace_back(*distance, i, k);
  std::sort(candidates.begin(), candidates.end());
  std::map<size_t, size_t> true_object_of;
  std::set<size_t> taken;
  for (const auto& [ignored, i, k] : candidates)
    if (!true_object_of.contains(k) && taken.insert(i).second) true_object_of[k] = i;
  return true_object_of;
}

namespace {

std::vector<TrueObject> true_objects_in(const std::map<int64_t, std::vector<TrueObject>>& true_objects,
                                        int64_t frame) {
  const auto found = true_objects.find(frame);
  return found == true_objects.end() ? std::vector<TrueObject>() : found->second;
}

void record(const std::string& true_object, memory::Id observation, const Told& told, Frame& frame) {
  frame.observation[true_object] = observation;
  const auto object = told.object_of.find(observation);
  frame.object[true_object] = object == told.object_of.end() ? 0 : object->second;
  const auto stated = told.probability.find(observation);
  if (stated != told.probability.end()) frame.probability[true_object] = stated->second;
}

std::map<int64_t, Frame> read_frames(const Truth& truth, const Moments& moments, const Story& story) {
  std::map<int64_t, Frame> frames;
  for (const auto& [index, moment] : moments) {
    Frame& frame = frames[index];
    const auto told = story.find(index);
    if (told == story.end()) continue;
    frame.events = told->second.events;
    for (const auto& [observation, object] : told->second.object_of) frame.seen.insert(object);
    std::vector<TrueObject> true_objects = true_objects_in(truth.visible, index);
    const size_t visible = true_objects.size();
    for (const TrueObject& true_object : true_objects_in(truth.barely, index))
      true_objects.push_back(true_object);
    const size_t of_the_day = true_objects.size();
    true_objects.insert(true_objects.end(), truth.clutter.begin(), truth.clutter.end());
    const std::map<size_t, size_t> true_object_of = find_true_objects(true_objects, moment);
    for (size_t k = 0; k < moment.sights.size(); ++k) {
      const auto object = told->second.object_of.find(moment.sights[k].observation);
      const bool attributed = object != told->second.object_of.end();
      const auto true_object = true_object_of.find(k);
      if (true_object != true_object_of.end() && true_object->second < visible)
        record(true_objects[true_object->second].name, moment.sights[k].observation, told->second, frame);
      else if (true_object != true_object_of.end()) {
        if (attributed && true_object->second >= of_the_day) frame.clutter.insert(object->second);
        continue;
      }
      frame.attributed += attributed ? 1 : 0;
    }
  }
  return frames;
}

/// What it is in a frame; 0 = not in it.
memory::Id id_in(const std::map<std::string, memory::Id>& ids, const std::string& true_object) {
  const auto found = ids.find(true_object);
  return found == ids.end() ? 0 : found->second;
}

class Judge {
 public:
  explicit Judge(const std::map<int64_t, Frame>& frames) : frames_(frames) {}

  JudgedTransition judge(const TrueTransition& truth) const {
    JudgedTransition judged{truth, ""};
    const Frame& from = frames_.at(truth.from_frame);
    const Frame& to = frames_.at(truth.to_frame);
    if (truth.kind != "added") {
      judged.from_object = id_in(from.object, truth.object);
      judged.from_observation = id_in(from.observation, truth.object);
    }
    if (truth.kind != "removed") {
      judged.to_object = id_in(to.object, truth.object);
      judged.to_observation = id_in(to.observation, truth.object);
    }
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
    const bool came = happened(before, last(), j.to_object, "appeared") ||
                      happened(before, j.truth.to_frame, j.to_object, "reappeared");
    return came ? "added" : "confused";
  }

  std::string said_removed(const JudgedTransition& j, const Frame& to) const {
    if (j.from_object == 0) return "not found";
    if (to.seen.contains(j.from_object)) return "confused";
    // With one look per place it may take until the camera comes back; a fixed camera sees it at once.
    return happened(j.truth.from_frame, gone_until(j), j.from_object, "gone") ? "removed" : "kept";
  }

  int64_t gone_until(const JudgedTransition& j) const {
    // Until the object is seen again, or to the end.
    for (auto frame = frames_.upper_bound(j.truth.to_frame); frame != frames_.end(); ++frame)
      if (frame->second.object.contains(j.truth.object)) return frame->first - 1;
    return last();
  }

  std::string said_both(const JudgedTransition& j, const Frame& to) const {
    if (j.from_object == 0 || j.to_object == 0) return "not found";
    const int64_t from = j.truth.from_frame, until = j.truth.to_frame;
    if (j.from_object != j.to_object)
      return to.seen.contains(j.from_object) || !happened(from, until, j.to_object, "appeared")
                 ? "confused"
                 : "identity lost";
    if (happened(from, until, j.to_object, "moved")) return "moved";
    if (happened(from, until, j.to_object, "looks_different")) return "looks_different";
    return "unchanged";
  }

  bool happened(int64_t after, int64_t until, memory::Id object, const char* kind) const {
    for (auto frame = frames_.upper_bound(after); frame != frames_.end() && frame->first <= until; ++frame) {
      const auto events = frame->second.events.find(object);
      if (events != frame->second.events.end() && events->second.contains(kind)) return true;
    }
    return false;
  }

  int64_t last() const { return frames_.rbegin()->first; }

  const std::map<int64_t, Frame>& frames_;
};

/// Objects that were removed and came back: recognised as the same?
void count_returns(Comparison& comparison) {
  std::map<std::string, memory::Id> removed;
  for (const JudgedTransition& t : comparison.transitions) {
    if (t.truth.kind == "removed") removed[t.truth.object] = t.from_object;
    if (t.truth.kind != "added" || !removed.contains(t.truth.object)) continue;
    ++comparison.returned;
    comparison.recognised += t.to_object != 0 && removed.at(t.truth.object) == t.to_object ? 1 : 0;
    removed.erase(t.truth.object);
  }
}

void count_switches(const std::map<int64_t, Frame>& frames, Comparison& comparison) {
  std::map<std::string, memory::Id> last;
  for (const auto& [index, frame] : frames)
    for (const auto& [true_object, object] : frame.object) {
      if (object == 0) continue;
      memory::Id& before = last[true_object];
      comparison.pairs += before != 0 ? 1 : 0;
      comparison.switches += before != 0 && before != object ? 1 : 0;
      const auto stated = frame.probability.find(true_object);
      if (before != 0 && stated != frame.probability.end())
        comparison.association.emplace_back(stated->second, before == object);
      before = object;
    }
}

void count_false_gone(const Truth& truth, const std::map<int64_t, Frame>& frames, Comparison& comparison) {
  struct Seen {
    std::string true_object;
    int handled = 0;
  };
  std::map<memory::Id, Seen> last;
  for (const auto& [index, frame] : frames) {
    const auto world = truth.handled.find(index);
    if (world == truth.handled.end()) continue;
    for (const auto& [object, kinds] : frame.events) {
      if (!kinds.contains("gone") || !last.contains(object)) continue;
      const auto now = world->second.find(last.at(object).true_object);
      comparison.false_gone += now != world->second.end() && now->second == last.at(object).handled ? 1 : 0;
    }
    for (const auto& [true_object, object] : frame.object)
      if (object != 0) last[object] = {true_object, world->second.at(true_object)};
  }
}

/// Sightings that agree with the best pairing of objects with objects, each once.
size_t count_agreed(const std::map<int64_t, Frame>& frames) {
  std::map<std::string, size_t> row_of;
  std::map<memory::Id, size_t> column_of;
  std::map<std::pair<size_t, size_t>, double> common;
  for (const auto& [index, frame] : frames)
    for (const auto& [true_object, object] : frame.object) {
      if (object == 0) continue;
      const size_t row = row_of.emplace(true_object, row_of.size()).first->second;
      const size_t column = column_of.emplace(object, column_of.size()).first->second;
      ++common[{row, column}];
    }
  if (common.empty()) return 0;
  const size_t rows = std::min(row_of.size(), column_of.size());
  const size_t columns = std::max(row_of.size(), column_of.size());
  memory::IdentityComponent component;
  component.transposed = column_of.size() < row_of.size();
  component.log_ratio.setConstant(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns),
                                  memory::kNever);
  for (const auto& [pair, count] : common) {
    const auto [true_object, object] = pair;
    component.log_ratio(static_cast<Eigen::Index>(component.transposed ? object : true_object),
                        static_cast<Eigen::Index>(component.transposed ? true_object : object)) = count;
  }
  for (size_t i = 0; i < rows; ++i) component.rows.push_back(i);
  for (size_t j = 0; j < columns; ++j) component.columns.push_back(j);
  component.row_free.assign(rows, true);
  component.column_free.assign(columns, true);
  const std::vector<memory::Matching> best = ranked_matchings(component, 1);
  double agreed = 0;
  for (const auto& pair : best.front().pairs) agreed += common.at(pair);
  return static_cast<size_t>(agreed);
}

}  // namespace

bool JudgedTransition::right() const {
  if (truth.kind == "moved and turned") return said == "moved";
  if (truth.kind == "turned") return said == "moved" || said == "looks_different";
  if (truth.kind == "recoloured") return said == "looks_different";
  return said == truth.kind;
}

Comparison compare(const std::string& method, const Truth& truth, const Moments& moments,
                   const Story& story) {
  Comparison comparison;
  comparison.method = method;
  const std::map<int64_t, Frame> frames = read_frames(truth, moments, story);
  std::set<memory::Id> known, all;
  for (const auto& [index, frame] : frames) {
    comparison.visible += true_objects_in(truth.visible, index).size();
    comparison.found += frame.object.size();
    comparison.attributed += frame.attributed;
    for (const auto& [name, object] : frame.object) known.insert(object);
    known.insert(frame.clutter.begin(), frame.clutter.end());
    all.insert(frame.seen.begin(), frame.seen.end());
  }
  for (const memory::Id object : all) comparison.phantoms += known.contains(object) ? 0 : 1;
  const Judge judge(frames);
  for (const TrueTransition& transition : truth.transitions)
    if (frames.contains(transition.from_frame) && frames.contains(transition.to_frame))
      comparison.transitions.push_back(judge.judge(transition));
  comparison.agreed = count_agreed(frames);
  count_switches(frames, comparison);
  count_false_gone(truth, frames, comparison);
  count_returns(comparison);
  return comparison;
}

void Comparison::add(const Comparison& other) {
  method = other.method;
  transitions.insert(transitions.end(), other.transitions.begin(), other.transitions.end());
  visible += other.visible;
  found += other.found;
  attributed += other.attributed;
  agreed += other.agreed;
  switches += other.switches;
  pairs += other.pairs;
  association.insert(association.end(), other.association.begin(), other.association.end());
  false_gone += other.false_gone;
  returned += other.returned;
  recognised += other.recognised;
  phantoms += other.phantoms;
  arbiter.observations += other.arbiter.observations;
  arbiter.settled += other.arbiter.settled;
  arbiter.as_decided += other.arbiter.as_decided;
}

size_t Comparison::certain() const {
  return static_cast<size_t>(
      std::ranges::count_if(transitions, [](const JudgedTransition& t) { return t.counts(); }));
}

size_t Comparison::right() const {
  return static_cast<size_t>(
      std::ranges::count_if(transitions, [](const JudgedTransition& t) { return t.counts() && t.right(); }));
}

size_t Comparison::count(const std::string& kind) const {
  return static_cast<size_t>(
      std::ranges::count_if(transitions, [&](const JudgedTransition& t) { return t.truth.kind == kind; }));
}

size_t Comparison::count_right(const std::string& kind) const {
  return static_cast<size_t>(std::ranges::count_if(
      transitions, [&](const JudgedTransition& t) { return t.truth.kind == kind && t.right(); }));
}

size_t Comparison::count(const std::string& kind, const std::string& said) const {
  return static_cast<size_t>(std::ranges::count_if(
      transitions, [&](const JudgedTransition& t) { return t.truth.kind == kind && t.said == said; }));
}

double Comparison::identity_f1() const {
  const size_t sum = visible + attributed;
  return sum == 0 ? 1.0 : 2 * double(agreed) / double(sum);
}

std::vector<std::pair<std::string, Stated>> stated_associations(const std::vector<Comparison>& methods) {
  std::vector<std::pair<std::string, Stated>> stated;
  for (const Comparison& method : methods)
    if (!method.association.empty()) stated.emplace_back("association, " + method.method, method.association);
  return stated;
}

std::vector<Comparison> compare_all(const std::filesystem::path& folder, const mapping::Recording& recording,
                                    const memory::Store& memory, const std::vector<TrueObject>& clutter) {
  Truth truth = read_truth(folder, recording);
  truth.clutter = clutter;
  const Moments moments = read_moments(memory);
  std::vector<Comparison> methods = {compare("loci", truth, moments, memory_story(memory, moments)),
                                     compare("greedy", truth, moments, greedy_story(moments)),
                                     compare("nearest", truth, moments, nearest_story(moments))};
  for (const memory::SceneRow& scene : memory.scenes())
    if (const std::optional<memory::SceneReasoning> reasoning = load_reasoning(memory, scene.id))
      methods.front().arbiter.add(reasoning->matrices, reasoning->decisions);
  return methods;
}

}  // namespace loci::apps::changes
