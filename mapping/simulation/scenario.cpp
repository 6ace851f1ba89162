#include "mapping/simulation/scenario.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "mapping/base/config.h"
#include "mapping/base/math/math.h"
#include "mapping/base/time_zone.h"

namespace loci::mapping {
namespace {

constexpr size_t kMaxFrames = 1'000'000;  ///< of a scenario: a few lines may ask for any number

void check_frames(double frames, const FileLocation& location) {
  if (frames > static_cast<double>(kMaxFrames))
    throw Error(fmt::format("the scenario has more than {} frames", kMaxFrames), location,
                "give fewer views, or fewer frames per view");
}

Vector3d point(const Config& config, const std::string& key) {
  const auto values = config.require<std::array<double, 3>>(key);
  Vector3d result(values[0], values[1], values[2]);
  if (!result.allFinite()) throw Error("a point is three finite numbers, in metres", config.location(key));
  return result;
}

std::optional<Rgba> color(const Config& config, const std::string& key) {
  if (!config.has(key)) return std::nullopt;
  const auto values = config.require<std::array<float, 3>>(key);
  for (const float value : values)
    if (!(value >= 0 && value <= 1))
      throw Error("colours are red, green, blue from 0 to 1", config.location(key));
  return Rgba(values[0], values[1], values[2], 1);
}

ObjectSpec read_object(const Config& config, const std::string& name, const std::filesystem::path& folder) {
  config.refuse_other_keys({"model", "size", "color", "accent", "pattern", "label"});
  ObjectSpec object;
  object.name = name;
  object.model = config.require<std::string>("model");
  const auto models = object_models();
  if (std::find(models.begin(), models.end(), object.model) == models.end())
    throw Error("unknown model '" + object.model + "'", config.location("model"),
                did_you_mean(object.model, models));
  if (config.has("size")) object.size = point(config, "size");
  if (config.has("size") && object.size->minCoeff() <= 0)
    throw Error("sizes are positive, in metres", config.location("size"));
  object.color = color(config, "color").value_or(object.color);
  object.accent = color(config, "accent");
  object.pattern = config.get<std::string>("pattern", "");
  const auto patterns = object_patterns();
  if (!object.pattern.empty() &&
      std::find(patterns.begin(), patterns.end(), object.pattern) == patterns.end())
    throw Error("unknown pattern '" + object.pattern + "'", config.location("pattern"),
                did_you_mean(object.pattern, patterns));
  if (config.has("label")) {
    object.label = folder / config.require<std::string>("label");
    if (!std::filesystem::exists(object.label))
      throw Error("no such image: " + object.label.string(), config.location("label"));
  }
  return object;
}

/// Reads actions; knows the objects that are declared.
class ActionReader {
 public:
  explicit ActionReader(const std::map<std::string, ObjectSpec>& objects) {
    for (const auto& [name, object] : objects) names_.push_back(name);
  }

  Action read(const Config& config) const {
    static const std::vector<std::string> verbs = {"place", "move",    "remove", "open",
                                                   "close", "recolor", "turn"};
    std::string verb;
    for (const std::string& key : config.keys())
      if (std::find(verbs.begin(), verbs.end(), key) != verbs.end()) verb = key;
    if (verb.empty()) {
      const std::string first = config.keys().empty() ? "" : config.keys().front();
      throw Error("unknown action '" + first + "'", config.location(), did_you_mean(first, verbs));
    }
    Action action;
    action.location = config.location(verb);
    action.subject = config.require<std::string>(verb);
    if (verb == "open" || verb == "close")
      read_joint(config, verb, action);
    else
      read_object_action(config, verb, action);
    config.finish();
    return action;
  }

 private:
  static void read_joint(const Config& config, const std::string& verb, Action& action) {
    action.kind = Action::Kind::open;
    if (verb == "close") return;
    if (config.has("to_deg"))
      action.position = config.require<double>("to_deg") * kDegree;
    else
      action.position = config.require<double>("to");
  }

