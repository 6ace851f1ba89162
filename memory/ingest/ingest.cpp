#include "memory/ingest/ingest.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <regex>
#include <set>

#include "mapping/base/files.h"
#include "mapping/base/text/hash.h"
#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "mapping/recording/posed_recording.h"
#include "mapping/world/semantic_map.h"
#include "mapping/world/urdf.h"
#include "memory/catalogue/catalogue.h"
#include "memory/ingest/detection_lifter.h"
#include "memory/ingest/detection_scene.h"
#include "memory/reasoning/revise.h"
#include "memory/recorder/map_entry.h"
#include "memory/recorder/recorder.h"
#include "memory/store/memory_file.h"
#include "perception/detection/detection_set.h"
#include "perception/detection/detection_values.h"
#include "perception/detection/people_detector.h"

namespace loci::memory {
namespace {

namespace fs = std::filesystem;

constexpr size_t kNamedLines = 100;       ///< bad lines with a warning; all are counted
constexpr size_t kScenesForNoise = 1000;  ///< from the beginning of the file

/// A valid line.
struct NumberedScene {
  int64_t line = 0;
  DetectedScene scene;
  std::string hash;  ///< of its text
};

/// Scenes in order of time.
class SceneSource {
 public:
  virtual ~SceneSource() = default;
  virtual std::optional<NumberedScene> next() = 0;
  virtual double fraction() const = 0;
  /// Those for which the recording has no frame, once all were read.
  virtual size_t unmatched() const { return 0; }

  /// Those to skip because they are in the memory.
  void skip(std::set<int64_t> lines) { skip_ = std::move(lines); }

  size_t bad() const { return bad_; }
  size_t repeated() const { return repeated_; }
  size_t skipped() const { return skipped_; }
  const std::optional<Error>& first_error() const { return first_error_; }
  /// The beginning of the line that it is about.
  const std::string& first_bad() const { return first_bad_; }

 protected:
  std::set<int64_t> skip_;
  std::optional<Error> first_error_;
  std::string first_bad_;
  size_t bad_ = 0, repeated_ = 0, skipped_ = 0;
};

/// Reads the valid lines of a file in order of time.
class LineSource : public SceneSource {
 public:
  /// With `lifting` detections may have a region instead of a position.
  LineSource(const fs::path& file, std::string called, bool lifting, std::optional<TimeNs> not_before,
             Warnings& warnings)
      : file_(file),
        called_(std::move(called)),
        reader_(file),
        lifting_(lifting),
        not_before_(not_before),
        warnings_(warnings) {}

  std::optional<NumberedScene> next() override {
    for (;;) {
      const LineReader::Status status = reader_.next(text_);
      if (status == LineReader::Status::end) return std::nullopt;
      const int64_t line = reader_.number();
      if (skip_.contains(line)) {
        ++skipped_;
        last_hash_ = content_hash(text_);
        continue;
      }
      if (text_.find_first_not_of(" \t") == std::string::npos && status == LineReader::Status::line) continue;
      try {
        if (std::optional<NumberedScene> scene = parse(status, line)) return scene;
      } catch (const Error& error) {
        report_bad(error, line);
      }
    }
  }

  double fraction() const override { return reader_.fraction(); }

 private:
  std::optional<NumberedScene> parse(LineReader::Status status, int64_t line) {
    if (status == LineReader::Status::too_long)
      throw Error(fmt::format("is longer than {} MB", LineReader::kDefaultLimit >> 20));
    NumberedScene read{line, parse_detections(text_, file_.parent_path()), content_hash(text_)};
    if (!lifting_ && !std::ranges::all_of(read.scene.detections, &Detection::has_position))
      throw Error("has a bbox or mask without a position", {}, "--recording FOLDER lifts it to 3-D");
    if (read.hash == last_hash_) {
      ++repeated_;
      return std::nullopt;
    }
    if (not_before_ && read.scene.time < *not_before_)
      throw Error(fmt::format("its time {} lies before {} of the scene before it",
                              format_time(read.scene.time), format_time(*not_before_)),
                  {}, "give detections in order of time");
    not_before_ = read.scene.time;
    last_hash_ = read.hash;
    for (const std::string& key : read.scene.unknown_keys)
      if (unknown_.insert(key).second)
        warnings_.add(fmt::format("'{}' is not part of the format and is ignored", key),
                      {called_, static_cast<int>(line), {}});
    return read;
  }

