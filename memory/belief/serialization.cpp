#include "memory/belief/serialization.h"

#include <cmath>

#include "mapping/base/error.h"
#include "memory/belief/belief_state.pb.h"

namespace loci::memory::belief {
namespace {

constexpr uint32_t kVersion = 2;
/// The evidence of scenes is read from this version on: from it the belief is computed again where the state
/// of another version cannot be continued.
constexpr uint32_t kOldestReasoning = 1;
constexpr size_t kMaxBytes = size_t{1} << 26;  // a message takes some tens of times its bytes

[[noreturn]] void refuse(const std::string& what) {
  throw Error("the stored belief cannot be read: " + what);
}

void check(bool good, const char* what) {
  if (!good) refuse(std::string("its ") + what + " is invalid");
}

/// A coordinate, size or variance: such numbers become indices of grids.
double finite(double value, const char* what) {
  check(std::isfinite(value), what);
  return value;
}

template <class Message>
std::string bytes_of(Message& message) {
  message.set_version(kVersion);
  return message.SerializeAsString();
}

template <class Message>
Message parsed(std::string_view bytes, uint32_t oldest = kVersion) {
  Message message;
  if (bytes.size() > kMaxBytes || !message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())))
    refuse("the bytes are damaged");
  if (message.version() == 0) refuse("the bytes are damaged or end too early");
  if (message.version() < oldest || message.version() > kVersion) refuse("another version of loci wrote it");
  return message;
}

template <class Enum>
Enum enumerator(uint32_t value, Enum last, const char* what) {
  check(value <= static_cast<uint32_t>(last), what);
  return static_cast<Enum>(value);
}

/// Conversions between values and messages: write(value, message) and value = read(message).
struct Codec {
  // ---- Values

  static void write(const Vector3d& v, stored::Vector& message) {
    message.set_x(v.x());
    message.set_y(v.y());
    message.set_z(v.z());
  }

  static Vector3d read(const stored::Vector& message) {
    return {finite(message.x(), "position"), finite(message.y(), "position"),
            finite(message.z(), "position")};
  }

  static void write(const AxisBox& box, stored::Box& message) {
    write(box.centre, *message.mutable_centre());
    write(box.size, *message.mutable_size());
  }

  static AxisBox read(const stored::Box& message) { return {read(message.centre()), read(message.size())}; }

  static void write(const Isometry3d& pose, stored::Pose& message) {
    for (int i = 0; i < 12; ++i) message.add_matrix(pose.matrix()(i / 4, i % 4));
  }

  static Isometry3d read(const stored::Pose& message) {
    check(message.matrix_size() == 12, "pose");
    Isometry3d pose = Isometry3d::Identity();
    for (int i = 0; i < 12; ++i) pose.matrix()(i / 4, i % 4) = finite(message.matrix(i), "pose");
    return pose;
  }

  static void write(const RateFactor& factor, stored::RateFactor& message) {
    message.set_found(factor.found);
    message.set_expected(factor.expected);
  }

  static RateFactor read(const stored::RateFactor& message) { return {message.found(), message.expected()}; }

  static void write(const Descriptor& descriptor, stored::Descriptor& message) {
    message.set_kind(descriptor.kind);
    message.mutable_values()->Add(descriptor.values.begin(), descriptor.values.end());
    for (const std::string& name : descriptor.names) message.add_names(name);
  }

  static Descriptor read(const stored::Descriptor& message) {
    check(message.names().empty() || message.names_size() == message.values_size(), "descriptor");
    return {message.kind(),
            {message.values().begin(), message.values().end()},
            {message.names().begin(), message.names().end()}};
  }

  static void write(const Texture& texture, stored::Texture& message) {
    for (const SurfaceKeypoint& keypoint : texture) {
      for (const float value : keypoint.position) message.add_positions(value);
      message.add_diameters(keypoint.diameter_m);
      message.mutable_descriptors()->append(keypoint.descriptor.begin(), keypoint.descriptor.end());
    }
  }

