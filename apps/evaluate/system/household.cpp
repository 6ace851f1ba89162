#include "apps/evaluate/system/household.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "mapping/base/math/math.h"
#include "mapping/world/kinematics.h"

namespace loci::apps::system_evaluation {
namespace {

constexpr double kGap = 0.02;        ///< between two objects, metres
constexpr double kHalfReach = 0.45;  ///< along the counter that one look shows
constexpr double kEdge = 0.04;       ///< kept free at the counter's edges

mapping::ObjectSpec of_model(const std::string& model, const mapping::Rgba& color,
                             const mapping::Rgba& accent, const std::string& pattern = "") {
  mapping::ObjectSpec spec;
  spec.model = model;
  spec.color = color;
  spec.accent = accent;
  spec.pattern = pattern;
  return spec;
}

mapping::ObjectSpec of_box(const Vector3d& size, const mapping::Rgba& color, const mapping::Rgba& accent,
                           const std::string& pattern = "") {
  mapping::ObjectSpec spec = of_model("box", color, accent, pattern);
  spec.size = size;
  return spec;
}

/// A counter as a place to work at.
struct Counter {
  std::string link;
  Isometry3d map_from_top = Isometry3d::Identity();  ///< axes of the link
  Vector2d half = Vector2d::Zero();                  ///< extent along x and y from the middle
  int along = 0;                                     ///< axis of its length
  double front = 1;                                  ///< sign of the other axis that points into the room

  /// `out` towards the room, `along` to its side.
  Vector2d at(double along_m, double out_m) const {
    Vector2d position;
    position[along] = along_m;
    position[1 - along] = front * out_m;
    return position;
  }
};

std::vector<Counter> counters_of(const perception::KnownMap& map) {
  const std::vector<Isometry3d> poses = root_from_links(map.world, {});
  Vector3d middle = Vector3d::Zero();
  for (const Isometry3d& pose : poses) middle += pose.translation() / static_cast<double>(poses.size());
  std::vector<Counter> counters;
  for (const perception::SupportSurface& surface : map.support_surfaces({"counter*"})) {
    Counter counter;
    counter.link = surface.link;
    for (size_t i = 0; i < map.world.links.size(); ++i)
      if (map.world.links[i].name == surface.link) counter.map_from_top = poses[i] * surface.link_from_top;
    Eigen::AlignedBox2d extent;
    for (const Vector2d& corner : surface.outline) extent.extend(corner);
    counter.half = extent.sizes() / 2;
    counter.along = counter.half.x() > counter.half.y() ? 0 : 1;
    // Furniture stands around a room: its middle is before the counter.
    counter.front = (counter.map_from_top.inverse() * middle)[1 - counter.along] < 0 ? -1 : 1;
    counters.push_back(counter);
  }
  if (counters.empty())
    throw Error("the map has no counter to set objects up on", {map.path.string(), 0, {}},
                "a link named counter_1");
  return counters;
}

/// What something covers of the counter.
cv::RotatedRect footprint(const Vector2d& at, const Vector2d& size, double yaw, double gap) {
  return {{static_cast<float>(at.x()), static_cast<float>(at.y())},
          {static_cast<float>(size.x() + gap), static_cast<float>(size.y() + gap)},
          static_cast<float>(yaw * 180 / kPi)};
}

bool free_of(const cv::RotatedRect& one, const std::vector<cv::RotatedRect>& others) {
  std::vector<cv::Point2f> common;
  return std::all_of(others.begin(), others.end(), [&](const cv::RotatedRect& other) {
    return cv::rotatedRectangleIntersection(one, other, common) == cv::INTERSECT_NONE;
  });
}

/// Sets objects up on a part of a counter.
class Setter {
 public:
  Setter(const Counter& counter, Random& random) : counter_(counter), random_(random) {
    const double most = std::max(0.0, counter.half[counter.along] - kHalfReach);
    centre_ = random.uniform(-most, most);
  }

