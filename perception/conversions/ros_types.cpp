#include "perception/conversions/ros_types.h"

#include <fmt/format.h>
#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <sstream>

#include "mapping/base/files.h"
#include "mapping/base/text/html.h"
#include "mapping/base/text/text.h"

namespace loci::perception {
namespace {

/// A built-in type of ROS messages and what holds it in a feature structure (names without "uima.cas.").
struct RosPrimitive {
  const char* name;
  const char* range;
  const char* array;
};

/// Null for time, duration and messages.
const RosPrimitive* find_ros_primitive(const std::string& name) {
  static constexpr RosPrimitive kPrimitives[] = {
      {"bool", "Boolean", "BooleanArray"},   {"int8", "Byte", "ByteArray"},
      {"byte", "Byte", "ByteArray"},         {"uint8", "Short", "ByteArray"},
      {"char", "Short", "ByteArray"},        {"int16", "Short", "ShortArray"},
      {"uint16", "Integer", "IntegerArray"}, {"int32", "Integer", "IntegerArray"},
      {"uint32", "Long", "LongArray"},       {"int64", "Long", "LongArray"},
      {"uint64", "Long", "LongArray"},       {"float32", "Float", "FloatArray"},
      {"float64", "Double", "DoubleArray"},  {"string", "String", "StringArray"}};
  for (const RosPrimitive& each : kPrimitives)
    if (name == each.name) return &each;
  return nullptr;
}

namespace fs = std::filesystem;

constexpr const char* kHeader = "std_msgs/Header";

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
                                                              : fmt::format("{}/{}", package, base);
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

/// Walks over the bytes of one message: little endian, without padding, counts before texts and arrays.
class RosMessageReader {
 public:
  RosMessageReader(const RosTypes& types, cas::Cas& cas, std::string_view bytes)
      : types_(types), cas_(cas), bytes_(bytes) {}

  cas::FeatureStructure message(const std::string& type, const std::string& user, int depth = 0) {
    if (depth > 100) throw Error(fmt::format("{} contains itself", type));
    if (type == "time" || type == "duration") return moment(type);
    if (type == "std_msgs/Header") return header();
    const cas::FeatureStructure made = cas_.create(ros_type_name(type));
    for (const RosTypes::Field& field : types_.find(type, user).fields) {
      const cas::Feature feature = made.feature(field.name);
      if (find_ros_primitive(field.type) != nullptr)
        field.is_array ? set_array(made, feature, field) : set_value(made, feature, field.type);
      else if (field.is_array)
        made.set(feature, structures(field, type, depth));
      else
        made.set(feature, message(field.type, type, depth + 1));
    }
    return made;
  }

  void finish() const {
    if (at_ != bytes_.size())
      throw Error(
          fmt::format("the message is {} bytes longer than its definition says", bytes_.size() - at_));
  }

 private:
  std::string_view next(size_t count) {
    if (count > bytes_.size() - at_) throw Error("the message is shorter than its definition says");
    at_ += count;
    return bytes_.substr(at_ - count, count);
  }
  template <typename T>
  T take() {
    T value{};
    std::memcpy(&value, next(sizeof(T)).data(), sizeof(T));
    return value;
  }
  std::string text() { return std::string(next(take<uint32_t>())); }

