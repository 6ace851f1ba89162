// Detections in the images of the sample day, lifted to 3-D, beside where the objects truly are.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <iostream>
#include <map>
#include <set>
#include <sstream>

#include "mapping/base/files.h"
#include "mapping/base/math/math.h"
#include "mapping/base/math/pose.h"
#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "mapping/base/time.h"
#include "mapping/recording/recording.h"
#include "memory/store/store.h"
#include "tests/cli/command.h"

namespace loci::apps::test {
namespace {

struct TrueObject {
  std::string name;
  Isometry3d map_from_object = Isometry3d::Identity();  ///< origin in the middle of the bottom
  Vector3d size = Vector3d::Zero();
  std::array<int, 4> box = {};  ///< first and last column and row in the depth image

  Vector3d centre() const { return map_from_object * Vector3d(0, 0, size.z() / 2); }
};

std::vector<TrueObject> objects_of(const Json& frame) {
  std::vector<TrueObject> objects;
  for (const Json& entry : frame.at("objects")) {
    if (entry.at("box").is_null() || entry.at("pixels").get<int>() < 150 || entry.at("visible").is_null() ||
        entry.at("visible").get<double>() < 0.5)
      continue;
    TrueObject& object = objects.emplace_back();
    object.name = entry.at("id").get<std::string>();
    object.map_from_object = pose_from_values(entry.at("pose").get<std::array<double, 7>>(), {});
    for (int axis = 0; axis < 3; ++axis) object.size[axis] = entry.at("size").at(static_cast<size_t>(axis));
    const auto box = entry.at("box").get<std::vector<int>>();
    object.box = {box[0], box[2], box[1], box[3]};
  }
  return objects;
}

/// The runs of a mask of the colour image in which the depth pixels of an object fall.
std::vector<uint32_t> runs_of(const TrueObject& object, const mapping::RgbdFrame& frame) {
  const mapping::PinholeCamera& color = frame.camera.color;
  std::vector<char> column_major(static_cast<size_t>(color.width) * static_cast<size_t>(color.height));
  const Isometry3d object_from_camera = object.map_from_object.inverse() * *frame.map_from_camera;
  const Isometry3d color_from_depth = frame.camera.depth_from_color.inverse();
  for (int v = object.box[2]; v <= object.box[3]; ++v)
    for (int u = object.box[0]; u <= object.box[1]; ++u) {
      const auto z = static_cast<double>(frame.depth.at<float>(v, u));
      if (!(z > 0)) continue;
      const Vector3d in_camera = frame.camera.depth.unproject(u, v, z);
      const Vector3d at = object_from_camera * in_camera;
      const double noise = 0.006 * z * z;
      if ((at.head<2>().cwiseAbs() - object.size.head<2>() / 2).maxCoeff() > noise || at.z() < 0.003 ||
          at.z() > object.size.z() + noise)
        continue;
      const Vector2d pixel = color.project(color_from_depth * in_camera);
      const auto x = std::lround(pixel.x()), y = std::lround(pixel.y());
      if (x < 0 || y < 0 || x >= color.width || y >= color.height) continue;
      column_major[static_cast<size_t>(x) * static_cast<size_t>(color.height) + static_cast<size_t>(y)] = 1;
    }
  std::vector<uint32_t> runs = {0};
  char current = 0;
  for (const char pixel : column_major) {
    if (pixel != current) runs.push_back(0);
    current = pixel;
    ++runs.back();
  }
  return runs;
}

class LiftedTruth : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(run("loci-simulate record apps/samples/day.yaml -o " + folder_ + "/day").exit_code, 0);
    std::istringstream lines(read_file(folder_ + "/day/truth.jsonl"));
    for (std::string line; std::getline(lines, line);)
      truth_.push_back(objects_of(parse_json(line, "truth")));
  }

  /// Distances of the lifted centres from the true ones, metres, of objects that have a detection nearby.
  std::vector<double> errors(const std::string& detections, const std::string& options) const {
    const std::string memory =
        folder_ + "/" + std::to_string(std::hash<std::string>()(detections + options)) + ".loci";
    const Outcome outcome =
        run("loci-memory ingest " + detections + " --recording " + folder_ + "/day -m " + memory + options);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    std::cout << outcome.out;
    const memory::Store store = memory::Store::open_read(memory);
    std::vector<double> distances;
    for (const memory::SceneRow& scene : store.scenes())
      for (const memory::ObservationRow& row : store.observations(scene.id)) {
        double best = 0.3;
        for (const TrueObject& object : truth_.at(static_cast<size_t>(*scene.frame_index)))
          best = std::min(best, (object.centre() - *row.position).norm());
        distances.push_back(best);
      }
    std::sort(distances.begin(), distances.end());
    std::cout << fmt::format("{}: {} detections, median {:.1f} mm, 90 % within {:.1f} mm\n", options,
                             distances.size(), 1000 * quantile(distances, 0.5),
                             1000 * quantile(distances, 0.9));
    return distances;
  }

