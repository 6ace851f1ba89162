#include <algorithm>

#include "apps/perceive/annotators.h"
#include "apps/perceive/commands.h"
#include "mapping/base/json.h"
#include "perception/annotators/annotators.h"
#include "perception/pipeline/pipeline.h"

namespace loci {
namespace {

template <class Declarer>
void answer(Declarer& declarer, Session& session) {
  OptionTable table;
  declarer.declare(table);
  session.answer(description_text(declarer.descriptor(), table), describe(declarer.descriptor(), table));
}

void describe_named(const std::string& name, Session& session) {
  const AnnotatorRegistry registry = all_annotators();
  if (name == "pipeline") {
    session.answer(default_pipeline(),
                   Pipeline::parse(default_pipeline(), "the default pipeline", registry).to_json());
    return;
  }
  const std::vector<std::string> readers = registry.readers();
  if (std::find(readers.begin(), readers.end(), name) != readers.end())
    answer(*registry.make_reader(name), session);
  else
    answer(*registry.make(name), session);
}

}  // namespace

Command describe_command() {
  return {"describe",
          "Describes one annotator, or the default pipeline",
          {"loci-perceive describe PlaneClusterExtractor", "loci-perceive describe pipeline"},
          [](CLI::App& app) {
            auto name = std::make_shared<std::string>();
            app.add_option("NAME", *name, "Annotator, reader, or 'pipeline'")->required();
            return [name](Session& session) { describe_named(*name, session); };
          }};
}

}  // namespace loci
