#include "apps/perceive/ros_input.h"

#include <fmt/format.h>

#include <algorithm>

namespace loci::apps {

perception::RosTypes ros_types_of(const mapping::RosBag& bag) {
  perception::RosTypes types;
  for (const mapping::BagTopic& topic : bag.topics())
    types.add(topic.type, topic.definition, bag.path().string() + ": " + topic.name);
  return types;
}

perception::RosTypes ros_types_of(const std::filesystem::path& path) {
  if (!std::filesystem::is_directory(path)) return ros_types_of(mapping::RosBag(path));
  perception::RosTypes types;
  types.add_folder(path);
  return types;
}

size_t add_ros_messages(const mapping::RosBag& bag, const perception::RosTypes& types,
                        const std::string& topic, size_t most, perception::cas::Cas& cas) {
  std::vector<std::string> names;
  for (const mapping::BagTopic& each : bag.topics()) names.push_back(each.name);
  if (!topic.empty() && bag.find(topic) == nullptr)
    throw Error(fmt::format("the bag has no topic {}", topic), {bag.path().string(), 0, {}},
                did_you_mean(topic, names));
  size_t count = 0;
  for (const mapping::BagTopic& each : bag.topics()) {
    if (!topic.empty() && each.name != topic) continue;
    for (size_t i = 0; i < std::min(most, each.messages); ++i, ++count) {
      try {
        cas.view(each.name).add_to_index(types.read(cas, each.type, bag.message(each.name, i)));
      } catch (const Error& error) {
        if (!error.location().file.empty()) throw;
        throw Error(error.message(), {fmt::format("{}: {}[{}]", bag.path().string(), each.name, i), 0, {}});
      }
    }
  }
  return count;
}

}  // namespace loci::apps
