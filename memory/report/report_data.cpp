#include "memory/report/report_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "mapping/image/hsv.h"
#include "memory/questions/objects.h"

namespace loci::memory {
namespace {

/// Those with most observations, in order of id.
std::vector<ObjectBelief> seen_most(std::vector<ObjectBelief> objects, size_t most) {
  std::stable_sort(objects.begin(), objects.end(),
                   [](const ObjectBelief& a, const ObjectBelief& b) { return a.sightings > b.sightings; });
  if (objects.size() > most) objects.resize(most);
  std::sort(objects.begin(), objects.end(),
            [](const ObjectBelief& a, const ObjectBelief& b) { return a.object.id < b.object.id; });
  return objects;
}

std::string css_from(const std::array<uint8_t, 3>& rgb) {
  return fmt::format("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2]);
}

}  // namespace

ReportData::ReportData(const Store& memory, const ReportOptions& options, Progress& progress)
    : store(memory), times(memory) {
  std::vector<ObjectBelief> all = ask(store, ObjectsQuestion{}).objects;
  objects = all.size();
  const std::vector<ObjectBelief> chosen = seen_most(std::move(all), options.objects);
  for (size_t i = 0; i < chosen.size(); ++i) {
    progress.check(static_cast<double>(i) / static_cast<double>(chosen.size()), "reading histories");
    HistoryAnswer answer = ask(store, HistoryQuestion{.subject = chosen[i].object.name});
    for (ObjectHistory& history : answer.objects) histories.push_back(std::move(history));
  }
  for (const BeliefRow& belief : store.beliefs())
    if (belief.hsv)
      colors[belief.object] =
          css_from(mapping::rgb8_from_hsv(belief.hsv->hue, belief.hsv->saturation, belief.hsv->value));
  scenes = store.scenes();
  scenes_in_all = scenes.size();
  if (scenes.size() > options.scenes)
    scenes.erase(scenes.begin(), scenes.end() - static_cast<std::ptrdiff_t>(options.scenes));
}

std::string ReportData::css_of(Id object) const {
  const auto found = colors.find(object);
  return found == colors.end() ? css_from(mapping::kUnknownRgb) : found->second;
}

std::string ReportData::objects_left_out() const {
  if (histories.size() >= objects) return "";
  return fmt::format("<p class=\"faint\">Of {} objects the {} with most observations.</p>\n", objects,
                     histories.size());
}

std::string ReportData::scenes_left_out() const {
  if (scenes.size() >= scenes_in_all) return "";
  return fmt::format("<p class=\"faint\">Of {} scenes the last {}.</p>\n", scenes_in_all, scenes.size());
}

std::string partner_name(const std::optional<Id>& object) {
  return object ? object_name(*object) : "clutter";
}

std::map<Id, ChosenAssociation> chosen_associations(const Store& store, Id scene) {
  const std::vector<AssociationRow> considered = store.associations(scene);
  std::map<Id, ChosenAssociation> result;
  for (const AssociationRow& row : considered)
    if (row.chosen && row.observation) result[*row.observation].chosen = row;
  std::map<Id, std::map<std::optional<Id>, double>> others;
  for (const AssociationRow& row : considered) {
    if (!row.observation || !result.contains(*row.observation)) continue;
    ChosenAssociation& association = result.at(*row.observation);
    if (row.object == association.chosen.object)
      association.probability += row.probability;
    else
      others[*row.observation][row.object] += row.probability;
  }
  for (const auto& [observation, objects] : others)
    for (const auto& [object, probability] : objects)
      if (std::string& text = result.at(observation).alternatives; probability >= 0.01)
        text +=
            fmt::format("{}{} {:.0f} %", text.empty() ? "" : ", ", partner_name(object), 100 * probability);
  return result;
}

std::string status_text(ObjectStatus status) {
  std::string text = to_text(status);
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

}  // namespace loci::memory
