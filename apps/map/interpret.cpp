#include <fmt/format.h>

#include "apps/map/commands.h"
#include "mapping/base/files.h"
#include "mapping/exchange/map_report.h"
#include "mapping/interpretation/interpretation.h"
#include "mapping/world/urdf.h"

namespace loci {
namespace {

std::string answer_text(const InterpretedMap& map, const std::string& folder) {
  std::string text = map.summary() + "\n";
  for (const auto& [name, link] : map.semantics.links) {
    const Json& geometry = link.geometry;
    const std::string where = geometry.contains("height")
                                  ? fmt::format("height {:.3f} m", geometry["height"].get<double>())
                                  : fmt::format("offset {:.3f} m", geometry["offset"].get<double>());
    text += fmt::format("  {:<14} {}, confidence {:.2f}\n", name, where, link.confidence);
  }
  return text + "in " + folder + "/map.urdf\n";
}

}  // namespace

Command interpret_command() {
  return {"interpret",
          "A scan set to a map: floor, walls, supports",
          {"loci-map interpret demo-output/scans -o demo-output",
           "loci-map interpret demo-output/scans -o demo-output/map --json"},
          [](CLI::App& app) {
            struct Arguments {
              std::string scans, out;
              InterpretationOptions options;
            };
            auto arguments = std::make_shared<Arguments>();
            app.add_option("SCANS", arguments->scans, "Folder of a scan set, or a PCD file")->required();
            app.add_option("-o,--out", arguments->out, "Folder of the map")->required();
            add_options(app, table_of(arguments->options));
            return [arguments](Session& session) {
              arguments->options.threads = session.flags().threads;
              const ScanSet scans = read_scan_set(arguments->scans);
              const InterpretedMap map = interpret(scans, arguments->options, session.progress());
              for (const std::string& note : map.notes) session.warnings().add(note);
              for (const StageTime& time : map.times) session.timing(time.stage, time.seconds);
              if (!map.usable()) throw Error(map.summary(), {arguments->scans, 0, ""}, "nothing was written");
              make_folder(arguments->out);
              const std::filesystem::path urdf = std::filesystem::path(arguments->out) / "map.urdf";
              write_urdf(map.world, urdf);
              write_semantic_map(map.semantics, sidecar_path(urdf));
              write_file_atomically(std::filesystem::path(arguments->out) / "report.html",
                                    map_report(map, scans, arguments->scans));
              session.answer(answer_text(map, arguments->out), map.report());
            };
          }};
}

}  // namespace loci
