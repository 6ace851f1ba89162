#include "apps/evaluate/commands.h"
#include "apps/evaluate/normals/comparison.h"
#include "apps/evaluate/normals/figures.h"
#include "mapping/base/text/json.h"

namespace loci::apps {
namespace {

using namespace normals_evaluation;

struct Arguments {
  std::vector<std::filesystem::path> recordings;
  std::string figures;
  normals_evaluation::ComparisonOptions comparison;
  perception::NormalOptions normals;
};

void run(Arguments& arguments, Session& session) {
  table_of(arguments.comparison).validate();
  table_of(arguments.normals).validate();
  const normals_evaluation::Comparison comparison =
      compare(arguments.recordings, arguments.comparison, arguments.normals, session.progress());
  if (!arguments.figures.empty()) write_figures(comparison, arguments.figures);
  session.answer(comparison.text(), comparison.to_json());
}

}  // namespace

Command normals_command() {
  return {"normals",
          "Normal estimation against other methods",
          {"loci-evaluate normals --frames 2 --reference-frames 0 -o demo-output/normals",
           "loci-evaluate normals demo-output/day --frames 1 --reference-frames 0 --min-holes 0 --json"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<Arguments>();
            table.positional("[RECORDING...]", &arguments->recordings,
                             "Recordings whose frames are judged by their flat areas");
            table.option("-o,--output FOLDER", &arguments->figures, "Folder for figures 4.2 to 4.6 as SVG");
            table.options(table_of(arguments->comparison), "Comparison");
            table.options(table_of(arguments->normals), "Estimator");
            return [arguments](Session& session) { run(*arguments, session); };
          }};
}

}  // namespace loci::apps
