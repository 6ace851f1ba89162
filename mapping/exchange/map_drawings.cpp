#include "mapping/exchange/map_drawings.h"
#include "mapping/interpretation/furniture/cabinets.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <ranges>

#include "mapping/base/math/label_places.h"
#include "mapping/base/text/base64.h"
#include "mapping/base/text/html.h"
#include "mapping/base/text/json.h"
#include "mapping/exchange/map_colors.h"
#include "mapping/image/image_io.h"
#include "mapping/interpretation/furniture/furniture_links.h"
#include "mapping/world/furniture_classes.h"

namespace loci::mapping {
namespace {

constexpr double kSameRun_m = 0.1;
constexpr double kSameDirection = 0.98;  ///< cosine
constexpr double kPlanScale = 140;       ///< pixels per metre
constexpr double kElevationScale = 220;
constexpr int kMaxPhotoSide = 1600;  ///< pixels
constexpr double kMargin = 64;       ///< around a drawing, pixels, for dimensions

/// A drawing in metres, y upwards.
class Drawing {
 public:
  Drawing(const Eigen::AlignedBox2d& box, double pixels_per_m, std::string label)
      : box_(box), scale_(pixels_per_m), label_(std::move(label)) {}

  void line(const Vector2d& a, const Vector2d& b, const std::string& style) {
    const Vector2d p = at(a), q = at(b);
    text_ += fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" {}/>\n", p.x(), p.y(),
                         q.x(), q.y(), style);
  }
  void polygon(const std::vector<Vector2d>& corners, const std::string& style) {
    std::string points;
    for (const Vector2d& corner : corners)
      points += fmt::format("{:.1f},{:.1f} ", at(corner).x(), at(corner).y());
    text_ += fmt::format("<polygon points=\"{}\" {}/>\n", points, style);
  }
  void rectangle(const Vector2d& low, const Vector2d& high, const std::string& style) {
    polygon({low, {high.x(), low.y()}, high, {low.x(), high.y()}}, style);
  }
  void image(const Vector2d& low, const Vector2d& high, const cv::Mat& pixels) {
    const std::vector<unsigned char> jpeg = encode_image(pixels, ".jpg");
    const Vector2d corner = at({low.x(), high.y()}), size = (high - low) * scale_;
    text_ += fmt::format(
        "<image x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" preserveAspectRatio=\"none\" "
        "href=\"data:image/jpeg;base64,{}\"/>\n",
        corner.x(), corner.y(), size.x(), size.y(), base64_from_bytes(jpeg));
  }
  void write(const Vector2d& middle, const std::string& words, double size = 12, double lines_down = 0) {
    const Vector2d p = at(middle);
    text_ += fmt::format(
        "<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"{}\" text-anchor=\"middle\" fill=\"#111\" "
        "stroke=\"#fff\" "
        "stroke-width=\"3\" paint-order=\"stroke\" font-family=\"sans-serif\">{}</text>\n",
        p.x(), p.y() + size * (0.35 + 1.15 * lines_down), size, html_escape(words));
  }
  /// A dimension line between two points, with the distance in centimetres.
  void dimension(const Vector2d& a, const Vector2d& b) {
    line(a, b, "stroke=\"#6b7280\" stroke-width=\"1\" marker-start=\"url(#tick)\" marker-end=\"url(#tick)\"");
    write((a + b) / 2, fmt::format("{:.0f}", 100 * (b - a).norm()), 11);
  }
  std::string svg() const {
    const Vector2d size = box_.sizes() * scale_ + Vector2d::Constant(2 * kMargin);
    return fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" "
        "style=\"max-width:100%;height:auto;background:#fff\" role=\"img\" aria-label=\"{2}\">\n"
        "<defs><marker id=\"tick\" markerWidth=\"6\" markerHeight=\"8\" refX=\"3\" refY=\"4\" "
        "orient=\"auto\">"
        "<path d=\"M1 7L5 1\" stroke=\"#6b7280\"/></marker></defs>\n{3}</svg>\n",
        size.x(), size.y(), html_escape(label_), text_);
  }

 private:
  Vector2d at(const Vector2d& p) const {
    return {(p.x() - box_.min().x()) * scale_ + kMargin, (box_.max().y() - p.y()) * scale_ + kMargin};
  }