  static Texture read(const stored::Texture& message) {
    constexpr size_t kBytes = sizeof(SurfaceKeypoint::descriptor);
    Texture texture(static_cast<size_t>(message.diameters_size()));
    check(static_cast<size_t>(message.positions_size()) == 3 * texture.size() &&
              message.descriptors().size() == kBytes * texture.size(),
          "texture");
    for (int i = 0; i < message.diameters_size(); ++i) {
      SurfaceKeypoint& keypoint = texture[static_cast<size_t>(i)];
      for (int axis = 0; axis < 3; ++axis)
        keypoint.position[axis] = static_cast<float>(finite(message.positions(3 * i + axis), "position"));
      keypoint.diameter_m = static_cast<float>(finite(message.diameters(i), "key point"));
      std::ranges::copy_n(message.descriptors().begin() + std::ptrdiff_t(kBytes) * i, kBytes,
                          keypoint.descriptor.begin());
    }
    return texture;
  }

  /// Lists element by element.
  template <class Value, class Message>
  static void write_all(const std::vector<Value>& values,
                        google::protobuf::RepeatedPtrField<Message>& messages) {
    messages.Reserve(static_cast<int>(values.size()));
    for (const Value& value : values) write(value, *messages.Add());
  }

  template <class Value, class Message>
  static void read_all(const google::protobuf::RepeatedPtrField<Message>& messages,
                       std::vector<Value>& values) {
    values.reserve(static_cast<size_t>(messages.size()));
    for (const Message& message : messages) values.push_back(read(message));
  }

  // ---- Belief state

  static void write(const StoredView& view, stored::StoredView& message) {
    write_all(view.descriptors, *message.mutable_descriptors());
    message.set_weight(view.weight);
    message.set_time(view.time);
    message.set_partial(view.partial);
  }

  static StoredView read(const stored::StoredView& message) {
    StoredView view{{}, message.weight(), message.time(), message.partial()};
    read_all(message.descriptors(), view.descriptors);
    return view;
  }

  static void write(const TextureView& view, stored::TextureView& message) {
    message.set_place(view.place);
    message.set_time(view.time);
    write(view.towards_camera, *message.mutable_towards_camera());
    message.set_range(view.range);
    message.set_in_place(view.in_place);
  }

  static TextureView read(const stored::TextureView& message) {
    return {{},
            message.place(),
            message.time(),
            read(message.towards_camera()),
            finite(message.range(), "range"),
            message.in_place()};
  }

  static void write(const PendingObservation& pending, stored::PendingObservation& message) {
    message.set_observation(pending.observation);
    message.set_time(pending.time);
    message.set_first(pending.first);
    message.set_probability(pending.probability);
  }

  static PendingObservation read(const stored::PendingObservation& message) {
    return {message.observation(), message.time(), message.first(), message.probability()};
  }

  static void write(const Alternative& alternative, stored::Alternative& message) {
    message.set_key(alternative.key);
    message.set_probability(alternative.probability);
  }

  static Alternative read(const stored::Alternative& message) {
    return {message.key(), message.probability()};
  }

  static void write(const std::map<std::string, RateFactor>& factors,
                    google::protobuf::RepeatedPtrField<stored::NamedFactor>& messages) {
    for (const auto& [name, factor] : factors) {
      stored::NamedFactor& message = *messages.Add();
      message.set_name(name);
      write(factor, *message.mutable_factor());
    }
  }

  static void read(const google::protobuf::RepeatedPtrField<stored::NamedFactor>& messages,
                   std::map<std::string, RateFactor>& factors) {
    for (const stored::NamedFactor& message : messages) factors[message.name()] = read(message.factor());
  }

  using ByAge = std::array<RateFactor, InteractionModel::kAges>;

  static void write(const ByAge& factors, google::protobuf::RepeatedPtrField<stored::RateFactor>& messages) {
    for (const RateFactor& factor : factors) write(factor, *messages.Add());
  }

  static void read(const google::protobuf::RepeatedPtrField<stored::RateFactor>& messages, ByAge& factors) {
    check(messages.size() == int{InteractionModel::kAges}, "interaction model");
    for (int i = 0; i < messages.size(); ++i) factors.at(static_cast<size_t>(i)) = read(messages[i]);
  }

