#pragma once

#include <string>

namespace loci::perception {

/// A built-in type of ROS messages and what holds it in a feature structure (names without "uima.cas.").
struct RosPrimitive {
  const char* name;
  const char* range;
  const char* array;
};

/// Null for time, duration and messages.
const RosPrimitive* find_ros_primitive(const std::string& name);

}  // namespace loci::perception
