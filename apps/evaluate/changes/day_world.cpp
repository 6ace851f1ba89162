#include "apps/evaluate/changes/day_world.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <optional>

#include "apps/evaluate/changes/line_of_sight.h"
#include "mapping/base/math/math.h"
#include "mapping/base/math/random.h"
#include "mapping/simulation/play.h"
#include "mapping/world/kinematics.h"
#include "mapping/world/urdf.h"

namespace loci::apps::changes {
namespace {

/// Families of links that people put objects on, by the beginning of their names.
constexpr const char* kFamilies[] = {"counter", "table", "island", "shelf", "desk"};
constexpr double kLowest = 0.3, kHighest = 1.15;  ///< metres, of a top
constexpr double kMinSide = 0.3, kMaxSide = 1.3;  ///< of a stretch; longer tops are divided
constexpr double kEdge = 0.06;                    ///< from the edge of a top stands nothing
constexpr size_t kMaxSupports = 5, kViews = 3;

/// Finds stretches of tops in a world, what stands on them, and views of them.
class Finder {
 public:
  Finder(const mapping::World& world, const mapping::MeshSearch& search, uint64_t seed, Warnings& warnings)
      : world_(world),
        search_(search),
        sight_(world, search, warnings),
        map_from_link_(root_from_links(world, {})),
        random_(seed),
        warnings_(warnings) {}

  std::vector<Support> supports() {
    std::vector<Support> found;
    for (size_t link = 0; link < world_.links.size(); ++link) {
      const std::string& name = world_.links[link].name;
      if (std::ranges::none_of(kFamilies, [&](const char* family) { return name.starts_with(family); }))
        continue;
      const auto top = top_of_link(world_.links[link], search_, warnings_);
      if (!top) continue;
      const Isometry3d map_from_top = map_from_link_[link] * Eigen::Translation3d(top->centre);
      const double height = map_from_top.translation().z();
      if (height < kLowest || height > kHighest || top->half.minCoeff() < kMinSide / 2) continue;
      add_stretches(name, top->half, map_from_top, found);
    }
    return found;
  }

 private:
  /// Divides a top into rectangles of like size.
  void add_stretches(const std::string& link, const Vector2d& half, const Isometry3d& map_from_top,
                     std::vector<Support>& found) {
    const Eigen::Array2d number = (2 * half.array() / kMaxSide).ceil();
    const Vector2d side = 2 * half.array() / number;
    for (double i = 0; i < number.x(); ++i)
      for (double j = 0; j < number.y(); ++j) {
        Support support;
        support.link = link;
        support.middle = Vector2d(i + 0.5, j + 0.5).cwiseProduct(side) - half;
        support.x = side.x() / 2 - kEdge;
        support.y = side.y() / 2 - kEdge;
        if (!look_for_blocked(map_from_top, support)) continue;
        support.views = views_of(map_from_top, support);
        if (!support.views.empty()) found.push_back(std::move(support));
      }
  }

  /// What is higher or lower than the top stands or is sunk there. False where that is most of it.
  bool look_for_blocked(const Isometry3d& map_from_top, Support& support) const {
    constexpr double kStep = 0.02, kAbove = 0.35, kOff = 0.004, kAround = 0.15;
    size_t bare = 0, all = 0;
    for (double x = -support.x - kAround; x <= support.x + kAround; x += kStep)
      for (double y = -support.y - kAround; y <= support.y + kAround; y += kStep) {
        const Vector2d at = support.middle + Vector2d(x, y);
        const double fall = sight_.height_above_ground(map_from_top * Vector3d(at.x(), at.y(), kAbove));
        const bool is_bare = std::abs(fall - kAbove) < kOff;
        if (!is_bare) support.blocked.push_back(at);
        if (std::abs(x) > support.x || std::abs(y) > support.y) continue;
        ++all;
        bare += is_bare ? 1 : 0;
      }
    return 2 * bare > all;
  }

  /// Places where a person or robot could stand and see the whole stretch, from different sides.
  std::vector<View> views_of(const Isometry3d& map_from_top, const Support& support) {
    constexpr double kMinTurn = 20 * kDegree, kOverTop = 0.1;
    const Vector3d middle = map_from_top * Vector3d(support.middle.x(), support.middle.y(), 0);
    std::vector<View> views;
    for (int draw = 0; draw < 600 && views.size() < kViews; ++draw) {
      const double azimuth = random_.uniform(0, 2 * kPi), distance = random_.uniform(0.9, 1.7);
      const Vector3d from(middle.x() + distance * std::cos(azimuth),
                          middle.y() + distance * std::sin(azimuth), random_.uniform(1.35, 1.65));
      const bool stands = sight_.height_above_ground(from) > from.z() - kLowest;
      if (!stands || !sight_.sees(from, middle)) continue;
      const bool shows_corners = std::ranges::all_of(std::array{-1, 1}, [&](int i) {
        return std::ranges::all_of(std::array{-1, 1}, [&](int j) {
          const Vector2d corner = support.middle + Vector2d(0.8 * i * support.x, 0.8 * j * support.y);
          return sight_.free_line(from, map_from_top * Vector3d(corner.x(), corner.y(), kOverTop));
        });
      });
      const bool is_new = std::ranges::all_of(views, [&](const View& view) {
        const Vector2d one = (view.from - middle).head<2>(), other = (from - middle).head<2>();
        return one.normalized().dot(other.normalized()) < std::cos(kMinTurn);
      });
      if (shows_corners && is_new) views.push_back({from, middle});
    }
    return views;
  }

