#include "mapping/tracking/known_poses.h"

#include "mapping/tracking/tracking.h"

namespace loci::mapping {
namespace {

/// Whether the frames are few and do not follow each other: images of different scenes.
bool is_no_video(const TrackingResult& result) {
  constexpr size_t kMinVideo = 30;
  return result.frames.size() < kMinVideo && 2 * result.good() < result.frames.size();
}

}  // namespace

std::unique_ptr<Recording> with_known_poses(std::unique_ptr<Recording> recording, PosesFor purpose,
                                            int threads, Progress& progress, Warnings& warnings) {
  const bool perceives = purpose == PosesFor::perception;
  if (recording->info().frames_with_pose > 0 || (perceives && recording->size() < 2)) return recording;
  TrackingOptions options;
  options.threads = threads;
  const TrackingResult result = track(*recording, options, progress);
  if (perceives && (result.still || is_no_video(result))) return recording;
  const FileLocation location{recording->info().path, 0, {}};
  require_usable(result, location.file);
  recording = with_tracked_poses(std::move(recording), result, false, warnings);
  warnings.add("the recording has no poses: " + result.summary() +
                   (perceives ? "; if the camera stood still, say so with --fixed-camera" : ""),
               location);
  if (perceives && !recording->info().levelled)
    throw Error("which way is up is not known", location,
                "give the direction of the first frame's camera that is up with --up, e.g. --up -y");
  return recording;
}

}  // namespace loci::mapping
