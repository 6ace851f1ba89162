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

namespace loci::memory {
namespace {

constexpr const char* kKept = "catalogue/";  ///< and the home: checkpoints with the catalogues
constexpr const char* kHabitsTaken = "catalogue habits/";
constexpr const char* kSource = "catalogue";
/// Of the things of another home, so many are believed to be like one of the catalogue before anybody looks.
constexpr double kKnown = 0.5;
/// Told from here on; a change of less is none.
constexpr double kTold = 0.5, kNews = 0.05;
/// Habits of another home are worth no more events than this.
constexpr double kMaxExpected = 10;

constexpr double kWeight = 0.8;  ///< as in BeliefOptions: annotations of one thing depend on each other
/// Known by what makes it this much more probable alone.
const double kTelling = std::log(2.0);

/// How much more probable the looks are if both are the same thing: mean over what was seen of it here.
double looks_ratio(const Looks& here, const Looks& there, const belief::Corrections& corrections) {
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

/// An object of this memory as far as it is compared.
struct Seen {
  Id object = 0;
  Looks looks;
  Words words;
};

/// What tells that an object is a thing of the catalogue: logarithms of likelihood ratios.
struct Likelihood {
  double looks = 0, words = 0;

  double sum() const { return looks + words; }
  std::string by() const {
    if (words < kTelling) return "looks";
    return looks < kTelling ? "words" : "looks and words";
  }
};

struct Told {
  double probability = 0;
  std::string by;
};
using Facts = std::map<std::tuple<Id, std::string, std::string>, Told>;  ///< object, key, value

void want(Facts& facts, Id object, const std::string& key, const std::string& value, double probability,
          const std::string& by) {
  if (value.empty() || probability < kTold) return;
  Told& known = facts[{object, key, value}];
  if (probability > known.probability) known = {std::min(probability, 0.999), by};
}

/// The class of an object is that of all things together that it is like.
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

/// What the catalogue says of the objects. A class may be that of many things; a name or an owner belongs to
/// one thing.
void match(const Catalogue& catalogue, const std::vector<Seen>& objects,
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
      of_object.push_back({looks_ratio(seen.looks, entry.looks, corrections),
                           kWeight * words_log_ratio(seen.words, entry.words)});
      problem.log_similar(e, o) = of_object.back().sum() + prior;
    }
    want_class(catalogue, seen.object, of_object, prior, facts);
  }
  IdentityOptions options;
  options.best = 1;
  options.priors.stay = options.priors.newview = kNever;
  options.gate = 1e-4;
  const IdentitySolution solution = solve(problem, options);
  for (Eigen::Index e = 0; e < rows; ++e)
    for (Eigen::Index o = 0; o < columns; ++o) {
      const CatalogueEntry& entry = catalogue.entries[size_t(e)];
      const auto tell = [&](const std::string& key, const std::string& value) {
        want(facts, objects[size_t(o)].object, key, value, solution.move(e, o),
             likelihoods[size_t(o)][size_t(e)].by());
      };
      for (const auto& [key, value] : entry.facts) tell(key, value);
      for (const char* kind : {"text", "product"})
        if (const auto said = entry.words.find(kind); said != entry.words.end())
          for (const auto& [value, agreement] : said->second) tell(kind, value);
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
    const Told& told = found->second;
    result.known.push_back({*fact.object, fact.key, *fact.value, told.probability, told.by});
    if (std::abs(told.probability - fact.probability.value_or(1)) > kNews) {
      row.value = fact.value;
      row.probability = told.probability;
      ++result.changed;
      rows.push_back(row);
    }
    wanted.erase(found);
  }
  for (const auto& [about, told] : wanted) {
    const auto& [object, key, value] = about;
    FactRow row{.object = object, .key = key, .value = value, .probability = told.probability};
    row.clock.source = kSource;
    const Store::ObservationCount seen = store.count_observations(object);
    if (seen.first_scene) row.clock.valid_from = store.scene(*seen.first_scene).time;
    result.known.push_back({object, key, value, told.probability, told.by});
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
    const double share = std::min(1.0, kMaxExpected / std::max(1e-9, factor.expected));
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
  if (catalogue.home == home_of(store) && !catalogue.home.empty())
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
  std::vector<Seen> objects;
  LooksOfObjects looks(store);
  for (const BeliefRow& belief : store.beliefs())
    objects.push_back({belief.object, looks.of(belief.object), words_of(store, belief.object)});
  result.objects = objects.size();
  const belief::Corrections corrections = load_belief(store).calibration.corrections();
  Facts facts;
  for (const auto& [name, checkpoint] : kept) {
    const Catalogue catalogue =
        catalogue_from(parse_json(checkpoint.bytes, store.path().string()), store.path().string());
    result.entries += catalogue.entries.size();
    match(catalogue, objects, corrections, facts);
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