  static void write(const InteractionModel::Statistics& statistics, stored::InteractionModel& message) {
    write(statistics.by_age, *message.mutable_by_age());
    write(statistics.by_class, *message.mutable_by_class());
    write(statistics.by_place, *message.mutable_by_place());
    write(statistics.by_use, *message.mutable_by_use());
    message.set_short_moves(statistics.short_moves);
    message.set_moves_within(statistics.moves_within);
    write(statistics.within, *message.mutable_within());
    write(statistics.elsewhere, *message.mutable_elsewhere());
    write(statistics.off, *message.mutable_off());
    write(statistics.changes, *message.mutable_changes());
    message.set_views(statistics.views);
    message.set_unseen_seconds(statistics.unseen_seconds);
    for (const auto& [place, count] : statistics.put_down) {
      stored::NamedCount& named = *message.add_put_down();
      named.set_name(place);
      named.set_count(count);
    }
    write(statistics.returns, *message.mutable_returns());
    write(statistics.first_view, *message.mutable_first_view());
    write(statistics.later_view, *message.mutable_later_view());
    write(statistics.clutter, *message.mutable_clutter());
  }

  static InteractionModel read(const stored::InteractionModel& message) {
    InteractionModel::Statistics statistics;
    read(message.by_age(), statistics.by_age);
    read(message.by_class(), statistics.by_class);
    read(message.by_place(), statistics.by_place);
    statistics.by_use = read(message.by_use());
    statistics.short_moves = message.short_moves();
    statistics.moves_within = message.moves_within();
    statistics.within = read(message.within());
    statistics.elsewhere = read(message.elsewhere());
    statistics.off = read(message.off());
    statistics.changes = read(message.changes());
    statistics.views = message.views();
    statistics.unseen_seconds = message.unseen_seconds();
    for (const stored::NamedCount& named : message.put_down())
      statistics.put_down[named.name()] = named.count();
    read(message.returns(), statistics.returns);
    statistics.first_view = read(message.first_view());
    statistics.later_view = read(message.later_view());
    statistics.clutter = read(message.clutter());
    return InteractionModel(std::move(statistics));
  }

  static void write(const PlaceHistories& places,
                    google::protobuf::RepeatedPtrField<stored::PlaceHistory>& messages) {
    for (const auto& [name, place] : places) {
      stored::PlaceHistory& message = *messages.Add();
      message.set_name(name);
      for (const PlaceHistory::View& view : place.views) {
        stored::PlaceHistory::View& stored_view = *message.add_views();
        stored_view.set_exposure_s(view.exposure_s);
        stored_view.set_unseen(view.unseen);
      }
      message.set_never_seen(place.never_seen);
      message.set_begin_s(place.begin_s);
      write(place.extent, *message.mutable_extent());
      write(place.map_from_place, *message.mutable_map_from_place());
    }
  }

  static PlaceHistory read(const stored::PlaceHistory& message) {
    PlaceHistory place;
    for (const stored::PlaceHistory::View& view : message.views())
      place.views.push_back({finite(view.exposure_s(), "time"), finite(view.unseen(), "view of a place")});
    place.never_seen = finite(message.never_seen(), "view of a place");
    place.begin_s = finite(message.begin_s(), "time");
    place.extent = read(message.extent());
    place.map_from_place = read(message.map_from_place());
    return place;
  }

  static void write(const NoiseScale& noise, google::protobuf::RepeatedField<double>& counts) {
    counts.Add(noise.counts().begin(), noise.counts().end());
  }

  static NoiseScale read(const google::protobuf::RepeatedField<double>& counts) {
    check(counts.size() == int{NoiseScale::kLevels}, "noise");
    NoiseScale::Levels levels{};
    std::ranges::copy(counts, levels.begin());
    return NoiseScale(levels);
  }

  using Histogram = std::array<float, Correction::kBins>;

