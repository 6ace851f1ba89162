#include <fmt/format.h>

#include <filesystem>

#include "apps/simulate/commands.h"
#include "mapping/base/files.h"
#include "mapping/simulation/kitchen.h"
#include "mapping/world/map_files.h"

namespace loci::apps {
namespace {

struct KitchenArguments {
  std::string layout, out;
  int seed = 0;

  void declare(OptionTable& table) {
    table.integer("seed", seed, "", "The same seed draws the same kitchen.", 0, 1 << 30);
  }
};

void draw(KitchenArguments& arguments, Session& session) {
  table_of(arguments).validate();
  const auto seed = static_cast<uint64_t>(arguments.seed);
  const std::string layout =
      !arguments.layout.empty()
          ? arguments.layout
          : std::string(mapping::kKitchenLayouts[seed % mapping::kKitchenLayouts.size()]);
  const mapping::DrawnKitchen kitchen = mapping::draw_kitchen(layout, seed);
  const std::filesystem::path urdf = std::filesystem::path(arguments.out) / "kitchen.urdf";
  session.check_outputs(arguments.out, {"kitchen.urdf", "kitchen.semantic.json"});
  make_folder(arguments.out);
  mapping::write_map(kitchen.world, kitchen.semantics, urdf);
  std::map<std::string, int> counts;
  for (const auto& [name, link] : kitchen.semantics.links) ++counts[link.class_name];
  session.answer(fmt::format("{}: a kitchen of layout '{}' with {} drawers, {} doors, {} flaps, {} handles "
                             "and {} knobs",
                             urdf.string(), layout, counts["drawer"], counts["door"], counts["flap"],
                             counts["handle"], counts["knob"]),
                 {{"map", urdf.string()}, {"layout", layout}, {"counts", counts}});
}

}  // namespace

Command kitchen_command() {
  return {"kitchen",
          "Draw a kitchen with ground truth",
          {"loci-simulate kitchen --seed 4 -o demo-output/drawn",
           "loci-simulate kitchen --layout peninsula --seed 7 -o demo-output/peninsula"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<KitchenArguments>();
            table.output("FOLDER", &arguments->out,
                         "Folder of kitchen.urdf and its sidecar, which is the truth", {.replaces = true});
            table.option("--layout NAME", &arguments->layout, "Layout of the furniture",
                         {.default_text = "follows the seed",
                          .choices = {mapping::kKitchenLayouts.begin(), mapping::kKitchenLayouts.end()}});
            table.options(table_of(*arguments), "Kitchen");
            return [arguments](Session& session) { draw(*arguments, session); };
          }};
}

}  // namespace loci::apps