  const mapping::World& world_;
  const mapping::MeshSearch& search_;
  const LineOfSight sight_;
  const std::vector<Isometry3d> map_from_link_;
  Random random_;
  Warnings& warnings_;
};

/// The place for the middle of a row of cups that is nearest to the middle of the support.
std::optional<Vector2d> row_on(const Support& support) {
  constexpr double kStep = 0.05, kCup = 0.07;
  const bool along_x = support.x > support.y;
  const double reach = (along_x ? support.x : support.y) - kCupSpacing;
  std::optional<Vector2d> best;
  for (double x = -reach; x <= reach; x += kStep) {
    const Vector2d along = along_x ? Vector2d(1, 0) : Vector2d(0, 1);
    const Vector2d row = support.middle + x * along;
    const bool is_free = std::ranges::none_of(support.blocked, [&](const Vector2d& at) {
      return std::ranges::any_of(std::array{-1, 0, 1}, [&](int cup) {
        return (at - row - cup * kCupSpacing * along).norm() < kCup;
      });
    });
    if (is_free && (!best || std::abs(x) < (*best - support.middle).norm())) best = row;
  }
  return best;
}

}  // namespace

const DayWorld& sample_day_world(const std::string& name) {
  static const std::map<std::string, DayWorld> worlds = {
      {"kitchen",
       {{{"counter_1",
          1.0,
          0.18,
          {{{1.0, 1.45, 1.5}, {1.0, 2.65, 0.88}}, {{2.1, 1.45, 1.5}, {2.1, 2.65, 0.88}}}},
         {"table_1",
          0.48,
          0.28,
          {{{2.0, 1.7, 1.45}, {2.0, 0.62, 0.74}},
           {{1.5, 1.55, 1.5}, {1.95, 0.62, 0.74}},
           {{2.5, 1.6, 1.4}, {2.05, 0.62, 0.74}}}}},
        {{"drawer_1", 0.45, {{0.85, 1.38, 1.6}, {0.8, 2.2, 0.72}}},
         {"drawer_2", 0.42, {{1.62, 1.38, 1.6}, {1.6, 2.2, 0.72}}}}}},
      {"kitchen_l",
       {{{"counter_2", 0.2, 0.75, {{{5.1, 1.25, 1.6}, {5.1, 0.3, 0.9}}, {{4.6, 1.2, 1.5}, {5.0, 0.3, 0.9}}}},
         {"island_1",
          0.3,
          0.6,
          {{{1.95, 1.3, 1.6}, {1.95, 2.9, 0.92}},
           {{2.95, 3.1, 1.6}, {1.95, 3.1, 0.92}},
           {{1.1, 3.1, 1.6}, {1.95, 3.1, 0.92}}}},
         {"table_1",
          0.48,
          0.28,
          {{{5.25, 0.95, 1.6}, {5.25, 1.9, 0.74}}, {{4.3, 1.5, 1.6}, {5.2, 1.9, 0.74}}}}},
        {}}}};
  const auto found = worlds.find(name);
  if (found == worlds.end())
    throw Error("no days are simulated in '" + name + "'", {}, "take kitchen or kitchen_l");
  return found->second;
}

DayWorld find_day_world(const std::filesystem::path& urdf,
                        const std::vector<std::filesystem::path>& package_paths, uint64_t seed,
                        Warnings& warnings) {
  const mapping::World world = mapping::read_urdf(urdf);
  const mapping::MeshSearch search{package_paths, urdf.parent_path()};
  DayWorld day;
  day.prefix = "day_";
  day.supports = Finder(world, search, seed, warnings).supports();
  const auto area = [](const Support& support) { return support.x * support.y; };
  std::ranges::stable_sort(day.supports, std::greater(), area);
  if (day.supports.size() > kMaxSupports) day.supports.resize(kMaxSupports);
  const auto first =
      std::ranges::find_if(day.supports, [](const Support& one) { return row_on(one).has_value(); });
  if (first == day.supports.end())
    throw Error("no counter, table or island of the world has room for objects and can be seen",
                {urdf.string(), 0, {}}, "their links begin with counter, table, island, shelf or desk");
  first->row = *row_on(*first);
  std::rotate(day.supports.begin(), first, first + 1);
  return day;
}

}  // namespace loci::apps::changes