  static Histogram read(const google::protobuf::RepeatedField<float>& values) {
    Histogram histogram{};
    check(values.size() == int{Correction::kBins}, "calibration");
    std::ranges::copy(values, histogram.begin());
    return histogram;
  }

  // ---- Reasoning

  static void write(const Observation& observation, stored::Observation& message) {
    message.set_id(observation.id);
    write(observation.box, *message.mutable_box());
    message.set_has_size(observation.has_size);
    if (observation.sigma_m) message.set_sigma_m(*observation.sigma_m);
    message.set_range(observation.range);
    message.set_partial(observation.partial);
    message.set_points(observation.points);
    message.set_place(observation.place);
    write_all(observation.descriptors, *message.mutable_descriptors());
    if (!observation.texture.empty()) write(observation.texture, *message.mutable_texture());
  }

  static Observation read(const stored::Observation& message) {
    Observation observation;
    observation.id = message.id();
    observation.box = read(message.box());
    observation.has_size = message.has_size();
    if (message.has_sigma_m()) observation.sigma_m = message.sigma_m();
    observation.range = message.range();
    observation.partial = message.partial();
    observation.points = message.points();
    observation.place = message.place();
    read_all(message.descriptors(), observation.descriptors);
    observation.texture = read(message.texture());
    return observation;
  }

  static void write(const ObservedPlace& place, stored::ObservedPlace& message) {
    message.set_name(place.name);
    message.set_fraction(place.fraction);
  }

  static ObservedPlace read(const stored::ObservedPlace& message) {
    return {message.name(), message.fraction()};
  }

  static void write(const PlacePose& pose, stored::PlacePose& message) {
    message.set_name(pose.name);
    write(pose.map_from_place, *message.mutable_map_from_place());
    message.set_unknown(!pose.known);
  }

  static PlacePose read(const stored::PlacePose& message) {
    return {message.name(), read(message.map_from_place()), !message.unknown()};
  }

  static void write(const Scene& scene, stored::Evidence& message) {
    message.set_time(scene.time);
    if (scene.seconds_to_next) message.set_seconds_to_next(*scene.seconds_to_next);
    message.set_has_camera(scene.view.has_camera);
    if (scene.view.observed) write_all(*scene.view.observed, *message.mutable_observed()->mutable_places());
    message.set_near_m(scene.view.near_m);
    message.set_far_m(scene.view.far_m);
    write_all(scene.observations, *message.mutable_observations());
    write_all(scene.places, *message.mutable_places());
  }

  static Scene read(const stored::Evidence& message) {
    Scene scene;
    scene.time = message.time();
    if (message.has_seconds_to_next()) scene.seconds_to_next = message.seconds_to_next();
    scene.view.has_camera = message.has_camera();
    if (message.has_observed()) read_all(message.observed().places(), scene.view.observed.emplace());
    scene.view.near_m = message.near_m();
    scene.view.far_m = message.far_m();
    read_all(message.observations(), scene.observations);
    read_all(message.places(), scene.places);
    return scene;
  }

  static void write(const Candidate& candidate, stored::Candidate& message) {
    message.set_key(candidate.key);
    message.set_object(candidate.object);
    message.set_stay(candidate.stay);
    message.set_move(candidate.move);
    message.set_newview(candidate.newview);
    message.set_similar(candidate.similar);
    message.set_proximity(candidate.proximity);
    message.set_stay_prior(candidate.stay_prior);
    message.set_move_prior(candidate.move_prior);
    message.set_newview_prior(candidate.newview_prior);
    message.mutable_distances()->Add(candidate.distances.begin(), candidate.distances.end());
    message.mutable_log_ratios()->Add(candidate.log_ratios.begin(), candidate.log_ratios.end());
  }

  static Candidate read(const stored::Candidate& message) {
    return {message.key(),
            message.object(),
            message.stay(),
            message.move(),
            message.newview(),
            message.similar(),
            message.proximity(),
            message.stay_prior(),
            message.move_prior(),
            message.newview_prior(),
            {message.distances().begin(), message.distances().end()},
            {message.log_ratios().begin(), message.log_ratios().end()}};
  }

