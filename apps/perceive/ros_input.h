#pragma once

#include <filesystem>

#include "mapping/recording/ros_bag.h"
#include "perception/conversions/ros_types.h"

namespace loci {

/// The message types of a bag.
RosTypes ros_types_of(const RosBag& bag);

/// The message types of a bag or of a folder of .msg files.
RosTypes ros_types_of(const std::filesystem::path& path);

/// Adds messages of a bag to a CAS, those of a topic to the view of its name, at most `most` of each;
/// `topic` empty = all. Returns how many. Error when there is no such topic.
size_t add_ros_messages(const RosBag& bag, const RosTypes& types, const std::string& topic, size_t most,
                        cas::Cas& cas);

}  // namespace loci
