#include "mapping/world/urdf_check.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <string_view>
#include <vector>

#include "mapping/base/error.h"
#include "mapping/base/text/text.h"

namespace loci::mapping::urdf_detail {
namespace {

using tinyxml2::XMLElement;

/// Whitespace-separated words as numbers; empty when one of them is no number.
std::vector<double> numbers(std::string_view text) {
  std::vector<double> values;
  size_t at = 0;
  while (true) {
    at = text.find_first_not_of(" \t\r\n", at);
    if (at == std::string_view::npos) return values;
    const size_t end = std::min(text.find_first_of(" \t\r\n", at), text.size());
    std::string_view word = text.substr(at, end - at);
    if (word.starts_with('+')) word.remove_prefix(1);
    double value = 0;
    const auto result = std::from_chars(word.data(), word.data() + word.size(), value);
    if (result.ec != std::errc() || result.ptr != word.data() + word.size()) return {};
    values.push_back(value);
    at = end;
  }
}

class Checker {
 public:
  explicit Checker(const std::string& file) : file_(file) {}

  void run(const XMLElement& robot) {
    robot_ = &robot;
    for (const XMLElement* e = robot.FirstChildElement("material"); e; e = e->NextSiblingElement("material"))
      check_material(*e, "the robot");
    for (const XMLElement* e = robot.FirstChildElement("link"); e; e = e->NextSiblingElement("link"))
      check_link(*e);
    if (links_.empty()) fail(robot, "the robot has no links");
    for (const XMLElement* e = robot.FirstChildElement("joint"); e; e = e->NextSiblingElement("joint"))
      check_joint(*e);
    for (const XMLElement* e = robot.FirstChildElement("joint"); e; e = e->NextSiblingElement("joint"))
      check_joint_ends(*e);
    check_mimics();
    check_tree();
  }

 private:
  struct JointEnds {
    const XMLElement* element = nullptr;
    std::string parent, child, mimics;
  };

  [[noreturn]] void fail(const XMLElement& element, const std::string& what, const std::string& hint = {}) {
    throw Error(what, FileLocation{file_, element.GetLineNum(), {}}, hint);
  }

  std::string name_of(const XMLElement& element, const std::string& kind) {
    const char* name = element.Attribute("name");
    if (!name || !*name) fail(element, "a " + kind + " has no name");
    return name;
  }

  /// The numbers of an attribute: `count` of them, all finite. An absent attribute gives an empty vector, or
  /// is refused when required.
  std::vector<double> check_numbers(const XMLElement& element, const char* attribute, size_t count,
                                    const std::string& owner, bool required = false) {
    const std::string what = std::string("'") + attribute + "' of <" + element.Name() + "> in " + owner;
    const char* text = element.Attribute(attribute);
    if (!text) {
      if (required) fail(element, what + " is missing");
      return {};
    }
    std::vector<double> values = numbers(text);
    if (values.size() != count)
      fail(element, what + " is \"" + text + "\", not " +
                        (count == 1 ? "a number" : std::to_string(count) + " numbers"));
    for (const double value : values)
      if (!std::isfinite(value)) fail(element, what + " is \"" + text + "\", not finite");
    return values;
  }

  void check_positive(const XMLElement& element, const char* attribute, size_t count,
                      const std::string& owner) {
    for (const double value : check_numbers(element, attribute, count, owner, true))
      if (value <= 0)
        fail(element, std::string("'") + attribute + "' of <" + element.Name() + "> in " + owner + " is \"" +
                          element.Attribute(attribute) + "\", not positive");
  }

  void check_origin(const XMLElement& parent, const std::string& owner) {
    if (const XMLElement* origin = parent.FirstChildElement("origin")) {
      check_numbers(*origin, "xyz", 3, owner);
      check_numbers(*origin, "rpy", 3, owner);
    }
  }

