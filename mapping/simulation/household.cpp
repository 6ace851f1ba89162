#include "mapping/simulation/household.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "mapping/base/math/math.h"
#include "mapping/image/hsv.h"
#include "mapping/simulation/household_shapes.h"

namespace loci::mapping {
namespace household {

bool chance(Random& draw, double probability) {
  return draw.uniform() < probability;
}

double between(Random& draw, const Range& range) {
  return draw.uniform(range.low, range.high);
}

Rgba drawn_color(Random& draw, const Range& hue, const Range& saturation, const Range& value) {
  const double h = between(draw, hue), s = between(draw, saturation), v = between(draw, value);
  const std::array<float, 3> rgb = rgb_from_hsv(std::fmod(h + 360, 360), s, v);
  return {rgb[0], rgb[1], rgb[2], 1};
}

Rgba any_color(Random& draw) {
  return drawn_color(draw, {0, 360}, {0, 1}, {0.1, 1});
}

Paint printed(Random& draw, const Rgba& ground, int max_patches) {
  struct Patch {
    double u, v, width, height;
    bool round;
    Rgba color;
  };
  std::vector<Patch> patches;
  for (int i = static_cast<int>(draw.index(static_cast<uint64_t>(max_patches) + 1)); i > 0; --i)
    patches.push_back({draw.uniform(), draw.uniform(), chance(draw, 0.3) ? 2.0 : draw.uniform(0.03, 0.3),
                       draw.uniform(0.02, 0.3), chance(draw, 0.4), any_color(draw)});
  return [patches, ground](double u, double v) {
    Rgba color = ground;
    for (const Patch& patch : patches) {
      const double x = std::abs(std::remainder(u - patch.u, 1.0)) / patch.width,
                   y = std::abs(v - patch.v) / patch.height;
      if (patch.round ? x * x + y * y < 1 : std::max(x, y) < 1) color = patch.color;
    }
    return color;
  };
}

void HouseholdShapes::block(const Vector3d& size, const Rgba& ground, int patches) {
  // All faces carry a print: six thin plates around the body, each with its own.
  const Vector3d low(-size.x() / 2, -size.y() / 2, 0), high = low + size;
  const auto cells = [](double length) { return std::clamp(static_cast<int>(length / kPaintDetail), 1, 60); };
  const auto face = [&](const Vector3d& along, const Vector3d& up, const Vector3d& corner) {
    ShapeBuilder plate;
    plate.box({0, 0, 0}, {along.norm(), 1e-4, up.norm()}, ground, printed(draw_, ground, patches),
              cells(along.norm()), cells(up.norm()));
    TriangleMesh mesh = plate.take();
    Eigen::Matrix3d turn;
    turn << along.normalized(), up.normalized().cross(along.normalized()), up.normalized();
    for (auto& vertex : mesh.vertices) vertex = (turn * vertex.cast<double>() + corner).cast<float>();
    builder_.append(mesh);
  };
  const Vector3d x(size.x(), 0, 0), y(0, size.y(), 0), z(0, 0, size.z());
  builder_.box(low + Vector3d::Constant(2e-4), high - Vector3d::Constant(2e-4), ground);
  face(x, z, low);
  face(y, z, low + x);
  face(-x, z, low + x + y);
  face(-y, z, low + y);
  face(x, y, low + z);
  room_ = std::min(size.x(), size.y()) / 2;
}

void HouseholdShapes::box() {
  const Vector3d extents = size({0.05, 0.3}, {0.035, 0.16}, {0.04, 0.28});
  block(extents, any_color(), 6);
  any_side_ = true;
}

void HouseholdShapes::book() {
  const Vector3d extents = size({0.12, 0.24}, {0.17, 0.31}, {0.012, 0.05});
  block(extents, any_color(), 4);
  any_side_ = chance(draw_, 0.15);
}

void HouseholdShapes::sponge() {
  const Vector3d extents = size({0.08, 0.13}, {0.05, 0.085}, {0.02, 0.042});
  block(extents, near_hue(chance(draw_, 0.5) ? 55 : between(0, 360), 8), 0);
}

void HouseholdShapes::cutting_board() {
  const Vector3d extents = size({0.18, 0.42}, {0.12, 0.28}, {0.01, 0.03});
  block(extents, chance(draw_, 0.7) ? hsv({22, 42}, {0.3, 0.6}, {0.4, 0.85}) : any_color(), 0);
}

void HouseholdShapes::carton() {
  const double width = between(0.055, 0.1), depth = width * between(0.75, 1), body = between(0.13, 0.23),
               roof = chance(draw_, 0.6) ? between(0.02, 0.045) : 0;
  block({width, depth, body}, chance(draw_, 0.5) ? hsv(0, 0, {0.8, 1}) : any_color(), 4);
  if (roof > 0) {  // A gable, as slices that get thinner.
    const Rgba color = any_color();
    constexpr int kSlices = 10;
    for (int i = 0; i < kSlices; ++i) {
      const double half = depth / 2 * (1 - (i + 0.5) / kSlices), at = body + roof * i / kSlices;
      bar({-width / 2, -half, at}, {width / 2, half, at + roof / kSlices}, color);
    }
    bar({-width / 2, -0.002, body + roof}, {width / 2, 0.002, body + roof + 0.015}, color);
    room_ = 0;
  }
  lying_ = 0.15;
}

void HouseholdShapes::tray() {
  const double x = between(0.24, 0.45), y = between(0.18, 0.32), h = between(0.014, 0.04), wall = 0.006;
  const Rgba color = any_color();
  bar({-x / 2, -y / 2, 0}, {x / 2, y / 2, 0.006}, color);
  for (const double side : {-1.0, 1.0}) {
    const double at = side * (x / 2 - wall / 2), across = side * (y / 2 - wall / 2);
    bar({at - wall / 2, -y / 2, 0}, {at + wall / 2, y / 2, h}, color);
    bar({-x / 2, across - wall / 2, 0}, {x / 2, across + wall / 2, h}, color);
  }
}

void HouseholdShapes::cutlery(const std::string& name) {
  const double length = name == "spatula" ? between(0.24, 0.34) : between(0.15, 0.25),
               grip = length * between(0.4, 0.65), thick = between(0.006, 0.014), wide = between(0.009, 0.02);
  const Rgba steel = metal(), handle = chance(draw_, 0.5)   ? steel
                                       : chance(draw_, 0.5) ? hsv(0, 0, 0.12)
                                                            : any_color();
  const double end = length / 2, head = -end + grip, flat = between(0.004, 0.007);
  bar({-end, -wide / 2, 0}, {head, wide / 2, thick}, handle);
  if (name == "knife") {
    const double blade = between(0.016, 0.042);
    bar({head, -blade / 2, 0}, {end - 0.3 * (end - head), blade / 2, flat}, steel);
    for (int i = 0; i < 6; ++i) {  // The point.
      const double from = end - 0.3 * (end - head) * (1 - i / 6.0),
                   to = end - 0.3 * (end - head) * (1 - (i + 1) / 6.0);
      bar({from, -blade / 2, 0}, {to, blade / 2 - blade * (i + 0.5) / 6.5, flat}, steel);
    }
    return;
  }
  const double broad = name == "spatula" ? between(0.055, 0.09)
                       : name == "fork"  ? between(0.02, 0.028)
                                         : between(0.026, 0.045),
               depth = name == "spatula" ? between(0.07, 0.1)
                       : name == "fork"  ? between(0.05, 0.07)
                                         : broad * between(1.2, 1.7);
  const double neck = end - depth;
  if (neck > head) bar({head, -0.0045, 0}, {neck, 0.0045, flat}, steel);
  if (name == "fork") {
    bar({neck, -broad / 2, 0}, {neck + 0.35 * depth, broad / 2, flat + 0.003}, steel);
    const int tines = 3 + static_cast<int>(draw_.index(2));
    for (int i = 0; i < tines; ++i) {
      const double at = -broad / 2 + broad * (i + 0.5) / tines;
      bar({neck + 0.35 * depth, at - 0.0016, 0}, {end, at + 0.0016, flat + 0.003}, steel);
    }
  } else if (name == "spoon") {
    const double deep = between(0.006, 0.014);
    constexpr int kSlices = 12;
    for (int i = 0; i < kSlices; ++i) {
      const double s = (i + 0.5) / kSlices, half = broad * std::sqrt(std::max(0.02, s * (1 - s)));
      bar({neck + depth * i / kSlices, -half, 0}, {neck + depth * (i + 1) / kSlices, half, deep}, steel);
    }
  } else {
    bar({neck, -broad / 2, 0}, {end, broad / 2, flat}, chance(draw_, 0.5) ? handle : steel);
  }
}

void HouseholdShapes::fruit(const std::string& name) {
  const bool lemon = name == "lemon", pear = name == "pear", apple = name == "apple";
  const double r = lemon ? between(0.023, 0.034) : pear ? between(0.028, 0.042) : between(0.031, 0.05);
  const double tall = lemon   ? between(1.2, 1.5)
                      : pear  ? between(1.25, 1.6)
                      : apple ? between(0.82, 1.02)
                              : between(0.93, 1.02);
  const Rgba color = name == "orange"     ? near_hue(27, 7)
                     : lemon              ? near_hue(52, 6)
                     : pear               ? near_hue(70, 20)
                     : chance(draw_, 0.5) ? near_hue(0, 14)
                                          : near_hue(80, 25);
  Profile profile;
  for (int i = 0; i <= 18; ++i) {
    const double angle = -kPi / 2 + kPi * i / 18, s = (std::sin(angle) + 1) / 2;
    const double narrow = pear ? 1 - 0.42 * s * s : apple ? 1 + 0.08 * std::sin(angle) : 1;
    profile.emplace_back(r * std::cos(angle) * narrow, r * tall * (1 + std::sin(angle)));
  }
  profile.front().x() = profile.back().x() = 0;
  solid(profile, apple ? printed(draw_, color, 0) : plain(color));
  if (apple || pear)
    builder_.tube({{0, 0, 2 * r * tall - 0.004}, {0.004, 0, 2 * r * tall + 0.012}}, {0.002, 0.002},
                  Vector3d::UnitY(), hsv(30, 0.5, 0.25));
  lying_ = lemon ? 1 : pear ? 0.5 : 0.2;
}

void HouseholdShapes::banana() {
  const double radius = between(0.1, 0.18), length = between(0.14, 0.21), thick = between(0.013, 0.02);
  const double half = length / radius / 2;
  std::vector<Vector3d> path;
  std::vector<double> radii;
  for (int i = 0; i <= 16; ++i) {
    const double s = i / 16.0, angle = kPi / 2 - half + 2 * half * s;
    path.emplace_back(radius * std::cos(angle), radius * (std::sin(angle) - std::cos(half / 2)), thick);
    radii.push_back(0.004 + thick * std::pow(std::sin(kPi * std::clamp(s, 0.02, 0.98)), 0.55) * 0.8);
  }
  builder_.tube(path, radii, Vector3d::UnitZ(), near_hue(50, 8));
}

void HouseholdShapes::other() {
  const Rgba color = any_color();
  switch (draw_.index(7)) {
    case 0: {  // keyboard, telephone, remote control
      const Vector3d extents = size({0.1, 0.46}, {0.04, 0.17}, {0.008, 0.03});
      block(extents, hsv(0, 0, {0.05, 0.9}), 6);
    } break;
    case 1: {  // computer mouse, stone
      Profile profile;
      const double r = between(0.025, 0.06), h = r * between(0.5, 0.9);
      for (int i = 0; i <= 10; ++i)
        profile.emplace_back(r * std::cos(kPi / 2 * i / 10), h * std::sin(kPi / 2 * i / 10));
      solid(profile, plain(color));
      TriangleMesh mesh = builder_.take();
      const auto stretch = static_cast<float>(between(1.1, 2.2));
      for (auto& vertex : mesh.vertices) vertex.x() *= stretch;
      builder_.append(mesh);
      break;
    }
    case 2:  // a screen on its foot
      bar({-0.09, -0.07, 0}, {0.09, 0.07, 0.015}, color);
      bar({-0.03, -0.01, 0.015}, {0.03, 0.01, 0.1}, color);
      {
        const Vector3d screen = size({0.1, 0.25}, 0, {0.2, 0.4});
        bar({-screen.x(), -0.02, 0.08}, {screen.x(), 0.01, screen.z()}, hsv(0, 0, 0.1));
      }
      break;
    case 3: {  // cable, hose, toy
      std::vector<Vector3d> path;
      double heading = between(0, 6), bend = 0;
      Vector3d at(-0.08, 0, 0);
      const double thick = between(0.005, 0.02);
      at.z() = thick;
      for (int i = 0; i < 20; ++i) {
        path.push_back(at);
        bend = std::clamp(bend + between(-0.5, 0.5), -0.8, 0.8);
        heading += bend;
        at += 0.016 * Vector3d(std::cos(heading), std::sin(heading), 0);
      }
      builder_.tube(path, std::vector<double>(path.size(), thick), Vector3d::UnitZ(), color);
      break;
    }
    case 4:  // boxes grown together
      for (int i = 0; i < 3; ++i) {
        const Vector3d middle = size({-0.06, 0.06}, {-0.06, 0.06}, 0);
        const Vector3d half = size({0.02, 0.09}, {0.02, 0.09}, 0);
        const double height = between(0.03, 0.22);
        bar(middle - half, middle + half + Vector3d(0, 0, height), any_color());
      }
      break;
    case 5: {  // turned: candlestick, lamp, figure
      Profile profile = {{0, 0}};
      const int rings = 4 + static_cast<int>(draw_.index(5));
      const double h = between(0.08, 0.35);
      for (int i = 0; i < rings; ++i) profile.emplace_back(between(0.012, 0.09), h * i / rings);
      profile.emplace_back(0, h);
      solid(profile, printed(draw_, color, 3));
      break;
    }
    default:  // a toaster, a machine: a box too large for what is handled
    {
      const Vector3d extents = size({0.2, 0.4}, {0.15, 0.35}, {0.16, 0.4});
      block(extents, cookware(), 5);
    } break;
  }
}

HouseholdObject HouseholdShapes::rest() {
  TriangleMesh mesh = builder_.take();
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  const double kind = draw_.uniform();
  if (kind < lying_)
    turn = (Eigen::AngleAxisd(kPi / 2, Vector3d::UnitY()) *
            Eigen::AngleAxisd(between(0, 2 * kPi), Vector3d::UnitZ()))
               .toRotationMatrix();
  else if (kind < lying_ + turned_)
    turn = Eigen::AngleAxisd(kPi, Vector3d::UnitX()).toRotationMatrix();
  else if (any_side_)
    turn = (Eigen::AngleAxisd(kPi / 2 * static_cast<double>(draw_.index(2)), Vector3d::UnitX()) *
            Eigen::AngleAxisd(kPi / 2 * static_cast<double>(draw_.index(2)), Vector3d::UnitY()))
               .toRotationMatrix();
  const bool upright = turn.isIdentity();
  const bool turned_over = kind >= lying_ && kind < lying_ + turned_;
  Eigen::AlignedBox3f bounds;
  for (auto& vertex : mesh.vertices) bounds.extend(vertex = turn.cast<float>() * vertex);
  const Eigen::Vector3f base(bounds.center().x(), bounds.center().y(), bounds.min().z());
  HouseholdObject object;
  for (auto& vertex : mesh.vertices) {
    vertex -= upright ? Eigen::Vector3f(0, 0, base.z()) : base;
    object.reach = std::max(object.reach, static_cast<double>(vertex.head<2>().norm()));
  }
  object.top = static_cast<double>(bounds.sizes().z());
  if (upright)
    object.room = room_;
  else if (any_side_)
    object.room = static_cast<double>(bounds.sizes().head<2>().minCoeff()) / 2;
  if (turned_over) object.foot = foot_;
  object.mesh = std::move(mesh);
  return object;
}

HouseholdObject HouseholdShapes::of(const std::string& name) {
  using Maker = void (*)(HouseholdShapes&, const std::string&);
  static const std::map<std::string, Maker> makers = {
      {"apple", [](HouseholdShapes& d, const std::string& n) { d.fruit(n); }},
      {"banana", [](HouseholdShapes& d, const std::string&) { d.banana(); }},
      {"book", [](HouseholdShapes& d, const std::string&) { d.book(); }},
      {"bottle", [](HouseholdShapes& d, const std::string&) { d.bottle(); }},
      {"bowl", [](HouseholdShapes& d, const std::string&) { d.bowl(); }},
      {"box", [](HouseholdShapes& d, const std::string&) { d.box(); }},
      {"can", [](HouseholdShapes& d, const std::string&) { d.can(); }},
      {"carton", [](HouseholdShapes& d, const std::string&) { d.carton(); }},
      {"cup", [](HouseholdShapes& d, const std::string& n) { d.cup(n); }},
      {"cutting board", [](HouseholdShapes& d, const std::string&) { d.cutting_board(); }},
      {"fork", [](HouseholdShapes& d, const std::string& n) { d.cutlery(n); }},
      {"glass", [](HouseholdShapes& d, const std::string& n) { d.cup(n); }},
      {"jar", [](HouseholdShapes& d, const std::string&) { d.jar(); }},
      {"jug", [](HouseholdShapes& d, const std::string&) { d.jug(); }},
      {"kettle", [](HouseholdShapes& d, const std::string&) { d.kettle(); }},
      {"kitchen roll", [](HouseholdShapes& d, const std::string&) { d.kitchen_roll(); }},
      {"knife", [](HouseholdShapes& d, const std::string& n) { d.cutlery(n); }},
      {"lemon", [](HouseholdShapes& d, const std::string& n) { d.fruit(n); }},
      {"mug", [](HouseholdShapes& d, const std::string& n) { d.cup(n); }},
      {"orange", [](HouseholdShapes& d, const std::string& n) { d.fruit(n); }},
      {"pan", [](HouseholdShapes& d, const std::string&) { d.pan(); }},
      {"pear", [](HouseholdShapes& d, const std::string& n) { d.fruit(n); }},
      {"plate", [](HouseholdShapes& d, const std::string&) { d.plate(); }},
      {"pot", [](HouseholdShapes& d, const std::string&) { d.pot(); }},
      {"spatula", [](HouseholdShapes& d, const std::string& n) { d.cutlery(n); }},
      {"sponge", [](HouseholdShapes& d, const std::string&) { d.sponge(); }},
      {"spoon", [](HouseholdShapes& d, const std::string& n) { d.cutlery(n); }},
      {"teapot", [](HouseholdShapes& d, const std::string&) { d.teapot(); }},
      {"tin", [](HouseholdShapes& d, const std::string&) { d.tin(); }},
      {"tray", [](HouseholdShapes& d, const std::string&) { d.tray(); }}};
  const auto maker = makers.find(name);
  if (maker == makers.end())
    other();
  else
    maker->second(*this, name);
  return rest();
}

}  // namespace household

const std::vector<std::string>& household_classes() {
  static const std::vector<std::string> names = {
      "apple",   "banana",        "book",  "bottle", "bowl", "box",  "can",    "carton",
      "cup",     "cutting board", "fork",  "glass",  "jar",  "jug",  "kettle", "kitchen roll",
      "knife",   "lemon",         "mug",   "orange", "pan",  "pear", "plate",  "pot",
      "spatula", "sponge",        "spoon", "teapot", "tin",  "tray"};
  return names;
}

HouseholdObject draw_household_object(const std::string& class_name, Random& draw) {
  return household::HouseholdShapes(draw).of(class_name);
}

}  // namespace loci::mapping
