#include "apps/evaluate/changes/random_day.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "mapping/base/math/pose.h"
#include "mapping/base/math/random.h"

namespace loci::apps::changes {
namespace {

struct Model {
  const char* name;
  double radius;     ///< metres, of the space it needs
  double height;     ///< metres, of the tallest of its kind
  const char* more;  ///< of the scenario's object
};
constexpr Model kModels[] = {
    {"mug", 0.06, 0.12, ""},
    {"bowl", 0.09, 0.1, ", accent: [0.9, 0.9, 0.9]"},
    {"plate", 0.13, 0.04, ""},
    {"box", 0.10, 0.22, ", size: [0.16, 0.07, 0.22]"},
    {"box", 0.08, 0.1, ", size: [0.13, 0.06, 0.1], accent: [0.9, 0.85, 0.6], pattern: band"},
    {"bottle", 0.05, 0.3, ", accent: [0.2, 0.2, 0.3]"},
    {"can", 0.05, 0.14, ""},
    {"jar", 0.055, 0.18, ", accent: [0.9, 0.86, 0.7]"},
    {"pot", 0.14, 0.2, ""},
    {"apple", 0.045, 0.1, ""},
    {"banana", 0.10, 0.06, ""}};
constexpr const char* kColors[] = {"[0.86, 0.86, 0.84]", "[0.8, 0.14, 0.12]",  "[0.2, 0.45, 0.8]",
                                   "[0.93, 0.66, 0.12]", "[0.16, 0.45, 0.24]", "[0.45, 0.08, 0.22]",
                                   "[0.62, 0.64, 0.68]", "[0.55, 0.75, 0.2]",  "[0.15, 0.15, 0.16]",
                                   "[0.7, 0.5, 0.35]"};
constexpr size_t kObjects = 13, kAtFirst = 11;
constexpr int kCupLeaves = 5, kCupReturns = 11;  ///< scenes before which the middle cup is moved

/// Makes up the day, scene by scene.
class Day {
 public:
  Day(const DayWorld& world, uint64_t seed, bool drawers)
      : world_(world), random_(seed), drawer_random_(~seed), drawers_(drawers && !world.drawers.empty()) {
    for (size_t i = 0; i < kObjects; ++i) {
      const Model& model = kModels[random_.index(std::size(kModels))];
      true_objects_.push_back({fmt::format("{}{}_{}", world.prefix, model.name, i),
                               model,
                               kColors[random_.index(std::size(kColors))],
                               {}});
    }
    const char* color = kColors[random_.index(std::size(kColors))];
    for (int i = 0; i < 3; ++i)
      true_objects_.push_back({fmt::format("{}cup_{}", world.prefix, i), kModels[0], color, {}});
  }

  std::string write(const std::filesystem::path& urdf, int scenes) {
    std::string text =
        fmt::format("world: {}\ncamera: kinect\nframe_interval_s: 1\nobjects:\n", urdf.string());
    for (const Object& true_object : true_objects_)
      text += fmt::format("  {}: {{model: {}, color: {}{}}}\n", true_object.name, true_object.model.name,
                          true_object.color, true_object.model.more);
    text += "scenes:\n";
    int minute = 7 * 60;
    for (int scene = 0; scene < scenes; ++scene) {
      text += fmt::format("  - time: \"2026-05-03T{:02}:{:02}:00Z\"\n    views:\n", minute / 60, minute % 60);
      std::vector<View> all_views = views(scene == 0);
      std::vector<std::string> actions = actions_before(scene);
      if (drawers_) use_drawers(scene, all_views, actions);
      for (const View& view : all_views)
        text += fmt::format("      - {{from: [{:.3f}], at: [{:.3f}]}}\n", fmt::join(view.from, ", "),
                            fmt::join(view.at, ", "));
      if (!actions.empty()) text += fmt::format("    do:\n      - {}\n", fmt::join(actions, "\n      - "));
      constexpr int kPauses[] = {5, 10, 20, 40, 60};
      minute += kPauses[random_.index(std::size(kPauses))];
    }
    return text;
  }

