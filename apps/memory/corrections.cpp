// Corrections: edit, fact, taxonomy.

#include <fmt/format.h>

#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"
#include "mapping/base/json.h"
#include "memory/catalogue/catalogue.h"
#include "memory/edits/edits.h"
#include "memory/questions/facts.h"
#include "memory/questions/snapshot.h"
#include "memory/questions/taxonomy.h"
#include "memory/questions/time_parser.h"

namespace loci::apps {

namespace {

constexpr const char* kForms =
    "merge X Y, split X TIME, label SCENE NUMBER CLASS, joint NAME TYPE, part X [NAME], undo, redo or list";

struct EditArguments {
  std::string memory, action;
  std::vector<std::string> words;
};

size_t min_words(const std::string& action) {
  if (action == "label") return 3;
  if (action == "part") return 1;
  if (action == "undo" || action == "redo" || action == "list") return 0;
  return 2;
}

memory::Id number_of(const std::string& word, const char* what) {
  try {
    size_t end = 0;
    const memory::Id number = std::stoll(word, &end);
    if (end == word.size()) return number;
  } catch (const std::exception&) {  // reported below
  }
  throw Error(fmt::format("'{}' is not the number of {}", word, what), {}, "loci-memory scenes lists them");
}

/// The one object that words mean.
memory::Id object_of(const memory::Store& store, const std::string& words) {
  const std::vector<memory::Id> objects = memory::Snapshot(store, {}).find_objects(words);
  if (objects.size() == 1) return objects.front();
  throw Error(fmt::format("'{}' may be any of {} objects", words, objects.size()), {},
              "name one, as object_3");
}

memory::Edit make_edit(memory::Store& store, const EditArguments& arguments, Progress& progress) {
  const auto& [memory, action, words] = arguments;
  if (action == "merge")
    return merge_objects(store, object_of(store, words[0]), object_of(store, words[1]), progress);
  if (action == "split")
    return split_object(store, object_of(store, words[0]), memory::TimeReader(store).read(words[1]).first,
                        progress);
  if (action == "label")
    return label_observation(store, number_of(words[0], "a scene"), number_of(words[1], "an observation"),
                             words[2]);
  if (action == "joint") return set_joint_type(store, words[0], words[1]);
  if (action == "part") return name_part(store, words[0], words.size() > 1 ? words[1] : "");
  return action == "undo" ? undo(store, progress) : redo(store, progress);
}

Json json_of(const std::vector<memory::Edit>& list) {
  Json json = Json::array();
  for (const memory::Edit& edit : list)
    json.push_back({{"run", edit.run}, {"known", format_time(edit.known)}, {"edit", edit.text}});
  return json;
}

void answer_list(Session& session, const memory::EditList& list) {
  std::string text = list.done.empty() && list.undone.empty() ? "Nothing was edited.\n" : "";
  for (const memory::Edit& edit : list.done) text += edit.text + "\n";
  for (auto edit = list.undone.rbegin(); edit != list.undone.rend(); ++edit)
    text += edit->text + " (undone)\n";
  session.answer(text, {{"done", json_of(list.done)}, {"undone", json_of(list.undone)}});
}

}  // namespace

Command edit_command() {
  return {
      "edit",
      "Correct object identities, labels and parts of the map, with undo",
      {"loci-memory edit label 3 1 cup -m demo-output/memory.loci",
       "loci-memory edit list -m demo-output/memory.loci --json"},
      [](ArgumentTable& table) {
        auto arguments = std::make_shared<EditArguments>();
        table.positional("ACTION", &arguments->action, kForms,
                         {.choices = {"merge", "split", "label", "joint", "part", "undo", "redo", "list"}});
        table.positional("[WORD...]", &arguments->words,
                         "X, Y: objects; part: a place, link or joint; TIME: \"08:30\", \"yesterday 9:00\"");
        table.memory(arguments->memory);
        return [arguments](Session& session) {
          const size_t least = min_words(arguments->action), given = arguments->words.size();
          const size_t optional = arguments->action == "part" ? 1 : 0;
          if (given < least || given > least + optional)
            throw UsageError(std::string("the actions are ") + kForms);
          if (arguments->action == "list")
            return answer_list(session, edits(memory::Store::open_read(arguments->memory)));
          memory::Store store = open_to_change(arguments->memory, session);
          const memory::Edit edit = make_edit(store, *arguments, session.progress());
          const std::string done = arguments->action == "undo" ? "Undone: " : "Done: ";
          Json json = json_of({edit}).front();
          if (!edit.note.empty()) json["note"] = edit.note;
          session.answer(done + edit.text + (edit.note.empty() ? "" : "; " + edit.note) + "\n", json);
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
                answer = ask(memory::Store::open_read(memory), memory::FactsQuestion{word(0), word(1), {}});
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
            taxonomy = memory::Taxonomy::of(memory::Store::open_read(arguments->memory), {});
          }
          session.answer(to_text(taxonomy), to_json(taxonomy));
        };
      }};
}

}  // namespace loci::apps