  Eigen::AlignedBox2d box_;
  double scale_;
  std::string label_, text_;
};

std::vector<Vector2d> outline_of(const SemanticLink& link) {
  std::vector<Vector2d> outline;
  if (!link.geometry.is_object()) return outline;
  for (const Json& corner : link.geometry.value("outline", Json::array()))
    outline.emplace_back(corner.at(0).get<double>(), corner.at(1).get<double>());
  return outline;
}

std::string stroke_of(double confidence) {
  return confidence < kUnsureConfidence ? "stroke=\"#b45309\" stroke-width=\"1.5\" stroke-dasharray=\"5 4\""
                                        : "stroke=\"#1f2937\" stroke-width=\"1.5\"";
}

/// Where a front's lines meet: the middle of the hinged side, in the plane of the front.
void draw_opening(Drawing& drawing, const Front& front, const Vector2d& middle) {
  constexpr const char* kThin = "stroke=\"#2563eb\" stroke-width=\"1\" stroke-dasharray=\"3 3\"";
  const Vector2d half(front.width / 2, front.height / 2);
  if (!front.joint || front.joint->type == ArticulationType::rigid) return;
  if (front.joint->type == ArticulationType::prismatic) {
    drawing.line(middle + Vector2d(-0.25 * half.x(), 0.55 * half.y()), middle + Vector2d(0, 0.3 * half.y()),
                 kThin);
    drawing.line(middle + Vector2d(0.25 * half.x(), 0.55 * half.y()), middle + Vector2d(0, 0.3 * half.y()),
                 kThin);
    return;
  }
  const HingeSide side = hinge_side(front);
  const int along = side == HingeSide::left || side == HingeSide::right ? 0 : 1;
  const double way = side == HingeSide::right || side == HingeSide::above ? half[along] : -half[along];
  Vector2d hinge = middle, far = Vector2d::Zero();
  hinge[along] += way;
  far[along] = -way;
  for (const double end : {-1.0, 1.0}) {
    Vector2d corner = middle + far;
    corner[1 - along] += end * half[1 - along];
    drawing.line(hinge, corner, kThin);
  }
}

/// Draws the part within a box of what the photos show of a run. False when they show nothing.
bool draw_photos(Drawing& drawing, const InterpretedMap& map, const FurnitureRun& run,
                 const Eigen::AlignedBox2d& box) {
  bool any = false;
  for (const FacePhoto& photo : map.photos) {
    if (photo.face.normal3().dot(run.normal) < kSameDirection ||
        std::abs(photo.face.offset - run.offset) > kSameRun_m)
      continue;
    const Vector3d right = Vector3d::UnitZ().cross(run.normal);
    // From the photo's columns to the run's: their directions differ by a little.
    const double shift = photo.face.at(photo.u0, 0).dot(right) - photo.u0;
    const Eigen::AlignedBox2d whole(
        Vector2d(photo.u0 + shift, photo.v0),
        Vector2d(photo.u0 + shift, photo.v0) + photo.pixel_m * Vector2d(photo.color.cols, photo.color.rows));
    const Eigen::AlignedBox2d part = whole.intersection(box);
    if (part.isEmpty()) continue;
    const Vector2d from = (part.min() - whole.min()) / photo.pixel_m, size = part.sizes() / photo.pixel_m;
    const cv::Rect pixels =
        cv::Rect(static_cast<int>(from.x()), static_cast<int>(photo.color.rows - from.y() - size.y()),
                 static_cast<int>(size.x()), static_cast<int>(size.y())) &
        cv::Rect({}, photo.color.size());
    if (pixels.empty()) continue;
    cv::Mat shown = photo.color(pixels).clone();
    shown.setTo(kUnseenColor, ~seen_pixels(shown));
    const double scale = static_cast<double>(kMaxPhotoSide) / std::max(shown.cols, shown.rows);
    if (scale < 1) cv::resize(shown, shown, {}, scale, scale, cv::INTER_AREA);
    drawing.image(part.min(), part.max(), shown);
    any = true;
  }
  return any;
}

