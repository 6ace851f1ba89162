#include "apps/evaluate/commands.h"
#include "apps/evaluate/fleet/figures.h"
#include "mapping/base/files.h"
#include "mapping/base/text/json.h"

namespace loci::apps {

Command fleet_command() {
  return {"fleet",
          "Memories of many robots in PostgreSQL: pushes, questions of several users, lag",
          {"loci-evaluate fleet postgresql:///loci --robots 2 --observations 500 --questions 20 --lag-scenes "
           "2 -o "
           "demo-output/fleet-figures",
           "loci-evaluate fleet postgresql:///loci --robots 2 --observations 500 --questions 20 --lag-scenes "
           "2 -o "
           "demo-output/fleet-figures --json"},
          [](ArgumentTable& table) {
            struct Arguments {
              fleet_experiment::FleetOptions options;
              std::string url, folder;
            };
            auto arguments = std::make_shared<Arguments>();
            table.positional("URL", &arguments->url,
                             "A database of this machine; robots of these names are replaced");
            table.options(table_of(arguments->options));
            table.output("FOLDER", &arguments->folder, "Folder for memories and replicas");
            return [arguments](Session& session) {
              table_of(arguments->options).validate();
              make_folder(arguments->folder);
              const fleet_experiment::FleetFigures figures = fleet_experiment::measure(
                  arguments->options, arguments->url, arguments->folder, session.progress());
              session.answer(text_of(figures), json_of(figures));
            };
          }};
}

}  // namespace loci::apps