  static void write(const ObservationDecision& decision, stored::ObservationDecision& message) {
    message.set_explanation(static_cast<uint32_t>(decision.explanation));
    message.set_key(decision.key);
    message.set_object(decision.object);
    message.set_probability(decision.probability);
    message.set_appear(decision.appear);
    message.set_clutter(decision.clutter);
    message.set_appear_prior(decision.appear_prior);
    message.set_clutter_prior(decision.clutter_prior);
    write_all(decision.candidates, *message.mutable_candidates());
  }

  static ObservationDecision read(const stored::ObservationDecision& message) {
    ObservationDecision decision{enumerator(message.explanation(), Explanation::hidden, "explanation"),
                                 message.key(),
                                 message.object(),
                                 message.probability(),
                                 message.appear(),
                                 message.clutter(),
                                 message.appear_prior(),
                                 message.clutter_prior(),
                                 {}};
    read_all(message.candidates(), decision.candidates);
    return decision;
  }

  static void write(const ObjectDecision& decision, stored::ObjectDecision& message) {
    message.set_explanation(static_cast<uint32_t>(decision.explanation));
    message.set_key(decision.key);
    message.set_object(decision.object);
    message.set_out_of_view(decision.out_of_view);
    message.set_hidden(decision.hidden);
    message.set_unmeasured(decision.unmeasured);
    message.set_occupied(decision.occupied);
    message.set_seen_through(decision.seen_through);
    message.set_searched(decision.searched);
    message.set_disappear(decision.disappear);
    message.set_missed(decision.missed);
    message.set_out_of_sight(decision.out_of_sight);
    message.set_here(decision.here);
  }

  static ObjectDecision read(const stored::ObjectDecision& message) {
    return {enumerator(message.explanation(), Explanation::hidden, "explanation"),
            message.key(),
            message.object(),
            message.out_of_view(),
            message.hidden(),
            message.unmeasured(),
            message.occupied(),
            message.seen_through(),
            message.searched(),
            message.disappear(),
            message.missed(),
            message.out_of_sight(),
            message.here()};
  }

  static void write(const Decisions& decisions, stored::Decisions& message) {
    for (const std::string& kind : decisions.kinds) message.add_kinds(kind);
    write_all(decisions.observations, *message.mutable_observations());
    write_all(decisions.unobserved, *message.mutable_unobserved());
    message.set_gate_bound(decisions.gate_bound);
  }

  static Decisions read(const stored::Decisions& message) {
    Decisions decisions{{message.kinds().begin(), message.kinds().end()}, {}, {}, message.gate_bound()};
    read_all(message.observations(), decisions.observations);
    read_all(message.unobserved(), decisions.unobserved);
    for (const ObservationDecision& decision : decisions.observations)
      for (const Candidate& candidate : decision.candidates)
        check(candidate.distances.size() == decisions.kinds.size() &&
                  candidate.log_ratios.size() == decisions.kinds.size(),
              "list of candidates");
    return decisions;
  }

  static std::string to_string(const std::vector<uint8_t>& bytes) { return {bytes.begin(), bytes.end()}; }

  static void write(const SceneMatrices& matrices, stored::SceneMatrices& message) {
    message.set_rows(matrices.rows);
    message.mutable_keys()->Add(matrices.keys.begin(), matrices.keys.end());
    message.mutable_objects()->Add(matrices.objects.begin(), matrices.objects.end());
    for (const std::string& kind : matrices.kinds) message.add_kinds(kind);
    for (const std::vector<uint8_t>& table : matrices.distances) message.add_distances(to_string(table));
    message.mutable_offsets()->Add(matrices.offsets.begin(), matrices.offsets.end());
    message.set_similarity(to_string(matrices.similarity));
  }

