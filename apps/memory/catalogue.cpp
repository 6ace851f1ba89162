#include "memory/catalogue/catalogue.h"

#include <fmt/format.h>

#include "apps/memory/commands.h"
#include "mapping/base/files.h"
#include "mapping/base/json.h"

namespace loci::apps {
namespace {

struct Arguments {
  std::string action, file, memory;
};

void export_to(const Arguments& arguments, Session& session) {
  const memory::Catalogue catalogue = catalogue_of(memory::Store::open_read(arguments.memory));
  write_file_atomically(arguments.file, to_json(catalogue).dump(1) + "\n");
  std::map<std::string, size_t> classes;
  for (const memory::CatalogueEntry& entry : catalogue.entries) ++classes[entry.class_name];
  std::string text = fmt::format("{} things in {}", catalogue.entries.size(), arguments.file);
  Json named = Json::object();
  for (const auto& [name, count] : classes) {
    text += fmt::format("\n  {:20} {:4}", name.empty() ? "(nobody says what)" : name, count);
    if (!name.empty()) named[name] = count;
  }
  session.answer(text, {{"things", catalogue.entries.size()}, {"classes", named}, {"file", arguments.file}});
}

void import_from(const Arguments& arguments, Session& session) {
  const memory::Catalogue catalogue = memory::read_home_catalogue(arguments.file);
  memory::Store::open_read(arguments.memory);  // a mistyped name must not make a new memory
  memory::Store store = memory::Store::open_write(arguments.memory);
  const memory::CatalogueResult result = import_catalogue(store, catalogue);
  session.answer(result.summary(), result.report());
}

}  // namespace

Command catalogue_command() {
  return {"catalogue",
          "Object knowledge to and from another home: what there is, its names, looks and habits",
          {"loci-memory catalogue export demo-output/catalogue.json -m demo-output/memory.loci",
           "loci-memory catalogue import demo-output/catalogue.json -m demo-output/detections.loci --json"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<Arguments>();
            table.positional("ACTION", &arguments->action, "export FILE, or import FILE",
                             {.choices = {"export", "import"}});
            table.positional("FILE", &arguments->file, "The catalogue, JSON");
            table.memory(arguments->memory);
            return [arguments](Session& session) {
              arguments->action == "export" ? export_to(*arguments, session)
                                            : import_from(*arguments, session);
            };
          }};
}

}  // namespace loci::apps
