#include <fmt/format.h>

#include "apps/map/commands.h"
#include "mapping/articulation/articulation.h"
#include "mapping/base/text/json.h"
#include "mapping/interpretation/furniture/furniture_links.h"
#include "mapping/world/map_files.h"
#include "mapping/world/mesh_files.h"
#include "mapping/world/semantic_map.h"
#include "mapping/world/urdf.h"

namespace loci::apps {
namespace {

struct ArticulateArguments {
  std::string track, before, after, map, front, out;
  mapping::TrackOptions options;
  mapping::DifferenceOptions difference;
};

/// Puts a front that has learned its joint in the place of the one of its name.
void replace_front(const mapping::Front& front, mapping::World& world, mapping::SemanticMap& semantics) {
  const auto link = front_link(front.name, semantics);
  const mapping::Joint* joint = link ? world.parent_joint(*link) : nullptr;
  if (joint == nullptr) throw Error("the map has no front '" + front.name + "'");
  const std::string parent = joint->parent;
  remove_front(front.name, world, semantics);
  add_front(front, parent, world, semantics);
}

std::string line_of(const std::string& name, const mapping::DifferenceResult& result) {
  const mapping::JointEstimate& joint = *result.joint;
  return fmt::format(
      "{}: {}, probability {:.2f}, moved {:.2f} {}; axis {:.3f} {:.3f} {:.3f} (± {:.2f} deg)\n", name,
      to_text(joint.type), joint.probabilities[static_cast<size_t>(joint.type)], result.moved,
      joint.type == mapping::ArticulationType::prismatic ? "m" : "rad", joint.axis.x(), joint.axis.y(),
      joint.axis.z(), joint.axis_sd_deg);
}

/// Which fronts moved between two scan sets, and the map with what that shows.
void articulate_map(const ArticulateArguments& arguments, Session& session) {
  mapping::World world = mapping::read_urdf(arguments.map);
  mapping::SemanticMap semantics = mapping::read_semantic_map(mapping::sidecar_path(arguments.map));
  const mapping::ScanSet before = mapping::read_registered_scans(arguments.before, session.warnings()),
                         after = mapping::read_registered_scans(arguments.after, session.warnings());
  if (!arguments.out.empty()) session.check_outputs({}, {mapping::sidecar_path(arguments.out)});
  std::string text;
  Json report = {{"fronts", Json::object()}};
  size_t asked = 0;
  const std::vector<mapping::Front> fronts = fronts_of(world, semantics);
  if (const mapping::MapFit fit = fit_to_map(before, fronts, arguments.difference);
      !fronts.empty() && !fit.plausible())
    throw Error(
        fmt::format("the scans do not fit the map {}: of its {} fronts {} are where it has them, {} are "
                    "looked through, {} are not seen",
                    arguments.map, fronts.size(), fit.there, fit.looked_through, fit.unseen),
        {arguments.before, 0, ""},
        "give scans of this kitchen in the map's frame; loci-map register brings scans together");
  for (const mapping::Front& front : fronts) {
    if (!arguments.front.empty() && front.name != arguments.front) continue;
    ++asked;
    const mapping::DifferenceResult result = articulate(before, after, front, {}, arguments.difference);
    if (!result.joint && arguments.front.empty()) continue;
    report["fronts"][front.name] = result.report();
    text += result.joint ? line_of(front.name, result) : front.name + ": " + result.reason + "\n";
    if (!result.joint) continue;
    mapping::Front learned = result.corrected.value_or(front);
    learned.joint = result.joint;
    learned.class_name = front_class(learned, *learned.joint);
    replace_front(learned, world, semantics);
  }
  if (asked == 0)
    throw Error(
        arguments.front.empty() ? "the map has no fronts" : "the map has no front '" + arguments.front + "'",
        {arguments.map, 0, ""});
  if (!arguments.out.empty()) {
    move_mesh_names(world, std::filesystem::path(arguments.map).parent_path(),
                    std::filesystem::path(arguments.out).parent_path());
    write_map(world, semantics, arguments.out);
  }
  session.answer(text.empty() ? "no front moved\n" : text, report);
}

}  // namespace

Command articulate_command() {
  return {
      "articulate",
      "Estimate joints from recorded tracks, or from scans before and after a front moved",
      {"loci-map articulate --track apps/samples/tracks/door.csv",
       "loci-map articulate --track apps/samples/tracks/drawer.csv --json"},
      [](ArgumentTable& table) {
        auto arguments = std::make_shared<ArticulateArguments>();
        table.option("--track CSV", &arguments->track, "Track with x, y, z and optionally qx, qy, qz, qw");
        table.option("--before SCANS", &arguments->before, "Scan set with everything closed",
                     {.needs = {"--after", "--map"}, .excludes = {"--track"}});
        table.option("--after SCANS", &arguments->after, "Scan set with a front open",
                     {.needs = {"--before"}});
        table.option("--map MAP", &arguments->map, "URDF of the map; the sidecar is found beside it",
                     {.needs = {"--before"}});
        table.option("--front NAME", &arguments->front, "Examine only this front",
                     {.default_text = "all", .needs = {"--map"}});
        table.option("-o,--output URDF", &arguments->out, "Write the map with the estimated joints",
                     {.needs = {"--map"}, .replaces = true});
        table.options(table_of(arguments->options), "Tracks");
        table.options(table_of(arguments->difference), "Scans before and after");
        return [arguments](Session& session) {
          if (!arguments->before.empty()) return articulate_map(*arguments, session);
          if (arguments->track.empty())
            throw Error("there is nothing to articulate", {}, "give --track, or --before, --after and --map");
          const mapping::TrackResult result =
              fit_track(mapping::read_track(arguments->track), arguments->options);
          session.answer(result.summary() + "\n", result.report());
        };
      }};
}

}  // namespace loci::apps
