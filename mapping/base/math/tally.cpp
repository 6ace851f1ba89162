#include "mapping/base/math/tally.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"

namespace loci {
namespace {

struct ReasonText {
  const char* name;
  const char* text;
  const char* hint;
  bool usable = false;  ///< nothing was wrong: there was nothing to find
};

/// In the order of Reason.
constexpr std::array<ReasonText, static_cast<size_t>(Reason::count)> kReasons = {{
    {"no_pose", "no pose of the camera", "give it poses: loci-map track, or --poses FILE"},
    {"no_matching_frame", "no such frame in the recording",
     "check the times or names of the images, and that it is the recording that was detected in"},
    {"no_depth", "an empty depth image", "check the depth images and invalid_depth"},
    {"no_color", "no colour image", "record the colour camera, too"},
    {"damaged", "an image that cannot be read", "copy or record these files again"},
    {"no_depth_in_range", "no depth between 0.2 and 5 m",
     "check depth_scale: metres per unit of the depth image"},
    {"depth_too_sparse", "depth with too many holes for surfaces",
     "use the depth camera's own image, not one that was warped to the colour camera"},
    {"no_plane", "no supporting plane",
     "show a table or counter from above, or lower min_area_m2 of PlaneClusterExtractor"},
    {"camera_rolled", "a plane only if the camera was on its side or upside down",
     "give the recording poses (loci-map track), or turn its images"},
    {"map_not_level", "a plane that is not level in the frame of the poses",
     "the poses need a frame with z up: give --up or world_to_map.txt"},
    {"outside_map", "nothing of the map in view", "check that the poses are in the frame of the map"},
    {"no_support_in_view", "no support of the map in view",
     "show a counter or a table of the map, or check that the poses are in the frame of the map, and that "
     "its "
     "sidecar has supports"},
    {"unconfirmed", "objects that no other frame shows in the same place",
     "if the camera moved, it needs poses that fit (loci-map track), and frames that overlap (a smaller "
     "--every); if images without time stamps were taken apart, say so with --seconds-apart"},
    {"annotator_failed", "an annotator that failed", "the warnings say which (--verbose)"},
    {"outside_image", "a region outside the image", "check the size of the images that were detected in"},
    {"no_depth_inside", "no depth inside the region",
     "glass, metal and black surfaces measure nothing: give positions instead"},
    {"nothing_new", "nothing detected", "check the detector or the pipeline", true},
    {"map_explained", "nothing but what the map explains",
     "objects that stood there while the map was made are part of it: map the room without them", true},
    {"support_empty", "nothing on the supports", "lower min_height_m or min_points of PlaneClusterExtractor",
     true},
}};

constexpr double kMinUsable = 0.1;

/// Indices of the reasons that occurred, the most frequent first.
template <class Counts>
std::vector<size_t> by_frequency(const Counts& counts) {
  std::vector<size_t> order;
  for (size_t i = 0; i < counts.size(); ++i)
    if (counts[i] > 0) order.push_back(i);
  std::ranges::stable_sort(order, [&](size_t a, size_t b) { return counts[a] > counts[b]; });
  return order;
}

}  // namespace

void Tally::add(Reason reason, const std::string& example) {
  add(reason);
  std::string& first = examples_[static_cast<size_t>(reason)];
  if (first.empty()) first = example;
}

void Tally::add(const Tally& other) {
  used_ += other.used_;
  for (size_t i = 0; i < counts_.size(); ++i) {
    counts_[i] += other.counts_[i];
    if (examples_[i].empty()) examples_[i] = other.examples_[i];
  }
}

size_t Tally::total() const {
  return std::accumulate(counts_.begin(), counts_.end(), used_);
}

bool Tally::usable() const {
  size_t usable = used_;
  for (size_t i = 0; i < counts_.size(); ++i)
    if (kReasons[i].usable) usable += counts_[i];
  return static_cast<double>(usable) >= kMinUsable * static_cast<double>(total());
}

std::string Tally::reasons() const {
  std::vector<std::string> parts;
  for (const size_t i : by_frequency(counts_))
    parts.push_back(fmt::format("{} in {}{}", kReasons[i].text, counts_[i],
                                examples_[i].empty() ? "" : " (" + examples_[i] + ")"));
  return joined(parts, ", ");
}

std::string Tally::hint() const {
  const std::vector<size_t> order = by_frequency(counts_);
  return order.empty() ? std::string() : kReasons[order.front()].hint;
}

Json Tally::report() const {
  Json reasons = Json::object();
  for (size_t i = 0; i < counts_.size(); ++i)
    if (counts_[i] > 0) reasons[kReasons[i].name] = counts_[i];
  return {{"total", total()}, {"used", used_}, {"reasons", reasons}};
}

void Tally::explain(const std::string& sought, const FileLocation& where, Warnings& warnings) const {
  if (total() == 0 || (used_ > 0 && usable())) return;
  std::string text = used_ > 0 ? fmt::format("only {} of {} could be used", used_, counted(total(), unit_))
                               : fmt::format("no {} found in {}", sought, counted(total(), unit_));
  if (const std::string why = reasons(); !why.empty()) text += ": " + why;
  const Error error(text, where, hint());
  if (!usable()) throw error;
  warnings.add(error.what());
}

}  // namespace loci
