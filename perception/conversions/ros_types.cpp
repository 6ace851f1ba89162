#include "perception/conversions/ros_types.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <sstream>

#include "mapping/base/files.h"
#include "mapping/base/html.h"
#include "perception/conversions/ros_primitives.h"

namespace loci::perception {
namespace {

namespace fs = std::filesystem;

constexpr const char* kHeader = "std_msgs/Header";

std::string trimmed(std::string text) {
  const auto is_space = [](unsigned char c) { return std::isspace(c) != 0; };
  text.erase(text.begin(), std::find_if_not(text.begin(), text.end(), is_space));
  text.erase(std::find_if_not(text.rbegin(), text.rend(), is_space).base(), text.end());
  return text;
}

bool is_name(const std::string& text) {
  return !text.empty() && std::isalpha(static_cast<unsigned char>(text[0])) != 0 &&
         std::all_of(text.begin(), text.end(),
                     [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; });
}

std::string feature_xml(const std::string& name, const std::string& range, const std::string& element) {
  return fmt::format(
      "        <featureDescription>\n          <name>{}</name>\n          "
      "<rangeTypeName>{}</rangeTypeName>\n{}"
      "        </featureDescription>\n",
      name, range, element.empty() ? "" : fmt::format("          <elementType>{}</elementType>\n", element));
}

std::string type_xml(const std::string& name, const std::string& description, const std::string& features) {
  return fmt::format(
      "    <typeDescription>\n      <name>{}</name>\n{}      <supertypeName>uima.cas.TOP</supertypeName>\n"
      "      <features>\n{}      </features>\n    </typeDescription>\n",
      name,
      description.empty() ? ""
                          : fmt::format("      <description>{}</description>\n", html_escape(description)),
      features);
}

/// What time, duration and Header are, as in loci's own types.
std::string special_types() {
  const std::string ns = feature_xml("nanoseconds", "uima.cas.Long", "");
  return type_xml("loci.ros.Time", "A point in time.", ns) +
         type_xml("loci.ros.Duration", "A span of time.", ns) +
         type_xml("loci.ros.Header", "Where and when a piece of sensor data was taken.",
                  feature_xml("sequence", "uima.cas.Long", "") + feature_xml("stamp", "loci.ros.Time", "") +
                      feature_xml("frame_id", "uima.cas.String", ""));
}

}  // namespace

std::string ros_type_name(const std::string& message) {
  if (message == "time") return "loci.ros.Time";
  if (message == "duration") return "loci.ros.Duration";
  if (message == kHeader) return "loci.ros.Header";
  std::string name = "ros." + message;
  std::replace(name.begin(), name.end(), '/', '.');
  return name;
}

RosTypes::Message RosTypes::parse(const std::string& type, const std::string& text,
                                  const std::string& where) {
  Message message;
  message.where = where;
  const std::string package = type.substr(0, type.find('/'));
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    const FileLocation place{where, number, type};
    const std::string code = trimmed(line.substr(0, line.find('#')));
    if (code.empty()) continue;
    std::istringstream words(code);
    std::string base, name;
    words >> base;
    std::getline(words, name);
    name = trimmed(name);
    if (const size_t equals = name.find('='); equals != std::string::npos) {
      // In a text constant a # is no comment.
      const std::string value = base == "string" ? line.substr(line.find('=') + 1) : name.substr(equals + 1);
      if (!message.constants.empty()) message.constants += ", ";
      message.constants += fmt::format("{}={}", trimmed(name.substr(0, equals)), trimmed(value));
      continue;
    }
    Field field;
    field.name = name;
    if (const size_t bracket = base.find('['); bracket != std::string::npos) {
      const std::string size = base.substr(bracket + 1, base.size() - bracket - 2);
      if (base.back() != ']' || !std::all_of(size.begin(), size.end(), ::isdigit) || size.size() > 9)
        throw Error(fmt::format("'{}' is no type", base), place);
      field.is_array = true;
      field.size = size.empty() ? 0 : std::stoul(size);
      base.resize(bracket);
    }
    const bool plain = find_ros_primitive(base) != nullptr || base == "time" || base == "duration";
    field.type = plain || base.find('/') != std::string::npos ? base
                 : base == "Header"                           ? kHeader
                                                              : package + "/" + base;
    if (!is_name(field.name))
      throw Error(fmt::format("'{}' is no field", code), place, "a field is TYPE NAME");
    message.fields.push_back(std::move(field));
  }
  return message;
}

void RosTypes::add(const std::string& type, const std::string& definition, const std::string& where) {
  std::istringstream lines(definition);
  std::string name = type, text;
  const auto finish = [&] { messages_.insert_or_assign(name, parse(name, text, where)); };
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("====")) continue;
    if (!line.starts_with("MSG: ")) {
      text += line + "\n";
      continue;
    }
    finish();
    name = trimmed(line.substr(5));
    text.clear();
  }
  finish();
}

void RosTypes::add_folder(const fs::path& folder) {
  if (!fs::is_directory(folder)) throw Error("no such folder", {folder.string(), 0, {}});
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file() && entry.path().extension() == ".msg")
      files.push_back(fs::absolute(entry.path()).lexically_normal());
  if (files.empty()) throw Error("the folder holds no .msg files", {folder.string(), 0, {}});
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    const fs::path above = file.parent_path();
    const std::string package = (above.filename() == "msg" ? above.parent_path() : above).filename().string();
    const std::string type = package + "/" + file.stem().string();
    messages_.insert_or_assign(type, parse(type, read_file(file), file.string()));
  }
}

std::vector<std::string> RosTypes::names() const {
  std::vector<std::string> names;
  for (const auto& [name, message] : messages_) names.push_back(name);
  return names;
}

const RosTypes::Message& RosTypes::find(const std::string& type, const std::string& user) const {
  const auto found = messages_.find(type);
  if (found != messages_.end()) return found->second;
  const auto from = messages_.find(user);
  throw Error(fmt::format("{} uses {}, whose definition is not there", user, type),
              {from == messages_.end() ? "" : from->second.where, 0, {}}, did_you_mean(type, names()));
}

std::string RosTypes::xml(const std::string& name) const {
  std::string types = special_types();
  for (const auto& [type, message] : messages_) {
    if (type == kHeader) continue;
    std::string features;
    for (const Field& field : message.fields) {
      const RosPrimitive* primitive = find_ros_primitive(field.type);
      const bool special = field.type == "time" || field.type == "duration" || field.type == kHeader;
      if (primitive == nullptr && !special) find(field.type, type);
      if (primitive != nullptr)
        features += feature_xml(
            field.name, std::string("uima.cas.") + (field.is_array ? primitive->array : primitive->range),
            "");
      else if (field.is_array)
        features += feature_xml(field.name, "uima.cas.FSArray", ros_type_name(field.type));
      else
        features += feature_xml(field.name, ros_type_name(field.type), "");
    }
    types += type_xml(
        ros_type_name(type),
        "ROS message " + type + (message.constants.empty() ? "." : "; " + message.constants + "."), features);
  }
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<typeSystemDescription "
      "xmlns=\"http://uima.apache.org/resourceSpecifier\">\n  <name>{}</name>\n  <types>\n{}  </types>\n"
      "</typeSystemDescription>\n",
      html_escape(name), types);
}

}  // namespace loci::perception
