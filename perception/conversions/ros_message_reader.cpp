#include <fmt/format.h>

#include <cstdint>
#include <cstring>

#include "perception/conversions/ros_primitives.h"
#include "perception/conversions/ros_types.h"

namespace loci::perception {

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
