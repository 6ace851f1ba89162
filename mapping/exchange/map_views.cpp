#include "mapping/exchange/map_views.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "mapping/base/math/label_places.h"
#include "mapping/base/math/math.h"
#include "mapping/base/text/base64.h"
#include "mapping/base/text/html.h"
#include "mapping/base/text/json.h"
#include "mapping/exchange/map_colors.h"
#include "mapping/exchange/map_drawings.h"
#include "mapping/image/image_io.h"

namespace loci::mapping {
namespace {

constexpr double kMaxShownHeight = 1.9;  // m; what hangs higher would hide the furniture
constexpr double kPointMargin = 0.2;     // m around the points
constexpr double kMaxPixels = 1400;

/// A part of the plane z = 0, seen along -z.
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

/// Visits the points below the ceiling, in the map.
template <class Visit>
void each_point(const InterpretedMap& map, const ScanSet& scans, Visit visit) {
  const Isometry3d map_from_set = map_from_scan_set(map, scans);
  for (const Scan& scan : scans.scans) {
    const Isometry3d map_from_scan = map_from_set * scan.map_from_scan;
    for (const ScanPoint& point : scan.points) {
      if (!point.returned) continue;
      const Vector3d position = map_from_scan * point.position.cast<double>();
      if (position.z() < kMaxShownHeight) visit(position, point);
    }
  }
}

/// The outlines of links and the points but for the few farthest on each side.
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
  for (const auto& [name, link] : map.semantics.links)
    if (is_seen_from_above(link))
      for (const Json& corner : link.geometry.at("outline")) {
        const Vector2d at(corner.at(0).get<double>(), corner.at(1).get<double>());
        view.low = view.low.cwiseMin(at - Vector2d::Constant(kPointMargin));
        view.high = view.high.cwiseMax(at + Vector2d::Constant(kPointMargin));
      }
  view.pixel = std::max(0.01, (view.high - view.low).maxCoeff() / kMaxPixels);
  return view;
}

/// The points in their colours (grey by height where they have none) as seen along -z of the view, the
/// highest on top; without those outside of the heights.
cv::Mat image_of(const InterpretedMap& map, const ScanSet& scans, const TopView& view,
                 const Isometry3d& view_from_map = Isometry3d::Identity(), double min_height = -1e9,
                 double max_height = 1e9) {
  cv::Mat image(view.height(), view.width(), CV_8UC3, cv::Scalar(255, 255, 255));
  cv::Mat heights(view.height(), view.width(), CV_32F, cv::Scalar(-1e9));
  each_point(map, scans, [&](const Vector3d& in_map, const ScanPoint& point) {
    const Vector3d position = view_from_map * in_map;
    if (position.z() < min_height || position.z() > max_height) return;
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

/// In pixels of the view.
Polygon outline_in(const TopView& view, const SemanticLink& link) {
  Polygon outline;
  for (const Json& corner : link.geometry.at("outline"))
    outline.push_back(view.at({corner.at(0).get<double>(), corner.at(1).get<double>()}));
  return outline;
}

std::string polygon_of(const Polygon& outline, const SemanticLink& link) {
  std::string points;
  for (const Vector2d& at : outline) points += fmt::format("{:.1f},{:.1f} ", at.x(), at.y());
  const char* color = outline_color(link.class_name);
  const bool wall = link.class_name == "wall",
             level = link.class_name == "floor" || link.class_name == "ceiling";
  return fmt::format(
      "<polygon points=\"{}\" fill=\"{}\" fill-opacity=\"{}\" stroke=\"{}\" stroke-width=\"{}\"{}/>\n",
      points, color, level || wall ? 0.0 : 0.15, color, wall ? 5 : 2.5,
      level ? " stroke-dasharray=\"6 6\"" : "");
}

/// The name of a link where there is room: inside of what stands in the room, at the middle of a wall.
std::string label_of(const std::string& name, const SemanticLink& link, const Polygon& outline,
                     LabelPlaces& places) {
  constexpr double kLetters = 16;  // pixels
  const Vector2d size = LabelPlaces::size_of_text(name.size(), kLetters);
  std::optional<Vector2d> at;
  if (link.class_name == "wall") {
    Eigen::AlignedBox2d extent;
    for (const Vector2d& corner : outline) extent.extend(corner);
    at = places.take_first({extent.center()}, size);
  } else if (!(at = places.take_inside(outline, size))) {
    at = places.take_about(outline, size);
  }
  if (!at) return {};
  return fmt::format(
      "<text x=\"{:.1f}\" y=\"{:.1f}\" fill=\"{}\" stroke=\"#fff\" stroke-width=\"4\" paint-order=\"stroke\" "
      "font-family=\"sans-serif\" font-size=\"{}\" font-weight=\"600\" text-anchor=\"middle\">{}</text>\n",
      at->x(), at->y() + 0.35 * kLetters, outline_color(link.class_name), kLetters, html_escape(name));
}

/// Outlines of links, and over them the names: furniture before walls, the smallest first.
std::string outlines_svg(const SemanticMap& semantics, const TopView& view) {
  struct Shape {
    std::string name;
    const SemanticLink* link;
    Polygon outline;
  };
  std::vector<Shape> shapes;
  std::string svg;
  for (const auto& [name, link] : semantics.links)
    if (is_seen_from_above(link)) {
      shapes.push_back({name, &link, outline_in(view, link)});
      svg += polygon_of(shapes.back().outline, link);
    }
  std::ranges::stable_sort(shapes, {}, [](const Shape& shape) {
    return std::pair(shape.link->class_name == "wall", area_of(shape.outline));
  });
  LabelPlaces places;
  for (const auto& [name, link, outline] : shapes)
    if (link->class_name != "floor" && link->class_name != "ceiling")
      svg += label_of(name, *link, outline, places);
  return svg;
}

constexpr double kAround_m = 0.12;       // shown around a front
constexpr double kNotePart_m = 0.4;      // half the width of what is shown around the place of a note
constexpr double kPointPixel_m = 0.006;  // of views of points
constexpr double kBehind_m = -0.1, kBefore_m = 0.25;  // what is shown of the space at a front
constexpr int kViewPixels = 260;                      // longest side of a view
const cv::Scalar kMark(28, 28, 185);                  // red, BGR

/// x of the view is to the right of who stands before a front, y up, z out of it; the origin is its centre.
Isometry3d view_from_map(const Front& front) {
  Isometry3d map_from_view = Isometry3d::Identity();
  map_from_view.linear() << front.right(), front.up, front.normal;
  map_from_view.translation() = front.centre;
  return map_from_view.inverse();
}

/// What photos, or else the points show of a front with the space around.
cv::Mat image_before(const InterpretedMap& map, const ScanSet& scans, const Front& front, double margin) {
  cv::Mat image = photo_of(map, front, margin);
  if (!image.empty()) {
    image.setTo(kUnseenColor, ~seen_pixels(image));
    return image;
  }
  TopView view;
  view.high = Vector2d(front.width, front.height) / 2 + Vector2d::Constant(margin);
  view.low = -view.high;
  view.pixel = kPointPixel_m;
  return image_of(map, scans, view, view_from_map(front), kBehind_m, kBefore_m);
}

/// Enlarges or reduces a view to its usual size.
cv::Mat resized(const cv::Mat& image) {
  const double scale = static_cast<double>(kViewPixels) / std::max(image.cols, image.rows);
  cv::Mat result;
  cv::resize(image, result, {}, scale, scale, scale < 1 ? cv::INTER_AREA : cv::INTER_NEAREST);
  return result;
}

/// "… at (1.20, 3.10, 0.54) …": two or three numbers.
std::vector<double> place_in(const std::string& note) {
  const size_t at = note.find(" at (");
  double x = 0, y = 0, z = 0;
  const int count =
      at == std::string::npos ? 0 : std::sscanf(note.c_str() + at, " at (%lf, %lf, %lf)", &x, &y, &z);
  return count == 3 ? std::vector{x, y, z} : count == 2 ? std::vector{x, y} : std::vector<double>();
}

/// A square before the plane of furniture that a point stands before; unset when there is none.
std::optional<Front> square_at(const InterpretedMap& map, const Vector3d& at) {
  for (const FurnitureFace& face : map.faces) {
    const Vector3d on_face = face.coordinates(at);
    if (on_face.z() < kBehind_m || on_face.z() > kBefore_m || on_face.x() < face.u_min - kBefore_m ||
        on_face.x() > face.u_max + kBefore_m)
      continue;
    Front square;
    square.normal = face.normal3();
    square.centre = face.at(on_face.x(), on_face.y());
    square.width = square.height = 2 * kNotePart_m;
    return square;
  }
  return std::nullopt;
}

}  // namespace

std::string top_view_svg(const InterpretedMap& map, const ScanSet& scans) {
  const TopView view = view_of(map, scans);
  const std::vector<unsigned char> png = encode_image(image_of(map, scans, view), ".png");
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"{4} 0 {3} {1}\" width=\"{3}\" height=\"{1}\" "
      "role=\"img\" "
      "aria-label=\"Top view\">\n<image width=\"{0}\" height=\"{1}\" href=\"data:image/png;base64,{2}\"/>\n",
      view.width(), view.height(), base64_from_bytes(png), view.width() + 2 * kLabelMargin, -kLabelMargin);
  svg += outlines_svg(map.semantics, view);
  const Vector2d left = {20, view.height() - 20.0};
  svg += fmt::format(
      "<path d=\"M{0} {1}h{2}\" stroke=\"#111\" stroke-width=\"3\"/><text x=\"{0}\" y=\"{3}\" "
      "font-family=\"sans-serif\" "
      "font-size=\"14\" fill=\"#111\">1 m</text>\n</svg>\n",
      left.x(), left.y(), 1 / view.pixel, left.y() - 6);
  return svg;
}

cv::Mat view_of_front(const InterpretedMap& map, const ScanSet& scans, const Front& front) {
  cv::Mat view = resized(image_before(map, scans, front, kAround_m));
  const double pixels_per_m = view.cols / (front.width + 2 * kAround_m);
  const auto pixel = [&](const Vector3d& point) {
    const Vector3d at = view_from_map(front) * point;
    return cv::Point(static_cast<int>(view.cols / 2.0 + pixels_per_m * at.x()),
                     static_cast<int>(view.rows / 2.0 - pixels_per_m * at.y()));
  };
  const Vector3d half = front.width / 2 * front.right() + front.height / 2 * front.up;
  cv::rectangle(view, pixel(front.centre - half), pixel(front.centre + half), kMark, 1, cv::LINE_AA);
  if (!front.fixture) return view;
  const Vector3d bar = front.fixture->length / 2 * front.fixture->axis;
  cv::line(view, pixel(front.fixture->centre - bar), pixel(front.fixture->centre + bar), kMark, 2,
           cv::LINE_AA);
  return view;
}

cv::Mat view_of_note(const InterpretedMap& map, const ScanSet& scans, const std::string& note) {
  const std::vector<double> at = place_in(note);
  if (at.empty()) return {};
  cv::Mat view;
  if (at.size() == 3)
    if (const auto square = square_at(map, {at[0], at[1], at[2]}))
      view = image_before(map, scans, *square, 0);
  if (view.empty()) {
    TopView above;
    above.low = Vector2d(at[0], at[1]) - Vector2d::Constant(2 * kNotePart_m);
    above.high = Vector2d(at[0], at[1]) + Vector2d::Constant(2 * kNotePart_m);
    view = image_of(map, scans, above);
  }
  view = resized(view);
  cv::circle(view, {view.cols / 2, view.rows / 2}, kViewPixels / 8, kMark, 2, cv::LINE_AA);
  return view;
}

}  // namespace loci::mapping
