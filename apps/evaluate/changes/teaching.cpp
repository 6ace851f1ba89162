#include "apps/evaluate/changes/teaching.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "apps/evaluate/changes/comparison.h"
#include "apps/evaluate/changes/story.h"
#include "mapping/base/text/json.h"
#include "memory/catalogue/catalogue.h"
#include "memory/questions/facts.h"

namespace loci::apps::changes {
namespace {

using memory::Id;

/// "mug" of "mug_3".
std::string class_of(const std::string& name) {
  return name.substr(0, name.find_last_of('_'));
}

/// The class of each remembered object: that of most true objects for which its observations stand.
std::map<Id, std::string> true_classes(const std::filesystem::path& folder,
                                       const mapping::Recording& recording, const memory::Store& store) {
  const Moments moments = read_moments(store);
  const Truth truth = read_truth(folder, recording);
  const Story story = memory_story(store, moments);
  std::map<Id, std::map<std::string, size_t>> votes;
  for (const auto& [frame, moment] : moments) {
    const auto visible = truth.visible.find(frame);
    const auto told = story.find(frame);
    if (visible == truth.visible.end() || told == story.end()) continue;
    for (const auto& [sight, true_object] : find_true_objects(visible->second, moment)) {
      const auto object = told->second.object_of.find(moment.sights[sight].observation);
      if (object != told->second.object_of.end())
        ++votes[object->second][class_of(visible->second[true_object].name)];
    }
  }
  std::map<Id, std::string> classes;
  for (const auto& [object, of] : votes)
    classes[object] = std::ranges::max_element(of, {}, &std::pair<const std::string, size_t>::second)->first;
  return classes;
}

/// Teaches some classes, each by the first of its objects; what the others are called then.
TeachingScore taught(memory::Store& store, const std::map<Id, std::string>& classes,
                     const std::set<std::string>& known) {
  std::map<std::string, Id> examples;
  for (const auto& [object, name] : classes)
    if (known.contains(name)) examples.try_emplace(name, object);
  for (const auto& [name, object] : examples)
    set_facts(store, fmt::format("object_{}", object), {{"class", name}, {memory::kTaughtKey, name}});
  std::map<Id, memory::CatalogueResult::Match> called;
  for (const memory::CatalogueResult::Match& match : apply_catalogues(store).known)
    if (match.key == "class") called[match.object] = match;
  TeachingScore score;
  for (const auto& [object, name] : classes) {
    if (const auto example = examples.find(name); example != examples.end() && example->second == object)
      continue;
    ++(known.contains(name) ? score.of_taught : score.of_others);
    const auto match = called.find(object);
    if (match == called.end()) continue;
    const bool right = match->second.value == name;
    ++(right ? score.right : known.contains(name) ? score.wrong : score.called);
    score.stated.emplace_back(match->second.probability, right);
  }
  return score;
}

}  // namespace

void TeachingScore::add(const TeachingScore& other) {
  of_taught += other.of_taught;
  right += other.right;
  wrong += other.wrong;
  of_others += other.of_others;
  called += other.called;
  stated.insert(stated.end(), other.stated.begin(), other.stated.end());
}

TeachingScore score_teaching(const std::filesystem::path& folder, const mapping::Recording& recording,
                             const std::filesystem::path& memory) {
  const std::map<Id, std::string> classes = true_classes(folder, recording, memory::Store::open_read(memory));
  std::set<std::string> names, parts[2];
  for (const auto& [object, name] : classes) names.insert(name);
  size_t number = 0;
  for (const std::string& name : names) parts[number++ % 2].insert(name);
  TeachingScore score;
  for (const std::set<std::string>& known : parts) {
    const std::filesystem::path copy = memory.string() + ".taught";
    std::filesystem::copy_file(memory, copy, std::filesystem::copy_options::overwrite_existing);
    {
      memory::Store store = memory::Store::open_write(copy);
      score.add(taught(store, classes, known));
    }
    std::filesystem::remove(copy);
  }
  return score;
}

std::string text(const TeachingScore& score) {
  double stated = 0;
  size_t right = 0;
  for (const auto& [probability, is_so] : score.stated) stated += probability, right += is_so ? 1 : 0;
  const auto all = static_cast<double>(std::max<size_t>(1, score.stated.size()));
  return fmt::format(
      "taught classes, one example each: of {} other objects of these {} called so, {} otherwise; of {} "
      "objects "
      "of other classes {} called by a taught one; stated {:.2f}, right {:.2f}, calibration error {:.3f}\n",
      score.of_taught, score.right, score.wrong, score.of_others, score.called, stated / all,
      static_cast<double>(right) / all, calibration_error(score.stated));
}

Json to_json(const TeachingScore& score) {
  return {{"of_taught", score.of_taught}, {"right", score.right},
          {"wrong", score.wrong},         {"of_others", score.of_others},
          {"called", score.called},       {"calibration_error", calibration_error(score.stated)}};
}

}  // namespace loci::apps::changes
