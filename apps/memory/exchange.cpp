// Exchange with other programs: ingest, export, catalogue, model, report.

#include <fmt/format.h>
#include <algorithm>

#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"
#include "mapping/base/files.h"
#include "mapping/base/output_file.h"
#include "mapping/base/text/csv.h"
#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "mapping/exchange/formats/ply.h"
#include "mapping/image/image_io.h"
#include "mapping/recording/recording.h"
#include "mapping/world/urdf.h"
#include "memory/annotators/memory_session.h"
#include "memory/catalogue/catalogue.h"
#include "memory/exchange/belief_states.h"
#include "memory/exchange/dataset.h"
#include "memory/exchange/object_model.h"
#include "memory/exchange/observation_image.h"
#include "memory/exchange/owl_individuals.h"
#include "memory/ingest/ingest.h"
#include "memory/questions/names/map_names.h"
#include "memory/questions/snapshot.h"
#include "memory/report/memory_report.h"
#include "memory/store/public_views.h"
#include "memory/store/scene_images.h"

namespace loci::apps {

Command ingest_command() {
  return {"ingest",
          "Import detections of other systems",
          {"loci-memory ingest apps/samples/detections.jsonl -m demo-output/detections.loci --resume",
           "loci-memory ingest apps/samples/detections.jsonl -m demo-output/detections_map.loci --map "
           "apps/samples/kitchen.urdf --strict --resume --json"},
          [](ArgumentTable& table) {
            struct Arguments {
              std::string file, memory, map, recording, now, time_zone;
              memory::IngestOptions options;
            };
            auto arguments = std::make_shared<Arguments>();
            table.positional("FILE", &arguments->file,
                             "Detections: JSON Lines, a COCO file (*.json), or a folder of YOLO text files");
            table.memory(arguments->memory);
            table.option("--recording RECORDING", &arguments->recording,
                         "Recording that was detected in: its depth lifts boxes and masks to 3-D");
            table.option("--map MAP", &arguments->map,
                         "URDF of the map, for the places; the sidecar is found beside it");
            table.now(arguments->now);
            table.time_zone(arguments->time_zone);
            table.options(table_of(arguments->options), "Import");
            table.options(table_of(arguments->options.reading), "Recording");
            return [arguments](Session& session) {
              memory::WriteOptions write;
              write.time_zone = arguments->time_zone;
              arguments->options.default_time_zone = machine_time_zone();
              if (!arguments->now.empty()) write.now = parse_time(arguments->now);
              arguments->options.map = arguments->map;
              arguments->options.recording = arguments->recording;
              const memory::IngestResult result =
                  ingest(arguments->file, arguments->memory, arguments->options, write, session.progress(),
                         session.warnings());
              session.answer(result.summary(), result.report());
              if (result.detections == 0)
                result.used.explain("object", {arguments->file, 0, {}}, session.warnings());
            };
          }};
}

namespace {

namespace fs = std::filesystem;

/// The values as a line of CSV; text is quoted where necessary, null is empty.
std::string csv_line(const Json& values) {
  std::vector<std::string> cells;
  for (const Json& value : values)
    cells.push_back(csv_cell(value.is_null()     ? ""
                             : value.is_string() ? value.get<std::string>()
                                                 : value.dump()));
  return joined(cells, ",") + "\n";
}

/// All rows of a view, as JSON Lines and CSV; the number of rows.
int64_t export_view(const memory::Store& store, const std::string& view, const fs::path& folder,
                    const OutputOptions& options) {
  OutputFile lines(folder / (view + ".jsonl"), options), table(folder / (view + ".csv"), options);
  int64_t rows = 0;
  table.write(csv_line(store.view_columns("v_" + view)));
  store.read_view("v_" + view, [&](const Json& row) {
    table.write(csv_line(row));
    lines.write(row.dump() + "\n");
    ++rows;
  });
  lines.commit();
  table.commit();
  return rows;
}

void write_image_of(const memory::SceneRow& scene, const cv::Mat& image, const fs::path& folder,
                    const Session& session) {
  const std::string name = fmt::format("scene_{:06}.png", scene.id);
  session.check_outputs(folder, {name});
  mapping::write_image(folder / name, image);
}

/// A 16-bit PNG per scene, the number of the object per pixel of the depth image; how many.
int64_t export_labels(const memory::Store& store, const fs::path& folder, Session& session) {
  make_folder(folder);
  const std::vector<memory::SceneRow> scenes = store.scenes();
  int64_t written = 0;
  for (size_t i = 0; i < scenes.size(); ++i) {
    session.progress().check(double(i) / double(scenes.size()), "label images");
    const cv::Mat labels = label_image(store, scenes[i]);
    if (labels.empty()) continue;
    write_image_of(scenes[i], labels, folder, session);
    ++written;
  }
  return written;
}

/// An 8-bit PNG per scene with the kind of each pixel of its depth thumbnail; how many.
int64_t export_kinds(const memory::Store& store, const fs::path& folder, Session& session) {
  make_folder(folder);
  const std::vector<memory::SceneRow> scenes = store.scenes();
  int64_t written = 0;
  for (size_t i = 0; i < scenes.size(); ++i) {
    session.progress().check(double(i) / double(scenes.size()), "kinds of pixels");
    const std::optional<memory::PixelKindImage> kinds = pixel_kinds(store, scenes[i]);
    if (!kinds) continue;
    cv::Mat image(kinds->height, kinds->width, CV_8U);
    std::ranges::transform(kinds->pixels, image.ptr<uint8_t>(),
                           [](mapping::PixelKind kind) { return static_cast<uint8_t>(kind); });
    write_image_of(scenes[i], image, folder, session);
    ++written;
  }
  return written;
}

/// A PLY in the map frame per observation with stored depth; how many.
int64_t export_clouds(const memory::Store& store, const fs::path& folder, Session& session) {
  make_folder(folder);
  const std::vector<memory::ObjectRow> objects = store.objects();
  int64_t written = 0;
  for (size_t i = 0; i < objects.size(); ++i) {
    session.progress().check(double(i) / double(objects.size()), "clouds");
    for (const memory::ObjectObservation& observed : store.observations_of(objects[i].id)) {
      const memory::SceneRow scene = store.scene(observed.observation.scene);
      std::optional<mapping::Scan> cloud = cloud_of(store, scene, observed.observation);
      if (!cloud) continue;
      mapping::ScanSet set;
      set.scans.push_back(std::move(*cloud));
      write_output(folder / fmt::format("{}_scene_{:06}.ply", memory::object_name(objects[i].id), scene.id),
                   ply_text(set), session.outputs());
      ++written;
    }
  }
  return written;
}

/// The state of the world as it was believed to be after each scene; how many.
int64_t export_beliefs(const memory::Store& store, const fs::path& file, Session& session) {
  OutputFile lines(file, session.outputs());
  int64_t written = 0;
  for_each_belief_state(store, session.progress(), [&](const Json& state) {
    lines.write(state.dump() + "\n");
    ++written;
  });
  lines.commit();
  return written;
}

/// The map as corrected by people; 1, or 0 when there is none.
int64_t export_map(const memory::Store& store, const fs::path& file, const OutputOptions& options) {
  const std::optional<mapping::World> map = named_map(store);
  if (map) write_output(file, urdf_text(*map), options);
  return map ? 1 : 0;
}

/// Finds the frames of a memory's scenes in the recording that it was made from.
std::function<std::optional<mapping::RgbdFrame>(const memory::SceneRow&)> frames_of(
    const memory::Store& store, const std::string& path) {
  const std::shared_ptr<mapping::Recording> recording = mapping::open_recording(path);
  const std::optional<memory::RecordingRow> known = store.recording(memory::fingerprint_of(*recording));
  if (!known)
    throw Error("the memory was not made from this recording", {path, 0, {}},
                "give the recording whose name the table recording holds");
  std::map<int64_t, size_t> position;
  for (size_t i = 0; i < recording->size(); ++i) position[recording->index_of(i)] = i;
  return [recording, position,
          id = known->id](const memory::SceneRow& scene) -> std::optional<mapping::RgbdFrame> {
    if (scene.recording != id || !scene.frame_index) return std::nullopt;
    const auto found = position.find(*scene.frame_index);
    return found == position.end() ? std::nullopt : std::optional(recording->frame(found->second));
  };
}

struct ExportArguments {
  std::string memory, folder;
  std::vector<std::string> include;
  std::string dataset, recording;
  bool by_object = false;
  bool keep_people = false;

