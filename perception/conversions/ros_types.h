#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "perception/cas/cas.h"

namespace loci::perception {

/// ROS 1 message definitions as types of a type system, and their messages as feature structures.
///
/// `sensor_msgs/Image` becomes `ros.sensor_msgs.Image`, its fields become features of the same names. Numbers
/// take the smallest type that holds them all: uint8 a Short, uint32 a Long; a uint64 keeps its bits in a
/// Long. Arrays of int8, uint8, byte and char are ByteArrays. `time`, `duration` and `Header` are
/// loci.ros.Time, loci.ros.Duration and loci.ros.Header. Constants are told in the description of the type.
class RosTypes {
 public:
  /// A definition as bags hold it: its own text, then each type it uses under a line of '=' and "MSG: name".
  void add(const std::string& type, const std::string& definition, const std::string& where);
  /// All `PACKAGE/msg/NAME.msg` or `PACKAGE/NAME.msg` below a folder, which may be a package itself. Error
  /// when there are none.
  void add_folder(const std::filesystem::path& folder);

  /// Names of all messages, "sensor_msgs/Image".
  std::vector<std::string> names() const;
  /// The type system in UIMA's format. Error that names a type which is used but not there.
  std::string xml(const std::string& name = "ros") const;

  /// A message as a feature structure of a CAS whose type system has these types. Error when the bytes are
  /// not a whole message.
  cas::FeatureStructure read(cas::Cas& cas, const std::string& type, std::string_view bytes) const;

 private:
  friend class RosMessageReader;
  struct Field {
    std::string name, type;  ///< base type: "uint8", "geometry_msgs/Point"
    bool is_array = false;
    size_t size = 0;  ///< of an array of fixed size; 0 = counted
  };
  struct Message {
    std::vector<Field> fields;
    std::string constants;  ///< "DEBUG=1, INFO=2"
    std::string where;
  };
  static Message parse(const std::string& type, const std::string& text, const std::string& where);
  const Message& find(const std::string& type, const std::string& user) const;

  std::map<std::string, Message> messages_;
};

/// "ros.sensor_msgs.Image" of "sensor_msgs/Image", "loci.ros.Header" of "std_msgs/Header".
std::string ros_type_name(const std::string& message);

}  // namespace loci::perception
