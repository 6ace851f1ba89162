#include <fmt/format.h>

#include "apps/perceive/commands.h"
#include "mapping/recording/recording.h"
#include "perception/annotators/hypotheses/flat_object_extractor.h"

namespace loci::apps {
namespace {

struct Arguments {
  std::string recording;
  std::string output;
  int frames = 100;
};

void run(const Arguments& given, Session& session) {
  const std::unique_ptr<mapping::Recording> recording = mapping::open_recording(given.recording);
  const size_t count = std::min(recording->size(), static_cast<size_t>(given.frames));
  perception::SurfaceCalibration calibration;
  for (size_t i = 0; i < count; ++i) {
    session.progress().check(static_cast<double>(i) / static_cast<double>(count), "averaging");
    calibration.add(recording->frame(i).depth);
  }
  const cv::Mat mean = calibration.mean();
  const double known =
      static_cast<double>(cv::countNonZero(mean == mean)) / static_cast<double>(mean.total());
  perception::write_surface(given.output, mean);
  session.answer(fmt::format("the mean of {} images, {:.0f} % of the pixels known: {}\n", count, 100 * known,
                             given.output),
                 {{"frames", count}, {"known", known}, {"file", given.output}});
}

}  // namespace

Command surface_command() {
  return {"surface",
          "Averages images of an empty workspace, so that flat things are found on it (FlatObjectExtractor)",
          {"loci-perceive surface demo-output/day -o demo-output/surface.png --frames 5",
           "loci-perceive surface demo-output/day -o demo-output/surface.png --json"},
          [](ArgumentTable& table) {
            auto given = std::make_shared<Arguments>();
            table.positional("RECORDING", &given->recording,
                             "Recording of the empty workspace by a camera that stands still");
            table.option("-o,--output", &given->output, "PNG, 16 bit, in tenths of a millimetre",
                         {.required = true});
            table.option("--frames", &given->frames, "Images to take at most", {.min = 1});
            return [given](Session& session) { run(*given, session); };
          }};
}

}  // namespace loci::apps
