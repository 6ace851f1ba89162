#include <algorithm>
#include <cmath>

#include "mapping/world/free_standing.h"
#include "memory/recorder/belief_rows.h"
#include "memory/recorder/recorder.h"
#include "memory/recorder/scene_reasoning.h"
#include "memory/store/feature_structures.h"
#include "memory/store/scene_images.h"

namespace loci::memory {
namespace {

constexpr double kPlaceSeen = 0.01;
constexpr double kJointMoved = 0.01;  ///< metres or radians

bool joint_moved(double from, double to) {
  return std::abs(to - from) > kJointMoved;
}

/// Depth image reduced to a thumbnail.
struct DepthSample {
  int width = 0, height = 0;
  std::string bytes;
};

int step_of(const cv::Mat& image) {
  return std::max(1, (std::max(image.cols, image.rows) + 159) / 160);
}

/// Every n-th pixel, so that the longer side has at most 160; where that has no measurement, the first
/// measured one of its block.
DepthSample depth_sample(const cv::Mat& depth) {
  const int step = step_of(depth);
  DepthSample small{depth.cols / step, depth.rows / step, {}};
  std::vector<float> values;
  for (int row = 0; row < small.height; ++row) {
    for (int column = 0; column < small.width; ++column) {
      const int v = row * step + step / 2, u = column * step + step / 2;
      float value = depth.at<float>(v, u);
      for (int i = 0; i < step * step && !std::isfinite(value); ++i)
        value = depth.at<float>(row * step + i / step, column * step + i % step);
      values.push_back(std::isfinite(value) ? value : 0.0F);
    }
  }
  small.bytes = encode_depth_thumbnail(values);
  return small;
}

/// The pixel kinds of the same samples, as bytes of pixel_kinds().
std::string kind_sample(const cv::Mat& kinds) {
  const int step = step_of(kinds);
  std::string bytes;
  for (int row = 0; row < kinds.rows / step; ++row)
    for (int column = 0; column < kinds.cols / step; ++column) {
      uint8_t kind = kinds.at<uint8_t>(row * step + step / 2, column * step + step / 2);
      for (int i = 0; i < step * step && kind == 0; ++i)
        kind = kinds.at<uint8_t>(row * step + i / step, column * step + i % step);
      bytes.push_back(static_cast<char>(kind));
    }
  return bytes;
}

}  // namespace

/// Writes one scene.
class Recorder::SceneWriter {
 public:
  SceneWriter(Recorder& recorder, const SceneRecord& record, ResolvedScene resolved)
      : recorder_(recorder),
        record_(record),
        transaction_(recorder.store_, recorder.run_),
        state_(std::move(resolved.after)) {
    result_.update = std::move(resolved.update);
    evidence_ = std::move(resolved.scene);
  }

  RecordedScene run() {
    if (recorder_.review_) memory::begin_review(transaction_, recorder_.store_);
    add_scene();
    add_places();
    add_observations();
    add_belief_rows();
    belief::Decisions decisions = belief::decisions_of(result_.update);
    belief::SceneMatrices matrices = belief::matrices_of(result_.update, decisions);
    std::vector<belief::PlacePose> places = evidence_.places;
    save_reasoning(transaction_, result_.scene,
                   {std::move(evidence_), std::move(decisions), std::move(matrices)});
    recorder_.checkpoint_.save(transaction_, result_.scene, state_);
    if (recorder_.review_ && !result_.update.mistakes.empty()) note_contradiction(transaction_);
    transaction_.commit();
    recorder_.checkpoint_.committed();
    update_last(recorder_.stored_beliefs_, rows_, state_);
    recorder_.state_ = std::move(state_);
    for (const auto& [joint, position] : record_.row.joints) recorder_.last_joints_[joint] = position;
    recorder_.last_map_ = recorder_.map_of(record_.row);
    recorder_.last_places_ = std::move(places);
    recorder_.places_.merge(new_places_);
    recorder_.next_observation_ += static_cast<Id>(result_.observations.size());
    return std::move(result_);
  }

 private:
  Bitemporal clock(std::optional<TimeNs> valid_from = {}) const {
    Bitemporal clock;
    clock.valid_from = valid_from.value_or(record_.row.time);
    clock.source = record_.source;
    return clock;
  }

