#include "gui/data/decisions.h"

#include <fmt/format.h>

#include "gui/data/scene_content.h"
#include "mapping/base/error.h"
#include "mapping/base/math/log_odds.h"
#include "memory/recorder/scene_reasoning.h"

namespace loci::gui {
namespace {

std::string name_of(const Names& names, int64_t object, int64_t key) {
  if (object != 0) return names.object(object);
  return key != 0 ? fmt::format("tentative (#{})", key) : std::string("a false cluster");
}

void add_reasoning(const memory::belief::Decisions& decisions, size_t k, const Names& names,
                   DecidedObservation& observation) {
  const memory::belief::ObservationDecision& d = decisions.observations[k];
  observation.key = d.key;
  observation.explanation = to_text(d.explanation);
  observation.probability = static_cast<double>(d.probability);
  observation.appear = static_cast<double>(d.appear);
  observation.clutter = static_cast<double>(d.clutter);
  for (const memory::belief::Candidate& c : d.candidates)
    observation.considered.push_back(
        {c.key, c.object, name_of(names, c.object, c.key), c.probability(),
         probability_from_log_odds(static_cast<double>(c.similar)),
         probability_from_log_odds(static_cast<double>(c.proximity)),
         c.key == d.key ? "" : memory::belief::rejection_reason(decisions, k, c)});
}

}  // namespace

SceneDecisions read_decisions(const memory::Store& store, const Names& names, const memory::SceneRow& scene) {
  SceneDecisions result{scene};
  std::map<memory::Id, memory::AssociationRow> chosen;
  for (const memory::AssociationRow& row : store.associations(scene.id))
    if (row.chosen && row.observation && row.probability > 0) chosen[*row.observation] = row;
  std::optional<memory::SceneReasoning> reasoning;
  try {
    reasoning = load_reasoning(store, scene.id);
  } catch (const Error& error) {  // the associations can be shown nevertheless
    result.unreadable = fmt::format("{} ({})", error.message(), error.hint());
  }
  result.kept = reasoning.has_value();
  for (const memory::ObservationRow& row : store.observations(scene.id)) {
    DecidedObservation observation;
    observation.number = row.number;
    if (const auto found = chosen.find(row.id); found != chosen.end()) {
      observation.object = found->second.object.value_or(0);
      observation.explanation = to_text(found->second.explanation);
      observation.probability = found->second.probability;
    }
    const auto k = static_cast<size_t>(row.number);
    if (reasoning && k < reasoning->decisions.observations.size())
      add_reasoning(reasoning->decisions, k, names, observation);
    observation.name = name_of(names, observation.object, observation.key);
    if (row.crop) observation.crop = read_image(store, *row.crop);
    result.observations.push_back(std::move(observation));
  }
  if (reasoning)
    for (const memory::belief::ObjectDecision& d : reasoning->decisions.unobserved)
      result.unseen.push_back({d.key, d.object, name_of(names, d.object, d.key),
                               static_cast<double>(d.disappear), static_cast<double>(d.missed),
                               static_cast<double>(d.out_of_sight)});
  return result;
}

}  // namespace loci::gui
