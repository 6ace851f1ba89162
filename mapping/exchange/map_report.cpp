#include "mapping/exchange/map_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "mapping/base/math/math.h"
#include "mapping/base/text/base64.h"
#include "mapping/base/text/html.h"
#include "mapping/base/text/json.h"
#include "mapping/exchange/map_drawings.h"
#include "mapping/image/image_io.h"
#include "mapping/interpretation/furniture/furniture_links.h"

namespace loci::mapping {
namespace {

constexpr double kMaxShownHeight = 1.9;  // m; what hangs higher would hide the furniture
constexpr double kPointMargin = 0.2;     // m around the points
constexpr double kMaxPixels = 1400;

struct TopView {
  Vector2d low = Vector2d::Constant(1e9);
  Vector2d high = Vector2d::Constant(-1e9);
  double pixel = 0.01;  ///< metres

  int width() const { return static_cast<int>((high - low).x() / pixel) + 1; }
  int height() const { return static_cast<int>((high - low).y() / pixel) + 1; }
  /// Pixels: x to the right, y of the map upwards.
  Vector2d at(const Vector2d& point) const {
    return {(point.x() - low.x()) / pixel, (high.y() - point.y()) / pixel};
  }
};

template <class Visit>
void each_point(const InterpretedMap& map, const ScanSet& scans, Visit visit) {
  const Isometry3d map_from_input = map.semantics.map_from_input.value_or(Isometry3d::Identity());
  for (const Scan& scan : scans.scans) {
    const Isometry3d map_from_scan = map_from_input * scan.map_from_scan;
    for (const ScanPoint& point : scan.points) {
      if (!point.returned) continue;
      const Vector3d position = map_from_scan * point.position.cast<double>();
      if (position.z() < kMaxShownHeight) visit(position, point);
    }
  }
}

/// The box of the points but for the few farthest on each side.
TopView view_of(const InterpretedMap& map, const ScanSet& scans) {
  std::vector<double> x, y;
  each_point(map, scans, [&](const Vector3d& position, const ScanPoint&) {
    x.push_back(position.x());
    y.push_back(position.y());
  });
  TopView view;
  const auto spread = [](std::vector<double>& values, double& low, double& high) {
    if (values.empty()) values = {0, 1};
    low = quantile(values, 0.001) - kPointMargin;
    high = quantile(values, 0.999) + kPointMargin;
  };
  spread(x, view.low.x(), view.high.x());
  spread(y, view.low.y(), view.high.y());
  view.pixel = std::max(0.01, (view.high - view.low).maxCoeff() / kMaxPixels);
  return view;
}

/// The points seen from above in their colours (grey by height where they have none), the highest on top.
cv::Mat image_of(const InterpretedMap& map, const ScanSet& scans, const TopView& view) {
  cv::Mat image(view.height(), view.width(), CV_8UC3, cv::Scalar(255, 255, 255));
  cv::Mat heights(view.height(), view.width(), CV_32F, cv::Scalar(-1e9));
  each_point(map, scans, [&](const Vector3d& position, const ScanPoint& point) {
    const Vector2d pixel = view.at(position.head<2>());
    const int u = static_cast<int>(std::floor(pixel.x()));
    const int v = static_cast<int>(std::floor(pixel.y()));
    if (u < 0 || v < 0 || u >= image.cols || v >= image.rows) return;
    auto& height = heights.at<float>(v, u);
    if (static_cast<float>(position.z()) <= height) return;
    height = static_cast<float>(position.z());
    const bool colored = point.r != 0 || point.g != 0 || point.b != 0;
    const auto grey = static_cast<uint8_t>(std::clamp(200 - 80 * position.z(), 40.0, 220.0));
    image.at<cv::Vec3b>(v, u) = colored ? cv::Vec3b(point.b, point.g, point.r) : cv::Vec3b(grey, grey, grey);
  });
  return image;
}

const char* outline_color(const std::string& class_name) {
  if (class_name == "wall") return "#1f4fd8";
  if (class_name == "table") return "#c2410c";
  if (class_name == "counter") return "#047857";
  if (class_name == "floor" || class_name == "ceiling") return "#9ca3af";
  return "#9d174d";
}

/// Room beside the image for names of what stands at its edge, pixels.
constexpr int kLabelMargin = 60;

std::string points_text(const Json& outline, const TopView& view) {
  std::string text;
  for (const Json& corner : outline) {
    const Vector2d at = view.at({corner.at(0).get<double>(), corner.at(1).get<double>()});
    text += fmt::format("{:.1f},{:.1f} ", at.x(), at.y());
  }
  return text;
}

std::string drawing_of(const std::string& name, const SemanticLink& link, const TopView& view) {
  const Json& outline = link.geometry.at("outline");
  const char* color = outline_color(link.class_name);
  Vector2d middle = Vector2d::Zero();
  for (const Json& corner : outline)
    middle += view.at({corner.at(0).get<double>(), corner.at(1).get<double>()});
  middle /= static_cast<double>(outline.size());
  const bool level = link.class_name == "floor" || link.class_name == "ceiling";
  std::string svg = fmt::format(
      "<polygon points=\"{}\" fill=\"{}\" fill-opacity=\"{}\" stroke=\"{}\" stroke-width=\"{}\"{}/>\n",
      points_text(outline, view), color, level || link.class_name == "wall" ? 0.0 : 0.15, color,
      link.class_name == "wall" ? 5 : 2.5, level ? " stroke-dasharray=\"6 6\"" : "");
  if (level) return svg;
  return svg + fmt::format(
                   "<text x=\"{:.1f}\" y=\"{:.1f}\" fill=\"{}\" stroke=\"#fff\" stroke-width=\"4\" "
                   "paint-order=\"stroke\" "
                   "font-family=\"sans-serif\" font-size=\"16\" font-weight=\"600\" "
                   "text-anchor=\"middle\">{}</text>\n",
                   middle.x(), middle.y(), color, html_escape(name));
}

std::string evidence_text(const Json& evidence) {
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : "; ") + part; };
  if (evidence.contains("inliers")) add(fmt::format("{} points", evidence["inliers"].get<size_t>()));
  if (evidence.contains("scans")) add(fmt::format("{} scans", evidence["scans"].size()));
  if (evidence.contains("area_m2")) add(fmt::format("{:.2f} m² seen", evidence["area_m2"].get<double>()));
  if (evidence.contains("sd_m")) add(fmt::format("sd {:.1f} mm", 1000 * evidence["sd_m"].get<double>()));
  if (evidence.contains("class_because")) add(evidence["class_because"].get<std::string>());
  return text;
}

