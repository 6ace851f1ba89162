// Annotators that fail, for the tests of what pipelines do then.

#include <chrono>
#include <limits>
#include <stdexcept>
#include <thread>

#include "perception/pipeline/plugin.h"
#include "perception/types/scene_cas.h"

namespace {

using namespace loci;

/// Says a word about every cluster, and fails in one scene.
class Broken : public loci::perception::Annotator {
 public:
  loci::perception::AnnotatorDescriptor descriptor() const override {
    return {"Broken", "Fails in one scene.", {"Cluster"}, {"TextAnnotation"}};
  }
  void declare(loci::OptionTable& table) override {
    table.text("how", how_, "What it does there.",
               {"throws", "throws_once", "throws_an_int", "hangs", "nan"});
    table.integer("frame", frame_, "", "In which frame.", 0, 1000000);
  }
  void process(loci::perception::cas::Cas& cas, loci::perception::Context& /*context*/) override {
    const loci::perception::types::SceneCas scene(cas);
    const bool here = scene.scene().frame_index.get() == frame_;
    for (const loci::perception::types::Cluster& cluster : scene.clusters()) {
      const auto text = loci::perception::types::TextAnnotation::create(cas);
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

void add_annotators(loci::perception::AnnotatorRegistry& registry) {
  registry.add<Broken>();
}

}  // namespace

LOCI_PLUGIN("broken", add_annotators, nullptr)
