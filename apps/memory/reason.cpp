#include "memory/reasoning/reason.h"

#include "apps/memory/commands.h"
#include "mapping/base/json.h"

namespace loci::apps {

Command reason_command() {
  return {
      "reason",
      "Runs the reasoning again over the whole past, with other parameters",
      {"loci-memory reason -m demo-output/memory.loci -o demo-output/other.loci --move-time-s 7200 --compare",
       "loci-memory reason -m demo-output/memory.loci -o demo-output/other.loci --only-compare --json"},
      [](ArgumentTable& table) {
        struct Arguments {
          std::string memory, other, now;
          bool compare = false, only_compare = false;
          memory::belief::BeliefOptions options;
        };
        auto arguments = std::make_shared<Arguments>();
        table.memory(arguments->memory);
        table.option("-o,--output", &arguments->other, "New memory for the other history",
                     {.required = true});
        table.flag("--compare", arguments->compare, "Then say what the two histories tell differently");
        table.flag("--only-compare", arguments->only_compare,
                   "Reason nothing: compare with a history made before");
        table.option("--now", &arguments->now, "When the memory learns it, ISO 8601",
                     {.default_text = "the clock"});
        table.options(table_of(arguments->options));
        return [arguments](Session& session) {
          const memory::Store store = memory::Store::open_read(arguments->memory);
          memory::WriteOptions write;
          if (!arguments->now.empty()) write.now = parse_time(arguments->now);
          std::string text;
          Json json = Json::object();
          if (!arguments->only_compare) {
            const memory::ReasonResult result =
                reason(store, arguments->other, arguments->options, write, session.progress());
            text = result.summary() + "\n";
            json = result.report();
          }
          if (arguments->compare || arguments->only_compare) {
            const memory::HistoryDifference difference =
                compare_histories(store, memory::Store::open_read(arguments->other));
            text += difference.text();
            json["difference"] = difference.to_json();
          }
          session.answer(text, json);
        };
      }};
}

}  // namespace loci::apps
