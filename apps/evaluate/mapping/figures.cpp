#include "apps/evaluate/mapping/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "mapping/base/text/json.h"

namespace loci::apps::mapping_claim {
namespace {

/// What a figure must be: at least or at most so much; NaN = no aim, it is reported.
struct Aim {
  enum class Kind { none, least, most } kind = Kind::none;
  double value = 0;
};

constexpr Aim kNone{};
Aim least(double value) {
  return {Aim::Kind::least, value};
}
Aim most(double value) {
  return {Aim::Kind::most, value};
}

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double worst_of(const std::vector<double>& values) {
  return *std::ranges::max_element(values);
}

double part_within(const std::vector<double>& values, double limit) {
  const auto within = std::ranges::count_if(values, [&](double value) { return value <= limit; });
  return 100 * static_cast<double>(within) / static_cast<double>(values.size());
}

/// Of what looking alone gave, of what pulling showed, or of the best that there is.
enum When { kBefore, kAfter, kLast };

class Table {
 public:
  explicit Table(const std::vector<const MappedWorld*>& maps) : maps_(maps) {}

  std::vector<Figure> figures() {
    count("handles found", "handle", false);
    count("handles not invented", "handle", true);
    const std::vector<double> centres = objects(kLast, "handle", &mapping::ComparedElement::centre_error);
    spread("handle centre, mean", "cm", 100, centres, mean_of, kNone);
    part("handle centres within 1.5 cm", centres, 0.015);
    count("fronts found", "front", false);
    count("fronts not invented", "front", true);
    fronts_overlapping(0.75);
    spread("front IoU before pulling, mean", "", 1,
           objects(kBefore, "front", &mapping::ComparedElement::overlap), mean_of, kNone);
    spread("front IoU after, mean", "", 1, objects(kAfter, "front", &mapping::ComparedElement::overlap),
           mean_of, least(0.85));
    joint_types("joint type before pulling", kBefore, 85);
    joint_types("joint type after", kAfter, 95);
    other_way();
    const std::vector<double> axes = joints(kAfter, &mapping::ComparedJoint::axis_error_deg);
    const std::vector<double> hinges = joints(kAfter, &mapping::ComparedJoint::hinge_error);
    spread("axis after, mean", "deg", 1, axes, mean_of, kNone);
    part("axes within 1 deg", axes, 1);
    spread("hinge after, mean", "cm", 100, hinges, mean_of, kNone);
    part("hinges within 2 cm", hinges, 0.02);
    count("supports found", "support", false);
    unobservable();
    spread("support height, worst", "cm", 100,
           objects(kLast, "support", &mapping::ComparedElement::height_error), worst_of, most(1));
    spread("support IoU, mean", "", 1, objects(kLast, "support", &mapping::ComparedElement::overlap), mean_of,
           least(0.9));
    count("walls found", "wall", false);
    spread("wall offset, worst", "cm", 100, objects(kLast, "wall", &mapping::ComparedElement::offset_error),
           worst_of, most(1));
    spread("wall angle, worst", "deg", 1, objects(kLast, "wall", &mapping::ComparedElement::angle_error_deg),
           worst_of, most(0.3));
    count("openings found", "opening", false);
    count("openings not invented", "opening", true);
    std::vector<double> edges;
    for (const mapping::Comparison* comparison : comparisons(kLast))
      std::ranges::copy(comparison->edge_errors("opening"), std::back_inserter(edges));
    spread("opening edge, worst", "cm", 100, edges, worst_of, kNone);
    each(
        "contacts in the closed state", "",
        [](const MappedWorld& map) { return static_cast<double>(map.contacts); }, most(0));
    each(
        "joints that jam", "", [](const MappedWorld& map) { return static_cast<double>(map.jammed); },
        most(0));
    each(
        "scans", "", [](const MappedWorld& map) { return static_cast<double>(map.scans); }, kNone);
    each(
        "handles pulled", "", [](const MappedWorld& map) { return static_cast<double>(map.pulls); }, kNone);
    each(
        "time", "s", [](const MappedWorld& map) { return map.seconds; }, kNone);
    each(
        "peak memory", "MB", [](const MappedWorld& map) { return map.memory_mb; }, most(4000));
    return std::move(figures_);
  }

