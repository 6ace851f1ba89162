#include "apps/evaluate/memory/simulator.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mapping/simulation/scenario.h"

namespace loci::apps::memory_experiment {
namespace {

constexpr double kTableHeight_m = 0.75, kTableLength_m = 1.5, kTableWidth_m = 0.9;
constexpr TimeNs kBegin = 1'767'225'600 * kSecond;  // 2026-01-01
const std::vector<std::string> kWords = {"fresh", "dark",  "whole",  "sweet",
                                         "old",   "green", "alpine", "salted"};
const std::vector<std::string> kGoods = {"milk", "coffee", "rice", "tea", "honey", "butter", "beans", "soap"};

Vector3d centre_of(int place) {
  const int column = place % 5, row = place / 5;
  return {3.0 * column, 4.0 * row, kTableHeight_m};
}

/// Stands before the table and looks down at its middle.
Isometry3d camera_at(int place) {
  const Vector3d at = centre_of(place);
  return mapping::looking_at(at + Vector3d(0, -1.3, 1.1), at);
}

}  // namespace

Home::Home(const HomeOptions& options, int seed)
    : options_(options), random_(static_cast<uint64_t>(seed)), time_(kBegin) {
  for (int i = 0; i < options.objects; ++i) {
    objects_.push_back(new_object());
    put(objects_.back(), i % options.places);
  }
}

std::string Home::place_name(int place) {
  return fmt::format("table_{}", place + 1);
}

const std::vector<std::string>& Home::classes() {
  static const std::vector<std::string> names = {"mug",  "bowl", "plate", "box",   "bottle",
                                                 "book", "can",  "fork",  "knife", "pan"};
  return names;
}

Home::Object Home::new_object() {
  Object object;
  object.number = numbers_++;
  object.class_name = classes()[random_.index(classes().size())];
  object.size = {random_.uniform(0.05, 0.14), random_.uniform(0.05, 0.14), random_.uniform(0.05, 0.25)};
  object.color = {random_.uniform(0, 360), random_.uniform(0.3, 1), random_.uniform(0.3, 1)};
  if (random_.uniform() < 0.3)
    object.text = kWords[random_.index(kWords.size())] + " " + kGoods[random_.index(kGoods.size())];
  return object;
}

void Home::put(Object& object, int place) {
  constexpr int kTries = 50;
  object.place = place;
  for (int i = 0; i < kTries; ++i) {
    object.position = centre_of(place) + Vector3d(random_.uniform(-kTableLength_m / 2, kTableLength_m / 2),
                                                  random_.uniform(-kTableWidth_m / 2, kTableWidth_m / 2),
                                                  object.size.z() / 2);
    const bool free = std::none_of(objects_.begin(), objects_.end(), [&](const Object& other) {
      const Vector3d apart = (other.position - object.position).cwiseAbs();
      return &other != &object && apart.x() < 0.15 && apart.y() < 0.15;
    });
    if (free) return;
  }
}

memory::Detection Home::detect(const Object& object) {
  memory::Detection detection;
  detection.position = object.position;
  Vector3d size = object.size, color = object.color;
  for (int axis = 0; axis < 3; ++axis) {
    detection.position[axis] += random_.normal(options_.noise_m);
    size[axis] *= 1 + random_.normal(0.03);
  }
  color[0] = std::fmod(color[0] + random_.normal(4) + 360, 360);
  for (int i = 1; i < 3; ++i) color[i] = std::clamp(color[i] + random_.normal(0.03), 0.0, 1.0);
  detection.size = size;
  detection.color = color;
  detection.position_sigma = options_.noise_m;
  detection.classes = {{object.class_name, 0.9}};
  if (!object.text.empty()) detection.texts = {object.text};
  detection.place = place_name(object.place);
  return detection;
}

TrueEvent Home::event_of(const Object& object) {
  if (!object.seen_on) return TrueEvent::fresh;
  if (*object.seen_on != object.place) return TrueEvent::moved_elsewhere;
  return object.moved ? TrueEvent::moved_here : TrueEvent::stayed;
}

memory::DetectedScene Home::look() {
  time_ += static_cast<TimeNs>(options_.scene_s * static_cast<double>(kSecond));
  const auto places = static_cast<uint64_t>(options_.places);
  if (random_.uniform() < options_.moves) {
    const auto to = static_cast<int>(random_.index(places));
    Object& object = objects_[random_.index(objects_.size())];
    put(object, to);
    object.moved = true;
  }
  if (random_.uniform() < options_.exchanges) {
    Object& object = objects_[random_.index(objects_.size())];
    object = new_object();
    put(object, static_cast<int>(random_.index(places)));
  }
  const int place = scenes_++ % options_.places;
  memory::DetectedScene scene;
  scene.time = time_;
  scene.camera = memory::DetectedScene::Camera{
      camera_at(place), mapping::PinholeCamera{640, 480, 525, 525, 320, 240}, {}, {}};
  scene.observed = {{place_name(place), 1.0}};
  seen_.clear();
  for (Object& object : objects_) {
    if (object.place != place || random_.uniform() >= options_.detection) continue;
    scene.detections.push_back(detect(object));
    seen_.push_back({object.number, event_of(object)});
    object.seen_on = place;
    object.moved = false;
  }
  if (random_.uniform() < options_.clutter) {
    Object ghost = new_object();
    put(ghost, place);
    scene.detections.push_back(detect(ghost));
    seen_.emplace_back();
  }
  return scene;
}

}  // namespace loci::apps::memory_experiment