void draw_front(Drawing& drawing, const FurnitureRun& run, const Front& front, bool over_photo) {
  const Vector3d right = Vector3d::UnitZ().cross(run.normal);
  const auto in_plane = [&](const Vector3d& p) { return Vector2d(p.dot(right), p.z()); };
  const Vector2d middle = in_plane(front.centre), half(front.width / 2, front.height / 2);
  drawing.rectangle(middle - half, middle + half,
                    (over_photo ? "fill=\"none\" " : "fill=\"#e5edf5\" ") + stroke_of(front.confidence));
  draw_opening(drawing, front, middle);
  drawing.write(middle, front.name, 11);
  if (front.height > 0.12)
    drawing.write(middle, fmt::format("{:.0f} × {:.0f}", 100 * front.width, 100 * front.height), 10, 1);
  if (!front.fixture) return;
  const Vector2d bar = in_plane(front.fixture->axis) * front.fixture->length / 2;
  const Vector2d at = in_plane(front.fixture->centre);
  if (front.fixture->kind == Fixture::Kind::handle)
    drawing.line(at - bar, at + bar, "stroke=\"#b91c1c\" stroke-width=\"5\" stroke-linecap=\"round\"");
  else
    drawing.line(at, at + Vector2d(1e-3, 0),
                 "stroke=\"#b91c1c\" stroke-width=\"9\" stroke-linecap=\"round\"");
}

}  // namespace

HingeSide hinge_side(const Front& front) {
  const Vector3d off = front.joint->origin - front.centre;
  if (std::abs(front.joint->axis.dot(front.up)) > std::sqrt(0.5))
    return off.dot(front.right()) > 0 ? HingeSide::right : HingeSide::left;
  return off.dot(front.up) > 0 ? HingeSide::above : HingeSide::below;
}

std::vector<FurnitureRun> furniture_runs(const InterpretedMap& map) {
  std::vector<FurnitureRun> runs;
  for (const Front& front : fronts_of(map.world, map.semantics)) {
    const double offset = front.normal.dot(front.centre);
    auto run = std::ranges::find_if(runs, [&](const FurnitureRun& one) {
      return one.normal.dot(front.normal) > kSameDirection && std::abs(one.offset - offset) < kSameRun_m;
    });
    if (run == runs.end()) run = runs.insert(runs.end(), {front.normal, offset, {}});
    run->fronts.push_back(front);
  }
  const auto width = [](const FurnitureRun& run) {
    double sum = 0;
    for (const Front& front : run.fronts) sum += front.width * front.height;
    return sum;
  };
  std::ranges::stable_sort(runs,
                           [&](const FurnitureRun& a, const FurnitureRun& b) { return width(a) > width(b); });
  for (FurnitureRun& run : runs) {
    const Vector3d right = Vector3d::UnitZ().cross(run.normal);
    std::ranges::stable_sort(run.fronts, [&](const Front& a, const Front& b) {
      const double apart = a.centre.dot(right) - b.centre.dot(right);
      return std::abs(apart) > kSameRun_m ? apart < 0 : a.centre.z() > b.centre.z();
    });
  }
  return runs;
}

std::string elevation_svg(const InterpretedMap& map, const FurnitureRun& run) {
  const Vector3d right = Vector3d::UnitZ().cross(run.normal);
  Eigen::AlignedBox2d box;
  for (const Front& front : run.fronts) {
    const Vector2d middle(front.centre.dot(right), front.centre.z()), half(front.width / 2, front.height / 2);
    box.extend(middle - half);
    box.extend(middle + half);
  }
  const double top = box.max().y();
  box.extend(Vector2d(box.min().x(), 0));
  box.extend(Vector2d(box.min().x(), top + 0.1));
  Drawing drawing(box, kElevationScale, "Elevation");
  const bool over_photos = draw_photos(drawing, map, run, box);
  drawing.line({box.min().x() - 0.2, 0}, {box.max().x() + 0.2, 0}, "stroke=\"#111\" stroke-width=\"3\"");
  for (const auto& [name, link] : map.semantics.links) {
    const std::vector<Vector2d> outline = outline_of(link);
    if (!is_support_class(link.class_name) || is_inferred_cabinet(link) || outline.empty()) continue;
    double from = 1e9, to = -1e9, nearest = 1e9;
    for (const Vector2d& corner : outline) {
      from = std::min(from, corner.dot(right.head<2>()));
      to = std::max(to, corner.dot(right.head<2>()));
      nearest = std::min(nearest, std::abs(corner.dot(run.normal.head<2>()) - run.offset));
    }
    const double height = link.geometry.at("height").get<double>();
    from = std::max(from, box.min().x() - 0.1);
    to = std::min(to, box.max().x() + 0.1);
    if (nearest > 0.15 || from >= to || height > top + 0.1) continue;
    drawing.rectangle({from, height - 0.03}, {to, height}, "fill=\"#9ca3af\" " + stroke_of(link.confidence));
    drawing.write({(from + to) / 2, height + 0.05}, fmt::format("{}, {:.0f} cm high", name, 100 * height),
                  11);
  }
  for (const Front& front : run.fronts) draw_front(drawing, run, front, over_photos);
  drawing.dimension({box.min().x(), -0.18}, {box.max().x(), -0.18});
  drawing.dimension({box.max().x() + 0.18, 0}, {box.max().x() + 0.18, top});
  return drawing.svg();
}

