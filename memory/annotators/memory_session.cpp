#include "memory/annotators/memory_session.h"

#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "memory/catalogue/catalogue.h"
#include "memory/reasoning/revise.h"
#include "memory/recorder/map_entry.h"
#include "memory/store/feature_structures.h"
#include "perception/types/scene_cas.h"

namespace loci::memory {
namespace {

KnownPlanes load_planes(const Store& store) {
  const std::optional<SceneRow> last = store.last_scene();
  if (!last) return {};
  for (const AnnotationRow& row : store.annotations(last->id))
    if (row.type == kKnownPlanesType) try {
        return KnownPlanes::from_json(parse_json(row.value, store.name()));
      } catch (const Json::exception&) {
        throw store.error("the known planes in table annotation are damaged", "perceive into a new memory");
      }
  return {};
}

/// Of furniture that the last scene had elsewhere than the map with which the next one is perceived.
perception::FurnitureStates load_furniture(const Store& store, std::optional<Id> map) {
  perception::FurnitureStates furniture;
  const std::optional<SceneRow> last = store.last_scene();
  if (!last || !map || last->map != map) return furniture;
  const std::string type(perception::types::FurnitureAnnotation::kTypeName);
  for (const FeatureStructureRow& row : store.feature_structures(last->id, type)) {
    perception::cas::Cas cas(perception::types::type_system());
    const auto piece = perception::types::as<perception::types::FurnitureAnnotation>(
        read_feature_structure(store, row.id, cas));
    furniture.pieces.push_back({piece.name.get(), piece.moved.get(), piece.found.get(),
                                Vector2d(piece.shift_x.get(), piece.shift_y.get()), piece.turn.get(),
                                piece.log_odds.get()});
  }
  return furniture;
}

/// What was recorded knows where its clocks were.
WriteOptions in_zone_of(const mapping::Recording& recording, const MemorySessionOptions& options) {
  WriteOptions write = options.write;
  if (write.time_zone.empty()) write.time_zone = recording.info().time_zone;
  if (write.time_zone.empty() && !recording.info().time_assumed) write.time_zone = options.default_time_zone;
  return write;
}

}  // namespace

std::string fingerprint_of(const mapping::Recording& recording) {
  std::vector<FrameDigest> frames;
  for (size_t i = 0; i < recording.size(); ++i)
    frames.push_back({recording.index_of(i), recording.time_of(i)});
  std::vector<cv::Mat> images;
  if (recording.size() > 0) {
    images.push_back(recording.frame(0).depth);
    images.push_back(recording.frame(recording.size() - 1).depth);
  }
  return recording_fingerprint(frames, images);
}

MemorySession::MemorySession(const MemorySessionOptions& options, const mapping::Recording& recording)
    : store_(Store::open_write(options.memory, in_zone_of(recording, options))), people_(options.people) {
  const mapping::RecordingInfo& info = recording.info();
  const std::string fingerprint = fingerprint_of(recording);
  if (const std::optional<RecordingRow> known = store_.recording(fingerprint)) {
    recording_ = known->id;
    present_ = store_.frames(recording_);
  }
  for (const SceneRow& scene : store_.scenes())
    if (recording_ != 0 && scene.recording == recording_) {
      const Moment moment(scene.time, scene.frame_index.value_or(0));
      last_present_ = std::max(moment, last_present_.value_or(moment));
    }
  if (!present_.empty() && !options.resume) refuse_again(options.memory, recording);
  if (present_.empty()) require_later(options.memory, recording);
  RecordingRow row;
  row.fingerprint = fingerprint;
  row.name = std::filesystem::path(info.path).lexically_normal().filename().string();
  if (row.name.empty())
    row.name = std::filesystem::path(info.path).lexically_normal().parent_path().filename().string();
  row.kind = info.format;
  row.time_assumed = info.time_assumed;
  row.frames = static_cast<int64_t>(recording.size());
  if (!options.map.empty()) map_ = add_map(store_, options.map);
  recording_ = store_.add_recording(row);
  run_ = store_.begin_run(options.program, options.configuration.dump());
  planes_ = load_planes(store_);
  furniture_ = load_furniture(store_, map_);
  recorder_ = std::make_unique<Recorder>(store_, run_, options.belief);
  recorder_->begin_review();
}

void MemorySession::refuse_again(const std::filesystem::path& memory,
                                 const mapping::Recording& recording) const {
  size_t after = 0;
  for (size_t i = 0; i < recording.size(); ++i)
    after += Moment(recording.time_of(i), recording.index_of(i)) > last_present_ ? 1 : 0;
  const std::string other = how_to_perceive_again();
  throw Error(fmt::format("this recording is in the memory already ({} of {} frames)", present_.size(),
                          recording.size()),
              {memory.string(), 0, recording.info().path},
              after > 0 ? fmt::format("--resume adds the {} after the last that is there; {}",
                                      counted(after, "frame"), other)
                        : other);
}

std::string MemorySession::how_to_perceive_again() const {
  const bool is_alone = std::ranges::all_of(
      store_.scenes(), [&](const SceneRow& scene) { return scene.recording == recording_; });
  return fmt::format("to perceive it anew, {}give another memory with -m",
                     is_alone ? fmt::format("remove {} or ", store_.name()) : "");
}

void MemorySession::require_later(const std::filesystem::path& memory,
                                  const mapping::Recording& recording) const {
  const std::optional<TimeNs> last = store_.last_scene_time();
  const mapping::RecordingInfo& info = recording.info();
  if (!last || info.first_time >= *last) return;
  throw Error(
      fmt::format("the recording begins at {}{}, before the last scene of the memory at {}",
                  format_time(info.first_time), info.time_assumed ? " (made up)" : "", format_time(*last)),
      {memory.string(), 0, info.path},
      info.time_assumed
          ? "say when it was recorded with --start TIME"
          : "perceive recordings in the order of time; those of the same time, as of a second camera, "
            "go into a memory each, which loci-memory merge joins");
}

void add_memory_session(MemorySessionOptions options, perception::Pipeline& pipeline,
                        const perception::AnnotatorRegistry& registry, perception::Resources& resources) {
  if (options.people == People::blurred) pipeline.add("PersonAnnotator", registry);
  pipeline.add("IdentityResolution", registry);
  pipeline.add_writer("MemoryWriter", registry);
  pipeline.check(registry);
  options.configuration = pipeline.to_json();
  const mapping::Recording& recording =
      resources.get<mapping::Recording>("recording to read", "give its folder");
  resources.put_for_run(std::make_shared<MemorySession>(options, recording));
}

MemoryRunResult run_with_memory(perception::Pipeline& pipeline, perception::Context& context,
                                const std::shared_ptr<const perception::cas::TypeSystem>& types,
                                Progress& progress, const std::function<void(perception::cas::Cas&)>& done) {
  MemorySession& session =
      context.resources.get<MemorySession>("memory to write to", "name one with -m FILE.loci");
  MemoryRunResult result;
  if (!session.furniture_.pieces.empty())
    context.resources.put(std::make_shared<perception::FurnitureStates>(session.furniture_));
  pipeline.start(context);
  perception::Reader& reader = pipeline.reader();
  while (session.last_present_ && reader.position() < reader.count()) {
    const perception::FrameId next = reader.upcoming();
    if (std::pair{next.time_ns, next.index} > *session.last_present_) break;
    ++(session.present_.contains(next.index) ? result.skipped : result.passed_over);
    reader.skip(1);
  }
  result.pipeline = pipeline.run(context, types, progress, done);
  look_back(session.store_, session.run_, progress);
  session.store_.finish_run(session.run_);
  apply_catalogues(session.store_);
  return result;
}

}  // namespace loci::memory
