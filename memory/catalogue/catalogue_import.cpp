// Matching the objects of a memory with the entries of a catalogue.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "memory/belief/evidence/similarity.h"
#include "memory/belief/parameters.h"
#include "memory/catalogue/catalogue.h"
#include "memory/identity/solution.h"
#include "memory/recorder/checkpoint.h"

namespace loci::memory {
namespace {

constexpr const char* kCheckpoint = "catalogue/";  ///< and the home: checkpoints with the catalogues
constexpr const char* kHabitsCheckpoint = "catalogue habits/";
constexpr const char* kOwnHome = "";  ///< of the examples that were taught
/// Prior probability that an object has an equal in the catalogue of another home.
constexpr double kKnown = 0.5;
/// Facts are stated from this probability on, and changed by at least that much.
constexpr double kMinProbability = 0.5, kMinChange = 0.05;
/// Habits of another home are worth no more events than this.
constexpr double kMaxExpected = 10;

/// A kind of evidence is named when it alone makes a match this much more probable.
const double kTelling = std::log(2.0);

/// The log likelihood ratio of being equal by appearance: the mean over the views in this memory.
double appearance_log_ratio(const ObjectViews& here, const ObjectViews& there, double weight,
                            const belief::Corrections& corrections) {
  double sum = 0;
  size_t count = 0;
  for (const auto& seen : here) {
    double likelihood = 0;
    size_t compared = 0;
    for (const auto& known : there) {
      const belief::ViewSimilarity similarity =
          belief::compare(belief::Appearance(known), belief::Appearance(seen), {}, weight, corrections);
      if (similarity.count == 0) continue;
      likelihood += std::exp(similarity.log_ratio);
      ++compared;
    }
    if (compared == 0) continue;
    sum += std::log(likelihood / double(compared));
    ++count;
  }
  return count == 0 ? 0.0 : std::clamp(sum / double(count), -30.0, 30.0);
}

/// An object of this memory as far as it is compared.
struct Seen {
  Id object = 0;
  ObjectViews views;
  ObjectTerms terms;
};

/// The evidence that an object is that of an entry: log likelihood ratios.
struct Likelihood {
  double appearance = 0, terms = 0;

