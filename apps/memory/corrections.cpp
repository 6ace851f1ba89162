// Corrections: edit, fact, teach, taxonomy, map.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"
#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "memory/catalogue/catalogue.h"
#include "memory/edits/edit_actions.h"
#include "memory/questions/facts.h"
#include "memory/questions/names/taxonomy.h"
#include "memory/recorder/map_entry.h"

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

void answer_maps(Session& session, const memory::Store& store) {
  const memory::TimeWriter times(store);
  std::string text;
  Json maps = Json::array();
  for (const memory::MapPeriod& period : map_periods(store)) {
    text += fmt::format("{} from {} on, {}", period.name, times.text(period.from),
                        counted(static_cast<size_t>(period.scenes), "scene"));
    if (!period.moved.empty()) text += fmt::format("; moved: {}", fmt::join(period.moved, ", "));
    text += "\n";
    maps.push_back({{"name", period.name},
                    {"from", format_time(period.from)},
                    {"scenes", period.scenes},
                    {"moved", period.moved}});
  }
  session.answer(text.empty() ? "No scene was perceived with a map.\n" : text, {{"maps", maps}});
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
              if (arguments->action == "list") {
                const memory::EditList list = edits(open_memory(arguments->memory, session));
                return session.answer(to_text(list), to_json(list));
              }
              const memory::Query query = arguments->query();
              memory::Store store = open_to_change(arguments->memory, session);
              const memory::Edit edit = make_edit(store, query, session.progress());
              session.answer(summary(edit), result_json(edit));
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
                memory::ChangeTransaction all(store);
                answer = action == "set" ? set_fact(store, word(0), word(1), word(2))
                                         : remove_fact(store, word(0), word(1), word(2));
                apply_catalogues(store);  // of what was an example, or is called otherwise now
                all.commit();
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
              const memory::CatalogueResult result =
                  memory::teach(store, arguments->object, arguments->class_name);
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

Command map_command() {
  return {"map",
          "Tell that furniture was moved: the map of the room from a time on",
          {"loci-memory map list -m demo-output/memory.loci",
           "loci-memory map add apps/samples/kitchen.urdf -m demo-output/detections_map.loci"},
          [](ArgumentTable& table) {
            struct Arguments {
              std::string memory, action, urdf, at;
            };
            auto arguments = std::make_shared<Arguments>();
            table.positional("ACTION", &arguments->action,
                             "list, or add MAP: what lies on furniture that moved has moved along",
                             {.choices = {"add", "list"}});
            table.positional("[MAP]", &arguments->urdf, "URDF of the map; the sidecar is found beside it");
            table.memory(arguments->memory);
            table.option("--at TIME", &arguments->at, "From then on: \"08:30\", \"today 9:00\"",
                         {.default_text = "a second after the last scene"});
            return [arguments](Session& session) {
              if (arguments->action == "list")
                return answer_maps(session, open_memory(arguments->memory, session));
              if (arguments->urdf.empty()) throw UsageError("the actions are add MAP and list");
              memory::Store store = open_to_change(arguments->memory, session);
              const TimeNs at = arguments->at.empty() ? store.last_scene_time().value_or(0) + kSecond
                                                      : memory::TimeReader(store).read(arguments->at).first;
              enter_map(store, arguments->urdf, at, "loci-memory map");
              answer_maps(session, store);
            };
          }};
}

}  // namespace loci::apps