 private:
  struct Spot {
    size_t support = 0;
    double x = 0, y = 0;
  };
  struct Object {
    std::string name;
    Model model;
    const char* color;
    std::optional<Spot> at;
  };

  bool is_free(const Spot& spot, const Object& true_object) const {
    const auto distance = [&spot](const Vector2d& other) {
      return (other - Vector2d(spot.x, spot.y)).norm();
    };
    const std::vector<Vector2d>& blocked = world_.supports[spot.support].blocked;
    if (std::ranges::any_of(blocked,
                            [&](const Vector2d& at) { return distance(at) < true_object.model.radius; }))
      return false;
    return std::ranges::all_of(true_objects_, [&](const Object& other) {
      return &other == &true_object || !other.at || other.at->support != spot.support ||
             distance({other.at->x, other.at->y}) > true_object.model.radius + other.model.radius + 0.02;
    });
  }

  std::optional<Spot> free_spot(size_t support, const Object& true_object,
                                const std::optional<Spot>& near = {}) {
    const Support& on = world_.supports[support];
    for (int i = 0; i < 300; ++i) {
      const double x = near ? near->x - on.middle.x() + random_.normal(0.1) : random_.uniform(-on.x, on.x);
      const double y = near ? near->y - on.middle.y() + random_.normal(0.1) : random_.uniform(-on.y, on.y);
      const Spot spot{support, on.middle.x() + x, on.middle.y() + y};
      if (std::abs(x) <= on.x && std::abs(y) <= on.y && is_free(spot, true_object)) return spot;
    }
    return std::nullopt;
  }

  std::string put(Object& true_object, const std::optional<Spot>& spot) {
    if (!spot) return {};
    true_object.at = spot;
    return fmt::format("{{place: {}, on: {}, at: [{:.3f}, {:.3f}], yaw_deg: {}}}", true_object.name,
                       world_.supports[spot->support].link, spot->x, spot->y,
                       static_cast<int>(random_.index(360)) - 180);
  }

  std::string put_anywhere(Object& true_object) {
    return put(true_object, free_spot(random_.index(world_.supports.size()), true_object));
  }

  /// Three in a row along the longer side of the first support.
  std::optional<Spot> in_row(int number) const {
    const Support& on = world_.supports[0];
    const double along = kCupSpacing * (number - 1);
    const Vector2d at = on.row + (on.x > on.y ? Vector2d(along, 0) : Vector2d(0, along));
    return Spot{0, at.x(), at.y()};
  }

  std::vector<std::string> actions_before(int scene) {
    std::vector<std::string> actions;
    Object* cups = &true_objects_[kObjects];
    if (scene == 0) {
      for (int i = 0; i < 3; ++i) actions.push_back(put(cups[i], in_row(i)));
      for (size_t i = 0; i < kAtFirst; ++i) actions.push_back(put_anywhere(true_objects_[i]));
    } else if (scene == kCupLeaves) {
      actions.push_back(put(cups[1], free_spot(world_.supports.size() - 1, cups[1])));
    } else if (scene == kCupReturns) {
      const std::optional<Spot> old = in_row(1);
      if (is_free(*old, cups[1])) actions.push_back(put(cups[1], old));
    } else {
      constexpr int kHowMany[] = {0, 0, 1, 1, 2, 3};
      for (int left = kHowMany[random_.index(std::size(kHowMany))]; left > 0; --left)
        actions.push_back(something());
    }
    std::erase(actions, "");
    return actions;
  }

