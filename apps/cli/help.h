#pragma once

#include <string>
#include <vector>

#include "apps/cli/program.h"
#include "mapping/base/text/json_fwd.h"

namespace loci::apps {

/// The help of a program: its commands, by group.
std::string program_help(const std::string& program, const std::string& description,
                         const std::vector<Command>& commands);
/// The help of a command; `name` with the program's ("loci-map fuse").
std::string command_help(const std::string& name, const Command& command, const ArgumentTable& arguments);

/// What completions and manual pages are generated from.
Json command_json(const Command& command, const ArgumentTable& arguments);

}  // namespace loci::apps
