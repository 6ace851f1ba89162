#include "gui/data/exports.h"

#include <fmt/format.h>

#include "mapping/base/math/vector_json.h"
#include "mapping/base/text/csv.h"
#include "mapping/base/text/json.h"
#include "mapping/exchange/formats/ply.h"

namespace loci::gui {
namespace {

std::string cells_of(const std::optional<Vector3d>& v) {
  return v ? fmt::format("{:.4f},{:.4f},{:.4f}", v->x(), v->y(), v->z()) : ",,";
}

}  // namespace

std::string believed_csv(const Belief& belief) {
  std::string csv = "object,name,class,color,place,state,probability,x,y,z,size_x,size_y,size_z,last_seen\n";
  for (const BelievedObject& object : belief.objects) {
    csv += fmt::format("object_{},{},{},{},{},{},{:.4f},{},{},{}\n", object.object,
                       csv_cell(belief.name_of(object)), csv_cell(belief.names->class_of(object.object)),
                       csv_cell(object.color.value_or("")), csv_cell(belief.place_of(object)),
                       memory::to_text(object.status), object.probability, cells_of(object.position),
                       cells_of(object.size), object.last_seen ? format_time(*object.last_seen) : "");
  }
  return csv;
}

std::string believed_json(const Belief& belief) {
  Json objects = Json::array();
  for (const BelievedObject& object : belief.objects) {
    Json row = {{"object", memory::object_name(object.object)},
                {"name", belief.name_of(object)},
                {"state", memory::to_text(object.status)},
                {"probability", object.probability}};
    if (const std::string name = belief.names->class_of(object.object); !name.empty()) row["class"] = name;
    if (object.color) row["color"] = *object.color;
    if (const std::string place = belief.place_of(object); !place.empty()) row["place"] = place;
    if (object.position) row["position"] = json_from_vector(*object.position);
    if (object.size) row["size"] = json_from_vector(*object.size);
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
