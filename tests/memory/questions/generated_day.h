#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "mapping/base/math/random.h"
#include "mapping/base/text/json.h"
#include "memory/ingest/ingest.h"
#include "tests/memory/store/temporary_folder.h"

namespace loci::memory::testing_support {

/// A test that asks the memory of a random day.
class GeneratedDay : public TemporaryFolder {
 protected:
  static constexpr int kScenes = 30, kObjects = 5, kPlaces = 3;

  /// A day of detections: the camera looks at one place after the other, and objects are moved or taken away.
  void generate(uint64_t seed) {
    Random random(seed);
    struct Object {
      int place;  ///< kPlaces = taken away
      Vector3d position;
    };
    const auto spot = [&](int place) {
      return Vector3d(3.0 * place + random.uniform(0, 1), random.uniform(0, 1), 0.8);
    };
    std::vector<Object> objects;
    for (int i = 0; i < kObjects; ++i) {
      const int place = static_cast<int>(random.index(kPlaces));
      objects.push_back({place, spot(place)});
    }
    std::string lines;
    for (int n = 0; n < kScenes; ++n) {
      for (Object& object : objects) {
        if (random.uniform() > 0.1) continue;
        object.place = static_cast<int>(random.index(kPlaces + 1));
        object.position = spot(object.place);
      }
      const int seen = static_cast<int>(random.index(kPlaces));
      Json detections = Json::array();
      for (int i = 0; i < kObjects; ++i) {
        if (objects[size_t(i)].place != seen || random.uniform() < 0.1) continue;
        const Vector3d p = objects[size_t(i)].position;
        detections.push_back(
            {{"position", {p.x() + 0.004 * random.normal(), p.y() + 0.004 * random.normal(), p.z()}},
             {"size", {0.08, 0.08, 0.1}},
             {"class", {{fmt::format("kind_{}", i), 0.9}}},
             {"color", {70 * i, 0.8, 0.8}},
             {"score", 0.9},
             {"place", fmt::format("table_{}", seen)}});
      }
      const Json scene = {{"time", format_time(parse_time("2026-05-01T08:00:00Z") + n * 600 * kSecond)},
                          {"observed", {{{"place", fmt::format("table_{}", seen)}, {"fraction", 0.95}}}},
                          {"detections", detections}};
      lines += scene.dump() + "\n";
    }
    write_file_atomically(folder_ / "day.jsonl", lines);
    NoProgress silent;
    Warnings warnings;
    ingest(folder_ / "day.jsonl", file_, {}, {}, silent, warnings);
  }
};

}  // namespace loci::memory::testing_support
