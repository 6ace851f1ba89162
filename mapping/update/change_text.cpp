#include <fmt/format.h>

#include <cmath>

#include "mapping/base/math/math.h"
#include "mapping/base/text/text.h"
#include "mapping/update/update.h"

namespace loci::mapping {
namespace {

Json polygon_json(const std::vector<Vector2d>& outline) {
  Json json = Json::array();
  for (const Vector2d& corner : outline) json.push_back({corner.x(), corner.y()});
  return json;
}

/// The extent of all outlines and of the map's walls and supports.
struct Plan {
  Eigen::AlignedBox2d box;
  double pixel = 0.01;

  std::string points(const std::vector<Vector2d>& outline) const {
    std::string text;
    for (const Vector2d& p : outline)
      text += fmt::format("{:.1f},{:.1f} ", (p.x() - box.min().x()) / pixel, (box.max().y() - p.y()) / pixel);
    return text;
  }
};

std::vector<Vector2d> outline_of(const SemanticLink& link) {
  std::vector<Vector2d> outline;
  if (!link.geometry.is_object() || !link.geometry.contains("outline")) return outline;
  for (const Json& corner : link.geometry.at("outline"))
    outline.emplace_back(corner.at(0).get<double>(), corner.at(1).get<double>());
  return outline;
}

Vector2d middle_of(const std::vector<Vector2d>& outline) {
  Vector2d sum = Vector2d::Zero();
  for (const Vector2d& p : outline) sum += p;
  return sum / static_cast<double>(outline.size());
}

const char* change_color(MapChange::Kind kind) {
  switch (kind) {
    case MapChange::Kind::moved:
      return "#c2410c";
    case MapChange::Kind::gone:
      return "#b91c1c";
    case MapChange::Kind::came:
      return "#047857";
    case MapChange::Kind::opened:
      return "#6d28d9";
    case MapChange::Kind::seen_first:
      return "#1f4fd8";
  }
  return "#000";
}

std::string drawing_of(const MapChange& change, const Plan& plan) {
  const char* color = change_color(change.kind);
  std::string svg;
  if (!change.outline_before.empty())
    svg += fmt::format(
        "<polygon points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\" stroke-dasharray=\"7 5\"/>\n",
        plan.points(change.outline_before), color);
  if (!change.outline_now.empty())
    svg += fmt::format(
        "<polygon points=\"{}\" fill=\"{}\" fill-opacity=\"0.25\" stroke=\"{}\" stroke-width=\"2.5\"/>\n",
        plan.points(change.outline_now), color, color);
  if (change.kind == MapChange::Kind::moved)
    svg += fmt::format(
        "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\" marker-end=\"url(#to)\"/>\n",
        plan.points({middle_of(change.outline_before), middle_of(change.outline_now)}), color);
  const std::vector<Vector2d>& at = change.outline_now.empty() ? change.outline_before : change.outline_now;
  const Vector2d label = at.empty() ? Vector2d(change.centre.head<2>()) : middle_of(at);
  return svg + fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" fill=\"{}\">{}</text>\n",
                           (label.x() - plan.box.min().x()) / plan.pixel,
                           (plan.box.max().y() - label.y()) / plan.pixel, color, change.name);
}

}  // namespace

const char* to_text(MapChange::Kind kind) {
  switch (kind) {
    case MapChange::Kind::moved:
      return "moved";
    case MapChange::Kind::gone:
      return "gone";
    case MapChange::Kind::came:
      return "came";
    case MapChange::Kind::opened:
      return "opened";
    case MapChange::Kind::seen_first:
      return "seen_first";
  }
  return "";
}

double MapChange::distance() const {
  return (now_from_before * centre - centre).head<2>().norm();
}

double MapChange::turn_deg() const {
  return rpy_from_rotation(now_from_before.linear()).z() / kDegree;
}

std::string MapChange::text() const {
  switch (kind) {
    case Kind::moved: {
      const long degrees = std::lround(std::abs(turn_deg()));
      return fmt::format("{} moved {:.2f} m{}", name, distance(),
                         degrees == 0 ? "" : fmt::format(" and turned {}°", degrees));
    }
    case Kind::gone:
      return name + " is gone";
    case Kind::came:
      return name + " is new: its place was free before";
    case Kind::opened:
      return prismatic ? fmt::format("{} is open by {:.2f} m", name, joint_position)
                       : fmt::format("{} is open by {:.0f}°", name, std::abs(joint_position) / kDegree);
    case Kind::seen_first:
      return name + " is seen for the first time";
  }
  return "";
}

