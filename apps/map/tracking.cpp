// Camera poses of recordings: track.

#include "mapping/tracking/tracking.h"
#include "apps/map/commands.h"
#include "mapping/base/text/json.h"
#include "mapping/recording/pose_check.h"

namespace loci::apps {
namespace {

struct TrackArguments {
  std::string recording, out;
  mapping::RecordingOptions reading;
  mapping::TrackingOptions options;
};

void write_posed(const mapping::Recording& recording, const mapping::TrackingResult& result,
                 const std::string& folder, Session& session) {
  const mapping::RecordingInfo& info = recording.info();
  mapping::RecordingWriter writer(folder, info.camera, info.map_frame,
                                  {.time_assumed = info.time_assumed,
                                   .time_zone = info.time_zone,
                                   .depth_unit_m = info.depth_unit_m,
                                   .inputs = {info.path},
                                   .force = session.flags().force});
  for (size_t i = 0; i < result.frames.size(); ++i) {
    session.progress().check(static_cast<double>(i) / static_cast<double>(result.frames.size()), "writing");
    const mapping::RgbdFrame frame = recording.frame(result.frames[i].number);
    if (!frame.damage.empty()) session.warnings().add(frame.damage);
    writer.add(frame);
  }
  writer.add_file("tracking.json", result.report().dump(2) + '\n');
  writer.finish();
}

void run_track(TrackArguments& arguments, Session& session) {
  arguments.options.threads = session.flags().threads;
  std::unique_ptr<mapping::Recording> recording =
      mapping::open_recording(arguments.recording, arguments.reading, &session.progress());
  for (const std::string& problem :
       arguments.options.refine ? problems_of(*recording, arguments.reading) : recording->info().problems)
    session.warnings().add(problem);
  const mapping::TrackingResult result = track(*recording, arguments.options, session.progress());
  session.timing("track", result.seconds);
  require_usable(result, arguments.recording);
  write_posed(*with_tracked_poses(std::move(recording), result, arguments.options.refine, session.warnings()),
              result, arguments.out, session);
  Json json = result.report();
  json["out"] = arguments.out;
  session.answer(result.summary() + "; written to " + arguments.out, json);
}

}  // namespace

Command track_command() {
  return {"track",
          "Estimate the camera poses of a recording from its images",
          {"loci-simulate record apps/samples/walk.yaml -o demo-output/walk",
           "loci-map track demo-output/walk -o demo-output/posed",
           "loci-map track demo-output/walk --every 2 -o demo-output/posed --json"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<TrackArguments>();
            table.positional("RECORDING", &arguments->recording, "Folder of the recording");
            table.output("POSED", &arguments->out,
                         "Folder of the recording with poses; frames that are lost have none",
                         {.replaces = true});
            table.options(table_of(arguments->reading), "Recording");
            table.options(table_of(arguments->options), "Tracking");
            return [arguments](Session& session) { run_track(*arguments, session); };
          }};
}

}  // namespace loci::apps
