#pragma once

#include <string>
#include <vector>

#include "mapping/simulation/household.h"
#include "mapping/simulation/shapes.h"

namespace loci::mapping::household {

/// From which a number is drawn.
struct Range {
  Range(double value) : low(value), high(value) {}
  Range(double l, double h) : low(l), high(h) {}
  double low, high;
};

bool chance(Random& draw, double probability);
double between(Random& draw, const Range& range);
/// In this order: hue in degrees, saturation, value.
Rgba drawn_color(Random& draw, const Range& hue, const Range& saturation, const Range& value);
Rgba any_color(Random& draw);
/// A printed surface: patches and bands of drawn colours on a ground.
Paint printed(Random& draw, const Rgba& ground, int max_patches);

/// Labels are painted on facets of this size, m.
inline constexpr double kPaintDetail = 0.006;

inline constexpr int kLatheSegments = 56;

/// Makes one object.
class HouseholdShapes {
 public:
  explicit HouseholdShapes(Random& draw) : draw_(draw) {}

  HouseholdObject of(const std::string& name);

 private:
  double between(double low, double high) { return draw_.uniform(low, high); }
  Vector3d size(const Range& x, const Range& y, const Range& z) {
    const double a = household::between(draw_, x), b = household::between(draw_, y);
    return {a, b, household::between(draw_, z)};
  }
  Rgba hsv(const Range& hue, const Range& saturation, const Range& value) {
    return drawn_color(draw_, hue, saturation, value);
  }
  Rgba any_color() { return household::any_color(draw_); }
  Rgba metal() { return hsv({0, 360}, {0, 0.08}, {0.3, 0.85}); }
  /// Crockery: mostly white, else of one colour.
  Rgba glaze() { return chance(draw_, 0.45) ? hsv({20, 70}, {0, 0.15}, {0.75, 1}) : any_color(); }
  Rgba cookware() { return chance(draw_, 0.65) ? metal() : any_color(); }
  Rgba near_hue(double hue, double spread) {
    return hsv({hue - spread, hue + spread}, {0.55, 0.95}, {0.5, 1});
  }

  void solid(const Profile& profile, const Paint& paint) {
    builder_.lathe(finely(profile, kPaintDetail), paint, kLatheSegments);
  }
  /// A vessel: `outside` from the axis up to the rim, and a wall of that thickness.
  void hollow(const Profile& outside, double wall, const Paint& paint, const Rgba& inside) {
    builder_.lathe(finely(outside, kPaintDetail), paint, kLatheSegments);
    Profile back = {outside.back()};
    for (size_t i = outside.size(); i-- > 1;)
      back.emplace_back(std::max(0.0, outside[i].x() - wall), std::max(outside[i].y(), 1.5 * wall));
    back.emplace_back(0, 1.5 * wall);
    builder_.lathe(back, plain(inside), kLatheSegments);
  }
  /// An ear at the side, from height `low` to `high`, that stands out.
  void ear(double radius_low, double low, double radius_high, double high, double out, double thickness,
           const Rgba& color) {
    std::vector<Vector3d> path;
    for (int i = 0; i <= 12; ++i) {
      const double s = i / 12.0, angle = kPi * s;
      path.emplace_back(radius_low + (radius_high - radius_low) * s - thickness / 2 + out * std::sin(angle),
                        0, (low + high) / 2 - (high - low) / 2 * std::cos(angle));
    }
    builder_.tube(path, std::vector<double>(path.size(), thickness), Vector3d::UnitY(), color);
  }
  void bar(const Vector3d& low, const Vector3d& high, const Rgba& color) { builder_.box(low, high, color); }

  void block(const Vector3d& size, const Rgba& ground, int patches);
  void box();
  void book();
  void sponge();
  void cutting_board();
  void carton();
  void can();
  void tin();
  void jar();
  void bottle();
  void kitchen_roll();
  void cup(const std::string& name);
  void bowl();
  void plate();
  void pot();
  void pan();
  void kettle();
  void teapot();
  void jug();
  void tray();
  void cutlery(const std::string& name);
  void fruit(const std::string& name);
  void banana();
  void other();

  HouseholdObject rest();

  Random& draw_;
  ShapeBuilder builder_;
  double room_ = 0;                ///< of what stands upright
  double foot_ = 0;                ///< of what is turned over
  bool any_side_ = false;          ///< a box: on any of its faces
  double lying_ = 0, turned_ = 0;  ///< probabilities
};

}  // namespace loci::mapping::household
