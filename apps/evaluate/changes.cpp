#include "apps/evaluate/changes/comparison.h"
#include "apps/evaluate/changes/mistakes.h"
#include "apps/evaluate/changes/remember.h"
#include "apps/evaluate/commands.h"
#include "mapping/base/files.h"
#include "mapping/base/temporary_folder.h"
#include "mapping/base/text/json.h"

namespace loci::apps {
namespace {

struct Arguments {
  std::string folder;
  std::string memory;
  std::string map;
  std::string pipeline;
  std::string diagram, mistakes;
};

void run(const Arguments& arguments, Session& session) {
  if (!arguments.mistakes.empty()) {
    make_folder(arguments.mistakes);
    session.check_outputs(arguments.mistakes, {changes::kMistakesFile});
  }
  const std::shared_ptr<mapping::Recording> recording = mapping::open_recording(arguments.folder);
  const TemporaryFolder folder("loci-evaluate-changes");
  changes::RememberOptions options;
  options.memory =
      arguments.memory.empty() ? folder.path() / "memory.loci" : std::filesystem::path(arguments.memory);
  options.map = arguments.map;
  options.pipeline = arguments.pipeline;
  options.program = "loci-evaluate changes";
  options.threads = session.flags().threads;
  changes::remember(recording, options, session.progress(), session.warnings());
  const memory::Store store = memory::Store::open_read(options.memory);
  const std::vector<changes::Comparison> methods = changes::compare_all(arguments.folder, *recording, store);
  if (!arguments.diagram.empty())
    write_file_atomically(arguments.diagram,
                          changes::reliability_diagrams(changes::stated_associations(methods)));
  if (!arguments.mistakes.empty())
    write_file_atomically(std::filesystem::path(arguments.mistakes) / changes::kMistakesFile,
                          changes::mistakes_page(
                              changes::worst_mistakes(methods.front(), arguments.folder, *recording, store)));
  session.answer(changes::text(methods, session.flags().verbose), changes::to_json(methods));
}

}  // namespace

Command changes_command() {
  return {"changes",
          "Events of the memory against ground truth and baselines",
          {"loci-evaluate changes demo-output/day --map apps/samples/kitchen.urdf",
           "loci-evaluate changes demo-output/day --map apps/samples/kitchen.urdf --json"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<Arguments>();
            table.positional("RECORDING", &arguments->folder,
                             "Recording with objects.csv and transitions.csv, or truth.jsonl");
            table.option("-o,--output MEMORY", &arguments->memory, "Keep the memory in this file");
            table.option("--map MAP", &arguments->map, "URDF of the map; the sidecar is found beside it");
            table.option("--diagram FILE", &arguments->diagram, "Draw the reliability of associations (SVG)",
                         {.replaces = true});
            table.option("--mistakes FOLDER", &arguments->mistakes,
                         "Write mistakes.html, a page of the ten worst mistakes, into this folder",
                         {.replaces = true});
            table.option("--pipeline FILE", &arguments->pipeline,
                         "Pipeline as YAML instead of the default one");
            return [arguments](Session& session) { run(*arguments, session); };
          }};
}

}  // namespace loci::apps
