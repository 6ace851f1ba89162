#include "memory/exchange/object_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mapping/base/error.h"
#include "mapping/base/math/math.h"
#include "mapping/base/options.h"
#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "mapping/registration/registration.h"
#include "memory/exchange/observation_image.h"

namespace loci::memory {
namespace {

/// Observations closer than this on one place show the object unmoved.
constexpr double kSameSpot_m = 0.08;
/// From higher than this it is seen from above.
constexpr double kAbove_deg = 55;

/// An observation that may become a view.
struct Candidate {
  ObjectObservation observed;
  size_t stay = 0;
};

std::vector<Candidate> candidates_of(const std::vector<ObjectObservation>& observations) {
  std::vector<Candidate> candidates;
  size_t stay = 0;
  const ObservationRow* before = nullptr;
  for (const ObjectObservation& observed : observations) {
    const ObservationRow& seen = observed.observation;
    if (!seen.position) continue;
    if (before != nullptr &&
        (before->place != seen.place || (*before->position - *seen.position).norm() > kSameSpot_m))
      ++stay;
    before = &seen;
    candidates.push_back({observed, stay});
  }
  return candidates;
}

/// Where the object stood in each stay: the mean of its observations.
std::map<size_t, Vector3d> centres_of(const std::vector<Candidate>& candidates) {
  std::map<size_t, Vector3d> sums;
  std::map<size_t, double> counts;
  for (const Candidate& candidate : candidates) {
    const auto [sum, fresh] = sums.try_emplace(candidate.stay, Vector3d::Zero());
    sum->second += *candidate.observed.observation.position;
    counts[candidate.stay] += 1;
  }
  for (auto& [stay, sum] : sums) sum /= counts[stay];
  return sums;
}

/// The direction from a centre to the camera, in eighths of a turn.
int eighth_of(const Vector3d& from_centre) {
  return static_cast<int>(std::floor(std::atan2(from_centre.y(), from_centre.x()) / (kPi / 4)));
}

/// Those with most points first, one of every side and stay before the second of any.
std::vector<Candidate> chosen_of(const Store& store, std::vector<Candidate> candidates,
                                 const std::map<size_t, Vector3d>& centres, size_t most) {
  std::erase_if(candidates, [](const Candidate& candidate) {
    return !candidate.observed.observation.roi || candidate.observed.observation.points.value_or(0) == 0;
  });
  std::ranges::stable_sort(candidates, [](const Candidate& a, const Candidate& b) {
    return *a.observed.observation.points > *b.observed.observation.points;
  });
  std::map<std::pair<size_t, int>, int> taken;
  std::vector<std::pair<int, size_t>> order;
  for (size_t i = 0; i < candidates.size(); ++i) {
    const SceneRow scene = store.scene(candidates[i].observed.observation.scene);
    const Vector3d from_centre =
        scene.map_from_camera ? (scene.map_from_camera->translation() - centres.at(candidates[i].stay)).eval()
                              : Vector3d::Zero();
    order.emplace_back(taken[{candidates[i].stay, eighth_of(from_centre)}]++, i);
  }
  std::ranges::sort(order);
  std::vector<Candidate> chosen;
  for (const auto& [round, i] : order)
    if (chosen.size() < most) chosen.push_back(candidates[i]);
  std::ranges::stable_sort(chosen, {}, [](const Candidate& candidate) { return candidate.observed.time; });
  return chosen;
}

std::string side_of(const Vector3d& from_centre, double front_yaw) {
  if (from_centre.z() > std::tan(kAbove_deg / 180 * kPi) * from_centre.head<2>().norm()) return "top";
  static const char* const names[] = {"front", "right", "back", "left"};  // to the left, seen from above
  const double turn = std::atan2(from_centre.y(), from_centre.x()) - front_yaw;
  return names[(static_cast<int>(std::lround(turn / (kPi / 2))) % 4 + 4) % 4];
}

/// In the frame of its stay's centre.
void centre(mapping::Scan& scan, const Vector3d& centre) {
  for (mapping::ScanPoint& point : scan.points) point.position -= centre.cast<float>();
  for (Eigen::Vector3f& origin : scan.origins) origin -= centre.cast<float>();
}

void register_views(ObjectModel& model, const ObjectModelOptions& options, Progress& progress) {
  mapping::RegistrationOptions registration;
  registration.position_error_m = options.position_error_m;
  registration.yaw_error_deg = options.yaw_error_deg;
  registration.voxel_m = options.voxel_m;
  registration.max_rmse_m = options.voxel_m;
  const mapping::RegistrationResult result = register_scans(model.cloud, registration, progress);
  for (size_t i = 0; i < model.views.size(); ++i) {
    ObjectView& view = model.views[i];
    view.registered = result.connected[i];
    if (view.registered) {
      model.cloud.scans[i].map_from_scan = result.map_from_scan[i];
      view.placed = i == 0 ? "the first view" : "registered with the views before";
      continue;
    }
    const bool unmoved = view.stay == model.views.front().stay;
    view.placed = unmoved ? "by the pose of the camera: it was not moved, and no alignment is certain"
                          : "by its centre alone: no alignment shows for certain how it was rotated";
  }
}

}  // namespace

void ObjectModelOptions::declare(OptionTable& table) {
  table.integer("views", views, "", "Views that are put together at most.", 1, 100);
  table.number("position_error_m", position_error_m, "m", "Expected error of a view's position (sigma).",
               0.001, 1);
  table.number("yaw_error_deg", yaw_error_deg, "deg", "Expected error of a view's direction (sigma).", 0.1,
               90);
  table.number("voxel_m", voxel_m, "m", "Voxel size of the registration.", 0.001, 0.1);
}

ObjectModel model_of(const Store& store, Id object, const ObjectModelOptions& options, Progress& progress,
                     const AsOf& as_of) {
  const Store::ReadTransaction moment(store);
  ObjectModel model;
  model.object = object;
  const std::vector<ObjectObservation> observations = store.observations_of(object, as_of);
  if (observations.empty()) throw Error(object_name(object) + " was never seen", {store.name(), 0, {}});
  model.observations = observations.size();
  model.evidence = annotation_support(store, observations);
  const std::vector<Candidate> candidates = candidates_of(observations);
  const std::map<size_t, Vector3d> centres = centres_of(candidates);
  model.cloud.sensor = "remembered depth";
  for (const Candidate& candidate :
       chosen_of(store, candidates, centres, static_cast<size_t>(options.views))) {
    const SceneRow scene = store.scene(candidate.observed.observation.scene);
    std::optional<mapping::Scan> scan = cloud_of(store, scene, candidate.observed.observation);
    if (!scan) continue;
    centre(*scan, centres.at(candidate.stay));
    model.views.push_back({.scene = scene.id,
                           .time = scene.time,
                           .stay = candidate.stay,
                           .side = {},
                           .points = scan->points.size(),
                           .placed = {}});
    model.cloud.range_max = std::max(model.cloud.range_max, 10.0);
    model.cloud.scans.push_back(std::move(*scan));
  }
  if (model.views.empty())
    throw Error(
        "nothing of the surface of " + object_name(object) + " is stored", {store.name(), 0, {}},
        "depth, masks and poses are needed (loci-perceive run keeps them; loci-memory retain lets them go)");
  register_views(model, options, progress);
  const auto from_centre = [&](size_t i) {
    const mapping::Scan& scan = model.cloud.scans[i];
    return (scan.map_from_scan * scan.origins.front().cast<double>()).eval();
  };
  const double front = std::atan2(from_centre(0).y(), from_centre(0).x());
  std::map<std::string, int> largest;
  for (size_t i = 0; i < model.views.size(); ++i) {
    ObjectView& view = model.views[i];
    view.side = side_of(from_centre(i), front);
    for (const Candidate& candidate : candidates) {
      const ObservationRow& seen = candidate.observed.observation;
      if (seen.scene != view.scene || !seen.crop || !seen.roi) continue;
      const int area = (*seen.roi)[2] * (*seen.roi)[3];
      if (area <= largest[view.side]) continue;
      largest[view.side] = area;
      model.best_crop[view.side] = *seen.crop;
    }
  }
  return model;
}

std::string ObjectModel::summary() const {
  size_t points = 0, registered = 0;
  for (const ObjectView& view : views) {
    points += view.points;
    registered += view.registered ? 1 : 0;
  }
  std::string text =
      fmt::format("{}: {} of {} ({} registered) of {}\n", object_name(object), counted(points, "point"),
                  counted(views.size(), "view"), registered, counted(size_t(observations), "observation"));
  for (const ObjectView& view : views)
    text += fmt::format("  scene {}: {}, {} points, {}\n", view.scene, view.side, view.points, view.placed);
  for (const AnnotationSupport& one : evidence)
    text += fmt::format("  {} '{}': {}, {:.0f} % agree\n", one.type, one.value,
                        counted(size_t(one.observations), "observation"), 100 * one.agreement);
  return text;
}

Json ObjectModel::report() const {
  Json json = {{"object", object_name(object)},
               {"observations", observations},
               {"views", Json::array()},
               {"evidence", Json::array()}};
  for (const ObjectView& view : views)
    json["views"].push_back({{"scene", view.scene},
                             {"time", format_time(view.time)},
                             {"stay", view.stay},
                             {"side", view.side},
                             {"points", view.points},
                             {"registered", view.registered},
                             {"placed", view.placed}});
  for (const AnnotationSupport& one : evidence) json["evidence"].push_back(to_json(one));
  return json;
}

}  // namespace loci::memory