std::string links_table(const InterpretedMap& map) {
  std::vector<std::vector<std::string>> rows;
  for (const auto& [name, link] : map.semantics.links) {
    const Json& geometry = link.geometry;
    const auto number = [&](const char* key) { return geometry.at(key).get<double>(); };
    const std::string where = geometry.contains("width")
                                  ? fmt::format("{:.3f} × {:.3f} m", number("width"), number("height"))
                              : geometry.contains("length") ? fmt::format("{:.3f} m long", number("length"))
                              : geometry.contains("height") ? fmt::format("height {:.3f} m", number("height"))
                              : geometry.contains("offset") ? fmt::format("offset {:.3f} m", number("offset"))
                                                            : "";
    rows.push_back(
        {name, link.class_name, where, fmt::format("{:.2f}", link.confidence), evidence_text(link.evidence)});
  }
  return html_table({"link", "class", "where", "confidence", "evidence"}, rows);
}

std::string configuration_table(const InterpretedMap& map) {
  std::vector<std::vector<std::string>> rows;
  for (const auto& [key, value] : map.configuration.items()) rows.push_back({key, value.dump()});
  return html_table({"option", "value"}, rows);
}

std::string times_table(const InterpretedMap& map) {
  std::vector<std::vector<std::string>> rows;
  for (const StageTime& time : map.times) rows.push_back({time.stage, fmt::format("{:.2f}", time.seconds)});
  return html_table({"stage", "seconds"}, rows);
}

constexpr double kUnsureJoint = 0.9;  // probability of a joint's type that nobody saw move

std::string details(const std::string& title, const std::string& body) {
  return "<details><summary>" + html_escape(title) + "</summary>" + body + "</details>\n";
}

/// "drawer", "door, hinge on the left", "flap, hinge below".
std::string way_of(const Front& front) {
  if (!front.joint || front.joint->type == ArticulationType::rigid) return "does not open, as far as known";
  if (front.joint->type == ArticulationType::prismatic) return "drawer";
  switch (hinge_side(front)) {
    case HingeSide::left:
      return "door, hinge on the left";
    case HingeSide::right:
      return "door, hinge on the right";
    case HingeSide::below:
      return "flap, hinge below";
    default:
      return "flap, hinge above";
  }
}

double probability_of(const JointEstimate& joint) {
  return joint.probabilities[static_cast<size_t>(joint.type)];
}

std::string openings_table(const InterpretedMap& map) {
  std::vector<std::vector<std::string>> rows;
  for (const Front& front : fronts_of(map.world, map.semantics)) {
    const bool opens = front.joint && front.joint->type != ArticulationType::rigid;
    const bool slides = opens && front.joint->type == ArticulationType::prismatic;
    const SemanticLink& entry = map.semantics.links.at(*front_link(front.name, map.semantics));
    std::string far = !opens   ? ""
                      : slides ? fmt::format("{:.0f} cm", 100 * front.joint->upper)
                               : fmt::format("{:.0f}°", front.joint->upper / kDegree);
    if (entry.extra.contains("blocked_by"))
      far += ", then it meets " + entry.extra["blocked_by"].get<std::string>();
    const std::string known = !opens                             ? ""
                              : front.joint->evidence == "prior" ? "its shape and handle"
                                                                 : "seen to move";
    rows.push_back({front.name, way_of(front), far, known,
                    opens ? fmt::format("{:.0f} %", 100 * probability_of(*front.joint)) : "",
                    fmt::format("{:.1f} × {:.1f} cm", 100 * front.width, 100 * front.height),
                    !front.fixture                               ? "none found"
                    : front.fixture->kind == Fixture::Kind::knob ? "knob"
                                                                 : "bar",
                    fmt::format("{:.2f}", front.confidence)});
  }
  return html_table(
      {"front", "how it opens", "how far", "known from", "probability", "size", "handle", "confidence"},
      rows);
}

