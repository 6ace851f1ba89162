#include "perception/pipeline/flow.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "mapping/base/stopwatch.h"
#include "perception/pipeline/contract.h"
#include "perception/types/scene_cas.h"

namespace loci::perception {

/// Everything that the annotator touches, so that it can be left behind.
struct Step::Attempt {
  explicit Attempt(const cas::Cas& home) : cas(home.branch()), before(*cas) {}

  std::unique_ptr<cas::Cas> cas;
  ContentsBefore before;
  Resources resources;
  Warnings warnings;
  Context context{resources, warnings, 1, {}};
  std::shared_ptr<Annotator> annotator;
  std::chrono::steady_clock::time_point begin = std::chrono::steady_clock::now();
  std::promise<void> promise;
  std::future<void> done = promise.get_future();
};

namespace {

/// What an exception says. Interrupted is none of the annotator's, and goes on.
std::string reason_of(const std::exception_ptr& exception) {
  try {
    std::rethrow_exception(exception);
  } catch (const Interrupted&) {
    throw;
  } catch (const std::exception& error) {
    std::string text = error.what();
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text;
  } catch (...) {
    return "an unknown exception";
  }
}

template <class T>
bool all_finite(const cas::FeatureStructure& array) {
  const cas::Buffer<T> values = array.elements<T>();
  return std::all_of(values.begin(), values.end(), [](T value) { return std::isfinite(value); });
}

/// Throws Error for a number that is none: in any feature, or in an array that an annotation says. Arrays of
/// clouds and images may hold NaN, which means no measurement, and matrices of pairs, for those that are
/// not compared.
void check_numbers(const cas::FeatureStructure& structure) {
  const bool annotation = types::is<types::Annotation>(structure) && !types::is<types::PairMatrix>(structure);
  for (const cas::Feature& feature : structure.type().features()) {
    const cas::Type range = feature.range();
    if (!structure.is_set(feature)) continue;
    bool fine = true;
    if (cas::is_floating(range.kind())) {
      fine = std::isfinite(structure.get<double>(feature));
    } else if (annotation && range.kind() == cas::Kind::kArray) {
      const auto array = structure.get<cas::FeatureStructure>(feature);
      if (range.component_kind() == cas::Kind::kFloat) fine = all_finite<float>(array);
      if (range.component_kind() == cas::Kind::kDouble) fine = all_finite<double>(array);
    }
    if (!fine)
      throw Error(fmt::format("{}.{} is not a finite number", structure.type().short_name(), feature.name()));
  }
}

}  // namespace

void StepPolicy::declare(OptionTable& table) {
  table.text("on_error", on_error,
             "When it fails: the run fails, the scene goes on without it, or the scene is left out.",
             {"fail", "skip", "skip_scene"});
  table.integer("retry", retry, "", "How often it is tried again before it has failed.", 0, 100);
  table.number("timeout_s", timeout_s, "s", "After this time it has failed; 0 = never.", 0, 86400);
  table.flag(
      "asynchronous", asynchronous,
      "It runs beside the others until what it makes is needed, at the latest when the scene is done.");
}

Step::Step(const std::string& name, const Config& options, const Config& policy, const FileLocation& place,
           const AnnotatorRegistry& registry)
    : maker_(registry.maker(name, place)), place_(place) {
  annotator_ = maker_();
  descriptor_ = annotator_->descriptor();
  options_ = read_declared(*annotator_, options);
  policy_json_ = read_declared(policy_, policy);
  StepPolicy standard;
  const Json standard_json = table_of(standard).to_json();
  for (const auto& [key, value] : standard_json.items())
    if (policy_json_[key] == value) policy_json_.erase(key);
}

Json Step::to_json() const {
  Json json = {{descriptor_.name, options_}};
  json.update(policy_json_);
  return json;
}

std::shared_ptr<Annotator> Step::make_annotator() {
  std::shared_ptr<Annotator> made = maker_();
  read_declared(*made, Config::parse(options_.dump(), place_.file));
  return made;
}

void Step::start(Context& context) {
  try {
    annotator_->start(context);
  } catch (const Error& error) {
    throw Error(descriptor_.name + " cannot start: " + error.what());
  }
}

void Step::run(cas::Cas& cas, Context& context) {
  try_until_done(cas, context, nullptr);
}

void Step::join(const std::shared_ptr<Attempt>& attempt, cas::Cas& cas, Context& context) {
  try_until_done(cas, context, attempt);
}

void Step::try_until_done(cas::Cas& cas, Context& context, std::shared_ptr<Attempt> first) {
  const Stopwatch watch;
  const double thread_begin = thread_cpu_seconds();
  std::string why;
  bool done = false;
  for (int left = policy_.retry; !done; --left) {
    try {
      if (first == nullptr && policy_.timeout_s <= 0)
        run_here(cas, context);
      else
        bring_home(first ? first : launch(cas, context), cas, context);
      done = true;
    } catch (...) {
      why = reason_of(std::current_exception());
      if (left <= 0) break;
      ++statistics_.retries;
    }
    first = nullptr;
  }
  const double seconds = watch.seconds();
  ++statistics_.scenes;
  statistics_.clusters += static_cast<int64_t>(types::SceneCas(cas).clusters().size());
  statistics_.seconds += seconds;
  cpu_seconds_ += context.alone ? watch.cpu_seconds() : thread_cpu_seconds() - thread_begin;
  if (!done) return fail(why, cas, context);
  types::SceneCas(cas).log(descriptor_.name, "info", "done", seconds * 1e3);
}

void Step::fail(const std::string& why, cas::Cas& cas, Context& context) {
  ++statistics_.failures;
  const types::SceneCas scene(cas);
  const std::string text =
      fmt::format("{} failed at frame {}: {}", descriptor_.name, scene.scene().frame_index.get(), why);
  if (policy_.on_error == "fail") throw Error(text);
  if (policy_.on_error == "skip_scene") throw SceneSkipped(text + "; the scene is left out");
  scene.log(descriptor_.name, "error", why);
  context.warnings.add(text + "; the scene goes on without it");
}

void Step::run_here(cas::Cas& cas, Context& context) {
  const ContentsBefore before(cas);
  cas.begin_changes();
  try {
    annotator_->process(cas, context);
    inspect(cas, before);
  } catch (...) {
    cas.undo_changes();
    throw;
  }
  cas.keep_changes();
}

std::shared_ptr<Step::Attempt> Step::launch(const cas::Cas& cas, Context& context) {
  auto attempt = std::make_shared<Attempt>(cas);
  // One that may be left behind must not hold what has to be closed.
  attempt->resources = policy_.timeout_s > 0 ? context.resources.lasting() : context.resources;
  attempt->context.threads = context.threads;
  attempt->context.alone = false;
  attempt->context.next = context.next;
  attempt->annotator = annotator_;
  std::thread([attempt] {
    try {
      attempt->annotator->process(*attempt->cas, attempt->context);
      attempt->promise.set_value();
    } catch (...) {
      attempt->promise.set_exception(std::current_exception());
    }
  }).detach();
  return attempt;
}

void Step::bring_home(const std::shared_ptr<Attempt>& attempt, cas::Cas& cas, Context& context) {
  if (policy_.timeout_s > 0) {
    const auto limit = std::chrono::duration_cast<std::chrono::steady_clock::duration>(
        std::chrono::duration<double>(policy_.timeout_s));
    if (attempt->done.wait_until(attempt->begin + limit) != std::future_status::ready) {
      // It is left alone with its branch; another of its kind goes on.
      ++statistics_.timeouts;
      annotator_ = make_annotator();
      start(context);
      throw Error(fmt::format("it took longer than {} s", policy_.timeout_s));
    }
  }
  attempt->done.get();
  inspect(*attempt->cas, attempt->before);
  cas.merge(*attempt->cas);
  for (const std::string& text : attempt->warnings.texts()) context.warnings.add(text);
}

void Step::inspect(cas::Cas& cas, const ContentsBefore& before) {
  check_contract(descriptor_, before, cas);
  const std::vector<cas::FeatureStructure> changes = cas.changes();
  for (const cas::FeatureStructure& each : changes) check_numbers(each);
  for (const cas::FeatureStructure& each : changes) {
    const auto annotation = types::try_as<types::Annotation>(each);
    if (!annotation || each.id() <= before.structures) continue;
    if (!annotation->source.is_set()) annotation->source.set(descriptor_.name);
    AnnotatorStatistics::Product& product = statistics_.products[each.type().short_name()];
    ++product.made;
    if (!annotation->confidence.is_set()) continue;
    ++product.with_confidence;
    product.confidence_sum += annotation->confidence.get();
  }
}

void wait_for(const std::shared_ptr<Step::Attempt>& attempt) {
  if (attempt->done.valid()) attempt->done.wait();
}

}  // namespace loci::perception
