#include "apps/evaluate/system/throughput.h"

#include <algorithm>

#include "apps/evaluate/resident_memory.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/text/json.h"
#include "perception/annotators/annotators.h"
#include "perception/types/scene_cas.h"

namespace loci::apps::system_evaluation {
namespace {

/// A recording that begins again at its end, with times that go on.
class Again : public mapping::Recording {
 public:
  Again(const mapping::Recording& once, size_t size) : size_(size), info_(once.info()) {
    constexpr size_t kKept = 16;
    for (size_t i = 0; i < std::min(kKept, once.size()); ++i)
      frames_.push_back(once.frame(i * once.size() / std::min(kKept, once.size())));
    info_.frames = info_.frames_with_pose = size;
  }
  const mapping::RecordingInfo& info() const override { return info_; }
  size_t size() const override { return size_; }
  mapping::RgbdFrame frame(size_t i) const override {
    mapping::RgbdFrame frame = frames_[i % frames_.size()];
    frame.index = index_of(i);
    frame.time_ns = time_of(i);
    return frame;
  }
  TimeNs time_of(size_t i) const override { return info_.first_time + static_cast<TimeNs>(i) * kSecond / 30; }
  int64_t index_of(size_t i) const override { return static_cast<int64_t>(i); }

 private:
  size_t size_;
  mapping::RecordingInfo info_;
  std::vector<mapping::RgbdFrame> frames_;
};

}  // namespace

std::vector<StepTime> step_times(const perception::PipelineResult& result) {
  std::vector<StepTime> steps;
  const double frames = static_cast<double>(std::max<size_t>(1, result.frames));
  for (size_t i = 0; i < result.seconds.size(); ++i)
    steps.push_back({result.seconds[i].first, 1000 * result.seconds[i].second / frames,
                     1000 * result.cpu_seconds[i].second / frames});
  return steps;
}

Throughput measure_throughput(const std::shared_ptr<mapping::Recording>& recording,
                              const std::shared_ptr<perception::KnownMap>& map, size_t frames, int threads,
                              Progress& progress) {
  perception::AnnotatorRegistry registry;
  add_annotators(registry);
  // Names that stay are the memory's business.
  perception::Pipeline pipeline = perception::Pipeline::parse(
      "flow: [NormalEstimator, KnownStructureFilter, PlaneClusterExtractor, FlatObjectExtractor, "
      "ColorHistogram, ColorName, GeometryAnnotator, LocationAnnotator]\n",
      "the tabletop pipeline", registry);
  perception::Resources resources;
  resources.put(std::shared_ptr<mapping::Recording>(std::make_shared<Again>(*recording, frames)));
  resources.put(map);
  Warnings warnings;  // They were given when the scenes went through.
  perception::Context context{resources, warnings, threads, {}};
  Throughput figures;
  const Stopwatch watch;
  const perception::PipelineResult result =
      pipeline.run(context, perception::types::type_system(), progress, [&](perception::cas::Cas&) {
        ++figures.frames;
        if (figures.frames == std::max<size_t>(1, frames / 10))
          figures.megabytes_first_tenth = resident_megabytes();
        if (figures.frames == std::max<size_t>(1, frames / 2)) figures.megabytes_half = resident_megabytes();
        if (figures.frames == frames) figures.megabytes_at_end = resident_megabytes();
      });
  figures.clock_ms = 1e3 * watch.seconds() / static_cast<double>(std::max<size_t>(1, figures.frames));
  figures.steps = step_times(result);
  for (size_t i = 1; i < figures.steps.size(); ++i) figures.processor_ms += figures.steps[i].processor_ms;
  return figures;
}

}  // namespace loci::apps::system_evaluation
