#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/evaluate/memory/identity_judge.h"
#include "mapping/base/math/random.h"
#include "memory/ingest/detections.h"

namespace loci::apps::memory_experiment {

struct HomeOptions {
  int places = 10;
  int objects = 100;        ///< at any time
  double scene_s = 30;      ///< from one look to the next
  double moves = 0.3;       ///< per scene: something is put elsewhere
  double exchanges = 0.01;  ///< per scene: something leaves for good and something new comes
  double detection = 0.95;  ///< what is on the place that is looked at is found
  double clutter = 0.02;    ///< false detections per scene
  double noise_m = 0.005;   ///< of positions, per axis
};

/// What a detection is of, which only evaluation may know.
struct TrueObject {
  int number = -1;  ///< -1 = false detection
  TrueEvent event = TrueEvent::ghost;
};

/// A home of tables with objects on them, and a robot that looks at one table after the other: what its
/// detector finds there, without images.
class Home {
 public:
  Home(const HomeOptions& options, int seed);

  /// Half a minute later, at the next table.
  memory::DetectedScene look();
  /// Of what the detections of the last look are.
  const std::vector<TrueObject>& seen() const { return seen_; }

  static std::string place_name(int place);
  static const std::vector<std::string>& classes();
  TimeNs time() const { return time_; }

 private:
  struct Object {
    int place = 0;
    Vector3d position = Vector3d::Zero(), size = Vector3d::Zero(), color = Vector3d::Zero();
    std::string class_name, text;
    int number = 0;
    std::optional<int> seen_on;  ///< the place where it was seen last
    bool moved = false;          ///< since then
  };
  Object new_object();
  void put(Object& object, int place);
  memory::Detection detect(const Object& object);
  static TrueEvent event_of(const Object& object);

  HomeOptions options_;
  Random random_;
  std::vector<Object> objects_;
  TimeNs time_;
  std::vector<TrueObject> seen_;
  int scenes_ = 0, numbers_ = 0;
};

}  // namespace loci::apps::memory_experiment
