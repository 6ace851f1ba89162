#include "perception/pipeline/pipeline.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "mapping/base/config.h"
#include "mapping/base/json.h"
#include "mapping/base/stopwatch.h"
#include "perception/types/scene_cas.h"

namespace loci {
namespace {

constexpr const char* kDefaultReader = "RecordingReader";

Place place_of(const Config& config, const YAML::Node& node, const std::string& path) {
  Place place = config.place();
  if (!node.Mark().is_null()) place.line = node.Mark().line + 1;
  place.key = path;
  return place;
}

/// `Name` or `Name: {options}`.
struct Named {
  std::string name;
  Config options;
  Place place;
};

Named read_named(const Config& parent, const YAML::Node& node, const std::string& path) {
  const Place place = place_of(parent, node, path);
  if (node.IsScalar())
    return {node.as<std::string>(), parent.over(YAML::Node(YAML::NodeType::Map), path), place};
  if (node.IsMap()) {
    for (const char* word : {"if", "then", "else", "parallel"})
      if (node[word])
        throw Error(fmt::format("'{}' in a pipeline is not built yet", word), place,
                    "list the annotators one after the other");
  }
  if (!node.IsMap() || node.size() != 1)
    throw Error("a step is a name, or a name with a map of options", place,
                "e.g. '- NormalEstimator' or '- NormalEstimator: {iterations: 5}'");
  const auto name = node.begin()->first.as<std::string>();
  const YAML::Node options = node.begin()->second;
  if (!options.IsMap() && !options.IsNull())
    throw Error("the options of '" + name + "' must be a map", place);
  return {name, parent.over(options.IsMap() ? options : YAML::Node(YAML::NodeType::Map), path + "." + name),
          place};
}

template <class Declarer>
Json read_options_of(Declarer& declarer, const Config& options) {
  OptionTable table;
  declarer.declare(table);
  table.read(options);
  options.finish();
  table.validate(options.place());
  return table.to_json();
}

std::vector<YAML::Node> sequence(const Config& config, const std::string& key) {
  std::vector<YAML::Node> nodes;
  const YAML::Node node = config.node(key);
  if (!node) return nodes;
  if (!node.IsSequence()) throw Error("a list was expected here", config.place(key));
  for (const auto& each : node) nodes.push_back(each);
  return nodes;
}

}  // namespace

Pipeline::Step Pipeline::read_step(const Config& parent, const YAML::Node& node, const std::string& path,
                                   const AnnotatorRegistry& registry) {
  const Named named = read_named(parent, node, path);
  Step step;
  step.annotator = registry.make(named.name, named.place);
  step.descriptor = step.annotator->descriptor();
  step.options = read_options_of(*step.annotator, named.options);
  step.place = named.place;
  return step;
}

Pipeline Pipeline::parse(const std::string& text, const std::string& file,
                         const AnnotatorRegistry& registry) {
  return parse(Config::parse(text, file), registry);
}

Pipeline Pipeline::parse(const Config& config, const AnnotatorRegistry& registry) {
  Pipeline pipeline;
  const YAML::Node reader = config.node("reader");
  const Named named =
      reader ? read_named(config, reader, "reader")
             : Named{kDefaultReader, config.over(YAML::Node(YAML::NodeType::Map), "reader"), config.place()};
  pipeline.reader_ = registry.make_reader(named.name, named.place);
  pipeline.reader_options_ = read_options_of(*pipeline.reader_, named.options);
  const auto read_list = [&](const std::string& key, std::vector<Step>& steps) {
    const std::vector<YAML::Node> nodes = sequence(config, key);
    for (size_t i = 0; i < nodes.size(); ++i)
      steps.push_back(read_step(config, nodes[i], fmt::format("{}[{}]", key, i), registry));
  };
  read_list("flow", pipeline.flow_);
  read_list("writers", pipeline.writers_);
  config.finish();
  if (pipeline.flow_.empty())
    throw Error("the pipeline has no annotators", config.place("flow"), "list them under 'flow:'");
  pipeline.check(registry);
  return pipeline;
}

bool Pipeline::has(const std::string& name) const {
  const auto is_it = [&](const Step& step) { return step.descriptor.name == name; };
  return std::any_of(flow_.begin(), flow_.end(), is_it) ||
         std::any_of(writers_.begin(), writers_.end(), is_it);
}

void Pipeline::add(const std::string& name, const AnnotatorRegistry& registry) {
  if (has(name)) return;
  const Config none = Config::parse("", "");
  flow_.push_back(read_step(none, YAML::Node(name), name, registry));
  check(registry);
}

void Pipeline::add_writer(const std::string& name, const AnnotatorRegistry& registry) {
  if (has(name)) return;
  const Config none = Config::parse("", "");
  writers_.push_back(read_step(none, YAML::Node(name), name, registry));
  check(registry);
}

void Pipeline::check(const AnnotatorRegistry& registry) const {
  const AnnotatorDescriptor source = reader_->descriptor();
  std::set<std::string> made(source.makes.begin(), source.makes.end());
  const auto check_step = [&](const Step& step) {
    for (const std::string& need : step.descriptor.needs) {
      if (made.contains(need)) continue;
      const std::vector<std::string> makers = registry.makers_of(need);
      throw Error(fmt::format("{} needs {}, which nothing before it makes", step.descriptor.name, need),
                  step.place,
                  makers.empty() ? "no known annotator makes it"
                                 : fmt::format("put {} before it", fmt::join(makers, " or ")));
    }
    made.insert(step.descriptor.makes.begin(), step.descriptor.makes.end());
  };
  for (const Step& step : flow_) check_step(step);
  for (const Step& step : writers_) check_step(step);
}

Json Pipeline::to_json() const {
  const auto list = [](const std::vector<Step>& steps) {
    Json json = Json::array();
    for (const Step& step : steps) json.push_back({{step.descriptor.name, step.options}});
    return json;
  };
  return {{"reader", {{reader_->descriptor().name, reader_options_}}},
          {"flow", list(flow_)},
          {"writers", list(writers_)}};
}

std::vector<Pipeline::Step*> Pipeline::steps() {
  std::vector<Step*> all;
  for (Step& step : flow_) all.push_back(&step);
  for (Step& step : writers_) all.push_back(&step);
  return all;
}

void Pipeline::start(Context& context) {
  if (started_) return;
  started_ = true;
  context.configuration = to_json();
  reader_->start(context);
  for (Step* step : steps()) {
    try {
      step->annotator->start(context);
    } catch (const Error& error) {
      throw Error(step->descriptor.name + " cannot start: " + error.what());
    }
  }
}

void Pipeline::run_frame(cas::Cas& cas, Context& context) {
  const types::SceneCas scene(cas);
  for (Step* step : steps()) {
    const Stopwatch watch;
    try {
      step->annotator->process(cas, context);
    } catch (const Error& error) {
      throw Error(fmt::format("{} failed at frame {}: {}", step->descriptor.name,
                              scene.scene().frame_index.get(), error.what()));
    }
    const double seconds = watch.seconds();
    step->seconds += seconds;
    step->processor_seconds += watch.processor_seconds();
    scene.log(step->descriptor.name, "info", "done", seconds * 1e3);
  }
}

void Pipeline::finish(Context& context) {
  for (Step* step : steps()) step->annotator->finish(context);
}

PipelineResult Pipeline::run(Context& context, const std::shared_ptr<const cas::TypeSystem>& type_system,
                             Progress& progress, const std::function<void(cas::Cas&)>& done) {
  start(context);
  PipelineResult result;
  const size_t first = reader_->position();
  const auto left = static_cast<double>(std::max<size_t>(1, reader_->count() - first));
  while (reader_->position() < reader_->count()) {
    const FrameId frame = reader_->upcoming();
    const double fraction = static_cast<double>(reader_->position() - first) / left;
    if (!progress.update(fraction, fmt::format("frame {}", frame.index))) {
      finish(context);
      throw Interrupted();
    }
    cas::Cas cas(type_system);
    const Stopwatch watch;
    reader_->read_next(cas, context);
    reader_seconds_ += watch.seconds();
    reader_processor_seconds_ += watch.processor_seconds();
    run_frame(cas, context);
    ++result.frames;
    if (done) done(cas);
  }
  finish(context);
  progress.update(1, "done");
  result.seconds.emplace_back(reader_->descriptor().name, reader_seconds_);
  result.processor_seconds.emplace_back(reader_->descriptor().name, reader_processor_seconds_);
  for (const Step* step : steps()) {
    result.seconds.emplace_back(step->descriptor.name, step->seconds);
    result.processor_seconds.emplace_back(step->descriptor.name, step->processor_seconds);
  }
  return result;
}

}  // namespace loci
