// Sections of a report that are drawings: the plan of the home and the time line.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>

#include "mapping/base/math/label_places.h"
#include "mapping/base/text/html.h"
#include "mapping/world/kinematics.h"
#include "memory/questions/environment_parts.h"
#include "memory/questions/events.h"
#include "memory/questions/snapshot.h"
#include "memory/report/report_data.h"

namespace loci::memory {
namespace {

constexpr double kScale = 150;   ///< units of the drawing per metre
constexpr double kMargin = 0.3;  ///< metres around everything

/// Collects shapes in the map's frame, and draws them with y upwards.
class Plan {
 public:
  void polygon(const std::vector<Vector2d>& outline, const std::string& style, const std::string& title) {
    std::string points;
    for (const Vector2d& corner : outline) points += text(corner) + " ";
    shapes_ += fmt::format("<polygon points=\"{}\" {}><title>{}</title></polygon>\n", points, style,
                           html_escape(title));
  }

  void line(const std::vector<Vector2d>& path, const std::string& style) {
    std::string points;
    for (const Vector2d& corner : path) points += text(corner) + " ";
    shapes_ += fmt::format("<polyline points=\"{}\" fill=\"none\" {}/>\n", points, style);
  }

  void dot(const Vector2d& at, double radius, const std::string& style, const std::string& title) {
    grow(at);
    shapes_ += fmt::format("<circle cx=\"{:.0f}\" cy=\"{:.0f}\" r=\"{}\" {}><title>{}</title></circle>\n",
                           kScale * at.x(), -kScale * at.y(), radius, style, html_escape(title));
  }

  /// The name of a place, inside its outline where it fits.
  void place_label(const std::vector<Vector2d>& outline, const std::string& words) {
    const Vector2d size = size_of(words);
    std::optional<Vector2d> middle = labels_.take_inside(outline, size);
    if (!middle) middle = labels_.take_about(outline, size);
    if (middle) write(*middle, "fill=\"currentColor\" fill-opacity=\".6\"", words);
  }

  /// Keeps labels off a dot.
  void keep_clear(const Vector2d& at, double radius) {
    labels_.take_first({at}, Vector2d::Constant(2 * radius / kScale));
  }

  /// The name of a dot: above it, or where beside it there is room.
  void dot_label(const Vector2d& at, const std::string& words) {
    constexpr double kOff = 15 / kScale;
    const Vector2d size = size_of(words), beside(size.x() / 2 + kOff / 1.5, 0), above(0, kOff);
    const std::vector<Vector2d> middles = {
        at + above,     at - above,          at + beside,         at - beside,         at + 2 * above,
        at - 2 * above, at + beside + above, at - beside + above, at + beside - above, at - beside - above};
    write(labels_.take_first(middles, size).value_or(middles[0]),
          "font-weight=\"bold\" fill=\"currentColor\"", words);
  }

  bool empty() const { return low_.x() > high_.x(); }

  std::string svg() const {
    const Vector2d size = kScale * (high_ - low_ + Vector2d::Constant(2 * kMargin));
    const double left = kScale * (low_.x() - kMargin), top = -kScale * (high_.y() + kMargin);
    return fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"{0:.0f} {1:.0f} {2:.0f} {3:.0f}\" "
        "width=\"{2:.0f}\" "
        "font-family=\"system-ui, sans-serif\" role=\"img\" aria-label=\"plan of the room\">\n{4}"
        "<path d=\"M{5:.0f} {6:.0f}h{7:.0f}\" stroke=\"currentColor\" stroke-width=\"3\"/>"
        "<text x=\"{5:.0f}\" y=\"{8:.0f}\" font-size=\"13\" fill=\"currentColor\">1 m</text>\n</svg>\n",
        left, top, size.x(), size.y(), shapes_ + texts_, left + 10, top + size.y() - 10, kScale,
        top + size.y() - 16);
  }

 private:
  static constexpr double kLetters = 13;  ///< units of the drawing