  double sum() const { return appearance + terms; }
  std::string by() const {
    if (terms < kTelling) return "appearance";
    return appearance < kTelling ? "terms" : "appearance and terms";
  }
};

struct MatchedFact {
  double probability = 0;
  std::string by;
};
using Facts = std::map<std::tuple<Id, std::string, std::string>, MatchedFact>;  ///< object, key, value

void want(Facts& facts, Id object, const std::string& key, const std::string& value, double probability,
          const std::string& by) {
  if (value.empty() || probability < kMinProbability) return;
  MatchedFact& known = facts[{object, key, value}];
  if (probability > known.probability) known = {std::min(probability, 0.999), by};
}

/// The class of an object is that of all entries together that it matches.
void want_class(const Catalogue& catalogue, Id object, const std::vector<Likelihood>& likelihoods,
                double prior, Facts& facts) {
  struct Weight {
    double sum = 0, most = 0;
    std::string by;
  };
  std::map<std::string, Weight> classes;
  double all = 1;
  for (size_t e = 0; e < likelihoods.size(); ++e) {
    const double weight = std::exp(likelihoods[e].sum() + prior);
    all += weight;
    Weight& of_class = classes[catalogue.entries[e].class_name];
    of_class.sum += weight;
    if (weight > of_class.most) of_class.most = weight, of_class.by = likelihoods[e].by();
  }
  for (const auto& [name, weight] : classes) want(facts, object, "class", name, weight.sum / all, weight.by);
}

/// Facts of the objects from a catalogue. A class may be that of many entries; a name or an owner belongs to
/// one.
void match(const Catalogue& catalogue, const std::vector<Seen>& objects, double weight,
           const belief::Corrections& corrections, Facts& facts) {
  const auto rows = static_cast<Eigen::Index>(catalogue.entries.size()),
             columns = static_cast<Eigen::Index>(objects.size());
  if (rows == 0 || columns == 0) return;
  LogOddsProblem problem;
  problem.log_similar.setZero(rows, columns);
  problem.log_proximity.setZero(rows, columns);
  problem.out_of_view.assign(catalogue.entries.size(), 0.0);
  const double prior = std::log(kKnown / (1 - kKnown) / double(rows));
  std::vector<std::vector<Likelihood>> likelihoods;  // by object
  for (Eigen::Index o = 0; o < columns; ++o) {
    const Seen& seen = objects[size_t(o)];
    std::vector<Likelihood>& of_object = likelihoods.emplace_back();
    for (Eigen::Index e = 0; e < rows; ++e) {
      const CatalogueEntry& entry = catalogue.entries[size_t(e)];
      of_object.push_back({appearance_log_ratio(seen.views, entry.views, weight, corrections),
                           weight * terms_log_ratio(seen.terms, entry.terms)});
      problem.log_similar(e, o) = of_object.back().sum() + prior;
    }
    want_class(catalogue, seen.object, of_object, prior, facts);
  }
  if (catalogue.home == kOwnHome) return;  // which of its objects these are is for the belief to say
  IdentityOptions options;
  options.best = 1;
  options.priors.stay = options.priors.newview = kNever;
  options.gate = belief::kParameters.gate;
  const IdentitySolution solution = solve(problem, options);
  for (Eigen::Index e = 0; e < rows; ++e)
    for (Eigen::Index o = 0; o < columns; ++o) {
      const CatalogueEntry& entry = catalogue.entries[size_t(e)];
      const auto add = [&](const std::string& key, const std::string& value) {
        want(facts, objects[size_t(o)].object, key, value, solution.move(e, o),
             likelihoods[size_t(o)][size_t(e)].by());
      };
      for (const auto& [key, value] : entry.facts) add(key, value);
      for (const char* kind : {"text", "product"})
        if (const auto values = entry.terms.find(kind); values != entry.terms.end())
          for (const auto& [value, agreement] : values->second) add(kind, value);
    }
}

/// Adds, changes and retracts facts until the memory has those that are wanted.
void settle(Store& store, Facts wanted, CatalogueResult& result) {
  std::vector<FactRow> rows;
  const std::vector<FactRow> facts = store.facts();
  for (const FactRow& fact : facts)  // facts of people take precedence
    if (fact.object && fact.value && fact.clock.source != kCatalogueSource)
      std::erase_if(wanted, [&](const auto& one) {
        return std::get<0>(one.first) == *fact.object && std::get<1>(one.first) == fact.key;
      });
  for (const FactRow& fact : facts) {
    if (!fact.object || !fact.value || fact.clock.source != kCatalogueSource) continue;
    const auto found = wanted.find({*fact.object, fact.key, *fact.value});
    FactRow row{.object = fact.object, .key = fact.key};
    row.clock.supersedes = fact.id;
    row.clock.source = kCatalogueSource;
    row.clock.valid_from = fact.clock.valid_from;
    if (found == wanted.end()) {
      ++result.taken_back;
      rows.push_back(row);
      continue;
    }
    const MatchedFact& matched = found->second;
    result.known.push_back({*fact.object, fact.key, *fact.value, matched.probability, matched.by});
    if (std::abs(matched.probability - fact.probability.value_or(1)) > kMinChange) {
      row.value = fact.value;
      row.probability = matched.probability;
      ++result.changed;
      rows.push_back(row);
    }
    wanted.erase(found);
  }
  for (const auto& [about, matched] : wanted) {
    const auto& [object, key, value] = about;
    FactRow row{.object = object, .key = key, .value = value, .probability = matched.probability};
    row.clock.source = kCatalogueSource;
    const Store::ObservationCount seen = store.count_observations(object);
    if (seen.first_scene) row.clock.valid_from = store.scene(*seen.first_scene).time;
    result.known.push_back({object, key, value, matched.probability, matched.by});
    ++result.added;
    rows.push_back(row);
  }
  std::ranges::stable_sort(result.known, {}, &CatalogueResult::Match::object);
  if (rows.empty()) return;
  const Id run = store.begin_run("loci-memory catalogue", "{}");
  for (const FactRow& row : rows) store.add_fact(row, run);
  store.finish_run(run);
}

/// The examples that people taught classes with.
Catalogue examples_of(const Store& store, const std::vector<Seen>& objects) {
  Catalogue examples;
  examples.home = kOwnHome;
  for (const FactRow& fact : store.facts()) {
    if (!fact.object || !fact.value || fact.key != kTaughtKey || fact.clock.source == kCatalogueSource)
      continue;
    const auto seen = std::ranges::find(objects, *fact.object, &Seen::object);
    if (seen == objects.end()) continue;
    CatalogueEntry& entry = examples.entries.emplace_back();
    entry.name = object_name(seen->object);
    entry.class_name = *fact.value;
    entry.terms = seen->terms;
    entry.terms.erase("label");  // the class itself does not count as evidence for it
    entry.views = seen->views;
  }
  return examples;
}

/// Whether facts depend on catalogues or examples, or did.
bool has_known_objects(const Store& store) {
  return std::ranges::any_of(store.facts(), [](const FactRow& fact) {
    return fact.object && (fact.key == kTaughtKey || fact.clock.source == kCatalogueSource);
  });
}

/// Adds the habits of the other home to the belief, once.
void add_habits(Store& store, const Catalogue& catalogue) {
  const std::optional<SceneRow> last = store.last_scene();
  if (!last || catalogue.handling.empty() || store.checkpoint(kHabitsCheckpoint + catalogue.home)) return;
  belief::BeliefState state = load_belief(store);
  for (const auto& [kind, factor] : catalogue.handling) {
    const double share = std::min(1.0, kMaxExpected / std::max(1e-9, factor.expected));
    state.interaction.import_class(kind, {share * factor.found, share * factor.expected});
  }
  const Id run = store.begin_run("loci-memory catalogue", "{}");
  SceneTransaction transaction(store, run);
  transaction.set_checkpoint(kHabitsCheckpoint + catalogue.home, "1", std::nullopt);
  BeliefCheckpoint().save(transaction, last->id, state);
  transaction.commit();
  store.finish_run(run);
}

}  // namespace

CatalogueResult import_catalogue(Store& store, const Catalogue& catalogue) {
  if (catalogue.home == home_of(store) && !catalogue.home.empty())
    throw Error("the catalogue is of this memory's own home", {store.name(), 0, {}},
                "import it into the memory of another home");
  ChangeTransaction all(store);
  const std::string bytes = to_json(catalogue).dump(), name = kCheckpoint + catalogue.home;
  const std::optional<Store::Checkpoint> stored = store.checkpoint(name);
  if (!stored || stored->bytes != bytes) {
    const Id run = store.begin_run("loci-memory catalogue import", "{}");
    SceneTransaction transaction(store, run);
    transaction.set_checkpoint(name, bytes, std::nullopt);
    transaction.commit();
    store.finish_run(run);
  }
  CatalogueResult result = apply_catalogues(store);
  all.commit();
  return result;
}

CatalogueResult apply_catalogues(Store& store) {
  CatalogueResult result;
  const std::map<std::string, Store::Checkpoint> stored = store.checkpoints(kCheckpoint);
  if (stored.empty() && !has_known_objects(store)) return result;
  std::vector<Seen> objects;
  ViewReader views(store);
  for (const BeliefRow& belief : store.beliefs())
    objects.push_back({belief.object, views.views_of(belief.object), terms_of(store, belief.object)});
  result.objects = objects.size();
  const belief::Corrections corrections = load_belief(store).calibration.corrections();
  const double weight = load_options(store).appearance_weight;
  Facts facts;
  for (const auto& [name, checkpoint] : stored) {
    const Catalogue catalogue = catalogue_from(parse_json(checkpoint.bytes, store.name()), store.name());
    result.entries += catalogue.entries.size();
    match(catalogue, objects, weight, corrections, facts);
    add_habits(store, catalogue);
  }
  const Catalogue examples = examples_of(store, objects);
  result.entries += examples.entries.size();
  match(examples, objects, weight, corrections, facts);
  settle(store, std::move(facts), result);
  return result;
}

std::string CatalogueResult::summary() const {
  std::string text =
      fmt::format("{} compared with {} or examples: {} known ({} new, {} changed, {} retracted)",
                  counted(objects, "object"), counted(entries, "catalogue object"),
                  counted(known.size(), "fact"), added, changed, taken_back);
  for (const Match& match : known)
    text += fmt::format("\n  {:10} {:8} {:20} {:3.0f} %, by its {}", object_name(match.object), match.key,
                        match.value, 100 * match.probability, match.by);
  return text;
}

Json CatalogueResult::report() const {
  Json list = Json::array();
  for (const Match& match : known)
    list.push_back({{"object", object_name(match.object)},
                    {"key", match.key},
                    {"value", match.value},
                    {"probability", match.probability},
                    {"by", match.by}});
  return {{"objects", objects}, {"entries", entries},       {"added", added},
          {"changed", changed}, {"taken_back", taken_back}, {"known", list}};
}

}  // namespace loci::memory