Json MapChange::to_json() const {
  Json json = {{"kind", mapping::to_text(kind)}, {"name", name},   {"class", class_name}, {"text", text()},
               {"probability", probability},     {"scans", scans}, {"links", links},      {"reason", reason}};
  if (kind == Kind::moved) {
    json["now_from_before"] = values_from_pose(now_from_before);
    json["distance_m"] = distance();
    json["turn_deg"] = turn_deg();
  }
  if (kind == Kind::opened) json[prismatic ? "position_m" : "position_rad"] = joint_position;
  if (!outline_before.empty()) json["outline_before"] = polygon_json(outline_before);
  if (!outline_now.empty()) json["outline_now"] = polygon_json(outline_now);
  return json;
}

std::string UpdateResult::text() const {
  std::string text;
  for (const MapChange& change : changes)
    text += fmt::format("{} (probability {:.2f}; {})\n", change.text(), change.probability,
                        change.scans.empty() ? "no single scan" : joined(change.scans, ", "));
  if (changes.empty()) text = "nothing changed\n";
  std::vector<std::string> seen, unseen;
  for (const UnchangedPiece& piece : unchanged) (piece.seen ? seen : unseen).push_back(piece.name);
  if (!seen.empty()) text += fmt::format("in place: {}\n", joined(seen, ", "));
  if (!unseen.empty()) text += fmt::format("not seen: {}\n", joined(unseen, ", "));
  return text;
}

Json UpdateResult::report() const {
  Json json = {{"changes", Json::array()}, {"unchanged", Json::array()}};
  for (const MapChange& change : changes) json["changes"].push_back(change.to_json());
  for (const UnchangedPiece& piece : unchanged)
    json["unchanged"].push_back(
        {{"name", piece.name}, {"seen", piece.seen}, {"outline", polygon_json(piece.outline)}});
  json["map_from_new"] = values_from_pose(map_from_new);
  json["overlap"] = overlap;
  json["notes"] = notes;
  json["seconds"] = seconds;
  return json;
}

std::string change_plan_svg(const UpdateResult& result) {
  Plan plan;
  const auto extend = [&](const std::vector<Vector2d>& outline) {
    for (const Vector2d& p : outline) plan.box.extend(p);
  };
  for (const auto& [name, link] : result.map.semantics.links) extend(outline_of(link));
  for (const MapChange& change : result.changes) extend(change.outline_before), extend(change.outline_now);
  if (plan.box.isEmpty()) plan.box.extend(Vector2d::Zero());
  plan.box.min().array() -= 0.3;
  plan.box.max().array() += 0.3;
  const Vector2d size = plan.box.sizes() / plan.pixel;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" "
      "height=\"{1:.0f}\" "
      "font-family=\"sans-serif\" font-size=\"15\">\n<defs><marker id=\"to\" viewBox=\"0 0 8 8\" refX=\"7\" "
      "refY=\"4\" "
      "markerWidth=\"7\" markerHeight=\"7\" orient=\"auto\"><path d=\"M0 0L8 4L0 8z\" "
      "fill=\"#c2410c\"/></marker></defs>\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
      size.x(), size.y());
  for (const auto& [name, link] : result.map.semantics.links) {
    const std::vector<Vector2d> outline = outline_of(link);
    if (outline.empty() || link.class_name == "floor" || link.class_name == "ceiling" ||
        link.class_name == "drawer_bottom")
      continue;
    svg += fmt::format("<polygon points=\"{}\" fill=\"#e5e7eb\" stroke=\"#374151\" stroke-width=\"{}\"/>\n",
                       plan.points(outline), link.class_name == "wall" ? 5 : 1.5);
  }
  for (const UnchangedPiece& piece : result.unchanged)
    svg += fmt::format("<polygon points=\"{}\" fill=\"none\" stroke=\"#9ca3af\" stroke-width=\"1.5\"/>\n",
                       plan.points(piece.outline));
  for (const MapChange& change : result.changes) svg += drawing_of(change, plan);
  return svg + "</svg>\n";
}

}  // namespace loci::mapping
