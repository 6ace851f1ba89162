// Which objects of a memory fit which things of a catalogue.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "mapping/base/json.h"
#include "memory/belief/appearance.h"
#include "memory/catalogue/catalogue.h"
#include "memory/catalogue/looks.h"
#include "memory/identity/solution.h"
#include "memory/recorder/carried_belief.h"

namespace loci {
namespace {

constexpr const char* kKept = "catalogue/";  ///< and the home: checkpoints with the catalogues
constexpr const char* kHabitsTaken = "catalogue habits/";
constexpr const char* kSource = "catalogue";
/// Of the things of another home, so many are believed to be like one of the catalogue before anybody looks.
constexpr double kKnown = 0.5;
/// Told from here on; a change of less is none.
constexpr double kTold = 0.5, kNews = 0.05;
/// Habits of another home are worth no more events than this.
constexpr double kMostExpected = 10;

/// How much more probable the looks are if both are the same thing: mean over what was seen of it here.
double log_ratio(const Looks& here, const Looks& there, const belief::Corrections& corrections) {
  constexpr double kWeight = 0.8;  // as in BeliefOptions: annotations of one thing depend on each other
  double sum = 0;
  size_t count = 0;
  for (const auto& seen : here) {
    double likelihood = 0;
    size_t compared = 0;
    for (const auto& known : there) {
      const belief::Contrast contrast =
          belief::contrast(belief::Appearance(known), belief::Appearance(seen), false, kWeight, corrections);
      if (contrast.count == 0) continue;
      likelihood += std::exp(contrast.log_ratio);
      ++compared;
    }
    if (compared == 0) continue;
    sum += std::log(likelihood / double(compared));
    ++count;
  }
  return count == 0 ? 0.0 : std::clamp(sum / double(count), -30.0, 30.0);
}

using Facts = std::map<std::tuple<Id, std::string, std::string>, double>;  ///< object, key, value

void want(Facts& facts, Id object, const std::string& key, const std::string& value, double probability) {
  if (value.empty() || probability < kTold) return;
  double& known = facts[{object, key, value}];
  known = std::max(known, std::min(probability, 0.999));
}

/// What the catalogue says of the objects. A class may be that of many things; a name or an owner belongs to
/// one thing.
void match(const Catalogue& catalogue, const std::vector<Id>& objects, const std::vector<Looks>& looks,
           const belief::Corrections& corrections, Facts& facts) {
  const auto rows = static_cast<Eigen::Index>(catalogue.entries.size()),
             columns = static_cast<Eigen::Index>(objects.size());
  if (rows == 0 || columns == 0) return;
  LogOddsProblem problem;
  problem.log_similar.setZero(rows, columns);
  problem.log_proximity.setZero(rows, columns);
  problem.out_of_view.assign(catalogue.entries.size(), 0.0);
  const double prior = std::log(kKnown / (1 - kKnown) / double(rows));
  for (Eigen::Index e = 0; e < rows; ++e)
    for (Eigen::Index o = 0; o < columns; ++o)
      problem.log_similar(e, o) =
          log_ratio(looks[size_t(o)], catalogue.entries[size_t(e)].looks, corrections) + prior;
  for (Eigen::Index o = 0; o < columns; ++o) {
    std::map<std::string, double> classes;
    double all = 1;
    for (Eigen::Index e = 0; e < rows; ++e) {
      const double weight = std::exp(problem.log_similar(e, o));
      all += weight;
      classes[catalogue.entries[size_t(e)].class_name] += weight;
    }
    for (const auto& [name, weight] : classes) want(facts, objects[size_t(o)], "class", name, weight / all);
  }
  IdentityOptions options;
  options.best = 1;
  options.priors.stay = options.priors.newview = kNever;
  options.gate = 1e-4;
  const IdentitySolution solution = solve(problem, options);
  for (Eigen::Index e = 0; e < rows; ++e)
    for (Eigen::Index o = 0; o < columns; ++o) {
      const CatalogueEntry& entry = catalogue.entries[size_t(e)];
      const double probability = solution.move(e, o);
      for (const auto& [key, value] : entry.facts) want(facts, objects[size_t(o)], key, value, probability);
      for (const std::string& text : entry.texts) want(facts, objects[size_t(o)], "text", text, probability);
      for (const std::string& product : entry.products)
        want(facts, objects[size_t(o)], "product", product, probability);
    }
}

/// Adds, changes and takes back facts until the memory says what is wanted.
void settle(Store& store, Facts wanted, CatalogueResult& result) {
  std::vector<FactRow> rows;
  const std::vector<FactRow> facts = store.facts();
  for (const FactRow& fact : facts)  // what people say comes first
    if (fact.object && fact.value && fact.clock.source != kSource)
      std::erase_if(wanted, [&](const auto& one) {
        return std::get<0>(one.first) == *fact.object && std::get<1>(one.first) == fact.key;
      });
  for (const FactRow& fact : facts) {
    if (!fact.object || !fact.value || fact.clock.source != kSource) continue;
    const auto found = wanted.find({*fact.object, fact.key, *fact.value});
    FactRow row{.object = fact.object, .key = fact.key};
    row.clock.supersedes = fact.id;
    row.clock.source = kSource;
    row.clock.valid_from = fact.clock.valid_from;
    if (found == wanted.end()) {
      ++result.taken_back;
      rows.push_back(row);
      continue;
    }
    result.known.push_back({*fact.object, fact.key, *fact.value, found->second});
    if (std::abs(found->second - fact.probability.value_or(1)) > kNews) {
      row.value = fact.value;
      row.probability = found->second;
      ++result.changed;
      rows.push_back(row);
    }
    wanted.erase(found);
  }
  for (const auto& [about, probability] : wanted) {
    const auto& [object, key, value] = about;
    FactRow row{.object = object, .key = key, .value = value, .probability = probability};
    row.clock.source = kSource;
    const Store::SightingCount seen = store.count_sightings(object);
    if (seen.first_scene) row.clock.valid_from = store.scene(*seen.first_scene).time;
    result.known.push_back({object, key, value, probability});
    ++result.added;
    rows.push_back(row);
  }
  std::ranges::stable_sort(result.known, {}, &CatalogueResult::Match::object);
  if (rows.empty()) return;
  const Id run = store.begin_run("loci-memory catalogue", "{}");
  for (const FactRow& row : rows) store.add_fact(row, run);
  store.finish_run(run);
}

/// Lets the belief begin with the other home's habits, once.
void take_habits(Store& store, const Catalogue& catalogue) {
  const std::optional<SceneRow> last = store.last_scene();
  if (!last || catalogue.handling.empty() || store.checkpoint(kHabitsTaken + catalogue.home)) return;
  belief::BeliefState state = load_belief(store);
  for (const auto& [kind, factor] : catalogue.handling) {
    const double share = std::min(1.0, kMostExpected / std::max(1e-9, factor.expected));
    state.habits.take_kind(kind, {share * factor.found, share * factor.expected});
  }
  const Id run = store.begin_run("loci-memory catalogue", "{}");
  SceneTransaction transaction(store, run);
  transaction.set_checkpoint(kHabitsTaken + catalogue.home, "1", std::nullopt);
  CarriedBelief().save(transaction, last->id, state);
  transaction.commit();
  store.finish_run(run);
}

}  // namespace

CatalogueResult import_catalogue(Store& store, const Catalogue& catalogue) {
  if (catalogue.home == catalogue_of(store).home && !catalogue.home.empty())
    throw Error("this catalogue is of this very home", {store.path().string(), 0, {}},
                "import it into the memory of another one");
  const std::string bytes = to_json(catalogue).dump(), name = kKept + catalogue.home;
  const std::optional<Store::Checkpoint> kept = store.checkpoint(name);
  if (!kept || kept->bytes != bytes) {
    const Id run = store.begin_run("loci-memory catalogue import", "{}");
    SceneTransaction transaction(store, run);
    transaction.set_checkpoint(name, bytes, std::nullopt);
    transaction.commit();
    store.finish_run(run);
  }
  return apply_catalogues(store);
}

CatalogueResult apply_catalogues(Store& store) {
  CatalogueResult result;
  const std::map<std::string, Store::Checkpoint> kept = store.checkpoints(kKept);
  if (kept.empty()) return result;
  std::vector<Id> objects;
  std::vector<Looks> looks;
  LooksOfObjects seen(store);
  for (const BeliefRow& belief : store.beliefs()) {
    objects.push_back(belief.object);
    looks.push_back(seen.of(belief.object));
  }
  result.objects = objects.size();
  const belief::Corrections corrections = load_belief(store).calibration.corrections();
  Facts facts;
  for (const auto& [name, checkpoint] : kept) {
    const Catalogue catalogue =
        catalogue_from(parse_json(checkpoint.bytes, store.path().string()), store.path().string());
    result.entries += catalogue.entries.size();
    match(catalogue, objects, looks, corrections, facts);
    take_habits(store, catalogue);
  }
  settle(store, std::move(facts), result);
  return result;
}

std::string CatalogueResult::summary() const {
  std::string text = fmt::format(
      "{} objects beside {} things of catalogues: {} facts known ({} new, {} changed, "
      "{} taken back)",
      objects, entries, known.size(), added, changed, taken_back);
  for (const Match& match : known)
    text += fmt::format("\n  {:10} {:8} {:20} {:3.0f} %", object_name(match.object), match.key, match.value,
                        100 * match.probability);
  return text;
}

Json CatalogueResult::report() const {
  Json list = Json::array();
  for (const Match& match : known)
    list.push_back({{"object", object_name(match.object)},
                    {"key", match.key},
                    {"value", match.value},
                    {"probability", match.probability}});
  return {{"objects", objects}, {"entries", entries},       {"added", added},
          {"changed", changed}, {"taken_back", taken_back}, {"known", list}};
}

}  // namespace loci