  static SceneMatrices read(const stored::SceneMatrices& message) {
    SceneMatrices matrices;
    matrices.rows = message.rows();
    matrices.keys = {message.keys().begin(), message.keys().end()};
    matrices.objects = {message.objects().begin(), message.objects().end()};
    matrices.kinds = {message.kinds().begin(), message.kinds().end()};
    for (const std::string& table : message.distances())
      matrices.distances.emplace_back(table.begin(), table.end());
    for (const uint32_t offset : message.offsets()) {
      check(offset <= SceneMatrices::kNone16, "table of offsets");
      matrices.offsets.push_back(static_cast<uint16_t>(offset));
    }
    matrices.similarity = {message.similarity().begin(), message.similarity().end()};
    const size_t entries = size_t{matrices.rows} * matrices.keys.size();
    bool complete = matrices.objects.size() == matrices.keys.size() && matrices.offsets.size() == entries &&
                    matrices.similarity.size() == entries &&
                    matrices.distances.size() == matrices.kinds.size();
    for (const std::vector<uint8_t>& table : matrices.distances)
      complete = complete && table.size() == entries;
    check(complete, "table of pairs");
    return matrices;
  }
};

}  // namespace

std::string to_bytes(const ProtoObject& object) {
  stored::ProtoObject message;
  message.set_key(object.key);
  message.set_id(object.id);
  message.set_status(static_cast<uint32_t>(object.status));
  message.set_first_seen(object.first_seen);
  message.set_last_seen(object.last_seen);
  message.set_last_update(object.last_update);
  message.set_exposure_s(object.exposure_s);
  message.set_last_seen_exposure_s(object.last_seen_exposure_s);
  message.set_observation_count(object.observation_count);
  message.set_exists_log_odds(object.exists_log_odds);
  message.set_probability_here(object.probability_here);
  message.set_hidden_scenes(object.hidden_scenes);
  message.set_hidden_reported(object.hidden_reported);
  message.set_missed_views(object.missed_views);
  message.set_gone_by_s(object.gone_by_s);
  message.set_uses(object.uses);
  message.set_place(object.place);
  Codec::write(object.box, *message.mutable_box());
  message.set_variance(object.variance);
  message.set_partial(object.partial);
  message.set_has_size(object.has_size);
  Codec::write(object.map_from_camera, *message.mutable_map_from_camera());
  Codec::write_all(object.views, *message.mutable_views());
  message.set_class_name(object.class_name);
  Codec::write(object.interaction, *message.mutable_interaction());
  Codec::write_all(object.alternatives, *message.mutable_alternatives());
  message.set_last_observation(object.last_observation);
  Codec::write_all(object.pending, *message.mutable_pending());
  message.set_alternative_of(object.alternative_of);
  message.set_clutter_probability(object.clutter_probability);
  Codec::write_all(object.textures, *message.mutable_textures());
  for (const Eigen::Vector3f& point : object.surface)
    message.mutable_surface()->Add(point.begin(), point.end());
  Codec::write(object.surface_camera, *message.mutable_surface_camera());
  return bytes_of(message);
}

ProtoObject object_from_bytes(std::string_view bytes) {
  const auto message = parsed<stored::ProtoObject>(bytes);
  ProtoObject object;
  object.key = message.key();
  object.id = message.id();
  object.status = enumerator(message.status(), Status::gone, "status");
  object.first_seen = message.first_seen();
  object.last_seen = message.last_seen();
  object.last_update = message.last_update();
  object.exposure_s = message.exposure_s();
  object.last_seen_exposure_s = message.last_seen_exposure_s();
  object.observation_count = message.observation_count();
  object.exists_log_odds = message.exists_log_odds();
  object.probability_here = message.probability_here();
  object.hidden_scenes = message.hidden_scenes();
  object.hidden_reported = message.hidden_reported();
  object.missed_views = message.missed_views();
  object.gone_by_s = message.gone_by_s();
  object.uses = finite(message.uses(), "use of a place");
  object.place = message.place();
  object.box = Codec::read(message.box());
  object.variance = finite(message.variance(), "variance");
  object.partial = message.partial();
  object.has_size = message.has_size();
  object.map_from_camera = Codec::read(message.map_from_camera());
  Codec::read_all(message.views(), object.views);
  object.class_name = message.class_name();
  object.interaction = Codec::read(message.interaction());
  Codec::read_all(message.alternatives(), object.alternatives);
  object.last_observation = message.last_observation();
  Codec::read_all(message.pending(), object.pending);
  object.alternative_of = message.alternative_of();
  object.clutter_probability = message.clutter_probability();
  Codec::read_all(message.textures(), object.textures);
  check(message.surface_size() % 3 == 0, "surface");
  for (int i = 0; i < message.surface_size(); i += 3)
    object.surface.push_back(Vector3d(finite(message.surface(i), "surface"),
                                      finite(message.surface(i + 1), "surface"),
                                      finite(message.surface(i + 2), "surface"))
                                 .cast<float>());
  if (message.has_surface_camera()) object.surface_camera = Codec::read(message.surface_camera());
  return object;
}

