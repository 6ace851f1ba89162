#include "apps/memory/commands.h"
#include "mapping/base/json.h"
#include "memory/questions/facts.h"
#include "memory/questions/taxonomy.h"

namespace loci::apps {

Command fact_command() {
  return {"fact",
          "What people say about objects and places: set, list, remove",
          {"loci-memory fact set table_1 alias \"couch table\" -m demo-output/memory.loci",
           "loci-memory fact list -m demo-output/memory.loci --json"},
          [](ArgumentTable& table) {
            struct Arguments {
              std::string memory, action;
              std::vector<std::string> words;
            };
            auto arguments = std::make_shared<Arguments>();
            table.memory(arguments->memory);
            table.positional("ACTION", &arguments->action,
                             "set X KEY VALUE, list [X [KEY]], or remove X KEY [VALUE]",
                             {.choices = {"set", "list", "remove"}});
            table.positional("[WORD...]", &arguments->words,
                             "X: an object or a place; KEY: alias, owner, class, state, ...");
            return [arguments](Session& session) {
              const auto& [memory, action, words] = *arguments;
              const size_t least = action == "set" ? 3 : action == "remove" ? 2 : 0;
              if (words.size() < least || words.size() > 3)
                throw Error("fact " + action + " takes other words", {},
                            "fact set X KEY VALUE, fact list [X [KEY]], fact remove X KEY [VALUE]");
              const auto word = [&w = words](size_t i) { return i < w.size() ? w[i] : std::string(); };
              memory::FactsAnswer answer;
              if (action == "list") {
                answer = ask(memory::Store::open_read(memory), memory::FactsQuestion{word(0), word(1), {}});
              } else {
                memory::Store::open_read(memory);  // a mistyped name must not make a new memory
                memory::Store store = memory::Store::open_write(memory);
                answer = action == "set" ? set_fact(store, word(0), word(1), word(2))
                                         : remove_fact(store, word(0), word(1), word(2));
              }
              session.answer(to_text(answer), to_json(answer));
            };
          }};
}

Command taxonomy_command() {
  return {
      "taxonomy",
      "Kinds of things, their other words and properties: load, list",
      {"loci-memory taxonomy load apps/samples/household.yaml -m demo-output/memory.loci",
       "loci-memory taxonomy list -m demo-output/memory.loci --json"},
      [](ArgumentTable& table) {
        struct Arguments {
          std::string memory, action, file;
        };
        auto arguments = std::make_shared<Arguments>();
        table.memory(arguments->memory);
        table.positional("ACTION", &arguments->action, "load FILE, or list", {.choices = {"load", "list"}});
        table.positional("[FILE]", &arguments->file, "load: the taxonomy, YAML");
        return [arguments](Session& session) {
          memory::Taxonomy taxonomy;
          if (arguments->action == "load") {
            if (arguments->file.empty()) throw Error("no file to load", {}, "taxonomy load FILE.yaml");
            taxonomy = memory::Taxonomy::read(arguments->file);
            memory::Store::open_read(arguments->memory);  // a mistyped name must not make a new memory
            memory::Store store = memory::Store::open_write(arguments->memory);
            taxonomy.save(store);
          } else {
            taxonomy = memory::Taxonomy::of(memory::Store::open_read(arguments->memory), {});
          }
          session.answer(to_text(taxonomy), to_json(taxonomy));
        };
      }};
}

}  // namespace loci::apps
