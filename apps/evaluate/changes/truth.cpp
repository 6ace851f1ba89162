#include "apps/evaluate/changes/truth.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>
#include <sstream>

#include "mapping/base/files.h"
#include "mapping/base/text/csv.h"
#include "mapping/base/text/json.h"
#include "mapping/simulation/play.h"
#include "mapping/world/kinematics.h"
#include "mapping/world/urdf.h"

namespace loci::apps::changes {
namespace {

constexpr double kMinMove = 0.01;    ///< metres
constexpr double kTurned = 0.09;     ///< radians
constexpr int kVisiblePixels = 150;  ///< of the depth image
constexpr double kVisibleShare = 0.3;

/// Scenes of the truth are numbered by whoever made it; in order they are the frames of the recording.
std::map<int64_t, int64_t> frames_of_scenes(const CsvTable& objects, const std::vector<int64_t>& frames) {
  std::set<int64_t> scenes;
  for (size_t row = 0; row < objects.rows(); ++row)
    scenes.insert(objects.integer(row, objects.require_column("scene")));
  if (scenes.size() != frames.size())
    throw Error(fmt::format("{} scenes do not fit {} frames", scenes.size(), frames.size()),
                objects.location(0, "scene"),
                "the truth must have every frame of the recording as one scene");
  std::map<int64_t, int64_t> frame_of_scene;
  size_t i = 0;
  for (const int64_t scene : scenes) frame_of_scene[scene] = frames[i++];
  return frame_of_scene;
}

/// How each object lay in each frame ("upside down"), where the table says it.
using States = std::map<std::pair<int64_t, std::string>, std::string>;

/// An object that is seen in a row, nothing of it being handled in between, keeps its count.
void count_handling(Truth& truth) {
  std::map<std::string, int> count;
  std::map<std::pair<int64_t, std::string>, std::string> kind_into;
  for (const TrueTransition& t : truth.transitions) kind_into[{t.to_frame, t.object}] = t.kind;
  for (const auto& [frame, true_objects] : truth.visible)
    for (const TrueObject& true_object : true_objects) {
      const auto kind = kind_into.find({frame, true_object.name});
      if (kind != kind_into.end() && kind->second != "unchanged") ++count[true_object.name];
      truth.handled[frame][true_object.name] = count[true_object.name];
    }
}

Truth read_tables(const std::filesystem::path& folder, const std::vector<int64_t>& frames) {
  Truth truth;
  const CsvTable objects = CsvTable::read(folder / "objects.csv");
  const std::map<int64_t, int64_t> frame_of_scene = frames_of_scenes(objects, frames);
  const int state_column = objects.column("state");
  States states;
  for (size_t row = 0; row < objects.rows(); ++row) {
    const auto number = [&](const char* name) { return objects.number(row, objects.require_column(name)); };
    const int64_t frame = frame_of_scene.at(objects.integer(row, objects.require_column("scene")));
    const std::string name = objects.cell(row, objects.require_column("object"));
    truth.visible[frame].push_back({name,
                                    {number("cx"), number("cy"), number("cz")},
                                    {number("size_x"), number("size_y"), number("size_z")},
                                    std::nullopt});
    if (state_column >= 0) states[{frame, name}] = objects.cell(row, static_cast<size_t>(state_column));
  }
  const CsvTable transitions = CsvTable::read(folder / "transitions.csv");
  for (size_t row = 0; row < transitions.rows(); ++row) {
    const auto frame = [&](const char* name) {
      const auto found = frame_of_scene.find(transitions.integer(row, transitions.require_column(name)));
      if (found == frame_of_scene.end())
        throw Error("there is no such scene in objects.csv", transitions.location(row, name));
      return found->second;
    };
    TrueTransition t{frame("from_scene"), frame("to_scene"),
                     transitions.cell(row, transitions.require_column("object")),
                     transitions.cell(row, transitions.require_column("change"))};
    if (t.kind == "moved" && states[{t.from_frame, t.object}] != states[{t.to_frame, t.object}])
      t.kind = "moved and turned";
    truth.transitions.push_back(t);
  }
  count_handling(truth);
  return truth;
}

/// An object as it stands in the simulation.
struct Stand {
  int64_t frame = 0;
  Isometry3d pose = Isometry3d::Identity();
  Vector3d size = Vector3d::Zero();  ///< along its own axes
  std::array<double, 3> color{};
};

/// An object of the simulation over time.
struct Course {
  std::optional<Stand> visible;  ///< when it was visible last
  std::optional<Stand> now;      ///< unset = not in the world
  int handled = 0;
};

bool shifted(const Stand& from, const Stand& to) {
  return (from.pose.translation() - to.pose.translation()).norm() > kMinMove;
}

bool turned(const Stand& from, const Stand& to) {
  return Eigen::AngleAxisd(from.pose.linear().transpose() * to.pose.linear()).angle() > kTurned;
}

/// As wide as deep and upright in both: how it is turned cannot be seen.
bool is_round(const Stand& from, const Stand& to) {
  const bool upright = from.pose.linear()(2, 2) > 0.99 && to.pose.linear()(2, 2) > 0.99;
  return upright && std::abs(from.size.x() - from.size.y()) < 0.02 * from.size.x();
}

std::string kind_of(const Stand& from, const Stand& to) {
  const bool turns = turned(from, to), round = is_round(from, to);
  if (shifted(from, to)) return turns && !round ? "moved and turned" : "moved";
  if (turns) return round ? "uncertain" : "turned";
  return from.color != to.color ? "recoloured" : "unchanged";
}

void add_line(const Json& line, std::map<std::string, Course>& courses, Truth& truth) {
  const int64_t frame = line.at("frame").get<int64_t>();
  std::set<std::string> present;
  for (const Json& entry : line.at("objects")) {
    const std::string name = entry.at("id").get<std::string>();
    present.insert(name);
    Course& course = courses[name];
    const auto size = entry.at("size").get<std::array<double, 3>>();
    const Stand now{frame, pose_from_values(entry.at("pose").get<std::array<double, 7>>()),
                    Vector3d(size[0], size[1], size[2]), entry.at("color").get<std::array<double, 3>>()};
    if (course.now && (shifted(*course.now, now) || turned(*course.now, now))) ++course.handled;
    course.now = now;
    truth.handled[frame][name] = course.handled;
    const double pixels = entry.at("pixels").get<double>();
    if (pixels <= 0) continue;
    const Vector3d extent = now.pose.linear().cwiseAbs() * now.size;
    TrueObject true_object{name, now.pose * Vector3d(0, 0, size[2] / 2), extent, std::nullopt};
    if (!entry.at("box").is_null()) {
      const auto box = entry.at("box").get<std::array<int, 4>>();
      true_object.pixels = {box[0], box[1], box[2] - box[0] + 1, box[3] - box[1] + 1};
    }
    const bool visible = pixels >= kVisiblePixels && !entry.at("visible").is_null() &&
                         entry.at("visible").get<double>() >= kVisibleShare;
    (visible ? truth.visible : truth.barely)[frame].push_back(true_object);
    if (!visible) continue;
    truth.transitions.push_back(
        course.visible ? TrueTransition{course.visible->frame, frame, name, kind_of(*course.visible, now)}
                       : TrueTransition{frame, frame, name, "added"});
    course.visible = now;
  }
  for (auto& [name, course] : courses) {
    if (!course.now || present.contains(name)) continue;
    course.now.reset();
    ++course.handled;
    if (course.visible) truth.transitions.push_back({course.visible->frame, frame, name, "removed"});
    course.visible.reset();
  }
}

Truth read_simulation(const std::filesystem::path& file) {
  Truth truth;
  std::map<std::string, Course> courses;
  std::istringstream lines(loci::read_file(file));
  std::string text;
  for (int number = 1; std::getline(lines, text); ++number) {
    if (text.empty()) continue;
    try {
      add_line(Json::parse(text), courses, truth);
    } catch (const nlohmann::json::exception& e) {
      throw Error(std::string("this line of the truth cannot be read: ") + e.what(),
                  {file.string(), number, {}});
    }
  }
  return truth;
}

}  // namespace

Truth read_truth(const std::filesystem::path& folder, const mapping::Recording& recording) {
  if (std::filesystem::exists(folder / "truth.jsonl")) return read_simulation(folder / "truth.jsonl");
  std::vector<int64_t> frames;
  for (size_t i = 0; i < recording.size(); ++i) frames.push_back(recording.index_of(i));
  if (std::filesystem::exists(folder / "transitions.csv")) return read_tables(folder, frames);
  throw Error("this folder has no truth to compare with", {folder.string(), 0, {}},
              "it needs objects.csv and transitions.csv, or truth.jsonl");
}

std::vector<TrueObject> clutter_of(const std::filesystem::path& urdf,
                                   const std::vector<std::filesystem::path>& package_paths,
                                   Warnings& warnings) {
  constexpr const char* kFamilies[] = {"bottle", "box", "crate", "cup", "kettle", "pot", "toaster"};
  const mapping::World world = mapping::read_urdf(urdf);
  const std::vector<Isometry3d> map_from_link = root_from_links(world, {});
  std::vector<TrueObject> clutter;
  for (size_t i = 0; i < world.links.size(); ++i) {
    const mapping::Link& link = world.links[i];
    if (std::ranges::none_of(kFamilies, [&](const char* family) { return link.name.starts_with(family); }))
      continue;
    Eigen::AlignedBox3d bounds = bounds_of_link(link, {package_paths, urdf.parent_path()}, warnings);
    if (bounds.isEmpty()) continue;
    bounds.transform(map_from_link[i]);
    clutter.push_back({link.name, bounds.center(), bounds.sizes(), std::nullopt});
  }
  return clutter;
}

}  // namespace loci::apps::changes