  static Vector2d size_of(const std::string& words) {
    return LabelPlaces::size_of_text(words.size(), kLetters) / kScale;
  }
  void write(const Vector2d& middle, const std::string& style, const std::string& words) {
    texts_ += fmt::format(
        "<text x=\"{:.0f}\" y=\"{:.0f}\" text-anchor=\"middle\" font-size=\"{}\" {}>{}</text>\n",
        kScale * middle.x(), -kScale * middle.y() + 0.35 * kLetters, kLetters, style, html_escape(words));
  }
  std::string text(const Vector2d& at) {
    grow(at);
    return fmt::format("{:.0f},{:.0f}", kScale * at.x(), -kScale * at.y());
  }
  void grow(const Vector2d& at) {
    low_ = low_.cwiseMin(at);
    high_ = high_.cwiseMax(at);
  }

  std::string shapes_, texts_;  ///< texts are over all shapes
  LabelPlaces labels_;
  Vector2d low_ = Vector2d::Constant(1e9), high_ = Vector2d::Constant(-1e9);
};

std::vector<Vector2d> footprint(const mapping::Box& box, const Isometry3d& map_from_box) {
  std::vector<cv::Point2d> corners;
  for (const double x : {-0.5, 0.5})
    for (const double y : {-0.5, 0.5})
      for (const double z : {-0.5, 0.5}) {
        const Vector3d corner = map_from_box * box.size.cwiseProduct(Vector3d(x, y, z));
        corners.emplace_back(corner.x(), corner.y());
      }
  std::vector<cv::Point2f> hull, points(corners.begin(), corners.end());
  cv::convexHull(points, hull);
  std::vector<Vector2d> outline;
  for (const cv::Point2f& corner : hull) outline.emplace_back(corner.x, corner.y);
  return outline;
}

void draw_home(const ReportData& data, Plan& plan) {
  const Snapshot snapshot(data.store, {});
  if (const auto world = world_of(snapshot)) {
    const std::vector<Isometry3d> poses = root_from_links(*world, {});
    for (size_t i = 0; i < world->links.size(); ++i)
      for (const mapping::Visual& visual : world->links[i].visuals)
        if (const auto* box = std::get_if<mapping::Box>(&visual.geometry))
          plan.polygon(
              footprint(*box, poses[i] * visual.link_from_visual),
              "fill=\"currentColor\" fill-opacity=\".05\" stroke=\"currentColor\" stroke-opacity=\".3\"",
              snapshot.part_names().link(world->links[i].name));
  }
  for (const PlaceRow& place : snapshot.places()) {
    if (place.outline.empty() || place.class_name == "legs") continue;  // below a table, which is drawn
    const char* drawn = place.container
                            ? "fill=\"none\" stroke=\"#89a\" stroke-dasharray=\"4 3\""
                            : "fill=\"#89a\" fill-opacity=\".2\" stroke=\"#89a\" stroke-width=\"2\"";
    plan.polygon(place.outline, drawn, place.name);
  }
}

/// Names of places, where those of objects leave room. What is inside furniture has its name in a tooltip.
void name_places(const ReportData& data, Plan& plan) {
  const Snapshot snapshot(data.store, {});
  for (const PlaceRow& place : snapshot.places())
    if (!place.outline.empty() && place.class_name != "legs" && !place.container)
      plan.place_label(place.outline, place.name);
}

/// "1 box", as plan and lanes call it.
std::string name_of(const ObjectRef& object) {
  return object.label ? fmt::format("{} {}", object.id, *object.label)
                      : fmt::format("{} {}", object.id, object.color.value_or("object"));
}

/// Of shapes in the colour of an object, which may be that of the page.
constexpr const char* kEdge = "stroke=\"currentColor\" stroke-opacity=\".5\" stroke-width=\".8\"";

constexpr double kDot = 7;  ///< radius of where an object is, units of the drawing

void draw_trace(const ReportData& data, const ObjectHistory& history, Plan& plan) {
  std::vector<Vector2d> path;
  for (const Stay& stay : history.stays)
    if (stay.position) path.emplace_back(stay.position->head<2>());
  const std::string css = data.css_of(history.now.object.id);
  if (path.size() > 1) {  // edged, as objects may have the colour of the page
    plan.line(path, "stroke=\"currentColor\" stroke-width=\"3.5\" stroke-opacity=\".35\"");
    plan.line(path, fmt::format("stroke=\"{}\" stroke-width=\"2\"", css));
  }
  for (const Stay& stay : history.stays)
    if (stay.position)
      plan.dot(stay.position->head<2>(), 3, fmt::format("fill=\"{}\" {}", css, kEdge),
               fmt::format("{}: {}", history.now.object.name,
                           data.times.span_text(stay.scenes.front().time, stay.scenes.back().time)));
  if (!history.now.position) return;
  const bool there = history.now.status != ObjectStatus::gone && history.now.probability >= 0.5;
  const Vector2d at = history.now.position->head<2>();
  plan.dot(at, kDot,
           there ? fmt::format("fill=\"{}\" {}", css, kEdge)
                 : fmt::format("fill=\"{}\" fill-opacity=\".3\" stroke=\"currentColor\" stroke-width=\"1.5\" "
                               "stroke-dasharray=\"3 2\"",
                               css),
           fmt::format("{}: {}, {:.0f} %", to_text(history.now.object), status_text(history.now.status),
                       100 * history.now.probability));
  plan.keep_clear(at, kDot);
}

constexpr double kNames = 150, kWidth = 880, kLane = 22, kTop = 38;
constexpr TimeNs kOneLook = 10 * kMinute;  ///< scenes that are farther apart are separate looks

/// A lane per object: bars while it was being looked at, narrow ones between two looks that saw it at one
/// spot, dots in between, an open end when it is gone.
class Lanes {
 public:
  explicit Lanes(const ReportData& data)
      : data_(data),
        zone_(data.store.time_zone()),
        first_(data.scenes.front().time),
        last_(data.scenes.back().time) {}

