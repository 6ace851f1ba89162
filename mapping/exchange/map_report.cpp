#include "mapping/exchange/map_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/core.hpp>

#include "mapping/base/math/math.h"
#include "mapping/base/text/html.h"
#include "mapping/base/text/json.h"
#include "mapping/base/text/natural_order.h"
#include "mapping/exchange/map_drawings.h"
#include "mapping/exchange/map_views.h"
#include "mapping/exchange/model_view.h"
#include "mapping/image/image_io.h"
#include "mapping/interpretation/furniture/furniture_links.h"
#include "mapping/interpretation/furniture/sliding.h"

namespace loci::mapping {
namespace {

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

/// door_2 before door_10.
void sort_by_name(std::vector<std::vector<std::string>>& rows) {
  std::ranges::stable_sort(rows, NaturalOrder(), [](const auto& row) { return row.front(); });
}

std::string links_table(const InterpretedMap& map) {
  std::vector<std::vector<std::string>> rows;
  for (const auto& [name, link] : map.semantics.links) {
    const Json& geometry = link.geometry;
    const auto number = [&](const char* key) { return geometry.at(key).get<double>(); };
    const std::string where =
        geometry.contains("width")    ? fmt::format("{:.3f} × {:.3f} m", number("width"), number("height"))
        : geometry.contains("length") ? fmt::format("{:.3f} m long", number("length"))
        : geometry.contains("top") ? fmt::format("{:.3f} m to {:.3f} m high", number("height"), number("top"))
        : geometry.contains("height") ? fmt::format("height {:.3f} m", number("height"))
        : geometry.contains("offset") ? fmt::format("offset {:.3f} m", number("offset"))
                                      : "";
    rows.push_back(
        {name, link.class_name, where, fmt::format("{:.2f}", link.confidence), evidence_text(link.evidence)});
  }
  sort_by_name(rows);
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
  if (slides_sideways(front)) return "door, slides";
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
                              : front.joint->evidence != "prior" ? "seen to move"
                              : front.fixture                    ? "its shape and handle"
                                                                 : "its shape and neighbours";
    rows.push_back({front.name, way_of(front), far, known,
                    opens ? fmt::format("{:.0f} %", 100 * probability_of(*front.joint)) : "",
                    fmt::format("{:.1f} × {:.1f} cm", 100 * front.width, 100 * front.height),
                    !front.fixture                               ? "none found"
                    : front.fixture->kind == Fixture::Kind::knob ? "knob"
                                                                 : "bar",
                    fmt::format("{:.2f}", front.confidence)});
  }
  sort_by_name(rows);
  return html_table(
      {"front", "how it opens", "how far", "known from", "probability", "size", "handle", "confidence"},
      rows);
}

constexpr size_t kMaxViews = 24;  // of one list; each takes about 8 KB

/// What a person should look at, with an image where there is one.
struct Remark {
  std::string text;
  cv::Mat view;
};

/// Remarks with images side by side, the others as a list.
std::string remarks_html(const std::vector<Remark>& remarks) {
  std::string views;
  std::vector<std::string> texts;
  for (const Remark& remark : remarks) {
    if (remark.view.empty()) {
      texts.push_back(remark.text);
      continue;
    }
    views += fmt::format(
        "<figure style=\"width:16rem\">{}<figcaption style=\"font-weight:400\">{}</figcaption></figure>\n",
        html_image(encode_image(remark.view, ".jpg"), "image/jpeg", remark.text), html_escape(remark.text));
  }
  if (!views.empty()) views = "<div style=\"display:flex;flex-wrap:wrap;gap:.75rem\">" + views + "</div>\n";
  return views + (texts.empty() ? "" : html_list(texts));
}

/// What is unsure about a front; empty when nothing is.
std::string doubts_about(const Front& front) {
  std::string text;
  if (front.confidence < kUnsureConfidence)
    text = fmt::format("{}: its edges are unsure (confidence {:.2f})", front.name, front.confidence);
  if (front.joint && front.joint->evidence == "prior" && probability_of(*front.joint) < kUnsureJoint)
    text += fmt::format("{} that it is a {} follows from its shape {} ({:.0f} %); nobody saw it move",
                        text.empty() ? front.name + ":" : ";", front.class_name,
                        front.fixture ? "and handle" : "and neighbours, as no handle was found",
                        100 * probability_of(*front.joint));
  if (!front.joint && front.fixture && front.evidence.contains("pulled"))
    text += fmt::format("{} it has a {} but was not seen to open when it was pulled: {}",
                        text.empty() ? front.name + ":" : ";",
                        front.fixture->kind == Fixture::Kind::knob ? "knob" : "handle",
                        front.evidence["pulled"].get<std::string>());
  return text;
}

std::vector<Remark> doubts(const InterpretedMap& map, const ScanSet& scans) {
  std::vector<Remark> remarks;
  for (const Front& front : fronts_of(map.world, map.semantics))
    if (const std::string text = doubts_about(front); !text.empty())
      remarks.push_back({text, remarks.size() < kMaxViews ? view_of_front(map, scans, front) : cv::Mat()});
  for (const auto& [name, link] : map.semantics.links) {
    if (link.class_name != "wall" && link.geometry.contains("outline") && link.confidence < kUnsureConfidence)
      remarks.push_back({fmt::format("{}: confidence {:.2f}", name, link.confidence), {}});
    const Json edges = link.evidence.is_object() ? link.evidence.value("edges", Json::object()) : Json();
    const auto unseen = std::ranges::count(edges, Json("unseen"));
    if (edges.is_object() && link.geometry.contains("outline") && unseen > 0)
      remarks.push_back({fmt::format("{}: {} of its edges were not seen", name, unseen), {}});
  }
  return remarks;
}

std::vector<Remark> left_out(const InterpretedMap& map, const ScanSet& scans) {
  std::vector<Remark> remarks;
  size_t views = 0;
  for (const std::string& note : map.notes) {
    remarks.push_back({note, views < kMaxViews ? view_of_note(map, scans, note) : cv::Mat()});
    views += remarks.back().view.empty() ? 0 : 1;
  }
  return remarks;
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
         "handles are red. What is outlined dashed in brown is unsure. Photos are put together from many "
         "frames.</p>\n";
}

}  // namespace

std::string map_report(const InterpretedMap& map, const ScanSet& scans, const std::string& input,
                       const std::string& glb) {
  const bool furnished = std::ranges::any_of(
      map.semantics.links, [](const auto& entry) { return entry.second.geometry.contains("width"); });
  const std::vector<Remark> unsure = doubts(map, scans);
  std::string sections = fmt::format("<p>{} from {}.</p>\n", html_escape(map.summary()), html_escape(input));
  sections += html_section(
      "plan", "Plan",
      plan_svg(map) + "<p class=\"faint\">Lengths in cm; fronts blue.</p>\n" +
          details("Points in their colours, seen from above (below 1.9 m)", top_view_svg(map, scans)));
  if (!glb.empty()) sections += model_section(glb);
  if (furnished) {
    sections += html_section("elevations", "Fronts", elevations(map));
    sections += html_section("openings", "What opens, and how", openings_table(map));
  }
  if (!unsure.empty()) sections += html_section("unsure", "What is uncertain", remarks_html(unsure));
  if (!map.notes.empty())
    sections += html_section("notes", "What was left out, and why", remarks_html(left_out(map, scans)));
  sections += html_section("links", "Details",
                           details("Every link", links_table(map)) +
                               details("Configuration", configuration_table(map)) +
                               details("Where the time went", times_table(map)));
  return html_page("Map", sections);
}

}  // namespace loci::mapping
