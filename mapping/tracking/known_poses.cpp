#include "mapping/tracking/known_poses.h"

#include "mapping/tracking/tracking.h"

namespace loci::mapping {
namespace {

/// Whether the frames are few and do not follow each other: images of different scenes.
bool is_no_video(const TrackingResult& result) {
  constexpr size_t kMinVideo = 30;
  return result.frames.size() < kMinVideo && 2 * result.good() < result.frames.size();
}

void require_up(const Recording& recording) {
  if (!recording.info().levelled)
    throw Error("which way is up is not known", {recording.info().path, 0, {}},
                "give the direction of the first frame's camera that is up with --up, e.g. --up -y");
}

}  // namespace

std::unique_ptr<Recording> with_known_poses(std::unique_ptr<Recording> recording, PosesFor purpose,
                                            int threads, Progress& progress, Warnings& warnings) {
  const bool perceives = purpose == PosesFor::perception, maps = purpose == PosesFor::mapping;
  if (recording->info().frames_with_pose > 0 || (perceives && recording->size() < 2)) return recording;
  TrackingOptions options;
  options.threads = threads;
  const TrackingResult result = track(*recording, options, progress);
  if (perceives && (result.still || is_no_video(result))) return recording;
  const FileLocation location{recording->info().path, 0, {}};
  require_usable(result, location.file);
  warnings.add("the recording has no poses: " + result.summary() +
                   (maps || result.still ? "" : "; if the camera stood still, say so with --fixed-camera"),
               location);
  if (!maps && result.still) return with_fixed_pose(std::move(recording), warnings);
  recording = with_tracked_poses(std::move(recording), result, false, warnings);
  if (!maps) require_up(*recording);
  return recording;
}

std::unique_ptr<Recording> with_fixed_pose(std::unique_ptr<Recording> recording, Warnings& warnings) {
  TrackingResult result;
  result.map_frame = kFirstCamera;
  result.still = true;
  for (size_t i = 0; i < recording->size(); ++i) {
    TrackedFrame& frame = result.frames.emplace_back();
    frame.number = i;
    frame.map_from_camera = Isometry3d::Identity();
  }
  recording = with_tracked_poses(std::move(recording), result, false, warnings);
  require_up(*recording);
  return recording;
}

}  // namespace loci::mapping