  void report_bad(const Error& error, int64_t line) {
    const Error named(error.message(), {called_, static_cast<int>(line), error.location().key}, error.hint());
    if (++bad_ <= kNamedLines) warnings_.add(std::string(named.what()) + ": line skipped");
    if (first_error_) return;
    first_error_ = named;
    first_bad_ = text_.substr(0, kShownOfLine);
  }

  static constexpr size_t kShownOfLine = 10'000;
  fs::path file_;
  std::string called_;
  LineReader reader_;
  bool lifting_;
  std::optional<TimeNs> not_before_;
  Warnings& warnings_;
  std::string text_, last_hash_;
  std::set<std::string> unknown_;
};

/// The frames of a recording that a detector looked at, with what it found.
class FrameSource : public SceneSource {
 public:
  FrameSource(const perception::DetectionSet& set, const mapping::Recording& recording)
      : set_(set), recording_(recording) {}

  std::optional<NumberedScene> next() override {
    while (position_ < recording_.size()) {
      const int64_t number = recording_.index_of(position_);
      if (skip_.contains(number)) {
        ++skipped_;
        ++position_;
        continue;
      }
      mapping::RgbdFrame frame = recording_.frame(position_++);
      const perception::ImageDetections* found = set_.find(frame.name, frame.index, frame.time_ns);
      if (found == nullptr) continue;
      ++matched_;
      NumberedScene read{number, {}, {}};
      read.scene.time = frame.time_ns;
      for (const perception::Detection2D& each : found->detections) {
        Detection& detection = read.scene.detections.emplace_back();
        detection.has_position = false;
        detection.region = each.region;
        detection.key_points = each.key_points;
        detection.classes = each.classes;
        detection.score = each.score;
      }
      read.scene.frame = std::move(frame);
      return read;
    }
    return std::nullopt;
  }
  double fraction() const override {
    return static_cast<double>(position_) / static_cast<double>(std::max<size_t>(1, recording_.size()));
  }
  size_t unmatched() const override {
    const size_t known = matched_ + skipped_;
    return set_.images().size() > known ? set_.images().size() - known : 0;
  }

