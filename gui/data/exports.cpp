#include "gui/data/exports.h"

#include <fmt/format.h>

#include "mapping/base/csv.h"
#include "mapping/base/json.h"
#include "mapping/exchange/ply.h"

namespace loci::gui {
namespace {

Json vector_of(const Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

std::string cells_of(const std::optional<Vector3d>& v) {
  return v ? fmt::format("{:.4f},{:.4f},{:.4f}", v->x(), v->y(), v->z()) : ",,";
}

}  // namespace

std::string believed_csv(const BelievedScene& belief) {
  std::string csv = "object,name,class,color,place,state,probability,x,y,z,size_x,size_y,size_z,last_seen\n";
  for (const BelievedObject& object : belief.objects) {
    std::optional<Vector3d> centre, size;
    if (object.map_from_object) centre = object.map_from_object->translation();
    if (!object.size.isZero()) size = object.size;
    csv += fmt::format("object_{},{},{},{},{},{},{:.4f},{},{},{}\n", object.id, csv_cell(object.name),
                       csv_cell(object.class_name), csv_cell(object.color_name), csv_cell(object.place),
                       presence_name(object.presence), object.probability, cells_of(centre), cells_of(size),
                       object.last_seen ? format_time(*object.last_seen) : "");
  }
  return csv;
}

std::string believed_json(const BelievedScene& belief) {
  Json objects = Json::array();
  for (const BelievedObject& object : belief.objects) {
    Json row = {{"object", fmt::format("object_{}", object.id)},
                {"name", object.name},
                {"state", presence_name(object.presence)},
                {"probability", object.probability}};
    if (!object.class_name.empty()) row["class"] = object.class_name;
    if (!object.color_name.empty()) row["color"] = object.color_name;
    if (!object.place.empty()) row["place"] = object.place;
    if (object.map_from_object) row["position"] = vector_of(object.map_from_object->translation());
    if (!object.size.isZero()) row["size"] = vector_of(object.size);
    if (object.last_seen) row["last_seen"] = format_time(*object.last_seen);
    objects.push_back(std::move(row));
  }
  return Json{{"time", format_time(belief.time)}, {"objects", objects}, {"joints", belief.joints}}.dump(2) +
         "\n";
}

std::string cloud_ply(const ColoredCloud& cloud) {
  mapping::Scan scan;
  scan.origins.emplace_back(0, 0, 0);
  for (size_t i = 0; i < cloud.points.size(); ++i) {
    mapping::ScanPoint point;
    point.position = cloud.points[i];
    point.r = cloud.colors[i][0];
    point.g = cloud.colors[i][1];
    point.b = cloud.colors[i][2];
    scan.points.push_back(point);
  }
  mapping::ScanSet set;
  set.scans.push_back(std::move(scan));
  return ply_text(set);
}

}  // namespace loci::gui