  /// Seconds and nanoseconds; those of a duration have signs.
  cas::FeatureStructure moment(const std::string& type) {
    const cas::FeatureStructure made = cas_.create(ros_type_name(type));
    const bool is_signed = type == "duration";
    const int64_t seconds = is_signed ? int64_t{take<int32_t>()} : int64_t{take<uint32_t>()};
    const int64_t nanoseconds = is_signed ? int64_t{take<int32_t>()} : int64_t{take<uint32_t>()};
    made.set("nanoseconds", seconds * 1'000'000'000 + nanoseconds);
    return made;
  }

  cas::FeatureStructure header() {
    const cas::FeatureStructure made = cas_.create("loci.ros.Header");
    made.set("sequence", int64_t{take<uint32_t>()});
    made.set("stamp", moment("time"));
    made.set("frame_id", text());
    return made;
  }

  void set_value(const cas::FeatureStructure& made, cas::Feature feature, const std::string& type) {
    if (type == "bool") return made.set(feature, take<uint8_t>() != 0);
    if (type == "int8" || type == "byte") return made.set(feature, take<int8_t>());
    if (type == "uint8" || type == "char") return made.set(feature, static_cast<int16_t>(take<uint8_t>()));
    if (type == "int16") return made.set(feature, take<int16_t>());
    if (type == "uint16") return made.set(feature, static_cast<int32_t>(take<uint16_t>()));
    if (type == "int32") return made.set(feature, take<int32_t>());
    if (type == "uint32") return made.set(feature, static_cast<int64_t>(take<uint32_t>()));
    if (type == "int64" || type == "uint64") return made.set(feature, take<int64_t>());
    if (type == "float32") return made.set(feature, take<float>());
    if (type == "float64") return made.set(feature, take<double>());
    made.set(feature, text());
  }

  /// An array of T in the message as one of Stored.
  template <typename T, typename Stored = T>
  cas::Buffer<Stored> numbers(size_t count) {
    const std::string_view raw = next(count * sizeof(T));
    const std::shared_ptr<Stored[]> kept(new Stored[count]);
    for (size_t i = 0; i < count; ++i) {
      T value{};
      std::memcpy(&value, raw.data() + i * sizeof(T), sizeof(T));
      kept[i] = static_cast<Stored>(value);
    }
    return {kept, kept.get(), count};
  }

  size_t count_of(const RosTypes::Field& field) { return field.size > 0 ? field.size : take<uint32_t>(); }

  void set_array(const cas::FeatureStructure& made, cas::Feature feature, const RosTypes::Field& field) {
    const size_t count = count_of(field);
    const std::string& type = field.type;
    if (type == "string") {
      std::vector<std::string> texts;
      for (size_t i = 0; i < count; ++i) texts.push_back(text());
      return made.set_array(feature, cas::Buffer<std::string>(std::move(texts)));
    }
    if (type == "bool") return made.set_array(feature, numbers<uint8_t, bool>(count));
    if (type == "int16") return made.set_array(feature, numbers<int16_t>(count));
    if (type == "uint16") return made.set_array(feature, numbers<uint16_t, int32_t>(count));
    if (type == "int32") return made.set_array(feature, numbers<int32_t>(count));
    if (type == "uint32") return made.set_array(feature, numbers<uint32_t, int64_t>(count));
    if (type == "int64" || type == "uint64") return made.set_array(feature, numbers<int64_t>(count));
    if (type == "float32") return made.set_array(feature, numbers<float>(count));
    if (type == "float64") return made.set_array(feature, numbers<double>(count));
    made.set_array(feature, numbers<uint8_t>(count));
  }

  cas::FeatureStructure structures(const RosTypes::Field& field, const std::string& user, int depth) {
    const size_t count = count_of(field);
    std::vector<cas::FeatureStructure> elements;
    // A broken count ends with the bytes; messages without fields are not worth more than the bytes there
    // are.
    for (size_t i = 0; i < count && i <= bytes_.size(); ++i)
      elements.push_back(message(field.type, user, depth + 1));
    return cas_.create_array(elements);
  }

  const RosTypes& types_;
  cas::Cas& cas_;
  std::string_view bytes_;
  size_t at_ = 0;
};

cas::FeatureStructure RosTypes::read(cas::Cas& cas, const std::string& type, std::string_view bytes) const {
  RosMessageReader reader(*this, cas, bytes);
  const cas::FeatureStructure message = reader.message(type, type);
  reader.finish();
  return message;
}

}  // namespace loci::perception
