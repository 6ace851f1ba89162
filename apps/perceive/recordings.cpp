// Recordings: info, convert, run.

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <map>
#include <mutex>

#include "apps/perceive/annotators.h"
#include "apps/perceive/commands.h"
#include "apps/perceive/goal_answers.h"
#include "mapping/base/config.h"
#include "mapping/base/files.h"
#include "mapping/base/math/tally.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "mapping/base/time.h"
#include "mapping/recording/convert.h"
#include "mapping/recording/pose_check.h"
#include "mapping/recording/posed_recording.h"
#include "mapping/recording/recording.h"
#include "mapping/tracking/known_poses.h"
#include "mapping/update/placement.h"
#include "mapping/world/semantic_map.h"
#include "mapping/world/urdf.h"
#include "memory/annotators/memory_annotators.h"
#include "memory/annotators/memory_session.h"
#include "memory/exchange/marker_layers.h"
#include "memory/questions/names/map_names.h"
#include "perception/annotators/annotators.h"
#include "perception/annotators/frame_outcome.h"
#include "perception/annotators/io/labelled_recording.h"
#include "perception/annotators/structure/known_map.h"
#include "perception/detection/people_detector.h"
#include "perception/pipeline/goal.h"
#include "perception/pipeline/pipeline.h"
#include "perception/types/scene_json.h"

namespace loci::apps {

namespace {

/// A recording on the command line, with what it does not say about itself.
struct RecordingArguments {
  std::string path;
  mapping::RecordingOptions options;

  void declare(ArgumentTable& table) {
    table.positional("RECORDING", &path, "Folder or file of the recording");
    table.options(table_of(options), "Recording");
  }
  std::unique_ptr<mapping::Recording> open(Session& session) const {
    return mapping::open_recording(path, options, &session.progress());
  }
};

std::string camera_text(const mapping::PinholeCamera& camera) {
  return fmt::format("{} x {} pixels, f {:.6g} {:.6g}, centre {:.6g} {:.6g}", camera.width, camera.height,
                     camera.fx, camera.fy, camera.cx, camera.cy);
}

std::string info_text(const mapping::RecordingInfo& info) {
  const Vector3d offset = info.camera.depth_from_color.translation();
  std::string text =
      fmt::format("{}: {}, layout {}\n", info.path, counted(info.frames, "frame"), info.format) +
      fmt::format("time    {} to {}{}\n", format_time(info.first_time), format_time(info.last_time),
                  info.time_assumed ? " (made up)" : "") +
      fmt::format("poses   {} of {}{}\n", info.frames_with_pose, info.frames,
                  info.map_frame.empty() ? "" : ", in frame '" + info.map_frame + "'") +
      fmt::format("depth   {}\n", camera_text(info.camera.depth)) +
      fmt::format("colour  {}, at {:.3f} {:.3f} {:.3f} m from depth\n", camera_text(info.camera.color),
                  offset.x(), offset.y(), offset.z());
  if (info.camera_names.size() > 1)
    text += fmt::format("cameras {}; the first is read\n", joined(info.camera_names, ", "));
  for (const std::string& guess : info.guesses) text += fmt::format("guessed {}\n", guess);
  for (const std::string& problem : info.problems) text += fmt::format("problem {}\n", problem);
  return text;
}

}  // namespace

Command info_command() {
  return {"info",
          "Describe a recording and what was guessed about it",
          {"loci-perceive info demo-output/day", "loci-perceive info demo-output/tour --json"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<RecordingArguments>();
            arguments->declare(table);
            return [arguments](Session& session) {
              const auto recording = arguments->open(session);
              mapping::RecordingInfo info = recording->info();
              info.problems = problems_of(*recording, arguments->options);
              session.answer(info_text(info), to_json(info));
            };
          }};
}

namespace {

struct ConvertArguments {
  RecordingArguments recording;
  std::string out, format, map, memory;
  int every = 1;
  bool keep_people = false;
};

/// Of the map that was given, else of the memory's.
std::vector<mapping::MarkerLayer> layers_of_map(const ConvertArguments& arguments, const memory::Store* store,
                                                Warnings& warnings) {
  const std::string& file = arguments.map.empty() ? arguments.memory : arguments.map;
  const mapping::MeshSearch search{{}, std::filesystem::path(file).parent_path()};
  if (!arguments.map.empty()) return memory::map_layers(mapping::read_urdf(arguments.map), search, warnings);
  if (store == nullptr) return {};
  const std::optional<mapping::World> map = memory::named_map(*store);
  if (!map) return {};
  try {
    return memory::map_layers(*map, search, warnings);
  } catch (const Error& error) {  // A memory holds no meshes.
    const Error without("the map of the memory is not shown: " + error.message(), {file, 0, {}},
                        "give the map with --map");
    warnings.add(without.what());
  }
  return {};
}

/// A recording in which nobody can be recognised.
class AnonymousRecording : public mapping::Recording {
 public:
  explicit AnonymousRecording(std::unique_ptr<mapping::Recording> recording)
      : recording_(std::move(recording)) {}
  const mapping::RecordingInfo& info() const override { return recording_->info(); }
  size_t size() const override { return recording_->size(); }
  mapping::RgbdFrame frame(size_t i) const override {
    mapping::RgbdFrame frame = recording_->frame(i);
    const std::lock_guard lock(mutex_);
    perception::anonymise(frame, detector_);
    return frame;
  }
  TimeNs time_of(size_t i) const override { return recording_->time_of(i); }
  int64_t index_of(size_t i) const override { return recording_->index_of(i); }
  std::optional<Isometry3d> pose_of(size_t i) const override { return recording_->pose_of(i); }
  std::string name_of(size_t i) const override { return recording_->name_of(i); }
  std::string color_name_of(size_t i) const override { return recording_->color_name_of(i); }

