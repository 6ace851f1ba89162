#include "memory/store/run_configuration.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "mapping/base/error.h"
#include "mapping/base/text/json.h"

namespace loci::memory {
namespace {

enum class Kind { text, id };

/// A member of the configuration, or of an object in it, whose members all must be there.
struct Member {
  const char* group;
  const char* key;
  Kind kind;
};

constexpr std::array kMembers = {
    Member{"", "text", Kind::text},        Member{"", "undoes", Kind::id},
    Member{"", "redoes", Kind::id},        Member{"", "last_scene", Kind::id},
    Member{"label", "scene", Kind::id},    Member{"label", "observation", Kind::id},
    Member{"label", "before", Kind::text}, Member{"label", "after", Kind::text},
    Member{"map", "before", Kind::id},     Member{"map", "after", Kind::id},
    Member{"part", "of", Kind::text},      Member{"part", "name", Kind::text},
    Member{"part", "before", Kind::text},  Member{"part", "after", Kind::text},
    Member{"split", "object", Kind::id},   Member{"split", "new", Kind::id},
};

bool is(const Json& value, Kind kind) {
  return kind == Kind::text ? value.is_string() : value.is_number_integer();
}

/// [{"object": 3, "observations": [4, 5]}]
bool is_identity(const Json& value) {
  return value.is_array() && std::ranges::all_of(value, [](const Json& one) {
           return one.is_object() && one.contains("object") && is(one["object"], Kind::id) &&
                  one.contains("observations") && one["observations"].is_array() &&
                  std::ranges::all_of(one["observations"],
                                      [](const Json& observation) { return is(observation, Kind::id); });
         });
}

/// What is wrong; empty = nothing.
std::string problem_of(const Json& configuration) {
  if (!configuration.is_object()) return "is no object";
  for (const auto& [group, key, kind] : kMembers) {
    const bool grouped = *group != '\0';
    if (grouped && !configuration.contains(group)) continue;
    const Json& object = grouped ? configuration[group] : configuration;
    if (!object.is_object()) return fmt::format("'{}' is no object", group);
    if (!object.contains(key)) {
      if (grouped) return fmt::format("'{}' has no '{}'", group, key);
      continue;
    }
    if (!is(object[key], kind))
      return fmt::format("'{}{}{}' is not {}", group, grouped ? "." : "", key,
                         kind == Kind::text ? "a text" : "a whole number");
  }
  if (configuration.contains("identity") && !is_identity(configuration["identity"]))
    return "'identity' is not a list of objects with their observations";
  return {};
}

}  // namespace

Json configuration_of(const RunRow& run, const std::filesystem::path& file) {
  const std::string where = fmt::format("run {}, configuration", run.id);
  Json configuration;
  try {
    configuration = parse_json(run.configuration, {});
  } catch (const Error& error) {
    throw Error(error.message(), {file.string(), 0, where}, "loci-memory verify lists what is damaged");
  }
  const std::string problem = problem_of(configuration);
  if (!problem.empty())
    throw Error(problem, {file.string(), 0, where}, "loci-memory verify lists what is damaged");
  return configuration;
}

}  // namespace loci::memory
