#include "apps/evaluate/commands.h"
#include "apps/evaluate/identity/report.h"
#include "mapping/base/text/json.h"

namespace loci::apps {
namespace {

using namespace identity_experiment;

struct Arguments {
  identity_experiment::WorldOptions world;
  identity_experiment::ExperimentOptions experiment;
  std::string figures;
  bool speed = false;
};

void run(Arguments& arguments, Session& session) {
  table_of(arguments.world).validate();
  table_of(arguments.experiment).validate();
  if (arguments.speed) {
    const std::vector<identity_experiment::SpeedRow> rows =
        identity_experiment::measure_speed(arguments.experiment.seed);
    session.answer(text_of(rows), json_of(rows));
    return;
  }
  const identity_experiment::ExperimentResult result =
      run_experiment(arguments.world, arguments.experiment, session.flags().threads, session.progress());
  if (!arguments.figures.empty()) write_figures(result, arguments.figures);
  session.answer(text_of(result, session.flags().verbose), json_of(result));
}

}  // namespace

Command identity_command() {
  return {"identity",
          "Data association by the belief of loci, by the model of the paper and by simpler ones",
          {"loci-evaluate identity --runs 1 -o demo-output/identity",
           "loci-evaluate identity --runs 1 --tables 8 --json"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<Arguments>();
            table.options(table_of(arguments->experiment), "Experiment");
            table.options(table_of(arguments->world), "Simulated world");
            table.option("-o,--output FOLDER", &arguments->figures, "Folder for figures 6.5 and 6.8 as SVG");
            table.flag("--speed", arguments->speed, "Measure the time of the solver instead");
            return [arguments](Session& session) { run(*arguments, session); };
          }};
}

}  // namespace loci::apps