namespace {

/// A gap in the line of a wall, a thin one for a window.
void draw_opening(Drawing& drawing, const Vector2d& along, const Json& opening) {
  const Json& centre = opening.at("centre");
  const double width = opening.at("width").get<double>();
  const Vector2d middle(centre.at(0).get<double>(), centre.at(1).get<double>()), half = along * width / 2;
  const std::string kind = opening.at("kind").get<std::string>();
  drawing.line(middle - half, middle + half,
               fmt::format("stroke=\"#fff\" stroke-width=\"{}\"", kind == "doorway" ? 7 : 3));
  drawing.write(
      middle, fmt::format("{} {:.0f} × {:.0f}", kind, 100 * width, 100 * opening.at("height").get<double>()),
      10);
}

/// The map from the axes of a room: x is along its longest wall.
Eigen::Rotation2Dd map_from_room_axes(const SemanticMap& semantics) {
  Vector2d along = Vector2d::Zero();
  for (const auto& [name, link] : semantics.links) {
    const std::vector<Vector2d> outline = outline_of(link);
    if (link.class_name != "wall" || outline.size() < 2) continue;
    if (const Vector2d wall = outline[1] - outline[0]; wall.norm() > along.norm()) along = wall;
  }
  return Eigen::Rotation2Dd(along.isZero() ? 0 : std::atan2(along.y(), along.x()));
}

/// A box along the axes of the room.
struct RoomBox {
  Eigen::Rotation2Dd map_from_axes;
  Eigen::AlignedBox2d box;