  std::string svg() const {
    std::string shapes;
    double y = kTop;
    for (const ObjectHistory& history : data_.histories) {
      if (history.stays.empty() || history.stays.back().scenes.back().time < first_) continue;
      shapes += lane(history, y);
      y += kLane;
    }
    return fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" "
        "font-family=\"system-ui, sans-serif\" font-size=\"12\" fill=\"currentColor\" role=\"img\" "
        "aria-label=\"where each object was seen when\">\n<text x=\"{2:.0f}\" y=\"12\">{3}</text>"
        "<text x=\"{4:.0f}\" y=\"12\" text-anchor=\"end\">{5}</text><text x=\"0\" y=\"12\">{6}</text>\n"
        "{7}{8}{9}</svg>\n",
        kNames + kWidth + 10, y + 4, kNames, html_escape(data_.times.text(first_)), kNames + kWidth,
        html_escape(data_.times.text(last_)), html_escape(zone_.name()), ticks(y), scenes(y), shapes);
  }

 private:
  double x(TimeNs time) const {
    if (last_ == first_) return kNames;
    const double part = static_cast<double>(time - first_) / static_cast<double>(last_ - first_);
    return kNames + kWidth * std::clamp(part, 0.0, 1.0);
  }

  /// Round times of the clocks in the room: the day where a tick begins one, else hours and minutes.
  std::string ticks(double bottom) const {
    constexpr size_t kMaxTicks = 12;
    static constexpr std::array<TimeNs, 16> kSteps = {
        kMinute,   2 * kMinute, 5 * kMinute, 10 * kMinute, 15 * kMinute, 30 * kMinute, kHour,     2 * kHour,
        3 * kHour, 6 * kHour,   12 * kHour,  kDay,         2 * kDay,     7 * kDay,     30 * kDay, 365 * kDay};
    const TimeNs from = zone_.local(first_), to = zone_.local(last_);
    const auto step = std::ranges::find_if(
        kSteps, [&](TimeNs one) { return (to - from) / one <= static_cast<TimeNs>(kMaxTicks); });
    std::string text;
    if (step == kSteps.end()) return text;
    for (TimeNs local = (from / *step + 1) * *step; local < to; local += *step) {
      const std::string clock = format_time(local);  // "2026-10-25T06:00:00Z"
      const double at = x(zone_.first_moment(local));
      text += fmt::format(
          "<path d=\"M{0:.1f} 31V{1:.0f}\" stroke=\"currentColor\" stroke-opacity=\".3\" "
          "stroke-dasharray=\"1 3\"/><text class=\"tick\" x=\"{0:.1f}\" y=\"27\" text-anchor=\"middle\" "
          "font-size=\"11\" fill-opacity=\".7\">{2}</text>\n",
          at, bottom - kLane / 2, local % kDay == 0 ? clock.substr(5, 5) : clock.substr(11, 5));
    }
    return text;
  }

