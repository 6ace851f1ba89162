#include "apps/evaluate/changes/truth.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>
#include <sstream>

#include "mapping/base/csv.h"
#include "mapping/base/files.h"
#include "mapping/base/json.h"

namespace loci::changes {
namespace {

constexpr double kMoved = 0.01;      ///< metres
constexpr double kTurned = 0.09;     ///< radians
constexpr int kVisiblePixels = 150;  ///< of the depth picture
constexpr double kVisibleShare = 0.3;

/// Scenes of the truth are numbered by whoever made it; in order they are the frames of the recording.
std::map<int64_t, int64_t> frames_of_scenes(const CsvTable& objects, const std::vector<int64_t>& frames) {
  std::set<int64_t> scenes;
  for (size_t row = 0; row < objects.rows(); ++row)
    scenes.insert(objects.integer(row, objects.require_column("scene")));
  if (scenes.size() != frames.size())
    throw Error(fmt::format("{} scenes do not fit {} frames", scenes.size(), frames.size()),
                objects.place(0, "scene"), "the truth must have every frame of the recording as one scene");
  std::map<int64_t, int64_t> frame_of_scene;
  size_t i = 0;
  for (const int64_t scene : scenes) frame_of_scene[scene] = frames[i++];
  return frame_of_scene;
}

Truth read_tables(const std::filesystem::path& folder, const std::vector<int64_t>& frames) {
  Truth truth;
  const CsvTable objects = CsvTable::read(folder / "objects.csv");
  const std::map<int64_t, int64_t> frame_of_scene = frames_of_scenes(objects, frames);
  for (size_t row = 0; row < objects.rows(); ++row) {
    const auto number = [&](const char* name) { return objects.number(row, objects.require_column(name)); };
    const int64_t scene = objects.integer(row, objects.require_column("scene"));
    truth.visible[frame_of_scene.at(scene)].push_back(
        {objects.cell(row, objects.require_column("object")),
         {number("cx"), number("cy"), number("cz")},
         {number("size_x"), number("size_y"), number("size_z")}});
  }
  const CsvTable transitions = CsvTable::read(folder / "transitions.csv");
  for (size_t row = 0; row < transitions.rows(); ++row) {
    const auto frame = [&](const char* name) {
      const auto found = frame_of_scene.find(transitions.integer(row, transitions.require_column(name)));
      if (found == frame_of_scene.end())
        throw Error("there is no such scene in objects.csv", transitions.place(row, name));
      return found->second;
    };
    truth.transitions.push_back({frame("from_scene"), frame("to_scene"),
                                 transitions.cell(row, transitions.require_column("object")),
                                 transitions.cell(row, transitions.require_column("change"))});
  }
  return truth;
}

struct Sighting {
  int64_t frame = 0;
  Isometry3d pose = Isometry3d::Identity();
};

/// A thing of the simulation over time.
struct Course {
  std::optional<Sighting> last;  ///< when it was visible last
  bool in_world = false;
};

void add_line(const Json& line, std::map<std::string, Course>& courses, Truth& truth) {
  const int64_t frame = line.at("frame").get<int64_t>();
  std::set<std::string> present;
  for (const Json& entry : line.at("objects")) {
    const std::string name = entry.at("id").get<std::string>();
    present.insert(name);
    Course& course = courses[name];
    course.in_world = true;
    const bool visible = entry.at("pixels").get<double>() >= kVisiblePixels &&
                         !entry.at("visible").is_null() && entry.at("visible").get<double>() >= kVisibleShare;
    if (!visible) continue;
    const Isometry3d pose = pose_from_values(entry.at("pose").get<std::array<double, 7>>());
    const auto size = entry.at("size").get<std::array<double, 3>>();
    const Vector3d extent(size[0], size[1], size[2]);
    const Vector3d turned = pose.linear().cwiseAbs() * extent;
    truth.visible[frame].push_back({name, pose * Vector3d(0, 0, size[2] / 2), turned});
    if (!course.last) {
      truth.transitions.push_back({frame, frame, name, "added"});
    } else {
      const Isometry3d change = course.last->pose.inverse() * pose;
      const bool moved =
          change.translation().norm() > kMoved || Eigen::AngleAxisd(change.linear()).angle() > kTurned;
      truth.transitions.push_back({course.last->frame, frame, name, moved ? "moved" : "unchanged"});
    }
    course.last = Sighting{frame, pose};
  }
  for (auto& [name, course] : courses) {
    if (!course.in_world || present.contains(name)) continue;
    course.in_world = false;
    if (course.last) truth.transitions.push_back({course.last->frame, frame, name, "removed"});
    course.last.reset();
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

Truth read_truth(const std::filesystem::path& folder, const std::vector<int64_t>& frames) {
  if (std::filesystem::exists(folder / "truth.jsonl")) return read_simulation(folder / "truth.jsonl");
  if (std::filesystem::exists(folder / "transitions.csv")) return read_tables(folder, frames);
  throw Error("this folder has no truth to compare with", {folder.string(), 0, {}},
              "it needs objects.csv and transitions.csv, or truth.jsonl");
}

}  // namespace loci::changes
