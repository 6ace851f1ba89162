#include "memory/exchange/belief_states.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mapping/base/text/json.h"

namespace loci::memory {
namespace {

constexpr double kMin = 0.001;
constexpr double kNextTo_m = 0.05;

double rounded(double value) {
  return std::round(value * 1e4) / 1e4;
}

Json vector_json(const std::optional<Vector3d>& v) {
  return v ? Json{rounded(v->x()), rounded(v->y()), rounded(v->z())} : Json();
}

std::string cluster_name(const ObservationRow& row) {
  return fmt::format("cluster_{}_{}", row.scene, row.number);
}

/// Observations of a scene, and what each may be.
struct Clusters {
  std::vector<ObservationRow> rows;
  std::map<Id, std::map<Id, double>> is;     ///< by observation and object
  std::map<Id, std::map<Id, double>> known;  ///< likewise, of objects that were known before
  std::map<Id, double> clutter;
  std::map<Id, Id> chosen;  ///< object by observation

  Clusters(const Store& store, const SceneRow& scene) : rows(store.observations(scene.id)) {
    for (const AssociationRow& row : store.associations(scene.id)) {
      if (!row.observation) continue;
      if (!row.object) {
        clutter[*row.observation] += row.probability;
        continue;
      }
      is[*row.observation][*row.object] += row.probability;
      if (row.explanation != Explanation::appear) known[*row.observation][*row.object] += row.probability;
      if (row.chosen) chosen[*row.observation] = *row.object;
    }
  }
};

class BeliefStateWriter {
 public:
  BeliefStateWriter(const Store& store, const SceneRow& scene, const std::optional<SceneRow>& previous)
      : scene_(scene), now_(store, scene), beliefs_(store.beliefs({.at = scene.time})) {
    if (previous) before_.emplace(store, *previous);
    for (const PlaceRow& place : store.places()) places_[place.id] = place;
    for (const BeliefRow& belief : beliefs_) {
      const bool seen =
          std::ranges::any_of(now_.chosen, [&](const auto& one) { return one.second == belief.object; });
      if (!seen && belief.status != ObjectStatus::gone) persisting_.push_back(&belief);
    }
  }

  Json json() const {
    Json state = {{"scene", scene_.id}, {"time", format_time(scene_.time)}};
    state["current_clusters"] = clusters(now_);
    state["previous_clusters"] = before_ ? clusters(*before_) : Json::array();
    state["persisting_objects"] = Json::array();
    for (const BeliefRow* belief : persisting_)
      state["persisting_objects"].push_back(object_name(belief->object));
    state["known_objects"] = Json::array();
    for (const BeliefRow& belief : beliefs_) state["known_objects"].push_back(object(belief));
    state["relations"] = relations();
    state["identities"] = identities();
    state["tracking"] = tracking();
    return state;
  }

 private:
  Json place_name(const std::optional<Id>& id) const {
    const auto found = id ? places_.find(*id) : places_.end();
    return found == places_.end() ? Json() : Json(found->second.name);
  }

  Json clusters(const Clusters& of) const {
    Json list = Json::array();
    for (const ObservationRow& row : of.rows)
      list.push_back({{"name", cluster_name(row)},
                      {"place", place_name(row.place)},
                      {"position", vector_json(row.position)},
                      {"size", vector_json(row.size)}});
    return list;
  }

  Json object(const BeliefRow& belief) const {
    return {{"name", object_name(belief.object)},
            {"status", belief.status},
            {"probability", rounded(belief.probability)},
            {"place", place_name(belief.place)},
            {"position", vector_json(belief.position)}};
  }

  Json relations() const {
    Json list = Json::array();
    const auto add = [&](const char* predicate, const std::string& subject, const Json& of) {
      list.push_back({{"predicate", predicate}, {"subject", subject}, {"object", of}});
    };
    std::vector<const BeliefRow*> here;
    for (const BeliefRow& belief : beliefs_) {
      if (belief.status == ObjectStatus::gone) continue;
      here.push_back(&belief);
      const auto place = belief.place ? places_.find(*belief.place) : places_.end();
      if (place != places_.end())
        add(place->second.container ? "in" : "on", object_name(belief.object), place->second.name);
    }
    for (size_t i = 0; i < here.size(); ++i)
      for (size_t j = i + 1; j < here.size(); ++j)
        if (next_to(*here[i], *here[j]))
          add("next_to", object_name(here[i]->object), object_name(here[j]->object));
    return list;
  }

  static bool next_to(const BeliefRow& a, const BeliefRow& b) {
    if (!a.position || !b.position || !a.size || !b.size || a.place != b.place) return false;
    const Vector3d gap = (*a.position - *b.position).cwiseAbs() - (*a.size + *b.size) / 2;
    return gap.maxCoeff() < kNextTo_m;
  }

  Json identities() const {
    Json list = Json::array();
    for (const ObservationRow& row : now_.rows) {
      Json candidates = Json::object();
      const auto clutter = now_.clutter.find(row.id);
      const double mistaken = clutter == now_.clutter.end() ? 0.0 : clutter->second;
      double fresh = 1 - mistaken;  // the rest: new, or not confirmed yet
      if (const auto found = now_.known.find(row.id); found != now_.known.end())
        for (const auto& [object, probability] : found->second) {
          fresh -= probability;
          if (probability >= kMin) candidates[object_name(object)] = rounded(probability);
        }
      list.push_back({{"cluster", cluster_name(row)},
                      {"candidates", candidates},
                      {"new", rounded(std::max(0.0, fresh))},
                      {"false", rounded(mistaken)}});
    }
    return list;
  }

  /// The probability that two clusters are of one object, summed over the objects.
  Json tracking() const {
    Json list = Json::array();
    for (const ObservationRow& row : now_.rows) {
      const auto is = now_.known.find(row.id);
      Json candidates = Json::object();
      if (is != now_.known.end()) {
        for (const ObservationRow& earlier : before_ ? before_->rows : std::vector<ObservationRow>()) {
          const auto was = before_->is.find(earlier.id);
          double both = 0;
          if (was != before_->is.end())
            for (const auto& [object, probability] : was->second)
              if (const auto same = is->second.find(object); same != is->second.end())
                both += probability * same->second;
          if (both >= kMin) candidates[cluster_name(earlier)] = rounded(both);
        }
        for (const BeliefRow* belief : persisting_)
          if (const auto same = is->second.find(belief->object);
              same != is->second.end() && same->second >= kMin)
            candidates[object_name(belief->object)] = rounded(same->second);
      }
      list.push_back({{"cluster", cluster_name(row)}, {"candidates", candidates}});
    }
    return list;
  }

  const SceneRow& scene_;
  Clusters now_;
  std::optional<Clusters> before_;
  std::vector<BeliefRow> beliefs_;
  std::vector<const BeliefRow*> persisting_;
  std::map<Id, PlaceRow> places_;
};

}  // namespace

Json belief_state(const Store& store, const SceneRow& scene, const std::optional<SceneRow>& previous) {
  return BeliefStateWriter(store, scene, previous).json();
}

void for_each_belief_state(const Store& store, Progress& progress,
                           const std::function<void(const Json&)>& visitor) {
  const std::vector<SceneRow> scenes = store.scenes();
  for (size_t i = 0; i < scenes.size(); ++i) {
    progress.check(double(i) / double(scenes.size()), "belief states");
    visitor(belief_state(store, scenes[i], i > 0 ? std::optional(scenes[i - 1]) : std::nullopt));
  }
}

}  // namespace loci::memory