  [[noreturn]] void refuse_other_writer(const std::string& what, Id id, Id expected) const {
    throw Error(what + " " + std::to_string(id) + " was to be " + std::to_string(expected),
                {recorder_.store_.path().string(), 0, {}},
                "another program has written to this memory meanwhile");
  }

  std::optional<Id> blob(const BlobRecord& record) {
    if (record.bytes.empty()) return std::nullopt;
    return transaction_.add_blob(record.bytes, record.media);
  }

  void add_scene() {
    SceneRow row = record_.row;
    row.map = recorder_.map_of(row);
    if (!record_.view.depth.empty()) {
      const DepthSample small = depth_sample(record_.view.depth);
      row.depth = transaction_.add_blob(small.bytes, kDepthThumbnailMedia);
      row.depth_width = small.width;
      row.depth_height = small.height;
      if (record_.kinds.size() == record_.view.depth.size())
        row.pixel_kinds = transaction_.add_blob(kind_sample(record_.kinds), kPixelKindsMedia);
    }
    row.image = blob(record_.image);
    result_.scene = transaction_.add_scene(row);
    for (size_t i = 0; i < record_.log.size(); ++i) {
      LogRow line = record_.log[i];
      line.scene = result_.scene;
      line.number = static_cast<int64_t>(i);
      transaction_.add_log(line);
    }
  }

  void add_places() {
    for (const PlaceRow& row : record_.places) {
      if (place(row.name)) continue;
      new_places_[row.name] = row;
      new_places_[row.name].id = transaction_.add_place(row);
    }
  }

  std::optional<Id> place(const std::string& name) const {
    if (const auto known = recorder_.places_.find(name); known != recorder_.places_.end())
      return known->second.id;
    const auto fresh = new_places_.find(name);
    return fresh == new_places_.end() ? std::nullopt : std::optional<Id>(fresh->second.id);
  }

  void add_observations() {
    FeatureStructureWriter structures(transaction_, result_.scene);
    for (size_t i = 0; i < record_.observations.size(); ++i) {
      const ObservationRecord& observation = record_.observations[i];
      ObservationRow row = observation.row;
      row.scene = result_.scene;
      if (row.id == 0) row.number = static_cast<int64_t>(i);  // else it keeps the one of another memory
      row.place = place(observation.evidence.place);
      row.crop = blob(observation.crop);
      row.mask = blob(observation.mask);
      row.cloud = blob(observation.cloud);
      const Id id = transaction_.add_observation(row);
      result_.observations.push_back(id);
      if (id != evidence_.observations[i].id)
        refuse_other_writer("observation", id, evidence_.observations[i].id);
      add_annotations(observation.annotations, observation.structures, id, structures);
    }
    add_annotations(record_.annotations, record_.structures, std::nullopt, structures);
    if (record_.cameras) add_color_camera(structures, *record_.cameras);
  }

  void add_annotations(const std::vector<AnnotationRecord>& annotations,
                       const std::vector<perception::cas::FeatureStructure>& others,
                       std::optional<Id> observation, FeatureStructureWriter& structures) {
    for (const AnnotationRecord& annotation : annotations) {
      AnnotationRow row = annotation_row(annotation, result_.scene, observation);
      if (annotation.structure) row.feature_structure = structures.add(annotation.structure, observation);
      transaction_.add_annotation(row);
    }
    for (const perception::cas::FeatureStructure& structure : others) structures.add(structure, observation);
  }

  void add_belief_rows() {
    std::map<std::string, Id> places;
    for (const auto& all : {std::cref(new_places_), std::cref(recorder_.places_)})
      for (const auto& [name, row] : all.get()) places[name] = row.id;
    rows_ = belief_rows({recorder_.store_, record_, evidence_.places, result_.scene, result_.observations,
                         result_.update, state_, recorder_.options_, places, recorder_.stored_beliefs_});
    for (const auto& [object, row] : rows_.objects) {
      const Id id = transaction_.add_object(row);
      recorder_.max_object_ = std::max(recorder_.max_object_, id);
      if (id != object) refuse_other_writer("object", id, object);
    }
    for (const AssociationRow& row : rows_.associations) transaction_.add_association(row);
    for (const EventRow& row : rows_.events) transaction_.add_event(row);
    add_joint_events();
    add_place_events();
    for (const BeliefRow& row : rows_.beliefs) transaction_.add_belief(row);
    for (const VisibilityRow& row : rows_.visibility) transaction_.add_visibility(row);
    for (const PlaceRow& place_row : record_.places) add_place_visibility(place_row);
  }

