#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace google::protobuf {
class Message;
}

namespace loci::perception {

/// How a message that was read from `bytes` differs from what we would make of it (§5.4.2): it is encoded
/// again with what its definition names, and where the two differ, every field that is not named is listed by
/// its path, number, kind and value ("info[0].ui_info.99: varint 7"); what looks like a message is opened. A
/// last line tells of bytes that are lost although every field is named: a field that is said twice, a number
/// that is spelt long.
std::vector<std::string> structural_differences(const google::protobuf::Message& message,
                                                std::string_view bytes);

}  // namespace loci::perception
