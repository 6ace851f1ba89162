#pragma once

#include <functional>

#include "mapping/base/text/json.h"
#include "perception/cas/json.h"
#include "perception/pipeline/pipeline.h"
#include "perception/types/geometry.h"
#include "perception/types/scene_cas.h"

namespace loci::perception {

/// Four clusters per scene, of heights 0.01, 0.05, 0.10 and 0.15 m, on counter_1, counter_2, table_1 and
/// nothing.
class FourThings : public Reader {
 public:
  AnnotatorDescriptor descriptor() const override {
    return {
        "RecordingReader", "Four things.", {}, {"Scene", "Cluster", "PlanarSupport", "GeometryAnnotation"}};
  }
  void start(Context&) override {}
  size_t count() const override { return 3; }
  size_t position() const override { return position_; }
  FrameId upcoming() const override { return {static_cast<int64_t>(position_ + 10), 0}; }
  void read_next(cas::Cas& cas, Context&) override {
    const types::SceneCas scene(cas);
    scene.create_scene().frame_index.set(upcoming().index);
    ++position_;
    const std::vector<std::string> places = {"counter_1", "counter_2", "table_1", ""};
    const std::vector<double> heights = {0.01, 0.05, 0.10, 0.15};
    for (size_t i = 0; i < places.size(); ++i) {
      const auto cluster = types::Cluster::create(cas);
      const auto geometry = types::GeometryAnnotation::create(cas);
      geometry.height.set(heights[i]);
      geometry.source.set("FourThings");
      cluster.annotations.push_back(geometry);
      if (!places[i].empty()) {
        const auto support = types::PlanarSupport::create(cas);
        support.name.set(places[i]);
        scene.add_support(support);
        cluster.support.set(support);
      }
      scene.add_cluster(cluster);
    }
  }
  void skip(size_t frames) override { position_ += frames; }

 private:
  size_t position_ = 0;
};

/// An annotator from a function.
class Scripted : public Annotator {
 public:
  using Work = std::function<void(cas::Cas&, Context&)>;
  Scripted(AnnotatorDescriptor descriptor, Work work)
      : descriptor_(std::move(descriptor)), work_(std::move(work)) {}
  AnnotatorDescriptor descriptor() const override { return descriptor_; }
  void declare(OptionTable& table) override { table.text("word", word_, "What it says."); }
  void process(cas::Cas& cas, Context& context) override {
    if (work_) return work_(cas, context);
    // Says its word about every cluster.
    for (const types::Cluster& cluster : types::SceneCas(cas).clusters()) say(cluster, word_);
  }
  static void say(const types::Cluster& cluster, const std::string& word) {
    const auto annotation = types::TextAnnotation::create(cluster.cas());
    annotation.text.set(word);
    cluster.annotations.push_back(annotation);
  }

 private:
  AnnotatorDescriptor descriptor_;
  Work work_;
  std::string word_ = "?";
};

inline void add_scripted(AnnotatorRegistry& registry, const AnnotatorDescriptor& descriptor,
                         const Scripted::Work& work = {}) {
  registry.add(descriptor.name, [=] { return std::make_unique<Scripted>(descriptor, work); });
}

/// A registry with FourThings as reader and Speaker, which says its word about every cluster.
inline AnnotatorRegistry test_registry() {
  AnnotatorRegistry registry;
  registry.add_reader<FourThings>();
  add_scripted(registry, {"Speaker", "Speaks.", {"Cluster"}, {"TextAnnotation"}});
  return registry;
}

/// What was said about a cluster, in order.
inline std::string words(const types::Cluster& cluster) {
  std::string said;
  for (const auto& text : cluster.annotations.filter<types::TextAnnotation>()) {
    if (!said.empty()) said += ' ';
    said += text.text.get();
  }
  return said;
}

struct TestRun {
  std::vector<std::vector<std::string>> words;  ///< by scene and cluster
  std::vector<std::string> json;                ///< of each CAS without its log
  std::vector<std::string> warnings;
  PipelineResult result;
};

inline TestRun run_test(const std::string& yaml, const AnnotatorRegistry& registry, int threads = 1) {
  Pipeline pipeline = Pipeline::parse(yaml, "p.yaml", registry);
  Resources resources;
  Warnings warnings;
  Context context{resources, warnings, threads, {}};
  NoProgress progress;
  TestRun run;
  run.result = pipeline.run(context, types::type_system(), progress, [&](cas::Cas& cas) {
    const types::SceneCas scene(cas);
    auto& said = run.words.emplace_back();
    for (const types::Cluster& cluster : scene.clusters()) said.push_back(words(cluster));
    scene.scene().log.unset();  // It holds times.
    run.json.push_back(cas::to_json(cas).dump());
  });
  run.warnings = warnings.texts();
  return run;
}

/// The message with which a pipeline is refused, or its run fails.
inline std::string refusal_of(const std::string& yaml, const AnnotatorRegistry& registry) {
  try {
    run_test(yaml, registry);
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace loci::perception
