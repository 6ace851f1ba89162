#include "apps/evaluate/commands.h"
#include "apps/evaluate/nbv/exploration.h"
#include "mapping/base/files.h"
#include "mapping/base/text/json.h"

namespace loci::apps {
namespace {

struct Arguments {
  std::vector<std::string> worlds = {"apps/samples/kitchen.urdf"};
  std::vector<std::filesystem::path> package_paths;
  std::string image, out;
  nbv_evaluation::ExplorationOptions options;
};

void run(Arguments& arguments, Session& session) {
  nbv_evaluation::ExplorationOptions& options = arguments.options;
  table_of(options).validate();
  options.threads = options.planner.threads = options.occupancy.threads = session.flags().threads;
  std::vector<nbv_evaluation::WorldResult> results;
  Json json = {{"options", table_of(options).to_json()}};
  if (!arguments.out.empty()) write_json(arguments.out, json);  // Hours later would be too late to fail.
  const auto count = static_cast<double>(arguments.worlds.size());
  for (size_t i = 0; i < arguments.worlds.size(); ++i) {
    PartialProgress part(session.progress(), static_cast<double>(i) / count,
                         static_cast<double>(i + 1) / count);
    results.push_back(nbv_evaluation::explore(arguments.worlds[i], arguments.package_paths, options, part,
                                              session.warnings()));
    json["worlds"] = nbv_evaluation::json_of_results(results, options.goal);
    if (!arguments.out.empty()) write_json(arguments.out, json);
    if (!arguments.image.empty())
      write_file_atomically(arguments.image, nbv_evaluation::coverage_svg(results, options.goal));
  }
  session.answer(nbv_evaluation::table_of_results(results, options.goal), json);
}

}  // namespace

Command nbv_command() {
  return {"nbv",
          "Next best view against other planners: coverage per number of scans, and time",
          {"loci-evaluate nbv apps/samples/kitchen.urdf --starts 1 --max-scans 2 --ray-step-deg 4",
           "loci-evaluate nbv apps/samples/kitchen.urdf --starts 1 --max-scans 2 --ray-step-deg 4 --json"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<Arguments>();
            table.positional("[WORLD...]", &arguments->worlds, "Worlds (URDF)");
            table.package_path(&arguments->package_paths);
            table.option("--ceiling HEIGHT", &arguments->options.ceiling, "Add a ceiling at this height",
                         {.unit = "m"});
            table.option("--planners NAME...", &arguments->options.planners, "Planners to run",
                         {.choices = nbv_evaluation::planner_names(), .open_end = true});
            table.option("-o,--output FILE", &arguments->out, "Write the results as JSON, after each world",
                         {.replaces = true});
            table.option("--figure FILE", &arguments->image,
                         "Write coverage over scans as SVG, after each world", {.replaces = true});
            table.options(table_of(arguments->options));
            return [arguments](Session& session) { run(*arguments, session); };
          }};
}

}  // namespace loci::apps