  void check_geometry(const XMLElement& shape, const std::string& owner) {
    const XMLElement* geometry = shape.FirstChildElement("geometry");
    if (!geometry) fail(shape, std::string("a <") + shape.Name() + "> of " + owner + " has no <geometry>");
    const XMLElement* kind = geometry->FirstChildElement();
    if (!kind) fail(*geometry, "a <geometry> of " + owner + " is empty");
    const std::string_view name = kind->Name();
    if (name == "box") {
      check_positive(*kind, "size", 3, owner);
    } else if (name == "cylinder") {
      check_positive(*kind, "radius", 1, owner);
      check_positive(*kind, "length", 1, owner);
    } else if (name == "sphere") {
      check_positive(*kind, "radius", 1, owner);
    } else if (name == "mesh") {
      if (!kind->Attribute("filename")) fail(*kind, "a <mesh> of " + owner + " has no filename");
      for (const double value : check_numbers(*kind, "scale", 3, owner))  // Negative: a mirrored mesh.
        if (value == 0) fail(*kind, "'scale' of <mesh> in " + owner + " has a 0");
    } else {
      fail(*kind, "unknown geometry <" + std::string(name) + "> in " + owner,
           "URDF has box, cylinder, sphere and mesh");
    }
  }

  void check_material(const XMLElement& material, const std::string& owner) {
    if (!material.Attribute("name")) fail(material, "a material of " + owner + " has no name");
    if (const XMLElement* color = material.FirstChildElement("color"))
      check_numbers(*color, "rgba", 4, owner, true);
  }

