// Corrections: edit, fact, taxonomy.

#include <fmt/format.h>

#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"
#include "mapping/base/json.h"
#include "mapping/base/text.h"
#include "memory/catalogue/catalogue.h"
#include "memory/edits/edit_actions.h"
#include "memory/questions/facts.h"
#include "memory/questions/taxonomy.h"

namespace loci::apps {

namespace {

struct EditArguments {
  std::string memory, action;
  std::vector<std::string> words;

  memory::Query query() const;
};

/// "merge ONE OTHER, split OBJECT TIME, …, undo, redo or list".
std::string edit_forms() {
  std::string forms;
  for (const memory::EditAction& action : memory::edit_actions()) {
    forms += action.name;
    for (const memory::Parameter& parameter : action.parameters) {
      const std::string word = upper_case(parameter.name);
      forms += parameter.required ? " " + word : " [" + word + "]";
    }
    forms += action.name == memory::edit_actions().back().name ? " or list" : ", ";
  }
  return forms;
}

std::vector<std::string> edit_names() {
  std::vector<std::string> names;
  for (const memory::EditAction& action : memory::edit_actions()) names.push_back(action.name);
  names.emplace_back("list");
  return names;
}

memory::Query EditArguments::query() const {
  memory::Query query{.question = action};
  const memory::EditAction* declared = memory::find_edit_action(action);
  if (words.size() > declared->parameters.size()) throw UsageError("the actions are " + edit_forms());
  for (size_t i = 0; i < declared->parameters.size(); ++i) {
    const memory::Parameter& parameter = declared->parameters[i];
    if (i < words.size())
      query.arguments[parameter.name] = words[i];
    else if (parameter.required)
      throw UsageError("the actions are " + edit_forms());
  }
  return query;
}

void answer_list(Session& session, const memory::EditList& list) {
  std::string text = list.done.empty() && list.undone.empty() ? "Nothing was edited.\n" : "";
  for (const memory::Edit& edit : list.done) text += edit.text + "\n";
  for (auto edit = list.undone.rbegin(); edit != list.undone.rend(); ++edit)
    text += edit->text + " (undone)\n";
  session.answer(text, to_json(list));
}

}  // namespace

Command edit_command() {
  return {"edit",
          "Correct object identities, labels, facts and parts of the map, with undo",
          {"loci-memory edit label 3 1 cup -m demo-output/memory.loci",
           "loci-memory edit list -m demo-output/memory.loci --json"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<EditArguments>();
            table.positional("ACTION", &arguments->action, edit_forms(), {.choices = edit_names()});
            table.positional("[WORD...]", &arguments->words,
                             "What the action takes; names of several words in quotes");
            table.memory(arguments->memory);
            return [arguments](Session& session) {
              if (arguments->action == "list")
                return answer_list(session, edits(open_memory(arguments->memory, session)));
              const memory::Query query = arguments->query();
              memory::Store store = open_to_change(arguments->memory, session);
              const memory::Edit edit = make_edit(store, query, session.progress());
              const std::string done = arguments->action == "undo" ? "Undone: " : "Done: ";
              session.answer(done + edit.text + (edit.note.empty() ? "" : "; " + edit.note) + "\n",
                             to_json(edit));
            };
          }};
}

Command fact_command() {
  return {"fact",
          "Set, list or remove facts about objects and places: names, class, owner",
          {"loci-memory fact set table_1 alias \"couch table\" -m demo-output/memory.loci",
           "loci-memory fact list -m demo-output/memory.loci --json"},
          [](ArgumentTable& table) {
            struct Arguments {
              std::string memory, action;
              std::vector<std::string> words;
            };
            auto arguments = std::make_shared<Arguments>();
            table.positional("ACTION", &arguments->action,
                             "set X KEY VALUE, list [X [KEY]], or remove X KEY [VALUE]",
                             {.choices = {"set", "list", "remove"}});
            table.positional("[WORD...]", &arguments->words,
                             "X: an object or a place; KEY: alias, owner, class, state, …");
            table.memory(arguments->memory);
            return [arguments](Session& session) {
              const auto& [memory, action, words] = *arguments;
              const size_t min = action == "set" ? 3 : action == "remove" ? 2 : 0;
              if (words.size() < min || words.size() > 3)
                throw UsageError("the actions are set X KEY VALUE, list [X [KEY]], remove X KEY [VALUE]");
              const auto word = [&w = words](size_t i) { return i < w.size() ? w[i] : std::string(); };
              memory::FactsAnswer answer;
              if (action == "list") {
                answer = ask(open_memory(memory, session), memory::FactsQuestion{word(0), word(1), {}});
              } else {
                memory::Store store = open_to_change(memory, session);
                answer = action == "set" ? set_fact(store, word(0), word(1), word(2))
                                         : remove_fact(store, word(0), word(1), word(2));
              }
              session.answer(to_text(answer), to_json(answer));
            };
          }};
}

Command teach_command() {
  return {"teach",
          "Teach a class by example: what looks like the object is called so, too",
          {"loci-memory teach object_1 mug -m demo-output/memory.loci",
           "loci-memory teach object_2 \"cereal box\" -m demo-output/memory.loci --json"},
          [](ArgumentTable& table) {
            struct Arguments {
              std::string memory, object, class_name;
            };
            auto arguments = std::make_shared<Arguments>();
            table.positional("OBJECT", &arguments->object, "The example, by name or description");
            table.positional("CLASS", &arguments->class_name, "What it is");
            table.memory(arguments->memory);
            return [arguments](Session& session) {
              memory::Store store = open_to_change(arguments->memory, session);
              set_fact(store, arguments->object, "class", arguments->class_name);
              set_fact(store, arguments->object, memory::kTaughtKey, arguments->class_name);
              const memory::CatalogueResult result = apply_catalogues(store);
              session.answer(result.summary(), result.report());
            };
          }};
}

Command taxonomy_command() {
  return {
      "taxonomy",
      "Load or list the taxonomy of object classes",
      {"loci-memory taxonomy load apps/samples/household.yaml -m demo-output/memory.loci",
       "loci-memory taxonomy list -m demo-output/memory.loci --json"},
      [](ArgumentTable& table) {
        struct Arguments {
          std::string memory, action, file;
        };
        auto arguments = std::make_shared<Arguments>();
        table.positional("ACTION", &arguments->action, "load FILE, or list", {.choices = {"load", "list"}});
        table.positional("[FILE]", &arguments->file, "Taxonomy to load, YAML");
        table.memory(arguments->memory);
        return [arguments](Session& session) {
          memory::Taxonomy taxonomy;
          if (arguments->action == "load") {
            if (arguments->file.empty()) throw UsageError("FILE is required");
            taxonomy = memory::Taxonomy::read(arguments->file);
            memory::Store store = open_to_change(arguments->memory, session);
            taxonomy.save(store);
          } else {
            taxonomy = memory::Taxonomy::of(open_memory(arguments->memory, session), {});
          }
          session.answer(to_text(taxonomy), to_json(taxonomy));
        };
      }};
}

}  // namespace loci::apps