  /// The times of the scenes.
  std::string scenes(double bottom) const {
    std::string path;
    for (const SceneRow& scene : data_.scenes)
      path += fmt::format("M{:.1f} 31V{:.0f}", x(scene.time), bottom - kLane / 2);
    return "<path d=\"" + path + "\" stroke=\"currentColor\" stroke-opacity=\".12\"/>\n";
  }

  std::string lane(const ObjectHistory& history, double y) const {
    const std::string css = data_.css_of(history.now.object.id);
    const double from = x(history.stays.front().scenes.front().time);
    const bool gone = history.now.status == ObjectStatus::gone;
    const double to = gone ? x(history.stays.back().scenes.back().time) : kNames + kWidth;
    std::string shapes = fmt::format(
        "<text x=\"0\" y=\"{:.0f}\">{}</text><path d=\"M{:.1f} {:.0f}H{:.1f}\" stroke=\"currentColor\" "
        "stroke-opacity=\".5\" stroke-dasharray=\"2 3\"/>\n",
        y + 8, html_escape(name_of(history.now.object)), from, y + 4, to);
    for (const Stay& stay : history.stays) {
      const TimeNs first = stay.scenes.front().time, last = stay.scenes.back().time;
      const std::string spot = stay.place ? (stay.place->container ? "in " : "on ") + stay.place->name
                                          : std::string("at no place");
      const std::string title =
          fmt::format("{} {}, {}", name_of(history.now.object), spot, data_.times.span_text(first, last));
      shapes += bar(first, last, y + 3, 2, css, title);
      for (size_t i = 0, next = 0; i < stay.scenes.size(); i = next) {
        for (next = i + 1; next < stay.scenes.size(); ++next)
          if (stay.scenes[next].time - stay.scenes[next - 1].time > kOneLook) break;
        shapes += bar(stay.scenes[i].time, stay.scenes[next - 1].time, y, 8, css, title);
      }
    }
    return shapes;
  }

  std::string bar(TimeNs from, TimeNs to, double y, double height, const std::string& css,
                  const std::string& title) const {
    return fmt::format(
        "<rect x=\"{:.1f}\" y=\"{:.0f}\" width=\"{:.1f}\" height=\"{:.0f}\" rx=\"{}\" "
        "fill=\"{}\" {}><title>{}</title></rect>\n",
        x(from) - 3, y, x(to) - x(from) + 6, height, height > 2 ? 3 : 1, css, kEdge, html_escape(title));
  }

  const ReportData& data_;
  TimeZone zone_;
  TimeNs first_, last_;
};

}  // namespace

std::string plan_section(const ReportData& data) {
  Plan plan;
  draw_home(data, plan);
  for (const ObjectHistory& history : data.histories) draw_trace(data, history, plan);
  for (const ObjectHistory& history : data.histories)
    if (history.now.position) plan.dot_label(history.now.position->head<2>(), name_of(history.now.object));
  name_places(data, plan);
  const std::string body =
      plan.empty()
          ? "<p class=\"faint\">Nothing here has a position.</p>"
          : data.objects_left_out() + plan.svg() +
                "<p class=\"faint\">Each object has its number (7 is object_7) and its own colour: filled "
                "where it is believed to be, dashed where it was last and is gone or doubtful. Lines join "
                "the spots "
                "where it was seen.</p>";
  return html_section("plan", "Plan of the room", body);
}

std::string timeline_section(const ReportData& data) {
  if (data.scenes.empty())
    return html_section("timeline", "What happened", "<p class=\"faint\">No scene has been seen yet.</p>");
  std::vector<std::vector<std::string>> rows;
  const TimelineQuestion question{.from = data.scenes.front().time};
  for (const TimelineEntry& entry : ask(data.store, question).entries) {
    std::string happened;
    for (const Change& change : entry.changes) happened += (happened.empty() ? "" : "; ") + to_text(change);
    rows.push_back({data.times.text(entry.scene.scene.time), fmt::format("{}", entry.seen.size()), happened});
  }
  return html_section(
      "timeline", "What happened",
      data.scenes_left_out() + Lanes(data).svg() +
          "<p class=\"faint\">Wide: the object was seen. Narrow: nobody looked, and before and "
          "after it was seen at this spot. Dotted: not seen since. Vertical lines are scenes.</p>" +
          html_table({"time", "objects seen", "what changed"}, rows));
}

}  // namespace loci::memory
