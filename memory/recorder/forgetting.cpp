// What of the belief and of the reasoning is left when something was forgotten.

#include <algorithm>
#include <memory>

#include "memory/belief/serialization.h"
#include "memory/recorder/checkpoint.h"

namespace loci::memory {
namespace {

/// Removes the elements of a list for which `gone` holds by index.
template <class List, class Gone>
void erase_by_index(List& list, Gone gone) {
  size_t index = 0;
  std::erase_if(list, [&](const auto&) { return gone(index++); });
}

/// Removes rows and columns of a table, row by row, of `width` columns.
template <class Value>
void erase_cells(std::vector<Value>& table, size_t width, const std::vector<bool>& rows,
                 const std::vector<bool>& columns) {
  if (width > 0) erase_by_index(table, [&](size_t i) { return rows.at(i / width) || columns.at(i % width); });
}

void erase_from(belief::SceneMatrices& matrices, const std::vector<bool>& rows, const std::set<int64_t>& keys,
                const std::set<Id>& objects) {
  std::vector<bool> columns;
  for (size_t i = 0; i < matrices.keys.size(); ++i)
    columns.push_back(keys.contains(matrices.keys[i]) || objects.contains(matrices.objects.at(i)));
  const size_t width = columns.size();
  for (auto& distances : matrices.distances) erase_cells(distances, width, rows, columns);
  erase_cells(matrices.offsets, width, rows, columns);
  erase_cells(matrices.similarity, width, rows, columns);
  matrices.rows -= static_cast<uint32_t>(std::ranges::count(rows, true));
  erase_by_index(matrices.keys, [&](size_t i) { return columns[i]; });
  erase_by_index(matrices.objects, [&](size_t i) { return columns[i]; });
}

/// Keys of proto objects that stand for a gone object. Tentative ones have no number yet, but the same key.
void add_keys(const belief::SceneReasoning& reasoning, const std::set<Id>& objects, std::set<int64_t>& keys) {
  const auto add = [&](int64_t key, Id object) {
    if (key != 0 && objects.contains(object)) keys.insert(key);
  };
  for (const belief::ObservationDecision& decision : reasoning.decisions.observations) {
    add(decision.key, decision.object);
    for (const belief::Candidate& candidate : decision.candidates) add(candidate.key, candidate.object);
  }
  for (const belief::ObjectDecision& decision : reasoning.decisions.unobserved)
    add(decision.key, decision.object);
  for (size_t i = 0; i < reasoning.matrices.keys.size(); ++i)
    add(reasoning.matrices.keys[i], reasoning.matrices.objects.at(i));
}

/// The reasoning of a scene without what is erased; unset where its numbers are those of another memory.
std::optional<belief::SceneReasoning> without(belief::SceneReasoning reasoning, const ErasedFromScene& scene,
                                              const std::set<int64_t>& keys) {
  auto& observations = reasoning.evidence.observations;
  auto& decisions = reasoning.decisions;
  const size_t count = scene.observations.size();
  if (observations.size() != count || decisions.observations.size() != count ||
      reasoning.matrices.rows != count)
    return std::nullopt;
  std::vector<bool> rows;
  for (size_t i = 0; i < count; ++i) {
    if (observations[i].id != scene.observations[i]) return std::nullopt;
    rows.push_back(scene.erased.contains(scene.observations[i]));
  }
  const auto is_gone = [&](const auto& one) {
    return keys.contains(one.key) || scene.objects.contains(one.object);
  };
  erase_from(reasoning.matrices, rows, keys, scene.objects);
  erase_by_index(observations, [&](size_t i) { return rows[i]; });
  erase_by_index(decisions.observations, [&](size_t i) { return rows[i]; });
  for (belief::ObservationDecision& decision : decisions.observations) {
    std::erase_if(decision.candidates, is_gone);
    if (is_gone(decision)) decision.key = decision.object = 0;  // an edit gave it to another object
  }
  std::erase_if(decisions.unobserved, is_gone);
  return reasoning;
}

/// What the checkpoints hold: unset where it cannot be read, for another version of loci wrote it.
template <class Value>
std::optional<Value> if_readable(const Store& store, Value (*load)(const Store&)) {
  try {
    return load(store);
  } catch (const Error&) {
    return std::nullopt;
  }
}

/// Keys of the proto objects that stand for gone objects, in the belief or in any scene.
std::set<int64_t> keys_of(const Store& store, const std::set<Id>& objects) {
  std::set<int64_t> keys;
  if (const auto state = if_readable<belief::BeliefState>(store, load_belief))
    for (const belief::ProtoObject& object : state->objects)
      if (objects.contains(object.id)) keys.insert(object.key);
  for (const SceneRow& row : store.scenes())
    if (const auto stored = store.reasoning(row.id))
      add_keys(belief::reasoning_from_bytes(*stored), objects, keys);
  return keys;
}

ReasoningFilter reasoning_filter(const Store& store) {
  // Which objects are gone is known when the first scene is filtered.
  auto keys = std::make_shared<std::optional<std::set<int64_t>>>();
  return
      [keys, &store](const std::string& bytes, const ErasedFromScene& scene) -> std::optional<std::string> {
        try {
          if (!*keys) *keys = keys_of(store, scene.objects);
          const auto rest = without(belief::reasoning_from_bytes(bytes), scene, **keys);
          return rest ? std::optional(belief::to_bytes(*rest)) : std::nullopt;
        } catch (const Error&) {
          return std::nullopt;  // what cannot be read cannot be searched
        }
      };
}

/// An object as its last remaining observation left it.
void restore(belief::ProtoObject& object, const ObjectObservation& last,
             const std::vector<PlaceRow>& places) {
  object.last_seen = object.last_update = last.time;
  object.last_observation = last.observation.id;
  object.place.clear();
  for (const PlaceRow& place : places)
    if (place.id == last.observation.place && !place.joint) object.place = place.name;
  if (last.observation.position) object.box.centre = *last.observation.position;
  if (last.observation.size) object.box.size = *last.observation.size;
  object.class_name.clear();  // the next observation classifies it
  object.alternatives.clear();
}

/// The belief without what was forgotten.
void forget_in(belief::BeliefState& state, const Store& store, const ForgetRequest& request,
               const ForgetResult& result) {
  const auto in_span = [&](TimeNs time) {
    return request.from && request.to && time >= *request.from && time <= *request.to;
  };
  const std::vector<PlaceRow> places = store.places();
  std::set<int64_t> gone;
  for (belief::ProtoObject& object : state.objects) {
    const auto seen = object.id != 0 ? store.observations_of(object.id) : std::vector<ObjectObservation>();
    std::erase_if(object.pending, [&](const belief::PendingObservation& pending) {
      return result.observation_ids.contains(pending.observation) || in_span(pending.time);
    });
    const bool lost_last =
        result.observation_ids.contains(object.last_observation) || in_span(object.last_seen);
    const bool lost_first = in_span(object.first_seen);
    // A stored view has the time of its scene.
    const auto is_lost = [&](const auto& view) {
      return in_span(view.time) || (lost_last && std::ranges::none_of(seen, [&](const auto& one) {
                                      return one.time == view.time;
                                    }));
    };
    const bool lost_views = std::erase_if(object.views, is_lost) > 0;
    std::erase_if(object.textures, is_lost);
    const bool empty = object.views.empty() && (lost_views || lost_last);
    if (result.object_ids.contains(object.id) || empty || ((lost_last || lost_first) && seen.empty())) {
      gone.insert(object.key);
      continue;
    }
    if (lost_last) restore(object, seen.back(), places);
    if (lost_first) object.first_seen = seen.front().time;
  }
  // An alternative hypothesis stands for the object at its former spot.
  std::erase_if(state.objects, [&](const belief::ProtoObject& object) {
    return gone.contains(object.key) || gone.contains(object.alternative_of);
  });
  std::set<std::string> class_names;
  for (belief::ProtoObject& object : state.objects) {
    std::erase_if(object.alternatives,
                  [&](const belief::Alternative& alternative) { return gone.contains(alternative.key); });
    class_names.insert(object.class_name);
  }
  state.interaction.retain_classes(
      class_names);  // else the class of a forgotten object would stay in the file
}

}  // namespace

ForgetResult forget(Store& store, const ForgetRequest& request, Id run) {
  std::optional<belief::BeliefState> state = if_readable<belief::BeliefState>(store, load_belief);
  const auto options = if_readable<belief::BeliefOptions>(store, load_options);
  ForgetResult result = store.forget(request, run, reasoning_filter(store));
  if (const std::optional<SceneRow> last = store.last_scene()) {
    if (state) forget_in(*state, store, request, result);
    SceneTransaction transaction(store, run);
    if (state)
      BeliefCheckpoint(options.value_or(belief::BeliefOptions())).save(transaction, last->id, *state);
    else if (drop_unreadable_belief(transaction, store))
      result.erased[kUnreadableBelief] = 1;
    transaction.drop_checkpoints(kKeptBeliefs);
    transaction.commit();
  }
  return result;
}

}  // namespace loci::memory
