#include "apps/evaluate/detection/detector_figures.h"

#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/stopwatch.h"
#include "mapping/base/text/json.h"

namespace loci::apps::detection_evaluation {
namespace {

constexpr double kSame = 0.5;  ///< intersection over union

double overlap(const cv::Rect2d& a, const cv::Rect2d& b) {
  const double common = (a & b).area();
  return common / (a.area() + b.area() - common);
}

double percent_of(int part, int all) {
  return 100.0 * part / std::max(1, all);
}

void judge(const std::vector<perception::Detection2D>& detections, const std::vector<TrueObject>& objects,
           DetectorFigures& figures) {
  for (const TrueObject& object : objects) {
    ++figures.all.objects;
    ++figures.by_class[object.name].objects;
  }
  std::vector<bool> taken(objects.size(), false);
  for (const perception::Detection2D& detection : detections) {
    const std::string& name = detection.classes.front().first;
    ++figures.all.detected;
    ++figures.by_class[name].detected;
    size_t best = objects.size();
    double most = kSame;
    for (size_t i = 0; i < objects.size(); ++i)
      if (const double common = overlap(detection.region.box, objects[i].box); !taken[i] && common >= most) {
        most = common;
        best = i;
      }
    if (best == objects.size()) continue;
    taken[best] = true;
    const bool right = objects[best].name == name;
    ++figures.on_objects;
    for (ClassFigures* counts : {&figures.all, &figures.by_class[objects[best].name]}) {
      ++counts->found;
      counts->right += right;
    }
  }
}

}  // namespace

DetectorFigures evaluate_detector(const perception::ObjectDetector& detector, const RenderedTables& tables,
                                  Progress& progress) {
  DetectorFigures figures;
  double seconds = 0;
  for (int i = 0; i < tables.size(); ++i) {
    progress.check(static_cast<double>(i) / tables.size(), "tables");
    const RenderedTable table = tables.table(i);
    const Stopwatch watch;
    const std::vector<perception::Detection2D> detections = detector.detect(table.color);
    seconds += watch.seconds();
    judge(detections, table.objects, figures);
    ++figures.tables;
  }
  figures.milliseconds = 1000 * seconds / std::max(1, figures.tables);
  return figures;
}

std::string DetectorFigures::text() const {
  std::string text = fmt::format(
      "detections on {} rendered tables, {:.1f} ms an image\n"
      "  objects {}, found {:.1f} %, detections {}, on an object {:.1f} %, right class {:.1f} % of those\n"
      "  {:<14}{:>9}{:>10}{:>10}{:>12}\n",
      tables, milliseconds, all.objects, percent_of(all.found, all.objects), all.detected,
      percent_of(on_objects, all.detected), percent_of(all.right, all.found), "class", "objects", "found",
      "recall", "precision");
  for (const auto& [name, counts] : by_class)
    text += fmt::format("  {:<14}{:>9}{:>8.1f} %{:>8.1f} %{:>10.1f} %\n", name, counts.objects,
                        percent_of(counts.found, counts.objects), percent_of(counts.right, counts.objects),
                        percent_of(counts.right, counts.detected));
  return text;
}

Json DetectorFigures::to_json() const {
  const auto counts_to_json = [](const ClassFigures& counts) {
    return Json{{"objects", counts.objects},
                {"found", counts.found},
                {"right", counts.right},
                {"detected", counts.detected}};
  };
  Json json = counts_to_json(all);
  json.update({{"tables", tables}, {"milliseconds", milliseconds}, {"on_objects", on_objects}});
  json["classes"] = Json::object();
  for (const auto& [name, counts] : by_class) json["classes"][name] = counts_to_json(counts);
  return json;
}

}  // namespace loci::apps::detection_evaluation
