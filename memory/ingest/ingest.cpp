#include "memory/ingest/ingest.h"

#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/files.h"
#include "mapping/base/hash.h"
#include "mapping/base/json.h"
#include "mapping/world/semantic_map.h"
#include "mapping/world/urdf.h"
#include "memory/catalogue/catalogue.h"
#include "memory/ingest/detection_scene.h"
#include "memory/recorder/recorder.h"

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

/// Reads the valid lines of a file in order of time.
class SceneReader {
 public:
  SceneReader(const fs::path& file, std::optional<TimeNs> not_before, Warnings& warnings)
      : file_(file), reader_(file), not_before_(not_before), warnings_(warnings) {}

  /// Lines to skip because they are in the memory.
  void skip(std::set<int64_t> lines) { skip_ = std::move(lines); }

  std::optional<NumberedScene> next() {
    for (;;) {
      const LineReader::Status status = reader_.next(text_);
      if (status == LineReader::Status::end) return std::nullopt;
      const int64_t line = reader_.number();
      if (skip_.contains(line)) {
        ++skipped_;
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

  size_t bad() const { return bad_; }
  size_t repeated() const { return repeated_; }
  size_t skipped() const { return skipped_; }
  double fraction() const { return reader_.fraction(); }
  const std::optional<Error>& first_error() const { return first_error_; }

 private:
  std::optional<NumberedScene> parse(LineReader::Status status, int64_t line) {
    if (status == LineReader::Status::too_long)
      throw Error(fmt::format("is longer than {} MB", LineReader::kDefaultLimit >> 20));
    NumberedScene read{line, parse_detections(text_), content_hash(text_)};
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
                      {file_.string(), static_cast<int>(line), {}});
    return read;
  }

  void report_bad(const Error& error, int64_t line) {
    const Error named(error.message(), {file_.string(), static_cast<int>(line), error.location().key},
                      error.hint());
    if (++bad_ <= kNamedLines) warnings_.add(std::string(named.what()) + ": line skipped");
    if (!first_error_) first_error_ = named;
  }

  fs::path file_;
  LineReader reader_;
  std::optional<TimeNs> not_before_;
  Warnings& warnings_;
  std::string text_, last_hash_;
  std::set<int64_t> skip_;
  std::set<std::string> unknown_;
  std::optional<Error> first_error_;
  size_t bad_ = 0, repeated_ = 0, skipped_ = 0;
};

/// What is read of the file before anything is written.
struct Preview {
  std::string fingerprint;  ///< of its first valid line: a file that has grown is the same file
  std::optional<double> sigma_m;
};

/// Error without a valid line, and with `whole` for the first bad one.
Preview preview(const fs::path& file, bool whole, Progress& progress) {
  Warnings ignored;  // they come again when the lines are ingested
  SceneReader reader(file, std::nullopt, ignored);
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
  if (reader.first_error() && (whole || count == 0)) throw *reader.first_error();
  if (count == 0)
    throw Error("has no scenes", {file.string(), 0, {}}, "one JSON object per line is expected");
  result.sigma_m = noise.sigma_m();
  return result;
}

Id add_map(Store& store, const fs::path& urdf) {
  const fs::path sidecar = mapping::sidecar_path(urdf);
  return store.add_map(urdf.filename().string(), read_file(urdf),
                       fs::exists(sidecar) ? read_file(sidecar) : std::string());
}

}  // namespace

void IngestOptions::declare(OptionTable& table) {
  table.flag("strict", strict, "Refuse the whole file for one bad line, before anything is added.");
  table.flag("resume", resume, "Resume a file that the memory has in part.");
  table.number("noise_m", noise_m, "m", "Noise of positions per axis (sigma); 0 = estimate it from the file.",
               0, 10);
}

std::string IngestResult::summary() const {
  std::string text = fmt::format("{} scenes with {} detections added", scenes, detections);
  if (present > 0) text += fmt::format("; {} lines were in the memory already", present);
  if (repeated > 0) text += fmt::format("; {} lines repeat the line before", repeated);
  if (bad > 0) text += fmt::format("; {} bad lines skipped", bad);
  return text + fmt::format("; noise of positions {:.1f} mm ({})", 1000 * noise_m,
                            noise_estimated ? "estimated" : "given or assumed");
}

Json IngestResult::report() const {
  return {{"scenes", scenes},
          {"detections", detections},
          {"present", present},
          {"repeated", repeated},
          {"bad_lines", bad},
          {"noise_m", noise_m},
          {"noise_estimated", noise_estimated}};
}

IngestResult ingest(const fs::path& file, const fs::path& memory, const IngestOptions& options,
                    const WriteOptions& write, Progress& progress, Warnings& warnings) {
  const Preview ahead = preview(file, options.strict, progress);
  std::vector<PlaceRow> places;
  if (!options.map.empty()) {
    mapping::read_urdf(options.map);  // Error when it is not a URDF
    places = places_of_map(options.map);
    if (places.empty()) warnings.add("the map has no places", {options.map.string(), 0, {}});
  }
  Store store = Store::open_write(memory, write);
  IngestResult result;
  result.noise_estimated = options.noise_m == 0 && ahead.sigma_m.has_value();
  result.noise_m = options.noise_m > 0 ? options.noise_m : ahead.sigma_m.value_or(PositionNoise::kDefault_m);
  const std::optional<RecordingRow> known = store.recording(ahead.fingerprint);
  std::set<int64_t> present;
  if (known) present = store.frames(known->id);
  if (!present.empty() && !options.resume)
    throw Error(fmt::format("this file is in the memory already ({} scenes)", present.size()),
                {file.string(), 0, {}}, "--resume adds the lines that are missing");

  SceneReader reader(file, store.last_scene_time(), warnings);
  reader.skip(std::move(present));
  std::optional<NumberedScene> current = reader.next();
  // Within the file the order was checked: if its first scene comes after the memory's last, all do.
  if (options.strict && reader.first_error()) throw *reader.first_error();

  std::optional<Id> map;
  if (!options.map.empty()) map = add_map(store, options.map);
  for (PlaceRow& place : places) place.map = map;
  const Id recording = store.add_recording(
      {.fingerprint = ahead.fingerprint, .name = file.filename().string(), .kind = "detections"});
  const Id run = store.begin_run(options.program, result.report().dump());
  Recorder recorder(store, run, options.belief);
  while (current) {
    progress.check(reader.fraction(), "ingesting detections");
    std::optional<NumberedScene> after = reader.next();
    SceneRecord record = detections_to_scene(current->scene, result.noise_m, places);
    record.row.recording = recording;
    record.row.frame_index = current->line;
    record.row.map = map;
    if (after)
      record.seconds_to_next = static_cast<double>(after->scene.time - current->scene.time) / double(kSecond);
    recorder.record(record);
    ++result.scenes;
    result.detections += current->scene.detections.size();
    current = std::move(after);
  }
  result.present = reader.skipped();
  result.repeated = reader.repeated();
  result.bad = reader.bad();
  if (result.bad > kNamedLines)
    warnings.add(fmt::format("{} more bad lines", result.bad - kNamedLines), {file.string(), 0, {}});
  store.finish_run(run);
  apply_catalogues(store);
  return result;
}

}  // namespace loci::memory