  /// Nothing when no place was found.
  std::optional<mapping::Action> place(const HouseholdObject& true_object, const Vector2d& size) {
    // A package's front looks at who stands before the counter, more or less; flat objects lie anyhow.
    const Vector2d out = counter_.at(0, 1);
    const double facing = std::atan2(out.x(), -out.y());
    const double half_along = std::min(kHalfReach, counter_.half[counter_.along]);
    for (int attempt = 0; attempt < 400; ++attempt) {
      const double yaw = facing + random_.uniform(-1, 1) * (true_object.flat ? kPi : 0.7);
      const double radius = size.norm() / 2;
      const double along = centre_ + random_.uniform(-1, 1) * std::max(0.0, half_along - radius);
      const double room = std::max(0.0, counter_.half[1 - counter_.along] - kEdge - radius);
      const Vector2d at = counter_.at(along, random_.uniform(-room, room));
      const cv::RotatedRect covered = footprint(at, size, yaw, kGap);
      if (!free_of(covered, covered_)) continue;
      covered_.push_back(covered);
      mapping::Action action;
      action.subject = true_object.spec.name;
      action.support = counter_.link;
      action.at = at;
      action.yaw = yaw;
      return action;
    }
    return std::nullopt;
  }

  /// A look over the part from a robot's head.
  Isometry3d view() {
    const auto point = [&](double along, double out, double height) {
      const Vector2d at = counter_.at(centre_ + along, out);
      return Vector3d(counter_.map_from_top * Vector3d(at.x(), at.y(), height));
    };
    const double depth = counter_.half[1 - counter_.along];
    return mapping::looking_at(
        point(random_.uniform(-0.12, 0.12), depth + random_.uniform(0.5, 0.65), random_.uniform(0.55, 0.7)),
        point(0, 0, 0));
  }

