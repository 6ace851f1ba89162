#include "mapping/image/hsv.h"

#include <algorithm>
#include <cmath>

namespace loci::mapping {

const char* color_name(float hue, float saturation, float value) {
  if (value < 0.2f) return "black";
  // Daylight tints white objects blue; people call a warm tint of that strength a colour (beige).
  const bool cool = hue >= 180 && hue < 270 && value > 0.5f;
  if (saturation < (cool ? 0.26f : 0.15f) || (saturation < 0.25f && value < 0.35f))
    return value > 0.72f ? "white" : value > 0.3f ? "grey" : "black";
  if (hue < 14 || hue >= 345) {
    if (saturation < 0.5f && value > 0.7f) return "pink";
    return value < 0.35f ? "brown" : "red";
  }
  if (hue < 42) return value < 0.6f ? "brown" : saturation < 0.35f ? "beige" : "orange";
  if (hue < 68) return value < 0.4f ? "brown" : saturation < 0.3f ? "beige" : "yellow";
  if (hue < 165) return "green";
  if (hue < 195) return "cyan";
  if (hue < 255) return "blue";
  if (hue < 300) return "purple";
  return saturation < 0.75f && value > 0.5f ? "pink" : "purple";
}

std::array<float, 3> rgb_from_hsv(double hue, double saturation, double value) {
  const auto channel = [&](double n) {
    const double k = std::fmod(n + hue / 60, 6.0);
    return static_cast<float>(value - value * saturation * std::clamp(std::min(k, 4 - k), 0.0, 1.0));
  };
  return {channel(5), channel(3), channel(1)};
}

std::array<uint8_t, 3> rgb8_from_hsv(double hue, double saturation, double value) {
  std::array<uint8_t, 3> rgb{};
  const std::array<float, 3> levels = rgb_from_hsv(hue, saturation, value);
  for (size_t i = 0; i < rgb.size(); ++i)
    rgb[i] = static_cast<uint8_t>(std::lround(std::clamp(levels[i], 0.0F, 1.0F) * 255));
  return rgb;
}

}  // namespace loci::mapping