 private:
  void add(const char* name, const char* unit, std::optional<double> value, Aim aim) {
    Figure figure;
    figure.name = name;
    figure.unit = unit;
    if (aim.kind != Aim::Kind::none)
      figure.aim = fmt::format("{} {:g}", aim.kind == Aim::Kind::least ? "≥" : "≤", aim.value);
    figure.known = value.has_value();
    figure.value = value.value_or(0);
    figure.met = figure.known && (aim.kind == Aim::Kind::least  ? figure.value >= aim.value
                                  : aim.kind == Aim::Kind::most ? figure.value <= aim.value
                                                                : true);
    figures_.push_back(std::move(figure));
  }

  /// Found of those asked for, or right of those that were found, in percent over all seeds.
  void count(const char* name, const char* kind, bool of_found) {
    size_t right = 0, all = 0;
    for (const MappedWorld* map : maps_) {
      const mapping::Comparison::Counts counts = map->last().counts(kind);
      right += counts.matched + (of_found ? counts.minor : 0);
      all += counts.matched + (of_found ? counts.minor + counts.extra : counts.missed);
    }
    const bool handles = std::string(kind) == "handle";
    add(name, "%", percent(right, all), handles ? least(95) : kNone);
  }

  /// Of the fronts asked for, in percent, before pulling.
  void fronts_overlapping(double min_overlap) {
    size_t good = 0, all = 0;
    for (const mapping::Comparison* comparison : comparisons(kBefore)) {
      const mapping::Comparison::Counts counts = comparison->counts("front");
      all += counts.matched + counts.missed;
      for (const double overlap : comparison->errors("front", &mapping::ComparedElement::overlap))
        good += overlap >= min_overlap ? 1 : 0;
    }
    add("fronts with IoU of 0.75 or more", "%", percent(good, all), kNone);
  }

  void joint_types(const char* name, When when, double aim) {
    size_t right = 0, all = 0;
    for (const mapping::Comparison* comparison : comparisons(when)) {
      const mapping::Comparison::Joints joints = comparison->joints();
      right += joints.right;
      all += joints.asked;
    }
    add(name, "%", percent(right, all), least(aim));
  }

  void unobservable() {
    size_t count = 0;
    for (const mapping::Comparison* comparison : comparisons(kLast))
      count += comparison->counts("support").not_observable;
    add("supports above the sensor", "", static_cast<double>(count), kNone);
  }

  void other_way() {
    size_t wrong = 0;
    for (const mapping::Comparison* comparison : comparisons(kLast)) wrong += comparison->joints().other_way;
    add("joints that open the other way", "", static_cast<double>(wrong), most(0));
  }

  static std::optional<double> percent(size_t part, size_t all) {
    if (all == 0) return std::nullopt;
    return 100 * static_cast<double>(part) / static_cast<double>(all);
  }

  template <class Reduce>
  void spread(const char* name, const char* unit, double scale, const std::vector<double>& values,
              const Reduce& reduce, Aim aim) {
    add(name, unit, values.empty() ? std::nullopt : std::optional(scale * reduce(values)), aim);
  }

  void part(const char* name, const std::vector<double>& values, double limit) {
    add(name, "%", values.empty() ? std::nullopt : std::optional(part_within(values, limit)), least(95));
  }

  template <class Value>
  void each(const char* name, const char* unit, const Value& value, Aim aim) {
    std::vector<double> values;
    for (const MappedWorld* map : maps_) values.push_back(value(*map));
    spread(name, unit, 1, values, worst_of, aim);
  }

  std::vector<const mapping::Comparison*> comparisons(When when) const {
    std::vector<const mapping::Comparison*> all;
    for (const MappedWorld* map : maps_)
      if (when == kBefore)
        all.push_back(&map->before);
      else if (when == kLast || map->after)
        all.push_back(&map->last());
    return all;
  }