  /// One object that happens to one of the objects, the cups aside.
  std::string something() {
    std::vector<Object*> here, away;
    for (size_t i = 0; i < kObjects; ++i)
      if (!in_drawer(true_objects_[i])) (true_objects_[i].at ? here : away).push_back(&true_objects_[i]);
    const double what = random_.uniform();
    if (what >= 0.85 || here.size() <= 5)
      return away.empty() ? std::string() : put_anywhere(*away[random_.index(away.size())]);
    Object& true_object = *here[random_.index(here.size())];
    if (what < 0.5) return put_anywhere(true_object);
    if (what < 0.65) return put(true_object, free_spot(true_object.at->support, true_object, true_object.at));
    if (what < 0.72) {
      constexpr int kTurns_deg[] = {60, 90, 120, 180};
      return fmt::format("{{turn: {}, yaw_deg: {}}}", true_object.name,
                         kTurns_deg[random_.index(std::size(kTurns_deg))]);
    }
    true_object.at.reset();
    return fmt::format("{{remove: {}}}", true_object.name);
  }

  bool in_drawer(const Object& true_object) const {
    return std::ranges::any_of(in_drawer_, [&](const auto& one) { return one.second == &true_object; });
  }

  /// From somewhere near a known place; at first everything is looked at.
  std::vector<View> views(bool all) {
    std::vector<View> list;
    const size_t most = random_.index(3) == 0 ? 2 : 1, begin = random_.index(world_.supports.size());
    for (size_t i = 0; i < (all ? world_.supports.size() : most); ++i) {
      const Support& support = world_.supports[(begin + i) % world_.supports.size()];
      const size_t one = random_.index(support.views.size());
      for (size_t v = 0; v < support.views.size(); ++v) {
        if (v != one && !(all && support.views.size() == 2)) continue;
        View view = support.views[v];
        for (int axis = 0; axis < 3; ++axis) {
          view.from[axis] += random_.uniform(-0.12, 0.12);
          view.at[axis] += random_.uniform(-0.06, 0.06);
        }
        list.push_back(view);
      }
    }
    return list;
  }

  /// Every third scene one drawer is open: an object is put into it or taken out. In the next it is shut.
  void use_drawers(int scene, std::vector<View>& views, std::vector<std::string>& actions) {
    if (open_ != nullptr) actions.push_back(fmt::format("{{close: {}}}", open_->name));
    open_ = nullptr;
    if (scene % 3 != 1) return;
    open_ = &world_.drawers[drawer_random_.index(world_.drawers.size())];
    actions.push_back(fmt::format("{{open: {}, to: {}}}", open_->name, open_->open_m));
    views.push_back(open_->view);
    if (const auto inside = in_drawer_.find(open_); inside != in_drawer_.end()) {
      if (drawer_random_.index(2) != 0) return;
      actions.push_back(put_anywhere(*inside->second));
      in_drawer_.erase(inside);
      return;
    }
    std::vector<Object*> small;
    for (size_t i = 0; i < kObjects; ++i)
      if (true_objects_[i].at && true_objects_[i].model.radius < 0.07 && !in_drawer(true_objects_[i]))
        small.push_back(&true_objects_[i]);
    if (small.empty()) return;
    Object* chosen = small[drawer_random_.index(small.size())];
    if (chosen->model.height > open_->room_m) return;
    if (std::ranges::any_of(actions, [&](const std::string& action) {
          return action.find(chosen->name) != std::string::npos;
        }))
      return;  // something else happens to it now
    actions.push_back(fmt::format("{{move: {}, in: {}, at: [{:.3f}, {:.3f}]}}", chosen->name, open_->name,
                                  drawer_random_.uniform(-0.14, -0.08), drawer_random_.uniform(-0.08, 0.08)));
    chosen->at.reset();
    in_drawer_[open_] = chosen;
  }

  const DayWorld& world_;
  Random random_, drawer_random_;
  const bool drawers_;
  const Drawer* open_ = nullptr;  ///< in this scene
  std::map<const Drawer*, Object*> in_drawer_;
  std::vector<Object> true_objects_;
};

}  // namespace

std::string random_day(const DayWorld& world, const std::filesystem::path& urdf, uint64_t seed, int scenes,
                       bool drawers) {
  return Day(world, seed, drawers).write(urdf, scenes);
}

}  // namespace loci::apps::changes
