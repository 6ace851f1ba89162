#include <fmt/format.h>

#include "apps/perceive/annotators.h"
#include "apps/perceive/commands.h"
#include "mapping/base/json.h"

namespace loci {
namespace {

template <class Declarer>
Json entry(Declarer& declarer) {
  OptionTable table;
  declarer.declare(table);
  return describe(declarer.descriptor(), table);
}

void list(Session& session) {
  const AnnotatorRegistry registry = all_annotators();
  Json json = {{"readers", Json::array()}, {"annotators", Json::array()}};
  std::string text;
  for (const std::string& name : registry.readers()) {
    const auto reader = registry.make_reader(name);
    json["readers"].push_back(entry(*reader));
    text += fmt::format("{:<24}{} (reader)\n", name, reader->descriptor().sentence);
  }
  for (const std::string& name : registry.annotators()) {
    const auto annotator = registry.make(name);
    json["annotators"].push_back(entry(*annotator));
    text += fmt::format("{:<24}{}\n", name, annotator->descriptor().sentence);
  }
  session.answer(text, json);
}

}  // namespace

Command list_command() {
  return {"list", "Lists the annotators", {"loci-perceive list", "loci-perceive list --json"}, [](CLI::App&) {
            return [](Session& session) { list(session); };
          }};
}

}  // namespace loci
