#include "apps/evaluate/commands.h"
#include "apps/evaluate/occupancy/insertion.h"
#include "mapping/base/text/json.h"

namespace loci::apps {
namespace {

struct Arguments {
  std::vector<std::string> scans;
  occupancy_claim::InsertionOptions options;
};

void run(Arguments& arguments, Session& session) {
  table_of(arguments.options).validate();
  std::vector<occupancy_claim::SetResult> results;
  const auto count = static_cast<double>(arguments.scans.size());
  for (const std::string& path : arguments.scans) {
    const auto done = static_cast<double>(results.size());
    PartialProgress part(session.progress(), done / count, (done + 1) / count);
    const std::filesystem::path folder = std::filesystem::path(path).lexically_normal();
    results.push_back(occupancy_claim::measure(folder.stem().string(), mapping::read_scan_set(folder),
                                               arguments.options, part));
  }
  session.answer(occupancy_claim::table_text(results), {{"options", table_of(arguments.options).to_json()},
                                                        {"sets", occupancy_claim::table_json(results)}});
}

}  // namespace

Command occupancy_command() {
  return {"occupancy",
          "Insertion of scans against OctoMap's insertPointCloud: time and equality of the trees",
          {"loci-evaluate occupancy demo-output/explored/scans --repeats 1",
           "loci-evaluate occupancy demo-output/explored/scans --repeats 1 --resolution-m 0.1 --json"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<Arguments>();
            table.positional("SCANS...", &arguments->scans, "Folders of scans, or single clouds (PCD)");
            table.options(table_of(arguments->options));
            return [arguments](Session& session) { run(*arguments, session); };
          }};
}

}  // namespace loci::apps