  bool includes(std::string_view what) const {
    return std::find(include.begin(), include.end(), what) != include.end();
  }
};

void write_dataset(const ExportArguments& arguments, const memory::Store& store, Session& session) {
  memory::DatasetOptions options;
  options.by_object = arguments.by_object;
  options.keep_people = arguments.keep_people;
  options.inputs.emplace_back(arguments.memory);
  if (!arguments.recording.empty()) {
    options.frame_of = frames_of(store, arguments.recording);
    options.inputs.emplace_back(arguments.recording);
  }
  const memory::DatasetResult result = export_dataset(store, arguments.dataset, options, session.progress());
  session.answer("Dataset " + arguments.dataset + ": " + result.summary(), result.report());
}

void export_memory(const ExportArguments& arguments, Session& session) {
  const memory::Store store = open_memory(arguments.memory, session);
  if (!arguments.dataset.empty()) return write_dataset(arguments, store, session);
  const fs::path folder = arguments.folder;
  make_folder(folder);
  Json rows = Json::object();
  std::string text = "Written to " + arguments.folder + ":";
  const auto report = [&](const std::string& what, int64_t count) {
    rows[what] = count;
    text += fmt::format(" {} {},", count, what);
  };
  for (const char* view : memory::kPublicViews)
    report(view, export_view(store, view, folder, session.outputs()));
  if (arguments.includes("pixel-kinds")) report("kinds", export_kinds(store, folder / "kinds", session));
  if (arguments.includes("labels")) report("labels", export_labels(store, folder / "labels", session));
  if (arguments.includes("map")) report("maps", export_map(store, folder / "map.urdf", session.outputs()));
  if (arguments.includes("clouds")) report("clouds", export_clouds(store, folder / "clouds", session));
  if (arguments.includes("beliefs"))
    report("beliefs", export_beliefs(store, folder / "beliefs.jsonl", session));
  if (arguments.includes("owl")) {
    write_output(folder / "individuals.owl",
                 owl_individuals(store, fs::path(arguments.memory).stem().string()), session.outputs());
    text += " individuals.owl,";
  }
  text.back() = '.';
  session.answer(text, {{"folder", arguments.folder}, {"rows", rows}});
}

}  // namespace

Command export_command() {
  return {"export",
          "Export a memory as JSON Lines and CSV, images, clouds, map, OWL, or as a training set",
          {"loci-memory export -m demo-output/memory.loci -o demo-output/memory-export",
           "loci-memory export -m demo-output/memory.loci -o demo-output/memory-export --include labels "
           "pixel-kinds "
           "clouds map owl beliefs --json",
           "loci-memory export -m demo-output/memory.loci --dataset demo-output/dataset --by-object "
           "--recording demo-output/day"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<ExportArguments>();
            table.memory(arguments->memory);
            table.option("-o,--output FOLDER", &arguments->folder,
                         "Folder for the tables as JSON Lines and CSV", {.replaces = true});
            table.option(
                "--include WHAT...", &arguments->include,
                "Export more: labels/scene_N.png with the number of the object per pixel; kinds/scene_N.png "
                "with the kind of each pixel (0 not measured, 1 map-explained, 2 background, 3 region of "
                "interest); clouds/object_N_scene_M.ply; map.urdf with corrections; individuals.owl for "
                "KnowRob; beliefs.jsonl with the belief after each scene",
                {.choices = {"labels", "pixel-kinds", "clouds", "map", "owl", "beliefs"},
                 .open_end = true,
                 .needs = {"--output"}});
            table.begin_group("Training set");
            table.option("--dataset FOLDER", &arguments->dataset,
                         "Write a training set for loci-perceive train instead; labels by people come first",
                         {.excludes = {"--output"}});
            table.option("--recording RECORDING", &arguments->recording,
                         "The recording that the memory was made from, for its full depth",
                         {.needs = {"--dataset"}});
            table.flag("--keep-people", arguments->keep_people,
                       "Write the faces of people in the recording, which are blurred otherwise",
                       {.needs = {"--recording"}});
            table.flag("--by-object", arguments->by_object, "Make each object a class of its own",
                       {.needs = {"--dataset"}});
            return [arguments](Session& session) {
              if (arguments->folder.empty() && arguments->dataset.empty())
                throw UsageError("--output or --dataset is required");
              export_memory(*arguments, session);
            };
          }};
}

namespace {

struct CatalogueArguments {
  std::string action, file, memory;
  bool force = false;
};

void export_to(const CatalogueArguments& arguments, Session& session) {
  const memory::Catalogue catalogue = catalogue_of(open_memory(arguments.memory, session));
  write_output(arguments.file, to_json(catalogue).dump(1) + "\n",
               {.replace = arguments.force ? Replace::anything : Replace::own, .inputs = {arguments.memory}});
  std::map<std::string, size_t> classes;
  for (const memory::CatalogueEntry& entry : catalogue.entries) ++classes[entry.class_name];
  std::string text = fmt::format("{} in {}", counted(catalogue.entries.size(), "object"), arguments.file);
  Json named = Json::object();
  for (const auto& [name, count] : classes) {
    text += fmt::format("\n  {:20} {:4}", name.empty() ? "(unknown class)" : name, count);
    if (!name.empty()) named[name] = count;
  }
  session.answer(text, {{"objects", catalogue.entries.size()}, {"classes", named}, {"file", arguments.file}});
}

void import_from(const CatalogueArguments& arguments, Session& session) {
  const memory::Catalogue catalogue = memory::read_home_catalogue(arguments.file);
  memory::Store store = open_to_change(arguments.memory, session);
  const memory::CatalogueResult result = import_catalogue(store, catalogue);
  session.answer(result.summary(), result.report());
}

}  // namespace

Command catalogue_command() {
  return {"catalogue",
          "Export or import object knowledge for another home: names, classes, appearance, habits",
          {"loci-memory catalogue export demo-output/catalogue.json -m demo-output/memory.loci",
           "loci-memory catalogue import demo-output/catalogue.json -m demo-output/detections.loci --json"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<CatalogueArguments>();
            table.positional("ACTION", &arguments->action, "export FILE, or import FILE",
                             {.choices = {"export", "import"}});
            table.positional("FILE", &arguments->file, "The catalogue, JSON");
            table.memory(arguments->memory);
            table.flag("--force", arguments->force, "Replace a file that loci did not write");
            return [arguments](Session& session) {
              arguments->action == "export" ? export_to(*arguments, session)
                                            : import_from(*arguments, session);
            };
          }};
}

namespace {

/// The object that words mean; Error when they mean several.
memory::Id one_object(const memory::Store& store, const std::string& words, const memory::AsOf& as_of) {
  const memory::Snapshot snapshot(store, as_of);
  const std::vector<memory::Id> found = snapshot.find_objects(words);
  if (found.size() == 1) return found.front();
  throw Error(fmt::format("'{}' means {} objects", words, found.size()), {store.name(), 0, {}},
              fmt::format("{} is the most probable one", memory::object_name(found.front())));
}

}  // namespace

Command model_command() {
  return {
      "model",
      "Merge the observations of an object: cloud, best images, evidence",
      {"loci-memory model object_1 -m demo-output/memory.loci -o demo-output/object_1.ply",
       "loci-memory model object_1 -m demo-output/memory.loci -o demo-output/object_1.ply --views 4 --json"},
      [](ArgumentTable& table) {
        struct Arguments {
          MemoryArguments memory;
          std::vector<std::string> subject;
          std::string output;
          memory::ObjectModelOptions options;
        };
        auto arguments = std::make_shared<Arguments>();
        table.positional("OBJECT...", &arguments->subject, "object_12, or words that mean one object");
        arguments->memory.declare(table);
        table.output("FILE", &arguments->output,
                     "PLY for the cloud; the best image per side is written beside it", {.replaces = true});
        table.options(table_of(arguments->options), "Model");
        return [arguments](Session& session) {
          table_of(arguments->options).validate();
          const memory::Store store = open_memory(arguments->memory.memory, session);
          const memory::AsOf as_of = arguments->memory.as_of(store);
          const memory::ObjectModel model =
              model_of(store, one_object(store, joined(arguments->subject, " "), as_of), arguments->options,
                       session.progress(), as_of);
          write_file_atomically(arguments->output, ply_text(model.cloud));
          Json json = model.report();
          json["cloud"] = arguments->output;
          json["images"] = Json::object();
          std::filesystem::path base = arguments->output;
          base.replace_extension();
          for (const auto& [side, crop] : model.best_crop) {
            const memory::BlobRow image = store.blob(crop);
            const std::string file =
                fmt::format("{}_{}.{}", base.string(), side, image.media == "image/png" ? "png" : "jpg");
            write_output(file, image.bytes, session.outputs());
            json["images"][side] = file;
          }
          session.answer(model.summary() + "Written to " + arguments->output + ".", json);
        };
      }};
}

Command report_command() {
  return {
      "report",
      "Write a self-contained HTML page about a memory",
      {"loci-memory report -m demo-output/memory.loci -o demo-output/memory.html",
       "loci-memory report -m demo-output/memory.loci --append-to demo-output/explored/report.html"},
      [](ArgumentTable& table) {
        struct Arguments {
          std::string memory, output, append_to;
          memory::ReportOptions options;
        };
        auto arguments = std::make_shared<Arguments>();
        table.memory(arguments->memory);
        table.option("-o,--output FILE", &arguments->output, "The page to write", {.replaces = true});
        table.option("--append-to FILE", &arguments->append_to,
                     "Report of loci-map to which the sections of the memory are added",
                     {.excludes = {"--output"}});
        table.option("--max-objects N", &arguments->options.objects, "Maximum number of objects with a card");
        table.option("--max-scenes N", &arguments->options.scenes,
                     "Maximum number of scenes in time line, decisions and log; the last ones", {.min = 1});
        return [arguments](Session& session) {
          const bool append_to_page = !arguments->append_to.empty();
          const std::string target = append_to_page ? arguments->append_to : arguments->output;
          if (target.empty()) throw UsageError("--output or --append-to is required");
          std::optional<std::string> page;
          if (append_to_page) page = read_file(target);
          // A page that is appended to keeps what it says.
          const OutputOptions replaces{.replace = Replace::anything, .inputs = {arguments->memory}};
          const OutputOptions& options = append_to_page ? replaces : session.outputs();
          check_output(target, options);
          write_output(target,
                       memory_report(open_memory(arguments->memory, session), page, arguments->options,
                                     session.progress()),
                       options);
          session.answer("report " + target, Json{{"report", target}});
        };
      }};
}

}  // namespace loci::apps