/// What a person should look at before relying on the map.
std::vector<std::string> doubts(const InterpretedMap& map) {
  std::vector<std::string> texts;
  for (const Front& front : fronts_of(map.world, map.semantics)) {
    if (front.confidence < kUnsureConfidence)
      texts.push_back(
          fmt::format("{}: its edges are unsure (confidence {:.2f})", front.name, front.confidence));
    if (front.joint && front.joint->evidence == "prior" && probability_of(*front.joint) < kUnsureJoint)
      texts.push_back(
          fmt::format("{}: that it is a {} follows from its shape alone ({:.0f} %); nobody saw it move",
                      front.name, front.class_name, 100 * probability_of(*front.joint)));
  }
  for (const auto& [name, link] : map.semantics.links) {
    if (link.class_name != "wall" && link.geometry.contains("outline") && link.confidence < kUnsureConfidence)
      texts.push_back(fmt::format("{}: confidence {:.2f}", name, link.confidence));
    const Json edges = link.evidence.is_object() ? link.evidence.value("edges", Json::object()) : Json();
    const auto unseen = std::ranges::count(edges, Json("unseen"));
    if (edges.is_object() && link.geometry.contains("outline") && unseen > 0)
      texts.push_back(fmt::format("{}: {} of its edges were not seen", name, unseen));
  }
  return texts;
}

std::string elevations(const InterpretedMap& map) {
  std::string text;
  for (const FurnitureRun& run : furniture_runs(map))
    text += fmt::format(
        "<figure>{}<figcaption class=\"faint\">{} front{}, seen from before them</figcaption>"
        "</figure>\n",
        elevation_svg(map, run), run.fronts.size(), run.fronts.size() == 1 ? "" : "s");
  return text +
         "<p class=\"faint\">Sizes in cm. Dashed lines of a door meet at its hinge, drawers have an arrow, "
         "handles are red. What is outlined dashed in brown is unsure.</p>\n";
}

}  // namespace

std::string top_view_svg(const InterpretedMap& map, const ScanSet& scans) {
  const TopView view = view_of(map, scans);
  const std::vector<unsigned char> png = encode_image(image_of(map, scans, view), ".png");
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"{4} 0 {3} {1}\" width=\"{3}\" height=\"{1}\" "
      "role=\"img\" "
      "aria-label=\"Top view\">\n<image width=\"{0}\" height=\"{1}\" href=\"data:image/png;base64,{2}\"/>\n",
      view.width(), view.height(), base64_from_bytes({reinterpret_cast<const char*>(png.data()), png.size()}),
      view.width() + 2 * kLabelMargin, -kLabelMargin);
  for (const auto& [name, link] : map.semantics.links)
    if (link.geometry.contains("outline")) svg += drawing_of(name, link, view);
  const Vector2d left = {20, view.height() - 20.0};
  svg += fmt::format(
      "<path d=\"M{0} {1}h{2}\" stroke=\"#111\" stroke-width=\"3\"/><text x=\"{0}\" y=\"{3}\" "
      "font-family=\"sans-serif\" "
      "font-size=\"14\" fill=\"#111\">1 m</text>\n</svg>\n",
      left.x(), left.y(), 1 / view.pixel, left.y() - 6);
  return svg;
}

std::string map_report(const InterpretedMap& map, const ScanSet& scans, const std::string& input) {
  const bool furnished = std::ranges::any_of(
      map.semantics.links, [](const auto& entry) { return entry.second.geometry.contains("width"); });
  const std::vector<std::string> unsure = doubts(map);
  std::string sections = fmt::format("<p>{} from {}.</p>\n", html_escape(map.summary()), html_escape(input));
  sections += html_section(
      "plan", "Plan",
      plan_svg(map) + "<p class=\"faint\">Lengths in cm; fronts blue.</p>\n" +
          details("Points in their colours, seen from above (below 1.9 m)", top_view_svg(map, scans)));
  if (furnished) {
    sections += html_section("elevations", "Fronts", elevations(map));
    sections += html_section("openings", "What opens, and how", openings_table(map));
  }
  if (!unsure.empty()) sections += html_section("unsure", "What is uncertain", html_list(unsure));
  if (!map.notes.empty())
    sections += html_section("notes", "What was left out, and why", html_list(map.notes));
  sections += html_section("links", "Details",
                           details("Every link", links_table(map)) +
                               details("Configuration", configuration_table(map)) +
                               details("Where the time went", times_table(map)));
  return html_page("Map", sections);
}

}  // namespace loci::mapping
