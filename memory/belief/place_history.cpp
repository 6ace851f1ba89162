#include "memory/belief/place_history.h"

#include <algorithm>

namespace loci::memory::belief {
namespace {

constexpr double kOneView = 1;  ///< seconds
constexpr size_t kMaxViews = 6;
constexpr double kMinUnseen = 0.01;  ///< of a place: below, everything was seen

}  // namespace

void PlaceHistory::add_view(double exposure_s, double share) {
  const double unseen = std::clamp(1 - share, 0.0, 1.0);
  if (!views.empty() && exposure_s - views.back().exposure_s < kOneView) {
    never_seen *= std::min(1.0, unseen / std::max(kMinUnseen, views.back().unseen));
    views.back() = {exposure_s, std::min(unseen, views.back().unseen)};
  } else {
    if (views.empty()) begin_s = exposure_s;
    never_seen *= unseen;
    views.push_back({exposure_s, unseen});
  }
  double product = 1;
  for (size_t i = views.size(); i-- > 0;) {
    product *= views[i].unseen;
    if (product >= kMinUnseen && views.size() - i < kMaxViews) continue;
    views.erase(views.begin(), views.begin() + static_cast<std::ptrdiff_t>(i));
    break;
  }
}

double PlaceHistory::unseen_seconds(double from_s, double to_s) const {
  double seconds = 0, unseen = 1, end = to_s;
  for (auto view = views.rbegin(); view != views.rend() && end > from_s; ++view) {
    if (view->exposure_s >= to_s) {
      unseen *= view->unseen;
      continue;
    }
    const double begin = std::max(from_s, view->exposure_s);
    seconds += unseen * std::max(0.0, end - begin);
    end = std::min(end, begin);
    unseen *= view->unseen;
  }
  // What lies before the oldest view that is kept was seen, unless that is the first one.
  const bool all_kept = views.empty() || views.front().exposure_s <= begin_s;
  if (end > from_s && (all_kept || unseen >= kMinUnseen)) seconds += unseen * (end - from_s);
  return seconds;
}

double PlaceHistory::unseen_share(double from_s, double to_s) const {
  const double begin = std::min(from_s, to_s - kOneView);
  return unseen_seconds(begin, to_s) / (to_s - begin);
}

}  // namespace loci::memory::belief
