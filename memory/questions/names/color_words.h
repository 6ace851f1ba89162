#pragma once

#include <string>
#include <vector>

namespace loci::memory {

/// Whether it is a name of mapping::color_name(), or "gray".
bool is_color_word(const std::string& word);

/// "gray" as "grey", others as they are.
std::string same_color(const std::string& word);

/// Whether a colour as it was seen or stated ("dark blue") is the one of a basic name ("blue").
bool has_color(const std::string& color, const std::string& name);

/// Whether light and shade, or people, make one of two colours of the other: "white", "grey".
bool are_similar_colors(const std::string& a, const std::string& b);

/// How far a hue is from those of a basic colour, degrees; infinite for black, white, grey and unknown words.
double degrees_from_color(double hue, const std::string& color);

/// Replaces what people call a colour by its basic colour: "maroon", "reddish", "dark red" by "red".
void name_basic_colors(std::vector<std::string>& words);

}  // namespace loci::memory
