// What is round about an axis: cans, bottles, crockery, cookware.

#include <algorithm>
#include <cmath>

#include "mapping/base/math/math.h"
#include "mapping/simulation/household_shapes.h"

namespace loci::mapping::household {

void HouseholdShapes::can() {
  const double r = between(0.026, 0.055), h = std::clamp(r * between(1.9, 6.5), 0.07, 0.26);
  const Rgba tin = chance(draw_, 0.7) ? metal() : any_color();
  const Rgba label = any_color();
  solid({{0, 0}, {0.93 * r, 0}, {r, 0.004}, {r, h - 0.004}}, printed(draw_, label, 5));
  const double sunk = chance(draw_, 0.6) ? between(0.002, 0.005) : 0;
  solid({{r, h - 0.004}, {0.95 * r, h}, {0.9 * r, h}, {0.88 * r, h - sunk}, {0, h - sunk}}, plain(tin));
  room_ = 0.9 * r;
  lying_ = 0.2;
}

void HouseholdShapes::tin() {
  const double r = between(0.045, 0.13), h = std::clamp(r * between(0.3, 1.0), 0.03, 0.12);
  const double lid = between(0.5, 0.9) * h, out = between(0, 0.002);
  const Rgba color = any_color();
  solid({{0, 0}, {r, 0}, {r, lid}}, printed(draw_, color, 5));
  solid({{r, lid}, {r + out, lid}, {r + out, h}}, printed(draw_, color, 3));
  const Rgba cover = chance(draw_, 0.5) ? color : metal();
  solid({{r + out, h}, {0, h}}, printed(draw_, cover, 5));
  room_ = 0.95 * r;
  lying_ = 0.2;
}

void HouseholdShapes::jar() {
  const double r = between(0.028, 0.06), h = r * between(1.7, 4.2), lid = between(0.012, 0.03),
               neck = r * between(0.75, 1.02);
  const Rgba glass = chance(draw_, 0.5) ? near_hue(30, 40) : any_color();
  const Rgba cap = any_color();
  const double shoulder = h - lid - between(0.003, 0.02);
  solid({{0, 0}, {0.92 * r, 0}, {r, 0.006}, {r, shoulder}, {neck, h - lid}}, printed(draw_, glass, 4));
  solid({{neck, h - lid}, {neck + 0.003, h - lid}, {neck + 0.003, h - 0.003}, {neck, h}, {0, h}}, plain(cap));
  room_ = 0.9 * neck;
  lying_ = 0.12;
}

void HouseholdShapes::bottle() {
  const double r = between(0.028, 0.048), h = r * between(5, 8.5), neck = between(0.011, 0.018),
               body = h * between(0.5, 0.72), slope = std::min(h - body - 0.03, between(0.03, 0.1)),
               cap = between(0.012, 0.025);
  const Rgba color = chance(draw_, 0.3) ? hsv(0, 0, {0.7, 1}) : any_color();
  solid({{0, 0}, {0.9 * r, 0}, {r, 0.006}, {r, body}}, printed(draw_, color, 4));
  Profile shoulder;
  for (int i = 0; i <= 8; ++i) {
    const double s = i / 8.0;
    shoulder.emplace_back(neck + (r - neck) * 0.5 * (1 + std::cos(kPi * s)), body + slope * s);
  }
  shoulder.emplace_back(neck, h - cap);
  solid(shoulder, plain(color));
  solid({{neck, h - cap}, {neck + 0.002, h - cap}, {neck + 0.002, h}, {0, h}}, plain(any_color()));
  lying_ = 0.15;
}

void HouseholdShapes::kitchen_roll() {
  const double r = between(0.045, 0.07), h = between(0.2, 0.28), core = between(0.018, 0.025);
  const Rgba paper = hsv({0, 360}, {0, 0.06}, {0.85, 1});
  solid({{core, 0}, {r, 0}, {r, h}, {core, h}, {core, 0.01}, {0, 0.01}}, printed(draw_, paper, 1));
  lying_ = 0.3;
}

void HouseholdShapes::cup(const std::string& name) {
  const bool glass = name == "glass", mug = name == "mug";
  const double r = glass ? between(0.028, 0.044) : between(0.034, 0.052),
               h = glass ? r * between(2.6, 4.6) : r * between(1.35, 2.55),
               foot = r * (mug ? between(0.8, 1.05) : between(0.6, 1)), wall = between(0.002, 0.006);
  const Rgba color = glass ? hsv({150, 240}, {0, 0.25}, {0.5, 0.9}) : glaze();
  const double bend = between(0, 0.25);
  Profile outside = {{0, 0}, {foot, 0}};
  for (int i = 1; i <= 6; ++i) {
    const double s = i / 6.0;
    outside.emplace_back(foot + (r - foot) * s + bend * (r - foot) * std::sin(kPi * s), h * s);
  }
  const bool print = !glass && chance(draw_, 0.4);
  const Rgba inside = chance(draw_, 0.7) ? color : glaze();
  hollow(outside, wall, print ? printed(draw_, color, 4) : plain(color), inside);
  if (mug) {
    const double low = between(0.15, 0.3) * h, high = between(0.7, 0.92) * h;
    const double out = between(0.02, 0.037), thick = between(0.0035, 0.007);
    ear(foot + (r - foot) * low / h, low, foot + (r - foot) * high / h, high, out, thick,
        chance(draw_, 0.85) ? color : any_color());
  }
  turned_ = 0.2;
  lying_ = 0.04;
}

void HouseholdShapes::bowl() {
  const double r = between(0.05, 0.13), h = std::clamp(r * between(0.42, 1.2), 0.035, 0.12),
               foot = r * between(0.35, 0.65), stand = between(0, 0.1) * h, power = between(1.3, 3.2),
               wall = between(0.003, 0.006);
  const Rgba color = glaze();
  Profile outside = {{0, 0}, {foot, 0}, {foot, stand + 0.001}};
  for (int i = 1; i <= 10; ++i) {
    const double s = i / 10.0;
    outside.emplace_back(foot + (r - foot) * std::pow(1 - std::pow(1 - s, power), 1 / power),
                         stand + (h - stand) * s);
  }
  const Rgba inside = chance(draw_, 0.6) ? color : glaze();
  hollow(outside, wall, printed(draw_, color, 2), inside);
  foot_ = foot;
  turned_ = 0.25;
}

void HouseholdShapes::plate() {
  const double r = between(0.075, 0.15), h = between(0.012, 0.035), foot = r * between(0.5, 0.72),
               wall = between(0.003, 0.005);
  const Rgba color = glaze(), inside = chance(draw_, 0.7) ? color : any_color();
  hollow({{0, 0}, {foot, 0}, {foot + 0.004, 0.25 * h}, {r, h}}, wall, plain(color), inside);
  turned_ = 0.04;
}

void HouseholdShapes::pot() {
  const double r = between(0.065, 0.135), h = r * between(0.6, 1.35), wall = between(0.002, 0.004),
               high = between(0.6, 0.92) * h, taper = between(0.85, 1);
  const Rgba color = cookware(), handle = chance(draw_, 0.5) ? color : hsv(0, 0, {0.05, 0.3});
  const Rgba inside = chance(draw_, 0.5) ? color : metal();
  hollow({{0, 0}, {0.9 * taper * r, 0}, {taper * r, 0.01}, {r, h}}, wall, printed(draw_, color, 1), inside);
  const double out = between(0.02, 0.045), wide = between(0.025, 0.05), thick = between(0.004, 0.008);
  for (const double side : {-1.0, 1.0}) {
    std::vector<Vector3d> path;
    for (int i = 0; i <= 10; ++i)
      path.emplace_back(side * (r - 0.004 + out * std::sin(kPi * i / 10)), wide * std::cos(kPi * i / 10),
                        high);
    builder_.tube(path, std::vector<double>(path.size(), thick), Vector3d::UnitZ(), handle);
  }
  if (chance(draw_, 0.3)) {  // With its lid.
    solid({{r, h}, {0.6 * r, h + 0.012}, {0, h + 0.018}}, plain(color));
    solid({{0.012, h + 0.018}, {0.018, h + 0.04}, {0, h + 0.042}}, plain(handle));
  } else {
    turned_ = 0.25;
  }
}

void HouseholdShapes::pan() {
  const double r = between(0.085, 0.15), h = between(0.03, 0.075), taper = between(0.75, 0.98),
               wall = between(0.002, 0.004), length = between(0.12, 0.21), high = between(0.6, 0.95) * h;
  const Rgba color = chance(draw_, 0.7) ? hsv(0, 0, {0.08, 0.4}) : cookware();
  hollow({{0, 0}, {taper * r, 0}, {r, h}}, wall, plain(color),
         chance(draw_, 0.6) ? color : hsv(0, 0, {0.05, 0.3}));
  const double thick = between(0.006, 0.012);
  const double middle = high + between(0, 0.02), end = middle + between(0, 0.02);
  builder_.tube({{r - 0.006, 0, high}, {r + length / 2, 0, middle}, {r + length, 0, end}},
                {thick, thick, thick}, Vector3d::UnitY(), chance(draw_, 0.5) ? color : hsv(20, 0.4, 0.3));
}

void HouseholdShapes::kettle() {
  const double r = between(0.065, 0.1), h = r * between(1.2, 2.0), top = r * between(0.4, 0.75);
  const Rgba color = cookware(), handle = hsv(0, 0, {0.05, 0.4});
  Profile outside = {{0, 0}, {0.95 * r, 0}};
  for (int i = 0; i <= 8; ++i) {
    const double s = i / 8.0;
    outside.emplace_back(r - (r - top) * s * s, 0.01 + (h - 0.01) * s);
  }
  outside.emplace_back(0, h + 0.01);
  solid(outside, plain(color));
  builder_.tube({{0, 0, h + 0.005}, {0, 0, h + 0.025}}, {0.014, 0.01}, Vector3d::UnitY(), handle);
  const double from = 0.55 * h;
  builder_.tube({{-0.8 * r, 0, from}, {-1.25 * r, 0, 0.8 * h}, {-1.5 * r, 0, 0.98 * h}},
                {0.016, 0.012, 0.009}, Vector3d::UnitY(), color);
  if (chance(draw_, 0.5)) {
    ear(r, 0.2 * h, top, 0.92 * h, between(0.04, 0.065), 0.009, handle);
  } else {
    std::vector<Vector3d> arch;
    for (int i = 0; i <= 12; ++i)
      arch.emplace_back(0.9 * r * std::cos(kPi * i / 12), 0,
                        0.85 * h + 0.9 * r * std::sin(kPi * i / 12) + 0.02);
    builder_.tube(arch, std::vector<double>(arch.size(), 0.008), Vector3d::UnitY(), handle);
  }
}

void HouseholdShapes::teapot() {
  const double r = between(0.05, 0.085), flat = between(0.75, 1.05), h = 1.8 * r * flat;
  const Rgba color = glaze();
  Profile outside;
  for (int i = 0; i <= 14; ++i) {
    const double angle = -0.42 * kPi + 0.86 * kPi * i / 14;
    outside.emplace_back(r * std::cos(angle), flat * r * (std::sin(angle) + std::sin(0.42 * kPi)));
  }
  outside.front().x() = 0;
  outside.back().x() = 0;
  solid(outside, printed(draw_, color, 2));
  builder_.tube({{0, 0, h - 0.004}, {0, 0, h + 0.022}}, {0.012, 0.009}, Vector3d::UnitY(), color);
  builder_.tube({{-0.85 * r, 0, 0.4 * h}, {-1.4 * r, 0, 0.6 * h}, {-1.75 * r, 0, 0.92 * h}},
                {0.014, 0.01, 0.008}, Vector3d::UnitY(), color);
  ear(0.8 * r, 0.25 * h, 0.8 * r, 0.8 * h, between(0.03, 0.05), 0.006, color);
}

void HouseholdShapes::jug() {
  const double r = between(0.045, 0.075), h = r * between(2.3, 3.6), neck = r * between(0.65, 1.0),
               wall = between(0.003, 0.005);
  const Rgba color = glaze();
  Profile outside = {{0, 0}, {0.8 * r, 0}};
  for (int i = 1; i <= 8; ++i) {
    const double s = i / 8.0;
    outside.emplace_back(s < 0.5 ? 0.8 * r + 0.2 * r * std::sin(kPi * s) : r - (r - neck) * (2 * s - 1),
                         h * s);
  }
  hollow(outside, wall, printed(draw_, color, 2), color);
  const double out = between(0.035, 0.055), thick = between(0.005, 0.009);
  ear(r, 0.2 * h, neck, 0.88 * h, out, thick, color);
}

}  // namespace loci::mapping::household
