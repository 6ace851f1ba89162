#include "apps/evaluate/commands.h"
#include "apps/evaluate/identity/tables.h"

namespace loci {
namespace {

using namespace identity_experiment;

struct Arguments {
  WorldOptions world;
  ExperimentOptions experiment;
};

void run(Arguments& arguments, Session& session) {
  table_of(arguments.world).validate();
  table_of(arguments.experiment).validate();
  const ExperimentResult result =
      run_experiment(arguments.world, arguments.experiment, session.flags().threads, session.progress());
  session.answer(text_of(result, session.flags().verbose), json_of(result));
}

}  // namespace

Command identity_command() {
  return {"identity",
          "The identity experiment: who is who and what happened, beside greedy and paper",
          {"loci-evaluate identity --runs 1", "loci-evaluate identity --runs 1 --noise estimated --json"},
          [](CLI::App& app) {
            auto arguments = std::make_shared<Arguments>();
            add_options(app, table_of(arguments->experiment));
            add_options(app, table_of(arguments->world));
            return [arguments](Session& session) { run(*arguments, session); };
          }};
}

}  // namespace loci
