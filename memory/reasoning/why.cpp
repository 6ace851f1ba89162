#include "memory/reasoning/why.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mapping/base/text/json.h"
#include "memory/belief/association/decisions.h"
#include "memory/reasoning/pair_matrices.h"
#include "memory/recorder/scene_reasoning.h"

namespace loci::memory {
namespace {

constexpr size_t kScenesLookedAt = 200;  ///< after a sighting, for what was concluded since

Json number_or_null(double value) {
  return std::isfinite(value) ? Json(std::round(value * 1e4) / 1e4) : Json();
}

std::string name_of(int64_t object, int64_t key) {
  if (object != 0) return object_name(object);
  return key != 0 ? fmt::format("something not yet sure (#{})", key) : std::string("a false cluster");
}

std::string percent(double probability) {
  return fmt::format("{:.{}f} %", 100 * probability, probability < 0.1 || probability > 0.99 ? 1 : 0);
}

struct Evidence {
  std::string kind;
  double distance, log_ratio;
};

std::vector<Evidence> evidence_of(const belief::Decisions& decisions, const belief::Candidate& candidate) {
  std::vector<Evidence> list;
  for (size_t i = 0; i < candidate.log_ratios.size(); ++i)
    if (std::isfinite(candidate.distances[i]))
      list.push_back({decisions.kinds[i], candidate.distances[i], candidate.log_ratios[i]});
  return list;
}

std::string evidence_text(const belief::Decisions& decisions, const belief::Candidate& candidate) {
  std::string parts;
  for (const Evidence& e : evidence_of(decisions, candidate))
    parts +=
        fmt::format("{}{} {:.2f} -> {:+.1f}", parts.empty() ? "" : ", ", e.kind, e.distance, e.log_ratio);
  return fmt::format(
      "looks {:+.1f} ({}), position {:+.1f}; beforehand: stayed {:+.1f}, moved {:+.1f}, changed {:+.1f}",
      candidate.similar, parts.empty() ? "nothing to compare" : parts, candidate.proximity,
      candidate.stay_prior, candidate.move_prior, candidate.newview_prior);
}

Json candidate_json(const belief::Decisions& decisions, size_t k, const belief::Candidate& candidate) {
  Json evidence = Json::object();
  for (const Evidence& e : evidence_of(decisions, candidate))
    evidence[e.kind] = {{"distance", number_or_null(e.distance)}, {"log_ratio", number_or_null(e.log_ratio)}};
  const bool chosen = decisions.observations[k].key == candidate.key;
  return {{"object", candidate.object == 0 ? Json() : Json(object_name(candidate.object))},
          {"probability", number_or_null(candidate.probability())},
          {"stay", number_or_null(candidate.stay)},
          {"move", number_or_null(candidate.move)},
          {"newview", number_or_null(candidate.newview)},
          {"evidence", evidence},
          {"log_similar", number_or_null(candidate.similar)},
          {"log_proximity", number_or_null(candidate.proximity)},
          {"log_prior",
           {{"stay", number_or_null(candidate.stay_prior)},
            {"move", number_or_null(candidate.move_prior)},
            {"newview", number_or_null(candidate.newview_prior)}}},
          {"against", chosen ? Json() : Json(belief::rejection_reason(decisions, k, candidate))}};
}

Why explain(const belief::Decisions& decisions, size_t k) {
  const belief::ObservationDecision& d = decisions.observations[k];
  const std::string chosen = to_text(d.explanation);
  Why why;
  why.text = fmt::format("observation {} is {}: {}, {}\n", k, name_of(d.object, d.key), chosen,
                         percent(d.probability));
  Json candidates = Json::array();
  for (const belief::Candidate& candidate : d.candidates) {
    const bool taken = candidate.key == d.key;
    why.text += fmt::format("  {} {}, {}\n    {}\n",
                            taken ? "taken:  " : "instead:", name_of(candidate.object, candidate.key),
                            percent(candidate.probability()), evidence_text(decisions, candidate));
    if (!taken)
      why.text += fmt::format("    not taken: {}\n", belief::rejection_reason(decisions, k, candidate));
    candidates.push_back(candidate_json(decisions, k, candidate));
  }
  why.text +=
      fmt::format("  {} something new, {} (beforehand {:+.1f}); a false cluster, {} (beforehand {:+.1f})\n",
                  d.explanation == Explanation::appear ? "taken:  " : "instead:", percent(d.appear),
                  d.appear_prior, percent(d.clutter), d.clutter_prior);
  why.json = {
      {"observation", k},
      {"object", d.object == 0 ? Json() : Json(object_name(d.object))},
      {"explanation", chosen},
      {"probability", number_or_null(d.probability)},
      {"candidates", candidates},
      {"new", {{"probability", number_or_null(d.appear)}, {"log_prior", number_or_null(d.appear_prior)}}},
      {"clutter",
       {{"probability", number_or_null(d.clutter)}, {"log_prior", number_or_null(d.clutter_prior)}}}};
  return why;
}

Why explain(const belief::ObjectDecision& d) {
  Why why;
  why.text = fmt::format(
      "{} was not seen: {} (gone {}, missed {}, out of sight {}). Of its place {} out of view, {} hidden, {} "
      "not "
      "measured, {} taken, {} seen through, {} searched in vain; still there: {}\n",
      name_of(d.object, d.key), to_text(d.explanation), percent(d.disappear), percent(d.missed),
      percent(d.out_of_sight), percent(d.out_of_view), percent(d.hidden), percent(d.unmeasured),
      percent(d.occupied), percent(d.seen_through), percent(d.searched), percent(d.here));
  why.json = {{"object", object_name(d.object)},
              {"explanation", to_text(d.explanation)},
              {"disappear", number_or_null(d.disappear)},
              {"missed", number_or_null(d.missed)},
              {"hidden", number_or_null(d.out_of_sight)},
              {"probability_here", number_or_null(d.here)},
              {"place",
               {{"out_of_view", number_or_null(d.out_of_view)},
                {"hidden", number_or_null(d.hidden)},
                {"unmeasured", number_or_null(d.unmeasured)},
                {"occupied", number_or_null(d.occupied)},
                {"seen_through", number_or_null(d.seen_through)},
                {"searched", number_or_null(d.searched)}}}};
  return why;
}

/// Proposals of the single-cue trackers.
Why explain_votes(const SceneReasoning& reasoning) {
  const belief::SceneMatrices& kept = reasoning.matrices;
  const auto name = [&](const std::optional<int64_t>& key) {
    const auto column = key ? std::ranges::find(kept.keys, *key) : kept.keys.end();
    if (column == kept.keys.end()) return std::string("-");
    return name_of(kept.objects[static_cast<size_t>(column - kept.keys.begin())], *key);
  };
  Why why;
  why.json = Json::array();
  const std::vector<belief::TrackerVotes> voted = belief::votes(kept);
  for (size_t k = 0; k < voted.size(); ++k) {
    why.text += fmt::format("trackers of observation {}:", k);
    Json one = Json::object();
    for (size_t t = 0; t < belief::kTrackers.size(); ++t) {
      why.text += fmt::format(" {} {},", belief::kTrackers[t], name(voted[k].key[t]));
      one[belief::kTrackers[t]] = voted[k].key[t] ? Json(name(voted[k].key[t])) : Json();
    }
    why.text += voted[k].settled ? " all agree\n" : " not settled\n";
    one["settled"] = voted[k].settled.has_value();
    why.json.push_back(std::move(one));
  }
  return why;
}

std::string heading(const SceneRow& scene) {
  return fmt::format("scene {} at {}: ", scene.id, format_time(scene.time));
}

[[noreturn]] void nothing_kept(const Store& store, Id scene) {
  if (store.reasoning_discarded(scene))
    throw Error(fmt::format("what was thought of scene {} was let go", scene), {store.name(), 0, {}},
                "loci-memory retain --keep-reasoning erased it; the conclusions are stored");
  throw Error(fmt::format("scene {} has no reasoning", scene), {store.name(), 0, {}},
              "it was written by an earlier version or forgotten; loci-memory reason makes it anew");
}

/// What the last look at an object's place said since it was seen.
std::optional<std::pair<SceneRow, belief::ObjectDecision>> last_visibility(const Store& store, Id object,
                                                                           TimeNs after, const AsOf& as_of) {
  std::vector<SceneRow> scenes = store.scenes(as_of, after, as_of.at);
  std::reverse(scenes.begin(), scenes.end());
  if (scenes.size() > kScenesLookedAt) scenes.resize(kScenesLookedAt);
  for (const SceneRow& scene : scenes) {
    if (scene.time <= after) break;
    const std::optional<SceneReasoning> reasoning = load_reasoning(store, scene.id);
    if (!reasoning) continue;
    for (const belief::ObjectDecision& d : reasoning->decisions.unobserved)
      if (d.object == object) return std::pair{scene, d};
  }
  return std::nullopt;
}

}  // namespace

Why why_object(const Store& store, Id object, const AsOf& as_of) {
  const std::vector<ObjectObservation> sightings = store.observations_of(object, as_of);
  if (sightings.empty())
    throw Error(fmt::format("{} was not seen{}", object_name(object), as_of.at ? " by then" : ""),
                {store.name(), 0, {}}, "loci-memory objects lists what is known");
  const ObjectObservation& last = sightings.back();
  const SceneRow scene = store.scene(last.association.scene);
  const std::optional<SceneReasoning> reasoning = load_reasoning(store, scene.id);
  if (!reasoning) nothing_kept(store, scene.id);
  Why why = explain(reasoning->decisions, static_cast<size_t>(last.observation.number));
  why.text = heading(scene) + why.text;
  why.json["scene"] = scene.id;
  why.json["time"] = format_time(scene.time);
  why.json = {{"object", object_name(object)}, {"last_seen", why.json}};
  if (const auto look = last_visibility(store, object, scene.time, as_of)) {
    const Why since = explain(look->second);
    why.text += heading(look->first) + since.text;
    why.json["since"] = since.json;
    why.json["since"]["scene"] = look->first.id;
    why.json["since"]["time"] = format_time(look->first.time);
  } else {
    why.text += "nobody has looked at its place since\n";
  }
  return why;
}

Why why_scene(const Store& store, Id id) {
  const SceneRow scene = store.scene(id);
  const std::optional<SceneReasoning> reasoning = load_reasoning(store, id);
  if (!reasoning) nothing_kept(store, id);
  Why why;
  why.text = heading(scene) + fmt::format("{} observations\n", reasoning->decisions.observations.size());
  why.json = {{"scene", id},
              {"time", format_time(scene.time)},
              {"observations", Json::array()},
              {"unseen", Json::array()},
              {"max_error", reasoning->decisions.gate_bound}};
  for (size_t k = 0; k < reasoning->decisions.observations.size(); ++k) {
    const Why one = explain(reasoning->decisions, k);
    why.text += one.text;
    why.json["observations"].push_back(one.json);
  }
  for (const belief::ObjectDecision& d : reasoning->decisions.unobserved) {
    const Why one = explain(d);
    why.text += one.text;
    why.json["unseen"].push_back(one.json);
  }
  const Why trackers = explain_votes(*reasoning);
  why.text += trackers.text;
  why.json["trackers"] = trackers.json;
  if (const std::optional<PairMatrices> matrices = pair_matrices(store, id)) {
    why.text += to_text(*matrices);
    why.json["matrices"] = to_json(*matrices);
  }
  return why;
}

}  // namespace loci::memory
