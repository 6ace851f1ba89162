#include <algorithm>

#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"
#include "mapping/base/json.h"

namespace loci::apps {

Command ask_command() {
  return {"ask",
          "Asks in words",
          {"loci-memory ask \"Is there anything on the couch table?\" -m demo-output/memory.loci",
           "loci-memory ask \"Where did I leave the red cup?\" \"When was the last time you saw it?\" -m "
           "demo-output/memory.loci --json"},
          [](ArgumentTable& table) {
            struct Arguments {
              MemoryArguments memory;
              std::vector<std::string> sentences;
            };
            auto arguments = std::make_shared<Arguments>();
            arguments->memory.declare(table);
            table.positional(
                "QUESTION...", &arguments->sentences,
                "A question or a task in English; of several, \"it\" is what the one before was about");
            return [arguments](Session& session) {
              const memory::Store store = memory::Store::open_read(arguments->memory.memory);
              const memory::AsOf as_of = arguments->memory.as_of(store);
              const auto answers = ask(store, memory::SpokenQuestion{arguments->sentences, as_of});
              std::string text;
              Json json = Json::array();
              for (const memory::SpokenAnswer& answer : answers) {
                text += (text.empty() ? "" : "\n") + to_text(answer, memory::TimeWriter(store));
                json.push_back(to_json(answer));
              }
              session.answer(text, json.size() == 1 ? json[0] : Json{{"answers", json}});
              for (const memory::SpokenAnswer& answer : answers)
                if (!answer.command)
                  throw Error("'" + answer.sentence + "' is not understood", {},
                              "ask for example: " + answer.nearest.at(0));
            };
          }};
}

}  // namespace loci::apps