std::string to_bytes(const Texture& texture) {
  stored::Texture message;
  Codec::write(texture, message);
  return bytes_of(message);
}

Texture texture_from_bytes(std::string_view bytes) {
  return Codec::read(parsed<stored::Texture>(bytes));
}

std::string to_bytes(const BeliefState& state) {
  stored::BeliefState message;
  if (state.last_scene) message.set_last_scene(*state.last_scene);
  message.set_exposure_s(state.exposure_s);
  message.set_next_key(state.next_key);
  message.set_next_id(state.next_id);
  Codec::write(state.interaction.statistics(), *message.mutable_interaction());
  for (const auto& [kind, counts] : state.calibration.counts()) {
    stored::DistanceCounts& histograms = *message.add_calibration();
    histograms.set_kind(kind);
    histograms.mutable_same()->Add(counts.same.begin(), counts.same.end());
    histograms.mutable_different()->Add(counts.different.begin(), counts.different.end());
  }
  message.set_detected(state.detection.detected);
  message.set_missed(state.detection.missed);
  Codec::write(state.view_noise, *message.mutable_view_noise());
  Codec::write(state.calibration.color_noise(), *message.mutable_color_noise());
  Codec::write(state.places, *message.mutable_places());
  return bytes_of(message);
}

std::string emptied_state_of_another_version() {
  stored::BeliefState message;
  message.set_version(kVersion - 1);
  return message.SerializeAsString();
}

BeliefState state_from_bytes(std::string_view bytes) {
  const auto message = parsed<stored::BeliefState>(bytes);
  BeliefState state;
  if (message.has_last_scene()) state.last_scene = message.last_scene();
  state.exposure_s = message.exposure_s();
  state.next_key = message.next_key();
  state.next_id = message.next_id();
  state.interaction = Codec::read(message.interaction());
  Calibration::CountsByKind counts;
  for (const stored::DistanceCounts& histograms : message.calibration())
    counts[histograms.kind()] = {Codec::read(histograms.same()), Codec::read(histograms.different())};
  state.calibration = Calibration(std::move(counts));
  state.detection = {message.detected(), message.missed()};
  state.view_noise = Codec::read(message.view_noise());
  if (!message.color_noise().empty()) state.calibration.set_color_noise(Codec::read(message.color_noise()));
  for (const stored::PlaceHistory& place : message.places()) state.places[place.name()] = Codec::read(place);
  return state;
}

std::string to_bytes(const SceneReasoning& reasoning) {
  stored::SceneReasoning message;
  Codec::write(reasoning.evidence, *message.mutable_evidence());
  Codec::write(reasoning.decisions, *message.mutable_decisions());
  Codec::write(reasoning.matrices, *message.mutable_matrices());
  return bytes_of(message);
}

SceneReasoning reasoning_from_bytes(std::string_view bytes) {
  const auto message = parsed<stored::SceneReasoning>(bytes, kOldestReasoning);
  SceneReasoning reasoning{Codec::read(message.evidence()), Codec::read(message.decisions()),
                           Codec::read(message.matrices())};
  const size_t decided = reasoning.decisions.observations.size();
  check(decided <= reasoning.evidence.observations.size(), "list of decisions");
  check(reasoning.matrices.keys.empty() || decided <= reasoning.matrices.rows, "table of pairs");
  return reasoning;
}

}  // namespace loci::memory::belief
