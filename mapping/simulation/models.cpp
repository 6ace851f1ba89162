#include "mapping/simulation/models.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "mapping/base/math/math.h"
#include "mapping/image/image_io.h"
#include "mapping/simulation/shapes.h"

namespace loci::mapping {
namespace {

/// What a builder works with.
struct Look {
  Rgba color;
  Rgba accent;
  Paint around;           ///< side of a round body: by angle and height
  Paint front;            ///< front of a box
  bool detailed = false;  ///< the paint has detail: cut surfaces finely
  std::optional<Vector3d> size;
};

struct Built {
  TriangleMesh mesh;
  double top_share = 1;  ///< of its height, where other objects stand on it
};

/// A round body: bottom, painted side of the given radius from z = low to high, then the rest of the profile.
void round_body(ShapeBuilder& builder, double radius, double low, double high, const Look& look) {
  builder.lathe({{0, 0}, {radius * 0.92, 0}, {radius, low}}, plain(look.color));
  const std::vector<Vector2d> side = {{radius, low}, {radius, high}};
  builder.lathe(look.detailed ? finely(side, 0.0025) : side, look.around, look.detailed ? 96 : 40);
}

Built mug(const Look& look) {
  ShapeBuilder builder;
  constexpr double r = 0.041, h = 0.096, wall = 0.004;
  round_body(builder, r, 0.005, h - 0.003, look);
  builder.lathe({{r, h - 0.003},
                 {r - wall / 2, h},
                 {r - wall, h - 0.003},
                 {r - wall, 0.012},
                 {r - 0.012, 0.006},
                 {0, 0.006}},
                plain(look.color));
  std::vector<Vector3d> path;
  for (int i = 0; i <= 12; ++i) {
    const double angle = kPi / 2 - kPi * i / 12;
    path.emplace_back(r - 0.003 + 0.03 * std::cos(angle), 0, 0.05 + 0.029 * std::sin(angle));
  }
  builder.tube(path, std::vector<double>(path.size(), 0.0055), Vector3d::UnitY(), look.accent);
  return {builder.take(), 1};
}

Built bowl(const Look& look) {
  ShapeBuilder builder;
  std::vector<Vector2d> outside = {{0, 0}, {0.032, 0}, {0.034, 0.006}}, inside;
  for (int i = 1; i <= 10; ++i) {
    const double angle = kPi / 2 * i / 10;
    outside.emplace_back(0.034 + 0.044 * std::sin(angle), 0.006 + 0.055 * (1 - std::cos(angle)));
    inside.emplace_back(0.031 + 0.043 * std::sin(angle), 0.011 + 0.05 * (1 - std::cos(angle)));
  }
  std::reverse(inside.begin(), inside.end());
  inside.emplace_back(0.0, 0.010);
  builder.lathe(look.detailed ? finely(outside, 0.004) : outside, look.around, look.detailed ? 96 : 48);
  inside.insert(inside.begin(), outside.back());
  builder.lathe(inside, plain(look.accent), 48);
  return {builder.take(), 0.2};
}

Built plate(const Look& look) {
  ShapeBuilder builder;
  const std::vector<Vector2d> rim = {{0, 0},        {0.07, 0},     {0.075, 0.004},
                                     {0.12, 0.018}, {0.12, 0.022}, {0.082, 0.010}};
  builder.lathe(rim, plain(look.color), 56);
  builder.lathe({{0.082, 0.010}, {0.074, 0.007}}, plain(look.accent), 56);
  builder.lathe({{0.074, 0.007}, {0, 0.007}}, plain(look.color), 56);
  return {builder.take(), 0.32};
}

Built can(const Look& look) {
  ShapeBuilder builder;
  constexpr double r = 0.033, h = 0.115;
  round_body(builder, r, 0.006, h - 0.006, look);
  const Rgba tin(0.75F, 0.75F, 0.76F, 1);
  builder.lathe({{r, h - 0.006}, {r * 0.93, h}, {r * 0.88, h}, {r * 0.86, h - 0.004}, {0, h - 0.004}},
                plain(tin));
  return {builder.take(), 1};
}

Built jar(const Look& look) {
  ShapeBuilder builder;
  constexpr double r = 0.045, h = 0.085;
  round_body(builder, r, 0.006, h, look);
  builder.lathe({{r, h}, {r + 0.002, h}, {r + 0.002, h + 0.02}, {r - 0.004, h + 0.024}, {0, h + 0.024}},
                plain(look.accent));
  return {builder.take(), 1};
}

Built bottle(const Look& look) {
  ShapeBuilder builder;
  constexpr double r = 0.036;
  round_body(builder, r, 0.006, 0.15, look);
  std::vector<Vector2d> shoulder;
  for (int i = 0; i <= 8; ++i) {
    const double s = i / 8.0;
    shoulder.emplace_back(0.014 + (r - 0.014) * 0.5 * (1 + std::cos(kPi * s)), 0.15 + 0.06 * s);
  }
  shoulder.emplace_back(0.014, 0.235);
  builder.lathe(shoulder, plain(look.color));
  builder.lathe({{0.014, 0.235}, {0.016, 0.235}, {0.016, 0.258}, {0, 0.258}}, plain(look.accent));
  return {builder.take(), 1};
}

Built pot(const Look& look) {
  ShapeBuilder builder;
  constexpr double r = 0.095, h = 0.11, wall = 0.004;
  round_body(builder, r, 0.008, h, look);
  builder.lathe({{r, h}, {r - wall, h}, {r - wall, 0.012}, {r - 0.02, 0.006}, {0, 0.006}}, plain(look.accent),
                48);
  for (const double side : {-1.0, 1.0}) {
    std::vector<Vector3d> path;
    for (int i = 0; i <= 10; ++i) {
      const double angle = kPi * i / 10;
      path.emplace_back(side * (r - 0.004 + 0.03 * std::sin(angle)), 0.035 * std::cos(angle), h - 0.025);
    }
    builder.tube(path, std::vector<double>(path.size(), 0.006), Vector3d::UnitZ(), look.accent);
  }
  return {builder.take(), 0.1};
}

Built banana(const Look& look) {
  ShapeBuilder builder;
  std::vector<Vector3d> path;
  std::vector<double> radii;
  for (int i = 0; i <= 16; ++i) {
    const double s = i / 16.0, angle = kPi * (0.25 + 0.5 * s);
    path.emplace_back(0.13 * std::cos(angle), 0.13 * std::sin(angle) - 0.11, 0.019);
    radii.push_back(0.005 + 0.014 * std::pow(std::sin(kPi * std::clamp(s, 0.03, 0.97)), 0.6));
  }
  builder.tube(path, radii, Vector3d::UnitZ(), look.color);
  builder.tube({path.back(), path.back() + 0.02 * (path[16] - path[15]).normalized()}, {0.006, 0.004},
               Vector3d::UnitZ(), look.accent);
  return {builder.take(), 1};
}

Built apple(const Look& look) {
  ShapeBuilder builder;
  std::vector<Vector2d> profile;
  for (int i = 0; i <= 16; ++i) {
    const double angle = -kPi / 2 + kPi * i / 16;
    profile.emplace_back(0.037 * std::cos(angle) * (1 + 0.08 * std::sin(angle)),
                         0.034 + 0.034 * std::sin(angle));
  }
  profile.front().x() = profile.back().x() = 0;
  builder.lathe(profile, look.around);
  builder.tube({{0, 0, 0.066}, {0.004, 0, 0.08}}, {0.002, 0.002}, Vector3d::UnitY(), look.accent);
  return {builder.take(), 1};
}

/// Flat cutlery with a broad end.
Built cutlery(const Look& look) {
  ShapeBuilder builder;
  builder.box({-0.10, -0.007, 0}, {0.045, 0.007, 0.006}, look.color);
  builder.box({0.045, -0.018, 0}, {0.10, 0.018, 0.006}, look.accent);
  return {builder.take(), 1};
}

Built box(const Look& look) {
  ShapeBuilder builder;
  const Vector3d size = look.size.value_or(Vector3d(0.16, 0.06, 0.22));
  const Vector3d low(-size.x() / 2, -size.y() / 2, 0);
  constexpr double cell = 0.0025;
  const auto cells = [&](double length) { return std::clamp(static_cast<int>(length / cell), 1, 200); };
  if (look.detailed)
    builder.box(low, low + size, look.color, look.front, cells(size.x()), cells(size.z()));
  else
    builder.box(low, low + size, look.color);
  return {builder.take(), 1};
}

using Builder = Built (*)(const Look&);

const std::map<std::string, Builder>& builders() {
  static const std::map<std::string, Builder> table = {
      {"mug", mug},       {"bowl", bowl},       {"plate", plate}, {"can", can},
      {"jar", jar},       {"bottle", bottle},   {"pot", pot},     {"box", box},
      {"banana", banana}, {"cutlery", cutlery}, {"apple", apple}};
  return table;
}

/// Patterns over u and v in [0,1].
const std::map<std::string, std::function<bool(double, double)>>& patterns() {
  static const std::map<std::string, std::function<bool(double, double)>> table = {
      {"band", [](double, double v) { return v > 0.35 && v < 0.7; }},
      {"stripes", [](double, double v) { return std::fmod(v * 5, 1.0) < 0.5; }},
      {"checker",
       [](double u, double v) { return (static_cast<int>(u * 12) + static_cast<int>(v * 6)) % 2 == 0; }},
      {"dots", [](double u, double v) {
         const double x = std::fmod(u * 10, 1.0) - 0.5, y = std::fmod(v * 5, 1.0) - 0.5;
         return x * x + y * y < 0.08;
       }}};
  return table;
}

Paint image_paint(const std::filesystem::path& path) {
  const cv::Mat image = read_color(path);
  return [image](double u, double v) {
    const int x = std::clamp(static_cast<int>(u * image.cols), 0, image.cols - 1);
    const int y = std::clamp(static_cast<int>((1 - v) * image.rows), 0, image.rows - 1);
    const auto& bgr = image.at<cv::Vec3b>(y, x);
    return Rgba(static_cast<float>(bgr[2]) / 255, static_cast<float>(bgr[1]) / 255,
                static_cast<float>(bgr[0]) / 255, 1);
  };
}

Look look_of(const ObjectSpec& spec) {
  Look look;
  look.size = spec.size;
  look.color = spec.color;
  look.accent =
      spec.accent.value_or(Rgba(spec.color.x() * 0.7F, spec.color.y() * 0.7F, spec.color.z() * 0.7F, 1));
  look.around = look.front = plain(spec.color);
  look.detailed = !spec.pattern.empty() || !spec.label.empty();
  if (!spec.pattern.empty()) {
    const auto inside = patterns().at(spec.pattern);
    look.around = look.front = [inside, color = spec.color, accent = look.accent](double u, double v) {
      return inside(u, v) ? accent : color;
    };
  }
  if (!spec.label.empty()) look.around = look.front = image_paint(spec.label);
  return look;
}

/// Brings a mesh to the wanted extents, with its origin in the middle of its bottom.
void fit(ObjectModel& model, const std::optional<Vector3d>& size) {
  Eigen::AlignedBox3f bounds;
  for (const auto& vertex : model.mesh.vertices) bounds.extend(vertex);
  Eigen::Vector3f scale = Eigen::Vector3f::Ones();
  if (size) scale = size->cast<float>().cwiseQuotient(bounds.sizes());
  const Eigen::Vector3f base(0, 0, bounds.min().z());
  for (auto& vertex : model.mesh.vertices) vertex = (vertex - base).cwiseProduct(scale);
  model.low = (bounds.min() - base).cwiseProduct(scale).cast<double>();
  model.high = (bounds.max() - base).cwiseProduct(scale).cast<double>();
}

template <class Map>
std::vector<std::string> names_of(const Map& map) {
  std::vector<std::string> names;
  for (const auto& entry : map) names.push_back(entry.first);
  return names;
}

}  // namespace

std::vector<std::string> object_models() {
  return names_of(builders());
}

std::vector<std::string> object_patterns() {
  return names_of(patterns());
}

ObjectModel build_object(const ObjectSpec& spec) {
  const auto builder = builders().find(spec.model);
  if (builder == builders().end())
    throw Error("unknown model '" + spec.model + "'", {}, did_you_mean(spec.model, object_models()));
  Built built = builder->second(look_of(spec));
  ObjectModel model;
  model.mesh = std::move(built.mesh);
  fit(model, spec.size);
  model.top = model.high.z() * built.top_share;
  return model;
}

}  // namespace loci::mapping
