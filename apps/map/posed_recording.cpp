#include "apps/map/posed_recording.h"

#include "mapping/base/stopwatch.h"
#include "mapping/recording/pose_check.h"
#include "mapping/recording/posed_recording.h"
#include "mapping/tracking/known_poses.h"

namespace loci::apps {

PosedRecording open_posed(const std::string& path, const mapping::RecordingOptions& reading, Session& session,
                          const mapping::SemanticMap* map) {
  auto recording = mapping::open_recording(path, reading, &session.progress());
  const bool tracked = recording->info().frames_with_pose == 0;
  const mapping::PoseAgreement agreement = mapping::check_poses(*recording);
  if (!agreement.cause.empty()) throw Error(agreement.text(), {path, 0, {}}, "a map of it would be invented");
  if (const std::string text = agreement.text(); !text.empty()) session.warnings().add(text);
  if (const auto doubt = mapping::doubt_about_up(*recording, reading)) {
    session.warnings().add(*doubt);
    recording = mapping::not_levelled(std::move(recording));  // Left to the floor of the map.
  }
  if (map != nullptr) recording = in_map(std::move(recording), map->map_from_input, map->frame);
  const Stopwatch watch;
  recording = mapping::with_known_poses(std::move(recording), mapping::PosesFor::mapping,
                                        session.flags().threads, session.progress(), session.warnings());
  if (tracked) {
    session.timing("track", watch.seconds());
    if (const auto height = implausible_height(*recording)) session.warnings().add(*height);
  }
  for (const std::string& problem : recording->info().problems) session.warnings().add(problem);
  return {std::move(recording), tracked};
}

}  // namespace loci::apps
