// Scans and what is made from them: fuse, register, interpret.

#include <fmt/format.h>

#include "apps/map/commands.h"
#include "apps/map/posed_recording.h"
#include "mapping/base/files.h"
#include "mapping/base/math/math.h"
#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "mapping/exchange/formats/gltf.h"
#include "mapping/exchange/formats/ply.h"
#include "mapping/exchange/map_colors.h"
#include "mapping/exchange/map_report.h"
#include "mapping/fusion/fusion.h"
#include "mapping/fusion/room_mesh.h"
#include "mapping/image/image_io.h"
#include "mapping/interpretation/furniture/names.h"
#include "mapping/interpretation/interpretation.h"
#include "mapping/orthophoto/photo_interpretation.h"
#include "mapping/registration/registration.h"
#include "mapping/world/map_files.h"
#include "mapping/world/urdf.h"

namespace loci::apps {

namespace {

void check_scan_files(const mapping::ScanSet& scans, const std::string& folder, const Session& session) {
  session.check_outputs(folder, {"scans.yaml"});
  for (const mapping::Scan& scan : scans.scans) session.check_outputs(folder, {scan.name + ".pcd"});
}

struct FuseArguments {
  std::string recording, out;
  mapping::RecordingOptions reading;
  mapping::FusionOptions options;
  mapping::MeshOptions mesh;
};

void write_room(const mapping::ColoredMesh& mesh, const std::filesystem::path& folder) {
  write_file_atomically(folder / "room.ply", ply_text(mesh));
  write_file_atomically(folder / "room.glb", glb_bytes(mesh));
}

/// room.ply and room.glb beside the scans.
Json write_mesh(const mapping::Recording& recording, const FuseArguments& arguments, Session& session) {
  const mapping::RoomMesh room = mesh_room(recording, arguments.options, arguments.mesh, session.progress());
  session.timing("mesh", room.seconds);
  if (room.mesh.triangles.empty()) {
    session.warnings().add("no surface was seen often enough to be meshed", {recording.info().path, 0, {}});
    return nullptr;
  }
  write_room(room.mesh, arguments.out);
  return {{"triangles", room.mesh.triangles.size()}, {"voxel_m", room.voxel_m}, {"seconds", room.seconds}};
}

void run(FuseArguments& arguments, Session& session) {
  arguments.options.threads = session.flags().threads;
  const auto recording = open_posed(arguments.recording, arguments.reading, session).recording;
  session.check_outputs(arguments.out, {"scans.yaml", "room.ply", "room.glb"});
  const mapping::FusionResult result = fuse(*recording, arguments.options, session.progress());
  result.frames.explain("frame", {arguments.recording, 0, {}}, session.warnings());
  check_scan_files(result.scans, arguments.out, session);
  write_scan_set(result.scans, arguments.out);
  session.timing("fuse", result.seconds);
  Json json = result.report();
  json["out"] = arguments.out;
  std::string text = result.summary() + " in " + arguments.out;
  if (arguments.mesh.mesh_voxel_m > 0) {
    json["mesh"] = write_mesh(*recording, arguments, session);
    if (!json["mesh"].is_null())
      text += fmt::format(", and a mesh of {} triangles in room.ply and room.glb",
                          json["mesh"]["triangles"].get<size_t>());
  }
  if (const std::string reasons = result.frames.reasons(); !reasons.empty()) text += "; left out: " + reasons;
  session.answer(text, json);
  if (const std::string reasons = result.without_color.reasons(); !reasons.empty())
    session.warnings().add("without colour: " + reasons, {arguments.recording, 0, {}});
}

}  // namespace

Command fuse_command() {
  return {"fuse",
          "Fuse depth images into a scan set and a coloured mesh; a recording without poses is tracked",
          {"loci-map fuse demo-output/tour -o demo-output/scans",
           "loci-map fuse demo-output/tour -o demo-output/coarse --every 2 --voxel-m 0.02 --json"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<FuseArguments>();
            table.positional("RECORDING", &arguments->recording, "Folder of the recording");
            table.output("FOLDER", &arguments->out, "Folder of the scan set", {.replaces = true});
            table.options(table_of(arguments->reading), "Recording");
            table.options(table_of(arguments->options), "Fusion");
            table.options(table_of(arguments->mesh), "Mesh");
            return [arguments](Session& session) { run(*arguments, session); };
          }};
}

namespace {

struct RegisterArguments {
  std::vector<std::string> scans;
  std::string out;
  std::vector<double> guess;  ///< x, y, z, yaw in degrees; empty = none
  bool dof_given = false;
  mapping::RegistrationOptions options;
};

/// A scan set, or several bare clouds as one, each at the guess from the one before it.
mapping::ScanSet read_scans(const RegisterArguments& arguments) {
  mapping::ScanSet set = mapping::read_scan_set(arguments.scans.front());
  for (size_t i = 1; i < arguments.scans.size(); ++i) {
    mapping::ScanSet more = mapping::read_scan_set(arguments.scans[i]);
    if (set.free_space || more.free_space)
      throw Error("only bare PCD files can be given one by one", {arguments.scans[i], 0, {}},
                  "a scan set is registered by itself");
    for (mapping::Scan& scan : more.scans) {
      scan.name += fmt::format("_{}", i);  // files of one name in different folders are different scans
      set.scans.push_back(std::move(scan));
    }
  }
  if (arguments.guess.empty()) return set;
  if (arguments.scans.size() < 2 || set.scans.size() > arguments.scans.size())
    throw Error("a guess is for bare PCD files", {arguments.scans.front(), 0, "--guess"},
                "the poses of a scan set stand in its scans.yaml");
  Isometry3d guess = Isometry3d::Identity();
  guess.translation() = Vector3d(arguments.guess[0], arguments.guess[1], arguments.guess[2]);
  guess.linear() = rotation_from_rpy({0, 0, arguments.guess[3] * kDegree});
  for (size_t i = 1; i < set.scans.size(); ++i)
    set.scans[i].map_from_scan = set.scans[i - 1].map_from_scan * guess;
  return set;
}

std::string answer_text(const mapping::RegistrationResult& result) {
  std::string text = result.summary() + "\n";
  for (const mapping::PairAlignment& pair : result.pairs)
    text += fmt::format("  {} <- {}: {}: {}\n", result.names[pair.target], result.names[pair.source],
                        pair.trusted ? "trusted" : "refused", pair.reason);
  for (size_t i = 0; i < result.names.size(); ++i) {
    const Vector3d position = result.map_from_scan[i].translation();
    const Vector3d rpy = rpy_from_rotation(result.map_from_scan[i].linear()) / kDegree;
    text += fmt::format("  {}: x {:.3f} y {:.3f} z {:.3f} m, roll {:.2f} pitch {:.2f} yaw {:.2f} deg{}\n",
                        result.names[i], position.x(), position.y(), position.z(), rpy.x(), rpy.y(), rpy.z(),
                        result.connected[i] ? "" : " (by odometry only)");
  }
  return text;
}

/// The connected scans at their new poses: one that stands nobody knows where would spoil a map.
void write_connected(mapping::ScanSet scans, const mapping::RegistrationResult& result,
                     const std::string& folder, const Session& session) {
  std::vector<mapping::Scan> connected;
  for (size_t i = 0; i < scans.scans.size(); ++i) {
    if (!result.connected[i]) continue;
    connected.push_back(std::move(scans.scans[i]));
    connected.back().map_from_scan = result.map_from_scan[i];
    connected.back().covariance.setZero();  // It was that of the pose given.
    connected.back().registered = true;
  }
  scans.scans = std::move(connected);
  // Bare clouds in their sensors' frames: what registration found out of their rays is worth keeping.
  scans.free_space |= std::ranges::all_of(scans.scans, mapping::origins_fit);
  check_scan_files(scans, folder, session);
  write_scan_set(scans, folder);
}

void run(RegisterArguments arguments, Session& session) {
  arguments.options.threads = session.flags().threads;
  const mapping::ScanSet scans = read_scans(arguments);
  if (!arguments.dof_given && !scans.levelled) arguments.options.dof = 6;
  const mapping::RegistrationResult result = register_scans(scans, arguments.options, session.progress());
  session.timing("register", result.seconds);
  std::string text = answer_text(result);
  Json json = result.report();
  json["dof"] = arguments.options.dof;
  if (result.usable() && !arguments.out.empty()) {
    write_connected(scans, result, arguments.out, session);
    text += fmt::format("{} in {}\n", counted(result.connected_count(), "scan"), arguments.out);
    json["out"] = arguments.out;
  }
  session.answer(text, json);
  if (!result.usable())
    throw Error("no two of the scans could be brought together", {arguments.scans.front(), 0, {}},
                "they show different places, share too little surface, or start too far off "
                "(--position-error-m, --yaw-error-deg)");
}

}  // namespace

Command register_command() {
  return {"register",
          "Estimate the poses of scans by registration",
          {"loci-map register demo-output/scans --dof 6 -o demo-output/registered",
           "loci-map register demo-output/scans --dof 6 --json"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<RegisterArguments>();
            table.positional("SCANS...", &arguments->scans, "Folder of a scan set, or several PCD files");
            table.option("-o,--output FOLDER", &arguments->out, "Folder for the scans at their new poses",
                         {.replaces = true});
            table.option("--guess POSE", &arguments->guess,
                         "Pose of each PCD file in the one before it: x,y,z,yaw_deg", {.values = 4});
            table.options(table_of(arguments->options), "Registration");
            table.at("--dof").given = &arguments->dof_given;
            return [arguments](Session& session) { run(*arguments, session); };
          }};
}

namespace {

/// The most telling numbers of a link's geometry, by what its class has of them.
std::string where_text(const Json& geometry) {
  if (geometry.contains("offset")) return fmt::format("offset {:.3f} m", geometry["offset"].get<double>());
  std::string text;
  if (geometry.contains("width"))
    text =
        fmt::format("{:.3f} x {:.3f} m", geometry["width"].get<double>(), geometry["height"].get<double>());
  else if (geometry.contains("top"))
    text = fmt::format("{:.3f} to {:.3f} m high", geometry["height"].get<double>(),
                       geometry["top"].get<double>());
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

/// The mesh beside the scans, moved as they were to level them, beside the map.
void move_room(const std::filesystem::path& scans, const mapping::SemanticMap& map,
               const std::filesystem::path& folder) {
  const std::filesystem::path file = scans / "room.ply";
  if (!std::filesystem::exists(file)) return;
  mapping::ColoredMesh mesh = mapping::read_ply_mesh(file);
  if (map.map_from_input)
    for (Eigen::Vector3f& position : mesh.positions)
      position = (*map.map_from_input * position.cast<double>()).cast<float>();
  write_room(mesh, folder);
}

struct InterpretArguments {
  std::string scans, out, names_from, recording, orthophotos;
  mapping::RecordingOptions reading;
  mapping::InterpretationOptions options;
};

/// Fronts and handles from the colour frames of the recording that the scans were fused from.
void add_photos(const mapping::Recording& recording, const InterpretArguments& arguments,
                mapping::InterpretedMap& map, Session& session) {
  const std::vector<mapping::PhotographedFace> faces =
      interpret_photos(recording, arguments.options.threads, session.progress(), map);
  if (arguments.orthophotos.empty()) return;
  make_folder(arguments.orthophotos);
  for (size_t i = 0; i < faces.size(); ++i) {
    const std::string name = fmt::format("face_{:02d}.png", i + 1);
    session.check_outputs(arguments.orthophotos, {name});
    mapping::write_image(std::filesystem::path(arguments.orthophotos) / name, drawn(faces[i]));
  }
}

/// The map with the colours of scans and photos, and its textures.
void write_map(mapping::InterpretedMap& map, const mapping::ScanSet& scans, const std::string& out,
               const Session& session) {
  color_links(scans, session.flags().threads, map);
  const std::map<std::string, std::string> textures = add_textures(map);
  for (const auto& [name, bytes] : textures) session.check_outputs(out, {name});  // known only now
  make_folder(out);
  const std::filesystem::path folder = out;
  if (!textures.empty()) make_folder(folder / "textures");
  for (const auto& [name, bytes] : textures) write_file_atomically(folder / name, bytes);
  map.world.name = mapping::map_name(out);
  write_map(map.world, map.semantics, folder / "map.urdf");
}

}  // namespace

Command interpret_command() {
  return {"interpret",
          "Interpret a scan set as a semantic map",
          {"loci-map interpret demo-output/scans -o demo-output",
           "loci-map interpret demo-output/scans --recording demo-output/tour -o demo-output/map --json"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<InterpretArguments>();
            table.positional("SCANS", &arguments->scans, "Folder of a scan set, or a PCD file");
            table.output("FOLDER", &arguments->out, "Folder of the map", {.replaces = true});
            table.option("--names-from MAP", &arguments->names_from,
                         "Older map (URDF) of the same kitchen, whose names are kept");
            table.option("--recording RECORDING", &arguments->recording,
                         "Recording that the scans were fused from: fronts and handles are sought in its "
                         "colour frames, too");
            table.option("--orthophotos FOLDER", &arguments->orthophotos,
                         "Folder for an image of each furniture face: fronts and handles drawn over it",
                         {.needs = {"--recording"}});
            table.options(table_of(arguments->reading), "Recording");
            table.options(table_of(arguments->options), "Interpretation");
            return [arguments](Session& session) {
              arguments->options.threads = session.flags().threads;
              const mapping::ScanSet scans =
                  mapping::read_registered_scans(arguments->scans, session.warnings());
              session.check_outputs(arguments->out,
                                    {"map.urdf", "map.semantic.json", "report.html", "room.ply", "room.glb"});
              std::optional<mapping::SemanticMap> older;
              if (!arguments->names_from.empty())
                older = mapping::read_semantic_map(mapping::sidecar_path(arguments->names_from));
              std::unique_ptr<mapping::Recording> recording;
              if (!arguments->recording.empty())
                recording = open_posed(arguments->recording, arguments->reading, session).recording;
              mapping::InterpretedMap map = interpret(scans, arguments->options, session.progress());
              if (recording) add_photos(*recording, *arguments, map, session);
              for (const std::string& note : map.notes) session.warnings().add(note);
              for (const mapping::StageTime& time : map.times) session.timing(time.stage, time.seconds);
              if (!map.usable())
                throw Error(map.summary(), {arguments->scans, 0, ""},
                            "nothing was written: scan more of the room, or lower --min-support-area-m2");
              if (older)
                for (const std::string& name : transfer_names(map.world, map.semantics, *older).vanished)
                  session.warnings().add("'" + name + "' of the older map was not found again");
              write_map(map, scans, arguments->out, session);
              move_room(arguments->scans, map.semantics, arguments->out);
              const std::filesystem::path folder = arguments->out;
              const std::string glb = glb_bytes(map.world, {{}, folder}, session.warnings());
              write_file_atomically(folder / "report.html", map_report(map, scans, arguments->scans, glb));
              session.answer(answer_text(map, arguments->out), map.report());
            };
          }};
}

}  // namespace loci::apps
