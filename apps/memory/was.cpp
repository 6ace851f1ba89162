#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"

namespace loci::apps {
Command was_command() {
  return {"was",
          "Was X there between two times: yes, no, or not observed",
          {"loci-memory was red on table_1 --between 08:00 09:00 -m demo-output/memory.loci",
           "loci-memory was object_1 in drawer_1 --between 08:00 18:00 -m demo-output/memory.loci --json"},
          [](ArgumentTable& table) {
            struct Arguments {
              MemoryArguments memory;
              SpanArguments span;
              std::vector<std::string> words;
            };
            auto arguments = std::make_shared<Arguments>();
            arguments->memory.declare(table);
            arguments->span.declare(table);
            table.positional("WORD...", &arguments->words, "X [on|in] PLACE");
            return [arguments](Session& session) {
              const memory::Store store = memory::Store::open_read(arguments->memory.memory);
              const auto scenes = store.scenes();
              memory::WasQuestion question = memory::read_was(arguments->words);
              question.as_of = arguments->memory.as_of(store);
              // Without times: over all that the memory has.
              question.from = arguments->span.first(store).value_or(scenes.empty() ? 0 : scenes.front().time);
              question.to = arguments->span.last(store).value_or(scenes.empty() ? 0 : scenes.back().time);
              answer_question(session, store, question);
            };
          }};
}

}  // namespace loci::apps