  void check_inertial(const XMLElement& inertial, const std::string& owner) {
    check_origin(inertial, owner);
    const XMLElement* mass = inertial.FirstChildElement("mass");
    if (!mass) fail(inertial, "the <inertial> of " + owner + " has no <mass>");
    if (check_numbers(*mass, "value", 1, owner, true)[0] < 0)
      fail(*mass, "the mass of " + owner + " is negative");
    const XMLElement* inertia = inertial.FirstChildElement("inertia");
    if (!inertia) fail(inertial, "the <inertial> of " + owner + " has no <inertia>");
    for (const char* entry : {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"})
      check_numbers(*inertia, entry, 1, owner, true);
  }

  void check_link(const XMLElement& link) {
    const std::string name = name_of(link, "link");
    const auto [first, fresh] = links_.emplace(name, &link);
    if (!fresh)
      fail(link, "link '" + name + "' is not unique",
           "it is first defined in line " + std::to_string(first->second->GetLineNum()));
    const std::string owner = "link '" + name + "'";
    if (const XMLElement* inertial = link.FirstChildElement("inertial")) check_inertial(*inertial, owner);
    for (const char* kind : {"visual", "collision"})
      for (const XMLElement* e = link.FirstChildElement(kind); e; e = e->NextSiblingElement(kind)) {
        check_origin(*e, owner);
        check_geometry(*e, owner);
        if (const XMLElement* material = e->FirstChildElement("material")) check_material(*material, owner);
      }
  }

  /// The link that a joint names as parent or child.
  std::string joint_end(const XMLElement& joint, const char* end, const std::string& owner) {
    const XMLElement* element = joint.FirstChildElement(end);
    const char* link = element ? element->Attribute("link") : nullptr;
    if (!link || !*link) fail(joint, owner + " has no " + end + " link");
    if (!links_.contains(link)) {
      std::vector<std::string> names;
      for (const auto& entry : links_) names.push_back(entry.first);
      fail(*element, std::string(end) + " link '" + link + "' of " + owner + " not found",
           did_you_mean(link, names));
    }
    return link;
  }

  void check_joint(const XMLElement& joint) {
    const std::string name = name_of(joint, "joint");
    const std::string owner = "joint '" + name + "'";
    const auto [first, fresh] = joints_.emplace(name, JointEnds{&joint, {}, {}, {}});
    if (!fresh)
      fail(joint, owner + " is not unique",
           "it is first defined in line " + std::to_string(first->second.element->GetLineNum()));
    check_origin(joint, owner);
    check_motion(joint, owner);
    if (const XMLElement* mimic = joint.FirstChildElement("mimic")) {
      const char* other = mimic->Attribute("joint");
      if (!other) fail(*mimic, "the <mimic> of " + owner + " names no joint");
      first->second.mimics = other;
      check_numbers(*mimic, "multiplier", 1, owner);
      check_numbers(*mimic, "offset", 1, owner);
    }
  }

  /// Apart from what a joint says of itself, because it is what the author sees first: a joint without limits
  /// is named before a link that is missing.
  void check_joint_ends(const XMLElement& joint) {
    const std::string name = joint.Attribute("name"), owner = "joint '" + name + "'";
    JointEnds& ends = joints_.at(name);
    ends.parent = joint_end(joint, "parent", owner);
    ends.child = joint_end(joint, "child", owner);
    const auto parent = parent_joint_.emplace(ends.child, name);
    if (!parent.second)
      fail(joint,
           "link '" + ends.child + "' is the child of two joints, '" + parent.first->second + "' and '" +
               name + "'",
           "every link but the root is the child of one joint");
  }

  void check_motion(const XMLElement& joint, const std::string& owner) {
    const std::string type = joint.Attribute("type") ? joint.Attribute("type") : "";
    static const std::set<std::string> kTypes = {"fixed",     "revolute", "continuous",
                                                 "prismatic", "floating", "planar"};
    if (type.empty()) fail(joint, owner + " has no type");
    if (!kTypes.contains(type))
      fail(joint, owner + " has the unknown type '" + type + "'",
           did_you_mean(type, {kTypes.begin(), kTypes.end()}));
    const XMLElement* axis = joint.FirstChildElement("axis");
    if (axis && type != "fixed" && type != "floating") {
      const std::vector<double> xyz = check_numbers(*axis, "xyz", 3, owner);
      if (!xyz.empty() && std::hypot(xyz[0], xyz[1], xyz[2]) == 0)
        fail(*axis, "the axis of " + owner + " is 0 0 0");
    }
    const XMLElement* limit = joint.FirstChildElement("limit");
    if (!limit && (type == "revolute" || type == "prismatic"))
      fail(joint, owner + " is " + type + " without limits",
           "add <limit lower=… upper=… effort=… velocity=…/>");
    if (limit) {
      check_numbers(*limit, "lower", 1, owner);
      check_numbers(*limit, "upper", 1, owner);
      check_numbers(*limit, "effort", 1, owner, true);
      check_numbers(*limit, "velocity", 1, owner, true);
    }
  }

  void check_mimics() {
    std::map<std::string, std::string> followed_from;  // Each joint is followed once.
    for (const auto& [name, joint] : joints_) {
      std::string at = name;
      while (!joints_.at(at).mimics.empty() && followed_from.emplace(at, name).second) {
        const std::string& next = joints_.at(at).mimics;
        if (!joints_.contains(next)) {
          std::vector<std::string> names;
          for (const auto& entry : joints_) names.push_back(entry.first);
          fail(*joints_.at(at).element, fmt::format("joint '{}' mimics '{}', which does not exist", at, next),
               did_you_mean(next, names));
        }
        at = next;
      }
      if (!joints_.at(at).mimics.empty() && followed_from.at(at) == name)
        fail(*joints_.at(at).element, "joint '" + at + "' mimics itself");
    }
  }

  /// The links of the cycle that is met when going up from `link`; empty when a root is met, or a link that
  /// an earlier call met.
  std::vector<std::string> cycle_above(const std::string& link) {
    std::vector<std::string> path;
    std::string at = link;
    while (met_.insert(at).second) {
      path.push_back(at);
      const auto joint = parent_joint_.find(at);
      if (joint == parent_joint_.end()) return {};
      at = joints_.at(joint->second).parent;
    }
    path.erase(path.begin(), std::find(path.begin(), path.end(), at));
    return {path.rbegin(), path.rend()};
  }

  void check_tree() {
    std::vector<std::string> roots;
    for (const XMLElement* e = robot_->FirstChildElement("link"); e; e = e->NextSiblingElement("link")) {
      const std::string name = e->Attribute("name");
      if (!parent_joint_.contains(name)) roots.push_back(name);
      const std::vector<std::string> cycle = cycle_above(name);
      if (cycle.empty()) continue;
      std::string text;
      for (const std::string& link : cycle) text += link + " → ";
      const XMLElement* last = nullptr;  // The joint that comes last in the file is the likeliest culprit.
      for (const std::string& link : cycle) {
        const XMLElement* joint = joints_.at(parent_joint_.at(link)).element;
        if (!last || joint->GetLineNum() > last->GetLineNum()) last = joint;
      }
      fail(*last, "the links form a cycle: " + text + cycle.front(),
           std::string("joint '") + last->Attribute("name") + "' closes it");
    }
    if (roots.size() > 1)
      fail(*links_.at(roots[1]),
           (roots.size() == 2 ? "two" : std::to_string(roots.size())) + std::string(" root links, '") +
               roots[0] + "' and '" + roots[1] + "'" + (roots.size() > 2 ? ", …" : ""),
           "join them with a joint");
  }

  std::string file_;
  const XMLElement* robot_ = nullptr;
  std::map<std::string, const XMLElement*> links_;
  std::map<std::string, JointEnds> joints_;
  std::map<std::string, std::string> parent_joint_;  ///< joint by the name of its child link
  std::set<std::string> met_;                        ///< links on whose way to the root no cycle was found
};

}  // namespace

namespace {

/// The encoding that an XML file declares in its first line, in lower case; "utf-8" where it is silent.
std::string encoding_of(const std::string& text) {
  const std::string declaration = lower_case(text.substr(0, text.find("?>")));
  const size_t at = declaration.find("encoding");
  if (!declaration.starts_with("<?xml") || at == std::string::npos) return "utf-8";
  const size_t quote = declaration.find_first_of("\"'", at);
  if (quote == std::string::npos) return "utf-8";
  return declaration.substr(quote + 1, declaration.find(declaration[quote], quote + 1) - quote - 1);
}

std::string utf8_from_latin1(const std::string& text) {
  std::string utf8;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80) {
      utf8 += c;
    } else {
      utf8 += static_cast<char>(0xC0 | (byte >> 6));
      utf8 += static_cast<char>(0x80 | (byte & 0x3F));
    }
  }
  return utf8;
}

/// The first element below, or at, another one that xacro expands; nullptr = none.
const XMLElement* xacro_element(const XMLElement& element) {
  if (std::string_view(element.Name()).starts_with("xacro:")) return &element;
  for (const XMLElement* child = element.FirstChildElement(); child; child = child->NextSiblingElement())
    if (const XMLElement* found = xacro_element(*child)) return found;
  return nullptr;
}

}  // namespace

std::string utf8_text(const std::string& text, const std::string& file) {
  const std::string encoding = encoding_of(text);
  if (encoding == "iso-8859-1" || encoding == "latin1" || encoding == "latin-1")
    return utf8_from_latin1(text);
  if (is_utf8(text)) return text;
  int line = 1;
  for (size_t begin = 0; begin < text.size(); ++line) {
    const size_t end = std::min(text.find('\n', begin), text.size());
    if (!is_utf8(text.substr(begin, end - begin))) break;
    begin = end + 1;
  }
  throw Error("this is not UTF-8, which an XML file is unless its first line declares another encoding",
              FileLocation{file, line, {}},
              "declare it (<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>), or convert the file with iconv");
}

void parse_xml(tinyxml2::XMLDocument& document, const std::string& text, const std::string& file) {
  if (document.Parse(text.c_str(), text.size()) == tinyxml2::XML_SUCCESS) return;
  if (document.ErrorID() == tinyxml2::XML_ERROR_EMPTY_DOCUMENT)
    throw Error("the file is empty", FileLocation{file, 0, {}});
  std::string reason = document.ErrorName() ? document.ErrorName() : "";
  if (reason.starts_with("XML_")) reason.erase(0, 4);
  for (char& c : reason) c = c == '_' ? ' ' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  throw Error("this is not XML (" + reason + ")", FileLocation{file, document.ErrorLineNum(), {}});
}

const XMLElement& check_urdf(const tinyxml2::XMLDocument& document, const std::string& file) {
  const XMLElement* robot = document.RootElement();
  if (!robot || std::string_view(robot->Name()) != "robot")
    throw Error(std::string("this is no URDF: the first element is <") + (robot ? robot->Name() : "") +
                    ">, not <robot>",
                FileLocation{file, robot ? robot->GetLineNum() : 0, {}});
  if (const XMLElement* macro = xacro_element(*robot))
    throw Error(fmt::format("this is a xacro, not a URDF: <{}> is yet to be expanded", macro->Name()),
                FileLocation{file, macro->GetLineNum(), {}},
                fmt::format("run 'xacro {} > world.urdf' and give that file", file));
  if (!robot->Attribute("name"))
    throw Error("the robot has no name", FileLocation{file, robot->GetLineNum(), {}});
  Checker(file).run(*robot);
  return *robot;
}

}  // namespace loci::mapping::urdf_detail
