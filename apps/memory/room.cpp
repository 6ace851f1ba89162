#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"

namespace loci::apps {
namespace {

template <class Question>
Declare about_parts() {
  return [](ArgumentTable& table) {
    struct Arguments {
      MemoryArguments memory;
      std::vector<std::string> part;
    };
    auto arguments = std::make_shared<Arguments>();
    arguments->memory.declare(table);
    table.positional("[PART...]", &arguments->part,
                     "Only these: a link of the map, a place, an alias, a class",
                     {.default_text = "everything"});
    return [arguments](Session& session) {
      const memory::Store store = memory::Store::open_read(arguments->memory.memory);
      const memory::AsOf as_of = arguments->memory.as_of(store);
      answer_question(session, store, Question{.part = joined(arguments->part), .as_of = as_of});
    };
  };
}

}  // namespace

Command room_command() {
  return {"room",
          "What the room consists of: furniture, what opens, what stands where",
          {"loci-memory room -m demo-output/memory.loci",
           "loci-memory room drawers -m demo-output/memory.loci --at 17:45 --json"},
          about_parts<memory::RoomQuestion>()};
}

Command opens_command() {
  return {"opens",
          "What opens, whether it is open, and when it was opened",
          {"loci-memory opens -m demo-output/memory.loci",
           "loci-memory opens drawer_1 -m demo-output/memory.loci --at 17:45"},
          about_parts<memory::OpensQuestion>()};
}

}  // namespace loci::apps