  /// A COCO file with a mask per visible object.
  std::string masks() const {
    const auto recording = mapping::open_recording(folder_ + "/day");
    Json file = {{"images", Json::array()}, {"annotations", Json::array()}, {"categories", Json::array()}};
    std::set<std::string> names;
    for (size_t i = 0; i < recording->size(); ++i) {
      const mapping::RgbdFrame frame = recording->frame(i);
      file["images"].push_back(
          {{"id", i}, {"file_name", frame.name + ".png"}, {"width", 640}, {"height", 480}});
      for (const TrueObject& object : truth_.at(i)) {
        const std::vector<uint32_t> runs = runs_of(object, frame);
        if (runs.size() < 20) continue;
        if (names.insert(object.name).second)
          file["categories"].push_back({{"id", object.name}, {"name", object.name}});
        file["annotations"].push_back({{"image_id", i},
                                       {"category_id", object.name},
                                       {"segmentation", {{"size", {480, 640}}, {"counts", runs}}}});
      }
    }
    write_json(folder_ + "/masks.json", file);
    return folder_ + "/masks.json";
  }

  std::string folder_ = fresh_folder();
  std::vector<std::vector<TrueObject>> truth_;
};

TEST_F(LiftedTruth, CentresAreWithinCentimetres) {
  const std::string map = " --map apps/samples/kitchen.urdf";
  const std::vector<double> boxes = errors("apps/samples/yolo", ""),
                            with_map = errors("apps/samples/yolo", map);
  const std::string file = masks();
  const std::vector<double> in_masks = errors(file, ""), both = errors(file, map);
  EXPECT_GT(with_map.size(), 80U);
  EXPECT_LT(quantile(boxes, 0.5), 0.04);
  EXPECT_LT(quantile(with_map, 0.5), 0.04);
  EXPECT_LT(quantile(in_masks, 0.5), 0.04);
  EXPECT_LT(quantile(both, 0.5), 0.04);
}

/// Spots of the objects of a real recording that a person picked.
struct Spot {
  std::string object;
  size_t frame = 0;
  int u = 0, v = 0;
  Vector3d point;  ///< map frame
};

std::vector<Spot> spots_of_bin() {
  std::vector<Spot> spots;
  std::istringstream table(read_file(shared("data/shelf_bin/objects.csv")));
  std::string line;
  std::getline(table, line);
  while (std::getline(table, line)) {
    const std::vector<std::string> cells = split(line, ',');
    spots.push_back({cells.at(0),
                     static_cast<size_t>(std::stoi(cells.at(1))),
                     std::stoi(cells.at(2)),
                     std::stoi(cells.at(3)),
                     {std::stod(cells.at(6)), std::stod(cells.at(7)), std::stod(cells.at(8))}});
  }
  return spots;
}

TEST(LiftedReal, ShelfBinWithinCentimetres) {
  LOCI_NEEDS_SHARED("data/shelf_bin");
  const auto recording = mapping::open_recording(shared("data/shelf_bin"));
  std::map<size_t, std::vector<Vector3d>> spots;
  std::map<size_t, Json> found;
  for (const Spot& spot : spots_of_bin()) {
    spots[spot.frame].push_back(spot.point);
    // A box of 50 pixels around each.
    found[spot.frame].push_back({{"bbox", {spot.u - 25, spot.v - 25, 50, 50}}, {"class", spot.object}});
  }
  std::string text;
  for (const auto& [frame, detections] : found)
    text += Json{{"time", format_time(recording->time_of(frame))}, {"detections", detections}}.dump() + "\n";
  const std::string folder = fresh_folder();
  write_file_atomically(folder + "/shelf.jsonl", text);
  const Outcome outcome = run("loci-memory ingest " + folder + "/shelf.jsonl --recording " +
                              shared("data/shelf_bin") + " -m " + folder + "/shelf.loci");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const memory::Store store = memory::Store::open_read(folder + "/shelf.loci");
  std::vector<double> distances;
  auto expected = spots.begin();
  for (const memory::SceneRow& scene : store.scenes()) {
    const std::vector<memory::ObservationRow> rows = store.observations(scene.id);
    ASSERT_EQ(rows.size(), expected->second.size());
    for (size_t i = 0; i < rows.size(); ++i)
      distances.push_back((*rows[i].position - expected->second[i]).norm());
    ++expected;
  }
  std::cout << fmt::format("{} spots, median {:.1f} mm, largest {:.1f} mm\n", distances.size(),
                           1000 * median(distances), 1000 * quantile(distances, 1.0));
  EXPECT_EQ(distances.size(), 12U);
  EXPECT_LT(median(distances), 0.015);
  EXPECT_LT(quantile(distances, 1.0), 0.05);
}

TEST(RememberedReal, ObjectsThatStandCloseInABinAreNotTakenForOne) {
  LOCI_NEEDS_SHARED("data/shelf_bin");
  const std::string memory = fresh_folder() + "/shelf.loci";
  const Outcome outcome = run("loci-perceive run " + shared("data/shelf_bin") + " -m " + memory);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const memory::Store store = memory::Store::open_read(memory);
  std::map<std::string, std::vector<Vector3d>> picked;
  for (const Spot& spot : spots_of_bin()) picked[spot.object].push_back(spot.point);
  std::set<memory::Id> found;
  for (const auto& [object, points] : picked) {
    Vector3d centre = Vector3d::Zero();
    for (const Vector3d& point : points) centre += point / static_cast<double>(points.size());
    double nearest = 0.12;  // m: spots are on the front sides
    std::optional<memory::Id> there;
    for (const memory::BeliefRow& belief : store.beliefs()) {
      const double distance = belief.position ? (*belief.position - centre).norm() : nearest;
      if (distance < nearest) there = belief.object, nearest = distance;
    }
    ASSERT_TRUE(there) << object;
    EXPECT_TRUE(found.insert(*there).second) << object;
  }
}

}  // namespace
}  // namespace loci::apps::test
