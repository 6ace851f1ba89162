#pragma once

#include <filesystem>

#include "mapping/recording/ros_bag.h"
#include "perception/conversions/ros_types.h"

namespace loci::apps {

/// The message types of a bag.
perception::RosTypes ros_types_of(const mapping::RosBag& bag);

/// The message types of a bag or of a folder of .msg files.
perception::RosTypes ros_types_of(const std::filesystem::path& path);

/// Adds messages of a bag to a CAS, those of a topic to the view of its name, at most `most` of each;
/// `topic` empty = all. Returns how many. Error when there is no such topic.
size_t add_ros_messages(const mapping::RosBag& bag, const perception::RosTypes& types,
                        const std::string& topic, size_t most, perception::cas::Cas& cas);

}  // namespace loci::apps