  std::vector<double> objects(When when, const char* kind,
                              std::optional<double> mapping::ComparedElement::*figure) const {
    std::vector<double> values;
    for (const mapping::Comparison* comparison : comparisons(when))
      std::ranges::copy(comparison->errors(kind, figure), std::back_inserter(values));
    return values;
  }

  std::vector<double> joints(When when, std::optional<double> mapping::ComparedJoint::*figure) const {
    std::vector<double> values;
    for (const mapping::Comparison* comparison : comparisons(when))
      std::ranges::copy(comparison->joint_errors(figure), std::back_inserter(values));
    return values;
  }

  const std::vector<const MappedWorld*>& maps_;
  std::vector<Figure> figures_;
};

/// The worlds in the order in which they were mapped, then all of them together.
std::vector<std::pair<std::string, std::vector<Figure>>> by_world(const std::vector<MappedWorld>& maps) {
  std::vector<std::pair<std::string, std::vector<const MappedWorld*>>> worlds;
  for (const MappedWorld& map : maps) {
    auto world = std::ranges::find_if(worlds, [&](const auto& known) { return known.first == map.world; });
    if (world == worlds.end()) world = worlds.insert(worlds.end(), {map.world, {}});
    world->second.push_back(&map);
  }
  std::vector<std::pair<std::string, std::vector<Figure>>> columns;
  for (const auto& [world, of_world] : worlds) columns.emplace_back(world, figures_of(of_world));
  if (worlds.size() < 2) return columns;
  std::vector<const MappedWorld*> all;
  for (const MappedWorld& map : maps) all.push_back(&map);
  columns.emplace_back("all", figures_of(all));
  return columns;
}

}  // namespace

std::string world_name(const std::filesystem::path& world) {
  return world.filename() == "kitchen.urdf" && world.has_parent_path()
             ? world.parent_path().filename().string()
             : world.stem().string();
}

std::vector<Figure> figures_of(const std::vector<const MappedWorld*>& maps) {
  return Table(maps).figures();
}

std::string table_text(const std::vector<MappedWorld>& maps) {
  const auto columns = by_world(maps);
  std::string text = fmt::format("{:<36} {:>8}", "", "aim");
  for (const auto& [world, figures] : columns) text += fmt::format(" {:>18}", world_name(world));
  text += "\n";
  for (size_t row = 0; row < columns.front().second.size(); ++row) {
    const Figure& first = columns.front().second[row];
    const std::string unit = first.unit.empty() ? "" : " [" + first.unit + "]";
    text += fmt::format("{:<36} {:>8}", first.name + unit, first.aim.empty() ? "-" : first.aim);
    for (const auto& [world, figures] : columns) {
      const Figure& figure = figures[row];
      const char* mark = !figure.known || figure.aim.empty() ? " " : figure.met ? "+" : "-";
      text += fmt::format(" {:>16} {}", figure.known ? fmt::format("{:.2f}", figure.value) : "-", mark);
    }
    text += "\n";
  }
  return text;
}

Json table_json(const std::vector<MappedWorld>& maps) {
  Json json = {{"worlds", Json::array()}, {"maps", Json::array()}};
  for (const auto& [world, figures] : by_world(maps)) {
    Json entry = {{"world", world}, {"figures", Json::array()}};
    for (const Figure& figure : figures) {
      Json one = {{"name", figure.name}, {"unit", figure.unit}};
      one["value"] = figure.known ? Json(figure.value) : Json(nullptr);
      if (!figure.aim.empty()) {
        one["aim"] = figure.aim;
        one["met"] = figure.met;
      }
      entry["figures"].push_back(std::move(one));
    }
    json["worlds"].push_back(std::move(entry));
  }
  for (const MappedWorld& map : maps) {
    Json one = {{"world", map.world}, {"seed", map.seed},       {"scans", map.scans},
                {"pulls", map.pulls}, {"seconds", map.seconds}, {"before", map.before.report()}};
    one["after"] = map.after ? map.after->report() : Json(nullptr);
    json["maps"].push_back(std::move(one));
  }
  return json;
}

}  // namespace loci::apps::mapping_claim
