#pragma once

#include <array>
#include <cstdint>

namespace loci::mapping {

/// The name of a colour: hue 0 to 360 degrees, saturation and value 0 to 1.
const char* color_name(float hue, float saturation, float value);

/// Red, green and blue, 0 to 1, of hue 0 to 360 degrees, saturation and value 0 to 1.
std::array<float, 3> rgb_from_hsv(double hue, double saturation, double value);
std::array<uint8_t, 3> rgb8_from_hsv(double hue, double saturation, double value);  ///< 0 to 255

/// Of what has a colour that is not known.
inline constexpr std::array<uint8_t, 3> kUnknownRgb = {160, 160, 160};

}  // namespace loci::mapping
