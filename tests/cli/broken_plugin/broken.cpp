// Annotators that fail, for the tests of what pipelines do then.

#include <chrono>
#include <limits>
#include <stdexcept>
#include <thread>

#include "perception/pipeline/plugin.h"
#include "perception/types/scene_cas.h"

namespace {

using namespace loci::perception;

/// Says a word about every cluster, and fails in one scene.
class Broken : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override {
    return {"Broken", "Fails in one scene.", {"Cluster"}, {"TextAnnotation"}};
  }
  void declare(loci::OptionTable& table) override {
    table.text("how", how_, "What it does there.",
               {"throws", "throws_once", "throws_an_int", "hangs", "nan"});
    table.integer("frame", frame_, "", "In which frame.", 0, 1000000);
  }
  void process(cas::Cas& cas, Context& /*context*/) override {
    const types::SceneCas scene(cas);
    const bool here = scene.scene().frame_index.get() == frame_;
    for (const types::Cluster& cluster : scene.clusters()) {
      const auto text = types::TextAnnotation::create(cas);
      text.text.set("said");
      if (here && how_ == "nan") text.confidence.set(std::numeric_limits<double>::quiet_NaN());
      cluster.annotations.push_back(text);
    }
    if (!here) return;
    if (how_ == "throws") throw std::runtime_error("the shelf\nis on fire");
    if (how_ == "throws_once" && !thrown_) {
      thrown_ = true;
      throw std::runtime_error("not yet");
    }
    if (how_ == "throws_an_int") throw 7;
    while (how_ == "hangs") std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }

 private:
  std::string how_ = "throws";
  int frame_ = 0;
  bool thrown_ = false;
};

void add_annotators(AnnotatorRegistry& registry) {
  registry.add<Broken>();
}

}  // namespace

LOCI_PLUGIN("broken", add_annotators, nullptr)
