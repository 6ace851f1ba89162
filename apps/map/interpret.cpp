#include <fmt/format.h>

#include "apps/map/commands.h"
#include "mapping/base/files.h"
#include "mapping/base/json.h"
#include "mapping/exchange/map_report.h"
#include "mapping/interpretation/furniture/names.h"
#include "mapping/interpretation/interpretation.h"
#include "mapping/world/urdf.h"

namespace loci::apps {
namespace {

/// The most telling numbers of a link's geometry, by what its class has of them.
std::string where_text(const Json& geometry) {
  if (geometry.contains("offset")) return fmt::format("offset {:.3f} m", geometry["offset"].get<double>());
  std::string text;
  if (geometry.contains("width"))
    text =
        fmt::format("{:.3f} x {:.3f} m", geometry["width"].get<double>(), geometry["height"].get<double>());
  else if (geometry.contains("height"))
    text = fmt::format("height {:.3f} m", geometry["height"].get<double>());
  else if (geometry.contains("length"))
    text = fmt::format("{:.3f} m long", geometry["length"].get<double>());
  if (!geometry.contains("centre")) return text;
  const Json& centre = geometry["centre"];
  return text + fmt::format(" at ({:.3f}, {:.3f}, {:.3f})", centre[0].get<double>(), centre[1].get<double>(),
                            centre[2].get<double>());
}

std::string answer_text(const mapping::InterpretedMap& map, const std::string& folder) {
  std::string text = map.summary() + "\n";
  for (const auto& [name, link] : map.semantics.links) {
    text += fmt::format("  {:<16} {}, confidence {:.2f}\n", name, where_text(link.geometry), link.confidence);
  }
  return text + "in " + folder + "/map.urdf\n";
}

}  // namespace

Command interpret_command() {
  return {"interpret",
          "A scan set to a map: floor, walls, supports",
          {"loci-map interpret demo-output/scans -o demo-output",
           "loci-map interpret demo-output/scans -o demo-output/map --json"},
          [](ArgumentTable& table) {
            struct Arguments {
              std::string scans, out, names_from;
              mapping::InterpretationOptions options;
            };
            auto arguments = std::make_shared<Arguments>();
            table.positional("SCANS", &arguments->scans, "Folder of a scan set, or a PCD file");
            table.option("-o,--output", &arguments->out, "Folder of the map", {.required = true});
            table.option("--names-from", &arguments->names_from,
                         "Older map (URDF) of the place: what was there before keeps its name");
            table.options(table_of(arguments->options));
            return [arguments](Session& session) {
              arguments->options.threads = session.flags().threads;
              const mapping::ScanSet scans = mapping::read_scan_set(arguments->scans);
              mapping::InterpretedMap map = interpret(scans, arguments->options, session.progress());
              for (const std::string& note : map.notes) session.warnings().add(note);
              for (const mapping::StageTime& time : map.times) session.timing(time.stage, time.seconds);
              if (!map.usable()) throw Error(map.summary(), {arguments->scans, 0, ""}, "nothing was written");
              if (!arguments->names_from.empty()) {
                const mapping::NameTransfer names =
                    transfer_names(map.world, map.semantics,
                                   mapping::read_semantic_map(mapping::sidecar_path(arguments->names_from)));
                for (const std::string& name : names.vanished)
                  session.warnings().add("'" + name + "' of the older map was not found again");
              }
              make_folder(arguments->out);
              const std::filesystem::path urdf = std::filesystem::path(arguments->out) / "map.urdf";
              write_urdf(map.world, urdf);
              write_semantic_map(map.semantics, mapping::sidecar_path(urdf));
              write_file_atomically(std::filesystem::path(arguments->out) / "report.html",
                                    map_report(map, scans, arguments->scans));
              session.answer(answer_text(map, arguments->out), map.report());
            };
          }};
}

}  // namespace loci::apps
