#pragma once

#include <string>

namespace tinyxml2 {
class XMLDocument;
class XMLElement;
}  // namespace tinyxml2

namespace loci::mapping::urdf_detail {

/// The text of an XML file in UTF-8: Latin-1 is converted where the file declares it. Error with the line for
/// other text.
std::string utf8_text(const std::string& text, const std::string& file);

/// Parses XML; Error with the line when it is none.
void parse_xml(tinyxml2::XMLDocument& document, const std::string& text, const std::string& file);

/// Refuses what urdfdom refuses, and what it lets pass although it is no tree or no number, with the line and
/// the names: urdfdom's own messages have neither lines nor, for cycles, names. Returns the robot element.
const tinyxml2::XMLElement& check_urdf(const tinyxml2::XMLDocument& document, const std::string& file);

}  // namespace loci::mapping::urdf_detail