  void extend(const Vector2d& in_map) { box.extend(map_from_axes.inverse() * in_map); }
  Vector2d in_map(double x, double y) const { return map_from_axes * Vector2d(x, y); }
  Eigen::AlignedBox2d around(double margin) const {
    Eigen::AlignedBox2d bounds;
    for (const double x : {box.min().x() - margin, box.max().x() + margin})
      for (const double y : {box.min().y() - margin, box.max().y() + margin}) bounds.extend(in_map(x, y));
    return bounds;
  }
};

/// What is written on a support, from the most to the least of it.
std::vector<std::vector<std::string>> words_on(const std::string& name, const SemanticLink& link,
                                               const std::vector<Vector2d>& outline) {
  const std::string high = fmt::format("{:.0f} high", 100 * link.geometry.at("height").get<double>());
  if (outline.size() != 4) return {{name, high}, {name}};
  const std::string size = fmt::format("{:.0f} × {:.0f}", 100 * (outline[1] - outline[0]).norm(),
                                       100 * (outline[2] - outline[1]).norm());
  return {{name, size + ", " + high}, {name, size, high}, {name}};
}

constexpr double kNameSize = 12, kSizeSize = 10;  ///< of letters, pixels

/// Writes a support's name and measures inside its outline; its name about its middle where they do not fit,
/// unless that is taken.
void write_support(Drawing& drawing, LabelPlaces& places, const std::vector<Vector2d>& outline,
                   const std::vector<std::vector<std::string>>& choices) {
  const auto size_of = [](const std::vector<std::string>& lines) {
    Vector2d size = LabelPlaces::size_of_text(lines[0].size(), kNameSize);
    for (size_t i = 1; i < lines.size(); ++i) {
      const Vector2d line = LabelPlaces::size_of_text(lines[i].size(), kSizeSize);
      size = Vector2d(std::max(size.x(), line.x()), size.y() + line.y());
    }
    return Vector2d(size / kPlanScale);
  };
  const auto write = [&](const Vector2d& middle, const std::vector<std::string>& lines) {
    Vector2d at = middle + Vector2d(0, size_of(lines).y() / 2);  // upper edge of a line
    for (size_t i = 0; i < lines.size(); ++i) {
      const double letters = i == 0 ? kNameSize : kSizeSize,
                   height = LabelPlaces::size_of_text(1, letters).y() / kPlanScale;
      drawing.write(at - Vector2d(0, height / 2), lines[i], letters);
      at.y() -= height;
    }
  };
  for (const std::vector<std::string>& lines : choices)
    if (const auto middle = places.take_inside(outline, size_of(lines))) return write(*middle, lines);
  if (const auto middle = places.take_about(outline, size_of(choices.back()))) write(*middle, choices.back());
}

struct Support {
  std::string name;
  const SemanticLink* link;
  std::vector<Vector2d> outline;
};

/// The smallest first.
std::vector<Support> supports_of(const SemanticMap& semantics) {
  std::vector<Support> supports;
  for (const auto& [name, link] : semantics.links)
    if (is_support_class(link.class_name) && is_seen_from_above(link))
      supports.push_back({name, &link, outline_of(link)});
  std::ranges::stable_sort(supports, {}, [](const Support& support) { return area_of(support.outline); });
  return supports;
}

}  // namespace

bool is_seen_from_above(const SemanticLink& link) {
  return !outline_of(link).empty() && link.class_name != "drawer_bottom" && !is_inferred_cabinet(link);
}

std::string plan_svg(const InterpretedMap& map) {
  constexpr double kDimension_m = 0.2;  // from the room to its dimension lines
  RoomBox room{map_from_room_axes(map.semantics), {}};
  for (const auto& [name, link] : map.semantics.links)
    if (link.class_name != "floor" && link.class_name != "ceiling")
      for (const Vector2d& corner : outline_of(link)) room.extend(corner);
  const std::vector<Front> fronts = fronts_of(map.world, map.semantics);
  for (const Front& front : fronts) room.extend(Vector2d(front.centre.head<2>()));
  if (room.box.isEmpty()) return {};
  Drawing drawing(room.around(kDimension_m), kPlanScale, "Plan");
  const std::vector<Support> supports = supports_of(map.semantics);
  for (const auto& [name, link, outline] : std::views::reverse(supports))
    drawing.polygon(outline, "fill=\"#dbe7df\" " + stroke_of(link->confidence));
  for (const auto& [name, link] : map.semantics.links) {
    if (link.class_name != "wall" || !is_seen_from_above(link)) continue;
    const std::vector<Vector2d> outline = outline_of(link);
    const Vector2d& end = outline[1 % outline.size()];
    drawing.line(outline[0], end, "stroke=\"#1f2937\" stroke-width=\"6\"");
    for (const Json& opening : link.geometry.value("openings", Json::array()))
      draw_opening(drawing, (end - outline[0]).normalized(), opening);
  }
  for (const Front& front : fronts) {
    const Vector2d middle = front.centre.head<2>(), half = front.right().head<2>() * front.width / 2;
    drawing.line(middle - half, middle + half, "stroke=\"#2563eb\" stroke-width=\"4\"");
  }
  LabelPlaces places;  // those with least room come first
  for (const auto& [name, link, outline] : supports)
    write_support(drawing, places, outline, words_on(name, *link, outline));
  const Vector2d low = room.box.min(), high = room.box.max();
  drawing.dimension(room.in_map(low.x(), low.y() - kDimension_m),
                    room.in_map(high.x(), low.y() - kDimension_m));
  drawing.dimension(room.in_map(high.x() + kDimension_m, low.y()),
                    room.in_map(high.x() + kDimension_m, high.y()));
  return drawing.svg();
}

}  // namespace loci::mapping
