#include "mapping/recording/clock.h"

#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/math/math.h"

namespace loci::mapping {
namespace {

bool is_earlier(const FrameFiles& a, const FrameFiles& b) {
  return a.time_ns < b.time_ns;
}

/// Between frames that follow each other in the file and in time.
TimeNs usual_interval(const std::vector<FrameFiles>& frames) {
  std::vector<TimeNs> intervals;
  for (size_t i = 1; i < frames.size(); ++i)
    if (is_earlier(frames[i - 1], frames[i])) intervals.push_back(frames[i].time_ns - frames[i - 1].time_ns);
  return intervals.empty() ? 0 : median(std::move(intervals));
}

/// Frames from `begin` up to where the stamps go back again.
size_t passage_end(const std::vector<FrameFiles>& frames, size_t begin) {
  size_t end = begin + 1;
  while (end < frames.size() && !is_earlier(frames[end], frames[end - 1])) ++end;
  return end;
}

/// Whether the passage that begins here would be woven into what was recorded before without a gap. Rows in
/// another order, as of names 1, 10, 11, 2, fill gaps instead.
bool interleaves(const std::vector<FrameFiles>& frames, size_t begin, TimeNs interval) {
  constexpr size_t kMinFrames = 3;  // fewer are rows that were swapped
  std::vector<TimeNs> before;
  for (size_t i = 0; i < begin; ++i) before.push_back(frames[i].time_ns);
  std::ranges::sort(before);
  size_t inside = 0;
  for (size_t i = begin; i < passage_end(frames, begin); ++i) {
    const auto after = std::ranges::upper_bound(before, frames[i].time_ns);
    if (after == before.begin() || after == before.end()) continue;
    if (2 * (*after - *std::prev(after)) <= 3 * interval) ++inside;
  }
  return inside >= kMinFrames;
}

/// Lets a clock go on that was set back.
void undo_set_back(std::vector<FrameFiles>& frames, RecordingInfo& info) {
  const TimeNs interval = usual_interval(frames);
  for (size_t i = 1; i < frames.size(); ++i) {
    if (!is_earlier(frames[i], frames[i - 1]) || !interleaves(frames, i, interval)) continue;
    const TimeNs back = frames[i - 1].time_ns - frames[i].time_ns, added = back + interval;
    info.problems.push_back(fmt::format(
        "{}: the clock goes back by {:.3f} s here, into what was recorded before: frames stay in the order "
        "of the file, {:.3f} s are added to the stamps from here on (correct them where the time of day "
        "matters)",
        frames[i].location.text(), in_seconds(back), in_seconds(added)));
    for (size_t k = i; k < frames.size(); ++k) frames[k].time_ns += added;
  }
}

}  // namespace

void order_by_time(std::vector<FrameFiles>& frames, RecordingInfo& info) {
  undo_set_back(frames, info);
  if (std::ranges::is_sorted(frames, is_earlier)) return;
  info.problems.push_back(fmt::format("{}: the stamps go back here; frames are taken in order of time",
                                      std::ranges::is_sorted_until(frames, is_earlier)->location.text()));
  std::ranges::stable_sort(frames, is_earlier);
}

}  // namespace loci::mapping