  void read_object_action(const Config& config, const std::string& verb, Action& action) const {
    if (std::find(names_.begin(), names_.end(), action.subject) == names_.end())
      throw Error("unknown object '" + action.subject + "'", action.location,
                  did_you_mean(action.subject, names_));
    if (verb == "place" || verb == "move") {
      read_place(config, action);
    } else if (verb == "remove") {
      action.kind = Action::Kind::remove;
    } else if (verb == "turn") {
      action.kind = Action::Kind::turn;
      action.yaw = config.require<double>("yaw_deg") * kDegree;
    } else {
      action.kind = Action::Kind::recolor;
      action.color = color(config, "color");
      action.accent = color(config, "accent");
      if (!action.color && !action.accent) throw Error("recolor needs a color or an accent", action.location);
    }
  }

  static void read_place(const Config& config, Action& action) {
    action.kind = Action::Kind::place;
    if (config.has("on") && config.has("in")) throw Error("either 'on' or 'in', not both", action.location);
    action.support = config.get<std::string>("on", "");
    if (config.has("in")) {
      action.support = config.require<std::string>("in");
      action.inside = true;
    }
    if (config.has("at")) {
      const auto at = config.require<std::array<double, 2>>("at");
      action.at = Vector2d(at[0], at[1]);
    }
    if (config.has("yaw_deg")) action.yaw = config.require<double>("yaw_deg") * kDegree;
    action.lying = config.get<bool>("lying", false);
  }

