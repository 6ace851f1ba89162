#include "apps/evaluate/description/primitives.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/evaluate/description/primitive_scenes.h"
#include "mapping/base/math/math.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/text/json.h"

namespace loci::apps::description_evaluation {
namespace {

using Kind = perception::PrimitiveShape::Kind;

double degrees_between(const Vector3d& a, const Vector3d& b) {
  return std::acos(std::min(1.0, std::abs(a.dot(b)))) * 180 / kPi;
}

Vector3d axis_of(const perception::PrimitiveShape& shape) {
  return shape.frame_from_shape.linear().col(2);
}

/// Least angle between an edge of one box and an edge of the other, both about the upright.
double yaw_between(const perception::PrimitiveShape& a, const perception::PrimitiveShape& b) {
  const Vector3d edge = a.frame_from_shape.linear().col(0);
  return std::min(degrees_between(edge, b.frame_from_shape.linear().col(0)),
                  degrees_between(edge, b.frame_from_shape.linear().col(1)));
}

void compare(const perception::PrimitiveShape& truth, const perception::PrimitiveShape& found,
             PrimitivesResult& result) {
  const std::string kind = name_of(truth.kind);
  const auto add = [&](const std::string& name, double error) {
    result.parameters[kind + " " + name].errors.push_back(std::abs(error));
  };
  add("centre", (found.frame_from_shape.translation() - truth.frame_from_shape.translation()).norm());
  if (truth.kind == Kind::box) {
    add("height", found.size.z() - truth.size.z());
    const auto ordered = std::minmax({truth.size.x(), truth.size.y()});
    const auto seen = std::minmax({found.size.x(), found.size.y()});
    add("longer edge", seen.second - ordered.second);
    add("shorter edge", seen.first - ordered.first);
    add("yaw, deg", yaw_between(truth, found));
    return;
  }
  if (truth.kind == Kind::sphere) {
    add("radius", found.radius() - truth.radius());
    return;
  }
  add("height", found.size.z() - truth.size.z());
  add("axis, deg", degrees_between(axis_of(truth), axis_of(found)));
  if (truth.kind == Kind::cylinder) {
    add("radius", found.radius() - truth.radius());
  } else {
    add("radius at the foot", found.radius_low - truth.radius_low);
    add("radius at the top", found.radius_high - truth.radius_high);
  }
}

}  // namespace

double ParameterErrors::median() const {
  return at(0.5);
}

double ParameterErrors::at(double share) const {
  return errors.empty() ? 0 : quantile(errors, share);
}

PrimitivesResult evaluate_primitives(size_t scenes, const Random& random, Progress& progress,
                                     Warnings& warnings) {
  PrimitivesResult result;
  const perception::LabelledSurfaces surfaces =
      labelled_surfaces(primitive_scenes(scenes, random), progress, warnings);
  double seconds = 0;
  for (const perception::LabelledSurface& each : surfaces.found) {
    const auto scene = static_cast<size_t>(perception::scene_number(each.frame));
    const PrimitiveTruth truth =
        primitive_truths(scene, random).at(static_cast<size_t>(each.object / 10 - 2));
    const Stopwatch watch;
    const std::optional<perception::PrimitiveShape> found = fit_primitive(each.view.surface, each.ground);
    seconds += watch.cpu_seconds();
    ++result.kinds[name_of(truth.shape.kind)][found ? name_of(found->kind) : "nothing"];
    if (found && truth.exact && found->kind == truth.shape.kind) compare(truth.shape, *found, result);
  }
  result.samples = static_cast<int>(surfaces.found.size());
  result.missed = static_cast<int>(surfaces.objects - surfaces.found.size());
  result.milliseconds = 1000 * seconds / std::max(1, result.samples);
  return result;
}

std::string PrimitivesResult::text() const {
  std::string text = fmt::format("primitive shapes: {} objects ({} not found), {:.2f} ms each\n", samples,
                                 missed, milliseconds);
  for (const auto& [truth, said] : kinds) {
    text += fmt::format("  {:10}", truth);
    for (const auto& [name, count] : said) text += fmt::format(" {:>4} {}", count, name);
    text += "\n";
  }
  text += fmt::format("  {:32}{:>8}{:>12}{:>12}\n", "error (m)", "objects", "median", "9 of 10");
  for (const auto& [name, of] : parameters)
    text += fmt::format("  {:32}{:>8}{:>12.4f}{:>12.4f}\n", name, of.errors.size(), of.median(), of.at(0.9));
  return text;
}

Json PrimitivesResult::to_json() const {
  Json json = {{"objects", samples},
               {"missed", missed},
               {"milliseconds", milliseconds},
               {"kinds", kinds},
               {"parameters", Json::object()}};
  for (const auto& [name, of] : parameters)
    json["parameters"][name] = {
        {"objects", of.errors.size()}, {"median", of.median()}, {"nine_of_ten", of.at(0.9)}};
  return json;
}

}  // namespace loci::apps::description_evaluation