 private:
  std::unique_ptr<mapping::Recording> recording_;
  mutable std::mutex mutex_;
  mutable perception::PeopleDetector detector_;
};

void convert(const ConvertArguments& arguments, Session& session) {
  static const std::map<std::string, mapping::RecordingFormat> kFormats = {
      {"loci", mapping::RecordingFormat::loci},
      {"mcap", mapping::RecordingFormat::mcap},
      {"tum", mapping::RecordingFormat::tum}};
  const bool is_mcap = std::filesystem::path(arguments.out).extension() == ".mcap";
  const std::string format = !arguments.format.empty() ? arguments.format : is_mcap ? "mcap" : "loci";
  if (format != "mcap") check_folder_name(arguments.out);
  mapping::ConvertOptions options{
      kFormats.at(format), arguments.every, {arguments.recording.path}, session.flags().force};
  if (!arguments.recording.options.poses.empty())
    options.inputs.emplace_back(arguments.recording.options.poses);
  for (const std::string& drawn : {arguments.map, arguments.memory}) {
    if (drawn.empty()) continue;
    if (format != "mcap")
      throw Error(fmt::format("layout {} has no place for a map or objects", format), {arguments.out, 0, {}},
                  "write --format mcap");
    options.inputs.emplace_back(drawn);
  }
  std::unique_ptr<mapping::Recording> recording = arguments.recording.open(session);
  if (const auto sidecar = mapping::sidecar_path(arguments.map); !arguments.map.empty() && exists(sidecar)) {
    const mapping::SemanticMap semantics = mapping::read_semantic_map(sidecar);
    recording = in_map(std::move(recording), semantics.map_from_input, semantics.frame);
  }
  if (!arguments.keep_people) recording = std::make_unique<AnonymousRecording>(std::move(recording));
  for (const std::string& problem : recording->info().problems) session.warnings().add(problem);
  std::optional<memory::Store> store;
  if (!arguments.memory.empty()) {
    store.emplace(memory::Store::open_read(arguments.memory));
    options.layers.push_back(memory::object_layer(*store));
  }
  for (mapping::MarkerLayer& layer : layers_of_map(arguments, store ? &*store : nullptr, session.warnings()))
    options.layers.push_back(std::move(layer));
  const Tally frames = convert_recording(*recording, arguments.out, options, session.progress());
  const std::string left_out = frames.reasons();
  session.answer(fmt::format("{} written to {} as {}{}\n", counted(frames.used(), "frame"), arguments.out,
                             format, left_out.empty() ? "" : "; left out: " + left_out),
                 {{"frames", frames.used()}, {"out", arguments.out}, {"format", format}});
}

}  // namespace

Command convert_command() {
  return {"convert",
          "Write a recording in another layout: loci, MCAP for ROS 2 and Foxglove, or TUM RGB-D",
          {"loci-perceive convert demo-output/day -m demo-output/memory.loci -o demo-output/day.mcap",
           "loci-perceive convert demo-output/day -o demo-output/day-tum --format tum --every 4"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<ConvertArguments>();
            arguments->recording.declare(table);
            table.output("OUT", &arguments->out, "Folder or file to write", {.replaces = true});
            table.option("--format FORMAT", &arguments->format, "Layout of the output",
                         {.default_text = "by the ending of OUT", .choices = {"loci", "mcap", "tum"}});
            table.option("--every N", &arguments->every, "Take every n-th frame", {.min = 1});
            table.flag("--keep-people", arguments->keep_people,
                       "Write the faces of people, which are blurred otherwise");
            table.option("-m,--memory MEMORY", &arguments->memory,
                         "MCAP also shows the objects of this memory, and its map, as markers");
            table.option("--map MAP", &arguments->map, "MCAP also shows this map (URDF) as markers");
            return [arguments](Session& session) { convert(*arguments, session); };
          }};
}

namespace {

std::string scene_text(const perception::types::SceneCas& facade) {
  const Json json = to_json(facade);
  std::string text =
      fmt::format("frame {}  {}\n", json["frame"].get<int64_t>(), json["time"].get<std::string>());
  for (const Json& support : json["supports"])
    text += fmt::format("  support {} at height {:.3f} m, {:.0f} % of it seen\n",
                        support.value("name", std::string("without a name")), support["height"].get<double>(),
                        100 * support["covered_fraction"].get<double>());
  for (const auto& joint : facade.scene().annotations.filter<perception::types::JointAnnotation>())
    if (joint.moved.get())
      text += fmt::format("  {} stands at {:.2f}\n", joint.joint.get(), joint.position.get());
  for (const auto& obstacle : facade.scene().annotations.filter<perception::types::ObstacleAnnotation>())
    text += fmt::format("  something stands {:.2f} m before {} and hides {:.0f} % of it\n",
                        obstacle.distance.get(), obstacle.joint.get(), 100 * obstacle.share.get());
  const std::vector<perception::types::Cluster> clusters = facade.clusters();
  for (const Json& cluster : json["clusters"]) {
    const auto number = cluster["cluster"].get<size_t>();
    const std::string name = perception::class_of(clusters[number - 1]);
    text += fmt::format("  {:2} {}{}", number, name.empty() ? "" : name + ", ",
                        cluster.value("sentence", std::string("somewhere")));
    if (cluster.contains("size"))
      text += fmt::format(", {:.2f} x {:.2f} x {:.2f} m", cluster["size"][0].get<double>(),
                          cluster["size"][1].get<double>(), cluster["size"][2].get<double>());
    if (cluster.contains("colors"))
      text += fmt::format(", {}", fmt::join(cluster["colors"].get<std::vector<std::string>>(), " "));
    if (cluster["at_image_border"].get<bool>()) text += ", cut off by the image";
    if (cluster["partly_hidden"].get<bool>()) text += ", partly hidden";
    text += "\n";
  }
  return text;
}

/// The part of a run that has to do with the memory: its flags, and what they do to resources and pipeline.
struct MemoryTarget {
  std::string memory;  ///< file; empty = none
  bool resume = false;
  bool keep_people = false;
  std::string now;        ///< ISO 8601; empty = the machine's clock
  std::string time_zone;  ///< empty = the recording's, or the machine's