  std::vector<std::string> names_;
};

Isometry3d read_view(const Config& config) {
  config.refuse_other_keys({"from", "at"});
  const Vector3d from = point(config, "from");
  const Vector3d at = point(config, "at");
  if ((at - from).norm() < 1e-6) throw Error("'from' and 'at' are the same point", config.location());
  return looking_at(from, at);
}

/// `count` values from first to last of a [first, last, count] entry.
std::vector<double> read_range(const Config& config, const std::string& key) {
  const auto values = config.require<std::array<double, 3>>(key);
  if (!(values[2] >= 1 && values[2] <= 1000))
    throw Error("expected [first, last, count]", config.location(key), "count is 1 to 1000");
  const int count = static_cast<int>(values[2]);
  std::vector<double> result;
  for (int i = 0; i < count; ++i)
    result.push_back(count == 1 ? values[0] : values[0] + (values[1] - values[0]) * i / (count - 1));
  return result;
}

/// From each position, each pitch, the yaw goes from first to last.
std::vector<Isometry3d> read_sweep(const Config& config) {
  config.refuse_other_keys({"positions", "pitch_deg", "yaw_deg"});
  std::vector<Isometry3d> views;
  const auto positions = config.require<std::vector<std::array<double, 3>>>("positions");
  const auto pitches = config.require<std::vector<double>>("pitch_deg");
  const auto yaws = read_range(config, "yaw_deg");
  check_frames(static_cast<double>(positions.size()) * static_cast<double>(pitches.size() * yaws.size()),
               config.location());
  for (const auto& position : positions) {
    const Vector3d from(position[0], position[1], position[2]);
    for (const double pitch : pitches) {
      for (const double yaw : yaws) {
        const Vector3d forward(std::cos(yaw * kDegree) * std::cos(pitch * kDegree),
                               std::sin(yaw * kDegree) * std::cos(pitch * kDegree),
                               std::sin(pitch * kDegree));
        views.push_back(looking_at(from, from + forward));
      }
    }
  }
  return views;
}

SceneSpec read_scene(const Config& config, const ActionReader& actions) {
  config.refuse_other_keys({"time", "do", "view", "views", "sweep", "frames"});
  SceneSpec scene;
  try {
    scene.time_ns = parse_time(config.require<std::string>("time"));
  } catch (const Error& error) {
    throw Error(error.message(), config.location("time"), error.hint());
  }
  for (const Config& action : config.list("do")) scene.actions.push_back(actions.read(action));
  std::vector<Isometry3d> views;
  if (config.has("view")) views.push_back(read_view(config.map("view")));
  for (const Config& view : config.list("views")) views.push_back(read_view(view));
  if (config.has("sweep"))
    for (const Isometry3d& view : read_sweep(config.map("sweep"))) views.push_back(view);
  const int frames = config.get<int>("frames", 1);
  if (frames < 1 || frames > 10000) throw Error("frames is 1 to 10000 per view", config.location("frames"));
  if (views.empty()) throw Error("the scene has no view, views or sweep", config.location());
  check_frames(static_cast<double>(views.size()) * frames, config.location());
  for (const Isometry3d& view : views)
    scene.map_from_camera.insert(scene.map_from_camera.end(), static_cast<size_t>(frames), view);
  return scene;
}

/// `camera: kinect`, or a mapping that overrides fields of the sensor.
void read_camera(const Config& config, Scenario& scenario) {
  scenario.camera = kinect_camera();
  const YAML::Node node = config.node("camera");
  if (!node) return;
  const Config fields = node.IsScalar() ? Config::parse("{}", "") : config.map("camera");
  const auto sensor = node.IsScalar() ? node.as<std::string>() : fields.get<std::string>("sensor", "kinect");
  if (sensor != "kinect")
    throw Error("unknown sensor '" + sensor + "'", config.location("camera"),
                did_you_mean(sensor, {"kinect"}));
  OptionTable table = table_of(scenario.sensor);
  table.read(fields);
  fields.finish();
  table.validate(config.location("camera"));
}

}  // namespace

Isometry3d looking_at(const Vector3d& from, const Vector3d& at) {
  const Vector3d forward = (at - from).normalized();
  Vector3d right = forward.cross(Vector3d::UnitZ());
  if (right.norm() < 1e-9) right = Vector3d::UnitX();  // Straight up or down: any heading will do.
  right.normalize();
  Isometry3d pose = Isometry3d::Identity();
  pose.linear().col(0) = right;
  pose.linear().col(1) = forward.cross(right);
  pose.linear().col(2) = forward;
  pose.translation() = from;
  return pose;
}

Scenario read_scenario(const std::filesystem::path& path) {
  const Config config = Config::read(path);
  config.refuse_other_keys(
      {"world", "camera", "floor", "time_zone", "frame_interval_s", "objects", "scenes"});
  Scenario scenario;
  scenario.file = path;
  scenario.world = path.parent_path() / config.require<std::string>("world");
  read_camera(config, scenario);
  if (config.has("floor")) scenario.floor = config.require<double>("floor");
  scenario.time_zone =
      TimeZone::named(config.get<std::string>("time_zone", "UTC"), config.location("time_zone")).name();
  const auto interval = config.get<double>("frame_interval_s", 1.0);
  if (!(interval >= 1e-6 && interval <= 3600))
    throw Error("the interval is 1e-6 to 3600 seconds", config.location("frame_interval_s"));
  scenario.frame_interval = static_cast<TimeNs>(std::llround(interval * static_cast<double>(kSecond)));
  const Config objects = config.map("objects");
  for (const std::string& name : objects.keys())
    scenario.objects[name] = read_object(objects.map(name), name, path.parent_path());
  const ActionReader actions(scenario.objects);
  size_t frames = 0;
  for (const Config& scene : config.list("scenes")) {
    scenario.scenes.push_back(read_scene(scene, actions));
    const auto& scenes = scenario.scenes;
    frames += scenes.back().map_from_camera.size();
    check_frames(static_cast<double>(frames), scene.location());
    if (scenes.size() < 2) continue;
    const SceneSpec& before = scenes[scenes.size() - 2];
    const auto lasts = static_cast<TimeNs>(before.map_from_camera.size()) * scenario.frame_interval;
    if (scenes.back().time_ns < before.time_ns + lasts)
      throw Error("the scene begins before the one before has ended", scene.location("time"),
                  fmt::format("that one lasts until {}", format_time(before.time_ns + lasts)));
  }
  if (scenario.scenes.empty()) throw Error("the scenario has no scenes", config.location("scenes"));
  return scenario;
}

}  // namespace loci::mapping
