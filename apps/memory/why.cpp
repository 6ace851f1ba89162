#include "memory/reasoning/why.h"

#include <charconv>

#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"
#include "memory/questions/snapshot.h"

namespace loci::apps {
namespace {

/// The number in "scene_12"; unset when it is no such name.
std::optional<memory::Id> scene_id(const std::string& name) {
  constexpr std::string_view kPrefix = "scene_";
  if (!name.starts_with(kPrefix)) return std::nullopt;
  memory::Id id = 0;
  const char* end = name.data() + name.size();
  const auto [rest, error] = std::from_chars(name.data() + kPrefix.size(), end, id);
  return error == std::errc() && rest == end ? std::optional(id) : std::nullopt;
}

}  // namespace

Command why_command() {
  return {"why",
          "Explains a decision: evidence, alternatives, what forbade them",
          {"loci-memory why red -m demo-output/memory.loci",
           "loci-memory why scene_3 -m demo-output/memory.loci --json"},
          [](ArgumentTable& table) {
            struct Arguments {
              MemoryArguments memory;
              std::vector<std::string> subject;
            };
            auto arguments = std::make_shared<Arguments>();
            arguments->memory.declare(table);
            table.positional("SUBJECT...", &arguments->subject,
                             "scene_12, object_12, or words for an object");
            return [arguments](Session& session) {
              const memory::Store store = memory::Store::open_read(arguments->memory.memory);
              const memory::AsOf as_of = arguments->memory.as_of(store);
              const std::string subject = joined(arguments->subject);
              if (const std::optional<memory::Id> scene = scene_id(subject)) {
                const memory::Why why = why_scene(store, *scene);
                session.answer(why.text, why.json);
                return;
              }
              const std::vector<memory::Id> objects = memory::Snapshot(store, as_of).find_objects(subject);
              const memory::Why why = why_object(store, objects.front(), as_of);
              session.answer(why.text, why.json);
            };
          }};
}

}  // namespace loci::apps