  /// Where a joint was seen last: few scenes show all fronts.
  double position_before(const std::string& joint) const {
    if (const auto known = recorder_.last_joints_.find(joint); known != recorder_.last_joints_.end())
      return known->second;
    const std::optional<SceneRow> before = recorder_.store_.latest_scene_of_joint(joint, {}, result_.scene);
    return before ? before->joints.at(joint) : 0.0;
  }

  void add_joint_events() {
    if (!recorder_.state_.last_scene) return;  // nothing to compare with
    for (const auto& [joint, position] : record_.row.joints) {
      const double from = position_before(joint);
      if (!joint_moved(from, position)) continue;
      EventRow row;
      row.scene = result_.scene;
      row.kind = EventKind::joint_changed;
      row.joint = joint;
      row.joint_position = position;
      row.from_joint_position = from;
      for (const PlaceRow& candidate : record_.places)
        if (candidate.joint == joint) row.place = place(candidate.name);
      row.since = recorder_.state_.last_scene;
      row.clock = clock();
      transaction_.add_event(row);
    }
  }

  /// Furniture that stands elsewhere than in the scene before: so the maps of both say, or what is seen.
  void add_place_events() {
    const std::optional<Id> before = recorder_.last_map_, now = recorder_.map_of(record_.row);
    if (!before || !now || !recorder_.state_.last_scene) return;
    for (const auto& [name, place_row] : recorder_.places_) {
      if (place_row.joint || !place_row.map) continue;
      const std::optional<Vector3d> origin = recorder_.motions_.position(place_row, *place_row.map);
      const Isometry3d& from = belief::place_pose(name, recorder_.last_places_);
      const Isometry3d& to = belief::place_pose(name, evidence_.places);
      if (!origin || !mapping::is_furniture_motion(to * from.inverse(), from * *origin)) continue;
      EventRow row;
      row.scene = result_.scene;
      row.kind = EventKind::place_moved;
      row.place = row.from_place = place_row.id;
      row.position = to * *origin;
      row.from_position = from * *origin;
      row.since = recorder_.state_.last_scene;
      row.clock = clock();
      transaction_.add_event(row);
    }
  }

  void add_place_visibility(const PlaceRow& place_row) {
    if (record_.view.observed) {
      for (const belief::ObservedPlace& observed : *record_.view.observed)
        if (observed.name == place_row.name) add_place_fraction(place_row, observed.fraction);
      return;
    }
    if (record_.view.depth.empty() || place_row.outline.empty() || !place_row.height) return;
    const Isometry3d now_from_outline = now_from(place_row);
    std::vector<Vector3d> outline;
    for (const Vector2d& corner : place_row.outline)
      outline.push_back(now_from_outline * Vector3d(corner.x(), corner.y(), *place_row.height));
    add_place_fraction(place_row,
                       belief::observed_fraction(record_.view, outline, 0.05, recorder_.options_.visibility));
  }

  /// Motion of a place from where its row has it to where it is in this scene.
  Isometry3d now_from(const PlaceRow& place_row) const {
    for (const belief::PlacePose& moved : record_.moved_places)
      if (moved.name == place_row.name && !place_row.joint) return moved.map_from_place;
    for (const belief::PlacePose& pose : evidence_.places) {
      if (pose.name != place_row.name) continue;
      if (!place_row.joint && place_row.map)
        return recorder_.motions_.motion(place_row, recorder_.map_of(record_.row));
      if (place_row.map_from_place) return pose.map_from_place * place_row.map_from_place->inverse();
    }
    return Isometry3d::Identity();
  }

  void add_place_fraction(const PlaceRow& place_row, double fraction) {
    if (fraction < kPlaceSeen) return;  // no row: not observed
    transaction_.add_visibility({0, result_.scene, std::nullopt, *place(place_row.name), ObjectStatus::seen,
                                 std::nullopt, std::min(1.0, fraction)});
  }

  Recorder& recorder_;
  const SceneRecord& record_;
  SceneTransaction transaction_;
  belief::BeliefState state_;
  belief::Scene evidence_;
  RecordedScene result_;
  std::map<std::string, PlaceRow> new_places_;
  BeliefRows rows_;
};

RecordedScene Recorder::record(const SceneRecord& scene, ResolvedScene resolved) {
  return SceneWriter(*this, scene, std::move(resolved)).run();
}

}  // namespace loci::memory