  void declare(ArgumentTable& table);
  /// Opens the memory for what the resources hold and adds identity and writer to the pipeline. Nothing
  /// without a memory.
  void prepare(const std::string& map, perception::Pipeline& pipeline,
               const perception::AnnotatorRegistry& registry, perception::Resources& resources) const;
};

void MemoryTarget::declare(ArgumentTable& table) {
  table.option("-m,--memory MEMORY", &memory, "Memory to write to, FILE.loci; created if absent");
  table.flag("--keep-people", keep_people,
             "Store images with the faces of people, which are blurred otherwise");
  table.flag("--resume", resume,
             "Continue a recording after its last frame in the memory; frames before it are not added");
  table.now(now);
  table.time_zone(time_zone);
}

void MemoryTarget::prepare(const std::string& map, perception::Pipeline& pipeline,
                           const perception::AnnotatorRegistry& registry,
                           perception::Resources& resources) const {
  if (memory.empty()) {
    if (resume) throw Error("--resume needs a memory", {}, "name it with -m FILE.loci");
    return;
  }
  memory::MemorySessionOptions options;
  options.memory = memory;
  options.resume = resume;
  if (keep_people) options.people = memory::People::kept;
  options.map = map;
  if (!now.empty()) options.write.now = parse_time(now);
  options.write.time_zone = time_zone;
  options.default_time_zone = machine_time_zone();
  memory::add_memory_session(options, pipeline, registry, resources);
  if (const auto known = resources.find<perception::KnownMap>())
    resources.put(std::make_shared<mapping::World>(known->world));
}

struct RunArguments {
  RecordingArguments recording;
  std::string map;
  std::vector<std::string> package_paths;
  std::vector<std::string> robots;
  std::string pipeline;
  std::string labels;
  std::string images;
  int every = 0;
  bool fixed_camera = false;
  MemoryTarget memory;
  StatisticsTarget statistics;
  PluginOption plugins;
  std::string goal;
  double budget_ms = 0;
  std::vector<std::string> with;
};

void declare(ArgumentTable& table, RunArguments& arguments) {
  arguments.recording.declare(table);
  table.begin_group("");
  table.option("--map MAP", &arguments.map, "URDF of the map; the sidecar is found beside it");
  table.package_path(&arguments.package_paths);
  table.option("--robot URDF", &arguments.robots,
               "URDF[,JOINTS.csv] of a robot that may be in view; may be repeated");
  table.option("--every N", &arguments.every, "Process every n-th frame",
               {.default_text = "as in the pipeline", .min = 1});
  table.flag("--fixed-camera", arguments.fixed_camera,
             "The camera of a recording without poses stood still: it is not tracked");
  table.option("--labels FOLDER", &arguments.labels,
               "Write label images FRAME_label.png (0 = none, n = object)", {.replaces = true});
  table.option("--overlays FOLDER", &arguments.images, "Write colour images with the results drawn in",
               {.replaces = true});
  table.begin_group("Memory");
  arguments.memory.declare(table);
  table.begin_group("Annotators");
  table.option("--pipeline FILE", &arguments.pipeline,
               "Pipeline as YAML; `describe pipeline` prints the default one");
  table.option("--goal CONDITIONS", &arguments.goal,
               "Choose annotators for a goal: \"class=cup color=red on=table_1\"",
               {.excludes = {"--pipeline"}});
  table.option("--budget-ms MS", &arguments.budget_ms,
               "Expected time per scene that the chosen annotators may take",
               {.default_text = "no limit", .min = 1, .needs = {"--goal"}});
  table.option("--annotator SPEC", &arguments.with,
               "Options of an annotator that may be chosen: 'Name: {option: value}'; may be repeated",
               {.needs = {"--goal"}});
  arguments.statistics.declare(table);
  arguments.plugins.declare(table);
}

/// The steps of the default pipeline that find the objects: those before the first that needs them.
Json steps_that_find(const perception::AnnotatorRegistry& registry) {
  Json steps = Json::array();
  const Json all =
      perception::Pipeline::parse(perception::default_pipeline(), "the default pipeline", registry).to_json();
  for (const Json& step : all["flow"]) {
    const std::vector<std::string> needs = registry.make(step.begin().key())->descriptor().inputs;
    if (std::find(needs.begin(), needs.end(), "Cluster") != needs.end()) break;
    steps.push_back(step);
  }
  return steps;
}

std::optional<perception::GoalPlan> plan_for(const RunArguments& arguments,
                                             const perception::AnnotatorRegistry& registry) {
  if (arguments.goal.empty()) return std::nullopt;
  Json configured = Json::object();
  for (const std::string& text : arguments.with) {
    const Config list = Config::parse("flow: [{" + text + "}]", "--annotator");
    configured.update(to_json(read_flow(list, "flow", registry))[0]);
  }
  const std::optional<double> budget =
      arguments.budget_ms > 0 ? std::optional<double>(arguments.budget_ms / 1e3) : std::nullopt;
  return plan_goal(read_goal(arguments.goal), steps_that_find(registry), configured, registry,
                   arguments.statistics.read(arguments.memory.memory), budget);
}

perception::Pipeline read_pipeline(const RunArguments& arguments,
                                   const perception::AnnotatorRegistry& registry,
                                   const std::optional<perception::GoalPlan>& plan) {
  const Config pipeline = plan ? Config::parse(plan->pipeline.dump(), "the pipeline made by --goal")
                          : arguments.pipeline.empty()
                              ? Config::parse(perception::default_pipeline(), "the default pipeline")
                              : Config::read(arguments.pipeline);
  return perception::Pipeline::parse(
      arguments.every > 0 ? perception::with_every(pipeline, arguments.every) : pipeline, registry);
}

/// What annotators share. Modules that bring annotators with resources of their own put them here.
perception::Resources make_resources(const RunArguments& arguments, Session& session) {
  perception::Resources resources;
  std::unique_ptr<mapping::Recording> recording = arguments.recording.open(session);
  for (const std::string& problem : problems_of(*recording, arguments.recording.options))
    session.warnings().add(problem);
  const Stopwatch watch;
  if (!arguments.map.empty())
    recording = perceived_in_map(std::move(recording), arguments.map, arguments.fixed_camera,
                                 session.flags().threads, session.progress(), session.warnings());
  else if (!arguments.fixed_camera)
    recording = with_known_poses(std::move(recording), mapping::PosesFor::perception, session.flags().threads,
                                 session.progress(), session.warnings());
  session.timing("track", watch.seconds());
  resources.put(std::shared_ptr<mapping::Recording>(std::move(recording)));
  if (!arguments.map.empty() || !arguments.robots.empty()) {
    const std::vector<std::filesystem::path> packages(arguments.package_paths.begin(),
                                                      arguments.package_paths.end());
    const std::shared_ptr<perception::KnownMap> map =
        arguments.map.empty() ? perception::KnownMap::robots_only(session.warnings())
                              : perception::KnownMap::load(arguments.map, packages, session.warnings());
    for (const std::string& robot : arguments.robots) {
      const size_t comma = robot.find(',');
      const std::string joints = comma == std::string::npos ? "" : robot.substr(comma + 1);
      map->add_robot(robot.substr(0, comma), joints, packages, session.warnings());
    }
    resources.put(map);
  }
  return resources;
}

void write_images(const RunArguments& arguments, const perception::types::SceneCas& scene, bool with_memory,
                  const Session& session) {
  // With a memory the numbers are its objects', otherwise those of the scene's clusters.
  if (!arguments.labels.empty()) {
    session.check_outputs(arguments.labels, {scene.scene().frame_name.get() + "_label.png"});
    perception::write_label_image(scene, arguments.labels,
                                  with_memory ? perception::tracked_numbers(scene) : std::vector<int>());
  }
  if (!arguments.images.empty()) {
    session.check_outputs(arguments.images, {std::to_string(scene.scene().frame_index.get()) + ".png"});
    perception::write_overlay(scene, arguments.images, arguments.memory.keep_people);
  }
}

/// The last line of the answer; `memory` is empty when nothing was stored.
std::string summary(const memory::MemoryRunResult& result, size_t clusters, const std::string& memory) {
  std::string text =
      fmt::format("{}, {} seen", counted(result.pipeline.frames, "frame"), counted(clusters, "object"));
  if (result.pipeline.left_out > 0)
    text +=
        fmt::format("; {} left out because an annotator failed", counted(result.pipeline.left_out, "frame"));
  if (result.skipped > 0) text += fmt::format("; {} in the memory already", counted(result.skipped, "frame"));
  if (result.passed_over > 0)
    text += fmt::format("; left out: {} before the last stored one", counted(result.passed_over, "frame"));
  return text + (memory.empty() ? "\n" : fmt::format("; stored in {}\n", memory));
}

void run(const RunArguments& arguments, Session& session) {
  const Experts experts = arguments.plugins.load();
  const perception::AnnotatorRegistry& registry = experts.registry;
  const std::optional<perception::GoalPlan> plan = plan_for(arguments, registry);
  std::optional<GoalAnswers> answers;
  if (plan) answers.emplace(*plan);
  perception::Pipeline pipeline = read_pipeline(arguments, registry, plan);
  perception::Resources resources = make_resources(arguments, session);
  if (!arguments.labels.empty()) make_folder(arguments.labels);
  if (!arguments.images.empty()) make_folder(arguments.images);
  arguments.memory.prepare(arguments.map, pipeline, registry, resources);
  perception::Context context{resources, session.warnings(), session.flags().threads, {}};
  const bool remembers = resources.find<memory::MemorySession>() != nullptr;
  std::string text = plan ? plan_text(*plan) : std::string();
  size_t clusters = 0;
  Tally frames;
  Json scenes = Json::array();
  const auto done = [&](perception::cas::Cas& cas) {
    const perception::types::SceneCas scene(cas);
    clusters += scene.scene().clusters.size();
    if (const auto reason = perception::no_object_because(scene, remembers))
      frames.add(*reason);
    else
      frames.add_used();
    if (answers) {
      answers->look_at(scene, remembers ? perception::tracked_numbers(scene) : std::vector<int>());
      return write_images(arguments, scene, remembers, session);
    }
    // With a memory, questions give the answer; without one this is it.
    if (!remembers || session.flags().verbose) text += scene_text(scene);
    if (session.flags().json) scenes.push_back(to_json(scene));
    write_images(arguments, scene, remembers, session);
  };
  memory::MemoryRunResult result;
  if (remembers)
    result = memory::run_with_memory(pipeline, context, experts.types, session.progress(), done);
  else
    result.pipeline = pipeline.run(context, experts.types, session.progress(), done);
  for (const auto& [name, seconds] : result.pipeline.seconds) session.timing(name, seconds);
  if (const auto path = arguments.statistics.path(arguments.memory.memory); !path.empty())
    add_to_statistics(path, result.pipeline.statistics);
  const memory::Store* store = remembers ? &resources.find<memory::MemorySession>()->store() : nullptr;
  if (answers) text += answers->text(store);
  text += summary(result, clusters, remembers ? arguments.memory.memory : "");
  frames.add(Reason::annotator_failed, result.pipeline.left_out);
  Json json = {{"frames", result.pipeline.frames},
               {"frames_used", frames.report()},
               {"skipped", result.skipped},
               {"passed_over", result.passed_over},
               {"left_out", result.pipeline.left_out},
               {"scenes", scenes},
               {"pipeline", context.configuration}};
  if (answers) json.update(answers->json(store));
  if (plan) json["plan"] = to_json(*plan);
  session.answer(text, json);
  try {
    frames.explain("object", {arguments.recording.path, 0, {}}, session.warnings());
  } catch (const Error& error) {
    const auto memory = resources.find<memory::MemorySession>();
    if (memory == nullptr) throw;
    throw Error(
        error.message(), error.location(),
        error.hint() + "; the frames are in the memory all the same: " + memory->how_to_perceive_again());
  }
}

}  // namespace

Command run_command() {
  return {"run",
          "Run a perception pipeline over a recording",
          {"loci-perceive run demo-output/day --map demo-output/explored/map.urdf -m demo-output/memory.loci "
           "--resume",
           "loci-perceive run demo-output/day --every 6 --json",
           "loci-perceive run demo-output/day --every 6 --goal \"color=red\" --budget-ms 2000"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<RunArguments>();
            declare(table, *arguments);
            return [arguments](Session& session) { run(*arguments, session); };
          }};
}

}  // namespace loci::apps