 private:
  const Counter& counter_;
  Random& random_;
  double centre_ = 0;
  std::vector<cv::RotatedRect> covered_;
};

/// So many of the flat, or of the other, objects.
std::vector<size_t> drawn(const std::vector<HouseholdObject>& true_objects, bool flat, int count,
                          Random& random) {
  std::vector<size_t> left;
  for (size_t i = 0; i < true_objects.size(); ++i)
    if (true_objects[i].flat == flat) left.push_back(i);
  for (size_t i = 0; i < left.size(); ++i) std::swap(left[i], left[i + random.index(left.size() - i)]);
  left.resize(std::min(left.size(), static_cast<size_t>(count)));
  return left;
}

/// Everything of a scene, anew until it fits.
mapping::SceneSpec set_up(const Counter& counter, const std::vector<HouseholdObject>& true_objects,
                          const std::vector<Vector2d>& sizes, const SceneCount& count, Random random) {
  for (int attempt = 0; attempt < 1000; ++attempt) {
    std::vector<size_t> chosen = drawn(true_objects, false, count.solid, random);
    for (const size_t flat : drawn(true_objects, true, count.flat, random)) chosen.push_back(flat);
    // The largest first, else nothing is left for them.
    std::stable_sort(chosen.begin(), chosen.end(),
                     [&](size_t a, size_t b) { return sizes[a].prod() > sizes[b].prod(); });
    Setter setter(counter, random);
    mapping::SceneSpec scene;
    for (const size_t true_object : chosen)
      if (auto action = setter.place(true_objects[true_object], sizes[true_object]))
        scene.actions.push_back(*action);
    if (scene.actions.size() < chosen.size()) continue;
    scene.map_from_camera.push_back(setter.view());
    return scene;
  }
  throw Error("the objects of a scene do not fit on " + counter.link);
}

}  // namespace

std::vector<HouseholdObject> household(const std::filesystem::path& labels) {
  const mapping::Rgba white(0.93F, 0.94F, 0.95F, 1), red(0.80F, 0.14F, 0.12F, 1),
      blue(0.20F, 0.45F, 0.80F, 1), yellow(0.93F, 0.75F, 0.14F, 1), green(0.16F, 0.45F, 0.24F, 1),
      steel(0.75F, 0.76F, 0.78F, 1), dark(0.16F, 0.17F, 0.20F, 1), wood(0.55F, 0.36F, 0.20F, 1),
      cream(0.92F, 0.86F, 0.70F, 1), orange(0.90F, 0.45F, 0.12F, 1);
  std::vector<HouseholdObject> true_objects = {
      {"mug", false, of_model("mug", red, red)},
      {"mug", false, of_model("mug", blue, white, "stripes")},
      {"mug", false, of_model("mug", white, white)},
      {"bowl", false, of_model("bowl", blue, white)},
      {"bowl", false, of_model("bowl", orange, white)},
      {"can", false, of_model("can", cream, red, "band")},
      {"can", false, of_model("can", green, yellow, "band")},
      {"jar", false, of_model("jar", mapping::Rgba(0.45F, 0.08F, 0.22F, 1), cream)},
      {"jar", false, of_model("jar", yellow, red, "band")},
      {"bottle", false, of_model("bottle", red, white, "band")},
      {"bottle", false, of_model("bottle", mapping::Rgba(0.62F, 0.60F, 0.12F, 1), green)},
      {"bottle", false, of_model("bottle", white, blue)},
      {"pot", false, of_model("pot", steel, dark)},
      {"cereal", false, of_box({0.19, 0.07, 0.28}, yellow, red)},
      {"carton", false, of_box({0.07, 0.07, 0.20}, white, blue, "band")},
      {"carton", false, of_box({0.09, 0.06, 0.22}, orange, cream, "checker")},
      {"tea", false, of_box({0.14, 0.08, 0.10}, green, cream, "band")},
      {"apple", false, of_model("apple", mapping::Rgba(0.55F, 0.75F, 0.20F, 1), wood)},
      {"banana", false, of_model("banana", yellow, wood)},
      {"cutlery", true, of_model("cutlery", steel, orange)},
      {"cutlery", true, of_model("cutlery", steel, steel)},
      {"cutlery", true, of_model("cutlery", dark, steel)},
      {"plate", true, of_model("plate", white, blue)},
      {"plate", true, of_model("plate", blue, white)},
      {"book", true, of_box({0.15, 0.21, 0.025}, red, white)},
      {"book", true, of_box({0.13, 0.19, 0.018}, dark, white)},
      {"magazine", true, of_box({0.21, 0.28, 0.005}, blue, white)},
      {"chocolate", true, of_box({0.08, 0.17, 0.012}, mapping::Rgba(0.45F, 0.20F, 0.55F, 1), white)},
  };
  for (size_t i = 0; i < true_objects.size(); ++i) {
    HouseholdObject& true_object = true_objects[i];
    true_object.spec.name = true_object.kind + "_" + std::to_string(i + 1);
    const std::filesystem::path label = labels / (true_object.kind + ".png");
    if (std::filesystem::exists(label)) true_object.spec.label = label;
  }
  return true_objects;
}

mapping::Scenario household_scenario(const perception::KnownMap& map,
                                     const std::vector<HouseholdObject>& true_objects,
                                     const std::vector<SceneCount>& counts, const Random& random) {
  const std::vector<Counter> counters = counters_of(map);
  mapping::Scenario scenario;
  scenario.world = map.path;
  scenario.camera = mapping::kinect_camera();
  std::vector<Vector2d> sizes;
  for (const HouseholdObject& true_object : true_objects) {
    const mapping::ObjectModel model = build_object(true_object.spec);
    // Models are not always in the middle of their origin (a mug's handle): cover both sides.
    sizes.push_back(2 * model.low.cwiseAbs().cwiseMax(model.high.cwiseAbs()).head<2>());
    scenario.objects[true_object.spec.name] = true_object.spec;
  }
  constexpr TimeNs kStart = 1777881600 * kSecond;  // 2026-05-04T08:00:00Z
  std::vector<std::string> there;
  for (size_t i = 0; i < counts.size(); ++i) {
    mapping::SceneSpec scene = set_up(counters[i % counters.size()], true_objects, sizes, counts[i],
                                      random.fork(static_cast<uint64_t>(i)));
    scene.time_ns = kStart + static_cast<TimeNs>(i) * 120 * kSecond;
    std::vector<mapping::Action> actions;
    for (const std::string& name : there) {
      mapping::Action clear;
      clear.kind = mapping::Action::Kind::remove;
      clear.subject = name;
      actions.push_back(clear);
    }
    there.clear();
    for (const mapping::Action& action : scene.actions) {
      there.push_back(action.subject);
      actions.push_back(action);
    }
    scene.actions = std::move(actions);
    scenario.scenes.push_back(std::move(scene));
  }
  return scenario;
}

}  // namespace loci::apps::system_evaluation