 private:
  const perception::DetectionSet& set_;
  const mapping::Recording& recording_;
  size_t position_ = 0, matched_ = 0;
};

/// What to do with a file of another format, by a line of it; empty when none is recognised.
std::string advice(const std::string& line) {
  const std::string text = trimmed(line);
  static const std::regex exported(R"re(^\{("time":"[^"]*",)?"(about|kind|object|place|scene)":)re");
  const std::vector<std::string> words = words_of(text);
  const auto is_number = [](const std::string& word) {
    return word.find_first_not_of("0123456789.+-eE") == std::string::npos;
  };
  if (text.find("\"image_id\"") != std::string::npos) return "it looks like COCO: call it *.json";
  if (text.starts_with('[')) return perception::kScenePerLine;
  if (std::regex_search(text, exported)) return "it looks like a table that `loci-memory export` wrote";
  if (words.size() >= 5 && std::ranges::all_of(words, is_number))
    return "it looks like YOLO: give the folder of such files";
  return text.starts_with('{') ? "" : "one JSON object per line is expected";
}

/// COCO and YOLO; everything else is JSON Lines, which are known by their first line, whatever the file is
/// called.
bool is_detection_set(const fs::path& file) {
  if (fs::is_directory(file)) return true;
  if (file.extension() != ".json") return false;
  require_regular_file(file);
  constexpr std::streamsize kMaxLine = 1 << 20;
  std::string line(static_cast<size_t>(kMaxLine), '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.getline(line.data(), kMaxLine);
  try {
    const Json first = parse_json(line.c_str(), file.string());
    return !first.is_object() || !first.contains("time");
  } catch (const Error&) {
    return true;  // A file of several lines.
  }
}

/// What is read of the file before anything is written.
struct Preview {
  std::string fingerprint;  ///< of its first valid line: a file that has grown is the same file
  std::optional<double> sigma_m;
};

/// What a set of detections is, wherever it lies: its first image.
Preview preview(const perception::DetectionSet& set) {
  const perception::ImageDetections& first = set.images().front();
  std::string text = "detections " + first.image;
  for (const perception::Detection2D& each : first.detections)
    text += fmt::format("\n{} {} {} {} {}", each.classes.front().first, each.region.box.x, each.region.box.y,
                        each.region.box.width, each.region.box.height);
  return {content_hash(text), std::nullopt};
}

/// Why a file is none of detections: what is wrong with its first bad line, as with most others.
Error not_detections(const SceneSource& reader, size_t good) {
  const Error& first = *reader.first_error();
  const std::string hint = advice(reader.first_bad());
  const std::string others = reader.bad() == 1 ? ""
                                               : fmt::format("; {} of {} lines are bad, nothing is added",
                                                             reader.bad(), reader.bad() + good);
  return Error(first.message() + others, first.location(), hint.empty() ? first.hint() : hint);
}

/// Error when most lines are bad, and with `whole` for the first bad one.
Preview preview(const fs::path& file, const std::string& called, bool lifting, bool whole,
                Progress& progress) {
  Warnings ignored;  // they come again when the lines are ingested
  LineSource reader(file, called, lifting, std::nullopt, ignored);
  PositionNoise noise;
  Preview result;
  size_t count = 0;
  while (whole || count < kScenesForNoise) {
    const std::optional<NumberedScene> current = reader.next();
    if (!current) break;
    if (count == 0) result.fingerprint = content_hash("detections " + current->hash);
    if (++count <= kScenesForNoise) noise.add(current->scene);
    if (count % 256 == 0) progress.check(reader.fraction() / 10, "checking the file");
    if (whole && reader.first_error()) break;
  }
  if (whole && reader.first_error()) throw *reader.first_error();
  if (const size_t good = count + reader.repeated(); reader.bad() > good) throw not_detections(reader, good);
  if (count == 0) throw Error("has no scenes", {called, 0, {}}, "one JSON object per line is expected");
  result.sigma_m = noise.sigma_m();
  return result;
}

/// How many observations are of no object after a scene that were of none before it: those of tentative
/// objects, which become objects when they are seen again.
int64_t unconfirmed(const belief::BeliefUpdate& update) {
  int64_t count = std::ranges::count(update.observations, int64_t{0}, &belief::ObservationOutcome::object);
  for (const belief::Confirmed& confirmed : update.confirmed)
    count -= static_cast<int64_t>(confirmed.earlier.size());
  return count;
}

/// Places the detections of a scene and counts. Whether the scene says anything.
bool place(DetectionLifter* lifter, DetectedScene& scene, Tally& used) {
  const bool in_image = scene.frame || !std::ranges::all_of(scene.detections, &Detection::has_position);
  std::optional<Reason> reason;
  if (lifter != nullptr && in_image) {
    if (!scene.frame)
      if (const auto number = lifter->frame_at(scene.time)) scene.frame = lifter->recording().frame(*number);
    reason = lifter->lift(scene);
  } else if (scene.detections.empty()) {
    reason = Reason::nothing_new;
  }
  if (reason)
    used.add(*reason);
  else
    used.add_used();
  return !in_image || scene.frame || !scene.detections.empty();
}

/// What is read; only with a recording all of it.
struct Input {
  std::unique_ptr<mapping::Recording> recording;
  std::unique_ptr<DetectionLifter> lifter;
  std::optional<perception::DetectionSet> set;  ///< unset for JSON Lines
};

Input open_input(const fs::path& file, const IngestOptions& options, Warnings& warnings) {
  Input input;
  if (!options.recording.empty()) {
    input.recording = mapping::open_recording(options.recording, options.reading);
    if (!options.map.empty() && fs::exists(mapping::sidecar_path(options.map))) {
      const mapping::SemanticMap semantics = mapping::read_semantic_map(mapping::sidecar_path(options.map));
      input.recording = in_map(std::move(input.recording), semantics.map_from_input, semantics.frame);
    }
    for (const std::string& problem : input.recording->info().problems) warnings.add(problem);
    input.lifter = std::make_unique<DetectionLifter>(*input.recording, options.map, warnings);
  }
  if (!fs::exists(file)) throw Error("no such file", {file.string(), 0, {}});
  if (!is_detection_set(file)) return input;
  input.set = perception::DetectionSet::read(file, warnings);
  if (!input.recording)
    throw Error("COCO and YOLO detections have no positions", {file.string(), 0, {}},
                "--recording FOLDER lifts them to 3-D");
  return input;
}

std::unique_ptr<SceneSource> source_of(const fs::path& file, const std::string& called, const Input& input,
                                       std::optional<TimeNs> not_before, Warnings& warnings) {
  if (input.set) return std::make_unique<FrameSource>(*input.set, *input.recording);
  return std::make_unique<LineSource>(file, called, input.lifter != nullptr, not_before, warnings);
}

}  // namespace

void IngestOptions::declare(OptionTable& table) {
  table.flag("strict", strict, "Refuse the whole file for one bad line, before anything is added.");
  table.flag("resume", resume, "Resume a file that the memory has in part.");
  table.flag("keep_people", keep_people,
             "Store images with the faces of people, which are blurred otherwise.");
  table.number("noise_m", noise_m, "m", "Noise of positions per axis (sigma); 0 = estimate it from the file.",
               0, 10);
}

std::string IngestResult::summary() const {
  std::string text =
      fmt::format("{} with {} added", counted(scenes, "scene"), counted(detections, "detection"));
  if (unconfirmed > 0) text += fmt::format(", {} of them not confirmed by other scenes", unconfirmed);
  if (present > 0) text += fmt::format("; {} in the memory already", counted(present, "line"));
  if (repeated > 0) text += fmt::format("; {} left out as repeated", counted(repeated, "line"));
  if (bad > 0) text += fmt::format("; {} skipped", counted(bad, "bad line"));
  if (lifted.total() > 0) text += fmt::format("; {} of {} lifted to 3-D", lifted.used(), lifted.total());
  if (const std::string reasons = lifted.reasons(); !reasons.empty()) text += ", the others not: " + reasons;
  return text + fmt::format("; noise of positions {:.1f} mm ({})", 1000 * noise_m,
                            noise_estimated ? "estimated" : "given or assumed");
}

Json IngestResult::report() const {
  return {{"scenes", scenes},
          {"detections", detections},
          {"unconfirmed", unconfirmed},
          {"present", present},
          {"repeated", repeated},
          {"bad_lines", bad},
          {"scenes_used", used.report()},
          {"lifted", lifted.report()},
          {"noise_m", noise_m},
          {"noise_estimated", noise_estimated}};
}

namespace {

/// A memory that is made here is not kept when nothing was added. Goes out of scope after its Store.
class NewMemory {
 public:
  explicit NewMemory(fs::path file) : file_(std::move(file)), is_new_(!fs::exists(file_)) {}
  ~NewMemory() {
    if (!is_new_ || !is_own_ || !is_empty_) return;
    std::error_code ignored;
    fs::remove(file_, ignored);
    remove_side_files(file_);
  }
  NewMemory(const NewMemory&) = delete;
  NewMemory& operator=(const NewMemory&) = delete;
  void opened() { is_own_ = true; }  ///< no other program writes to it
  void added() { is_empty_ = false; }

 private:
  fs::path file_;
  bool is_new_, is_own_ = false, is_empty_ = true;
};

}  // namespace

IngestResult ingest(const fs::path& file, const fs::path& memory, const IngestOptions& options,
                    const WriteOptions& write, Progress& progress, Warnings& warnings) {
  const Input input = open_input(file, options, warnings);
  const std::string called = options.called.empty() ? file.string() : options.called;
  const Preview ahead = input.set ? preview(*input.set)
                                  : preview(file, called, input.lifter != nullptr, options.strict, progress);
  std::vector<PlaceRow> places;
  if (!options.map.empty()) {
    mapping::read_urdf(options.map);  // Error when it is not a URDF
    places = places_of_map(options.map);
    if (places.empty()) warnings.add("the map has no places", {options.map.string(), 0, {}});
  }
  WriteOptions zoned = write;
  if (zoned.time_zone.empty() && input.recording) zoned.time_zone = input.recording->info().time_zone;
  if (zoned.time_zone.empty()) zoned.time_zone = options.default_time_zone;
  NewMemory made(memory);
  Store store = Store::open_write(memory, zoned);
  made.opened();
  if (!store.kept_before_migration().empty())
    warnings.add("was migrated; as it was it is kept in " + store.kept_before_migration().string(),
                 {memory.string(), 0, {}});
  IngestResult result;
  result.noise_estimated = options.noise_m == 0 && ahead.sigma_m.has_value();
  result.noise_m = options.noise_m > 0 ? options.noise_m : ahead.sigma_m.value_or(PositionNoise::kDefault_m);
  const std::optional<RecordingRow> known = store.recording(ahead.fingerprint);
  std::set<int64_t> present;
  if (known) present = store.frames(known->id);
  if (!present.empty() && !options.resume)
    throw Error(fmt::format("this file is in the memory already ({})", counted(present.size(), "scene")),
                {called, 0, {}}, "--resume adds the lines that are missing");

  const std::unique_ptr<SceneSource> source =
      source_of(file, called, input, store.last_scene_time(), warnings);
  SceneSource& reader = *source;
  reader.skip(std::move(present));
  std::optional<NumberedScene> current = reader.next();
  // Within the file the order was checked: if its first scene comes after the memory's last, all do.
  if (options.strict && reader.first_error()) throw *reader.first_error();
  if (const auto last = store.last_scene_time(); current && last && current->scene.time < *last)
    throw Error(fmt::format("begins at {}, before the last scene of the memory at {}",
                            format_time(current->scene.time), format_time(*last)),
                {options.recording.string(), 0, {}}, "give recordings in order of time");

  std::optional<Id> map;
  if (!options.map.empty()) map = add_map(store, options.map);
  for (PlaceRow& place : places) place.map = map;
  const Id recording = store.add_recording(
      {.fingerprint = ahead.fingerprint, .name = file.filename().string(), .kind = "detections"});
  const Id run = store.begin_run(options.program, result.report().dump());
  Recorder recorder(store, run, options.belief);
  recorder.begin_review();
  std::optional<perception::PeopleDetector> people;
  if (!options.recording.empty() && !options.keep_people) people.emplace();
  while (current) {
    progress.check(reader.fraction(), "ingesting detections");
    std::optional<NumberedScene> after = reader.next();
    if (!place(input.lifter.get(), current->scene, result.used)) {
      current = std::move(after);
      continue;
    }
    if (people && current->scene.frame) perception::anonymise(*current->scene.frame, *people);
    SceneRecord record = detections_to_scene(current->scene, result.noise_m, places);
    record.row.recording = recording;
    record.row.frame_index = current->line;
    record.row.map = map;
    if (after) record.seconds_to_next = in_seconds(after->scene.time - current->scene.time);
    result.unconfirmed += unconfirmed(recorder.record(record).update);
    made.added();
    ++result.scenes;
    result.detections += current->scene.detections.size();
    current = std::move(after);
  }
  result.unconfirmed = std::max<int64_t>(result.unconfirmed, 0);  // earlier runs left some to confirm
  if (input.lifter) result.lifted = input.lifter->detections();
  result.used.add(Reason::no_matching_frame, reader.unmatched());
  result.present = reader.skipped();
  result.repeated = reader.repeated();
  result.bad = reader.bad();
  if (result.bad > kNamedLines)
    warnings.add(fmt::format("{} more bad lines", result.bad - kNamedLines), {called, 0, {}});
  look_back(store, run, progress);
  store.finish_run(run);
  apply_catalogues(store);
  return result;
}

}  // namespace loci::memory
