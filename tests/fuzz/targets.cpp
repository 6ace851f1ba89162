#include "tests/fuzz/targets.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>

#include "mapping/base/error.h"
#include "mapping/base/files.h"
#include "mapping/base/progress.h"
#include "mapping/base/terminal.h"
#include "mapping/base/text/json.h"
#include "mapping/image/image_io.h"
#include "mapping/recording/depth_image.h"
#include "mapping/recording/recording.h"
#include "mapping/recording/ros/rvl.h"
#include "mapping/sensor/pcd.h"
#include "mapping/sensor/scan.h"
#include "mapping/simulation/scenario.h"
#include "mapping/world/kinematics.h"
#include "mapping/world/semantic_map.h"
#include "mapping/world/urdf.h"
#include "memory/catalogue/catalogue.h"
#include "memory/identity/vector_file.h"
#include "memory/ingest/detections.h"
#include "memory/questions/question.h"
#include "memory/report/memory_report.h"
#include "memory/sentences/natural_language.h"
#include "memory/sentences/sentence_parser.h"
#include "perception/cas/json.h"
#include "perception/cas/xmi.h"
#include "perception/detection/detection_set.h"
#include "perception/pipeline/goal.h"
#include "perception/recognition/product_catalogue.h"
#include "perception/search/protocol.h"
#include "tests/memory/questions/synthetic_day.h"
#include "tests/perception/pipeline/test_annotators.h"

namespace loci::fuzz {
namespace {

namespace fs = std::filesystem;

/// A folder of this process that is removed at its end.
class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / ("loci_fuzz_" + std::to_string(::getpid()))) {
    fs::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  fs::path operator/(const char* name) const { return path_ / name; }

 private:
  fs::path path_;
};

const Folder& folder() {
  static const Folder instance;
  return instance;
}

/// The bytes as a file: most readers take a path.
fs::path file_of(std::string_view bytes, const char* name) {
  fs::path path = folder() / name;
  fs::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return path;
}

Json json_of(std::string_view bytes) {
  return parse_json(bytes, "input.json");
}

void urdf(std::string_view bytes) {
  const mapping::World world = mapping::parse_urdf(std::string(bytes), "input.urdf");
  mapping::root_from_links(world, {});
  mapping::parse_urdf(mapping::urdf_text(world), "again.urdf");
}

void sidecar(std::string_view bytes) {
  mapping::to_json(mapping::semantic_map_from_json(json_of(bytes), "input.json"));
}

void type_system(std::string_view bytes) {
  using perception::cas::TypeSystem;
  const auto types =
      TypeSystem::load(std::vector<perception::cas::TypeSource>{{"input.xml", std::string(bytes)}}, {}, {});
  perception::cas::types_text(*types);
}

void xmi(std::string_view bytes) {
  for (const bool lenient : {false, true}) {
    perception::cas::Cas cas(perception::types::type_system());
    Warnings warnings;
    try {
      perception::cas::from_xmi(cas, bytes, "input.xmi", {.lenient = lenient}, warnings);
    } catch (const Error&) {
      if (lenient) throw;
      continue;
    }
    perception::cas::to_xmi(cas);
    perception::cas::to_json(cas);
  }
}

void canonical_json(std::string_view bytes) {
  perception::cas::Cas cas(perception::types::type_system());
  perception::cas::from_json(cas, json_of(bytes));
  perception::cas::to_json(cas);
}

void detections(std::string_view bytes) {
  memory::LineReader lines(file_of(bytes, "input.jsonl"));
  for (std::string line; lines.next(line) != memory::LineReader::Status::end;) memory::parse_detections(line);
}

/// JSON Lines, a COCO file, or a text file of a YOLO folder.
void detections_2d(std::string_view bytes) {
  static const fs::path classes = file_of("cup\nplate\n", "yolo/classes.txt");
  const bool lines = bytes.starts_with("{\"time\""), coco = bytes.starts_with('{') || bytes.starts_with('[');
  const fs::path file = lines  ? file_of(bytes, "images.jsonl")
                        : coco ? file_of(bytes, "coco.json")
                               : file_of(bytes, "yolo/000001.txt").parent_path();
  Warnings warnings;
  perception::DetectionSet::read(file, warnings).find("000001", 1, parse_time("2026-05-01T08:30:00Z"));
}

void scenario(std::string_view bytes) {
  mapping::read_scenario(file_of(bytes, "input.yaml"));
}

void pipeline(std::string_view bytes) {
  static const perception::AnnotatorRegistry registry = perception::test_registry();
  const auto read = perception::Pipeline::parse(std::string(bytes), "input.yaml", registry);
  read.check(registry);
  read.to_json();
}

void condition(std::string_view bytes) {
  perception::Condition::parse(std::string(bytes), {"input.yaml", 1, {}})
      .check(*perception::types::type_system());
}

void goal(std::string_view bytes) {
  perception::parse_goal(std::string(bytes));
}

void question(std::string_view bytes) {
  const std::string text(bytes);
  const memory::TimeReader times(parse_time("2026-05-01T08:30:00Z"), TimeZone::fixed(120));
  if (const auto span = times.try_read(text)) format_time(span->first, 120);
  memory::parse_sentence(text, times);
  memory::nearest_examples(text);
  memory::parse_query(text);
}

void scans(std::string_view bytes) {
  static const fs::path scan = file_of(
      "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\nPOINTS 1\n"
      "DATA ascii\n1 2 3\n",
      "scans/scan_000.pcd");
  mapping::read_scan_set(file_of(bytes, "scans/scans.yaml").parent_path());
}

void pcd(std::string_view bytes) {
  mapping::read_scan_set(file_of(bytes, "input.pcd"));
}

void read_frames(const fs::path& path) {
  const auto recording = mapping::open_recording(path);
  mapping::to_json(recording->info());
  for (size_t i = 0; i < std::min<size_t>(recording->size(), 3); ++i) recording->frame(i);
}

/// A bag of ROS 1, MCAP, or the database of rosbag2, plain or compressed, which is known by its name, too.
void bag(std::string_view bytes) {
  const char* name = "input.bag";
  if (bytes.starts_with("SQLite format 3")) name = "input.db3";
  if (bytes.starts_with("\x28\xb5\x2f\xfd")) name = "input.mcap.zstd";
  if (bytes.starts_with("\x1f\x8b")) name = "input.bag.gz";
  if (bytes.starts_with("BZh")) name = "input.bag.bz2";
  read_frames(file_of(bytes, name));
}

/// recording.yaml and frames.csv with a line "---" between them.
void recording(std::string_view bytes) {
  const size_t cut = std::min(bytes.find("---\n"), bytes.size());
  static const bool images = [] {
    for (const auto& [kind, type] : {std::pair{"color", CV_8UC3}, std::pair{"depth", CV_16UC1}})
      for (const int frame : {1, 2}) {
        const cv::Mat image(240, 320, type, cv::Scalar::all(1500));
        const auto encoded = mapping::encode_image(image, ".png");
        file_of({reinterpret_cast<const char*>(encoded.data()), encoded.size()},
                fmt::format("recording/frames/00000{}_{}.png", frame, kind).c_str());
      }
    return true;
  }();
  static_cast<void>(images);
  const fs::path yaml = file_of(bytes.substr(0, cut), "recording/recording.yaml");
  file_of(bytes.substr(std::min(cut + 4, bytes.size())), "recording/frames.csv");
  read_frames(yaml.parent_path());
}

/// A recording of another program: its files, each after a line "--- NAME", beside images of every frame.
void layout(std::string_view bytes) {
  const fs::path root = folder() / "layout";
  fs::remove_all(root);
  const cv::Mat depth(6, 8, CV_16UC1, cv::Scalar(1500)), color(6, 8, CV_8UC3, cv::Scalar(1, 2, 3));
  static const auto png_of = [](const cv::Mat& image) { return mapping::encode_image(image, ".png"); };
  static const auto depth_png = png_of(depth), color_png = png_of(color);
  const auto write = [](const auto& content, const std::string& name) {
    return file_of({reinterpret_cast<const char*>(content.data()), content.size()},
                   ("layout/" + name).c_str());
  };
  for (const char* number : {"000000", "000001"}) {
    write(depth_png, fmt::format("depth/{}.png", number));
    write(color_png, fmt::format("color/{}.png", number));
  }
  constexpr std::string_view kNext = "--- ";
  while (bytes.starts_with(kNext)) {
    const size_t line = std::min(bytes.find('\n'), bytes.size());
    const std::string name(bytes.substr(kNext.size(), line - kNext.size()));
    bytes.remove_prefix(std::min(line + 1, bytes.size()));
    const size_t end = std::min(bytes.find("\n--- "), bytes.size());
    const bool plain = !name.empty() && name.size() < 40 && name[0] != '/' && name.find("..") == name.npos &&
                       name.find('\0') == name.npos && !name.ends_with('/');
    if (!plain || fs::exists(root / name)) throw Error("no name of a file");
    const fs::path file = write(bytes.substr(0, end), name);
    bytes.remove_prefix(std::min(end + 1, bytes.size()));
    if (bytes.empty() && (file.extension() == ".sens" || file.extension() == ".pcd"))
      return read_frames(file);
  }
  read_frames(root);
}

void image(std::string_view bytes) {
  constexpr uint64_t kMaxPixels = 1 << 20;
  try {
    mapping::parse_image_header(bytes, "input.png");
  } catch (const Error&) {  // The decoder does not rely on it.
  }
  mapping::decode_color(bytes, "input.png", kMaxPixels);
}

/// PNG, NumPy, TIFF or OpenEXR.
void depth(std::string_view bytes) {
  const fs::path file = file_of(bytes, "input.depth");
  mapping::read_depth_header(file);
  mapping::read_depth_image(file);
}

void rvl(std::string_view bytes) {
  constexpr uint64_t kMaxPixels = 1 << 20;
  mapping::decode_rvl(bytes, {"input.rvl", 0, {}}, kMaxPixels);
}

void search_request(std::string_view bytes) {
  perception::decode_request(bytes);
}

void search_response(std::string_view bytes) {
  for (const perception::SearchResult& result : perception::decode_response(bytes).results)
    perception::encode(std::vector{result});
}

void catalogue(std::string_view bytes) {
  memory::to_json(memory::catalogue_from(json_of(bytes), "input.json"));
}

void identity(std::string_view bytes) {
  memory::identity_vector_from_json(json_of(bytes), "input.json");
}

void products(std::string_view bytes) {
  static const fs::path catalogue_image = file_of({}, "products/a.jpg");
  perception::read_catalogue(file_of(bytes, "products/catalogue.csv").parent_path());
}

void terminal(std::string_view bytes) {
  terminal_text(bytes);
}

/// Reads numbers from the bytes, 0 at their end.
class Choices {
 public:
  explicit Choices(std::string_view bytes) : bytes_(bytes) {}
  bool done() const { return bytes_.empty(); }
  size_t below(size_t count) { return count == 0 ? 0 : number(2) % count; }
  uint64_t number(size_t width) {
    uint64_t value = 0;
    for (; width > 0 && !bytes_.empty(); --width) {
      value = value << 8 | static_cast<uint8_t>(bytes_[0]);
      bytes_.remove_prefix(1);
    }
    return value;
  }
  std::string text() {
    const size_t wanted = below(256);
    const size_t size = std::min(wanted, bytes_.size());
    const std::string text(bytes_.substr(0, size));
    bytes_.remove_prefix(size);
    return text;
  }

 private:
  std::string_view bytes_;
};

struct Column {
  std::string table, name;
};

std::vector<Column> columns_of(const fs::path& memory) {
  const SQLite::Database database(memory.string());
  SQLite::Statement query(database,
                          "SELECT t.name, c.name FROM pragma_table_list t, pragma_table_info(t.name) c "
                          "WHERE t.type = 'table' AND NOT t.wr AND t.name NOT LIKE 'sqlite_%' ORDER BY 1, 2");
  std::vector<Column> columns;
  while (query.executeStep()) columns.push_back({query.getColumn(0), query.getColumn(1)});
  return columns;
}

/// Sets one cell of a row to something else.
void change_cell(SQLite::Database& database, const Column& column, Choices& choices) {
  const std::string name = '"' + column.name + '"', table = '"' + column.table + '"';
  SQLite::Statement update(database, "UPDATE " + table + " SET " + name +
                                         " = ? WHERE rowid = (SELECT rowid FROM " + table +
                                         " LIMIT 1 OFFSET ?)");
  constexpr std::array<double, 6> kReals = {0, -1, 1e300, -1e-300, INFINITY, 1e18};
  switch (choices.below(6)) {
    case 0:
      update.bind(1);
      break;
    case 1:
      update.bind(1, static_cast<int64_t>(choices.number(8)));
      break;
    case 2:
      update.bind(1, static_cast<int64_t>(choices.number(1)) - 2);
      break;
    case 3:
      update.bind(1, kReals[choices.below(kReals.size())]);
      break;
    case 4:
      update.bind(1, choices.text());
      break;
    default: {
      const std::string blob = choices.text();
      update.bind(1, blob.data(), static_cast<int>(blob.size()));
    }
  }
  update.bind(2, static_cast<int64_t>(choices.below(20)));
  try {
    update.exec();
  } catch (const SQLite::Exception&) {  // of a constraint
  }
}

/// Cells of a valid memory are changed as the bytes say; then it is opened, and asked a question or reported.
void memory_rows(std::string_view bytes) {
  static const fs::path original = [] {
    fs::path file = folder() / "day.loci";
    memory::testing_support::SyntheticDay day(file);
    return file;
  }();
  static const std::vector<Column> columns = columns_of(original);
  constexpr std::array kQuestions = {"objects", "where object_1",   "on table_1", "was object_1 table_1",
                                     "changes", "history object_2", "timeline",   "scenes"};
  const fs::path file = folder() / "changed.loci";
  Choices choices(bytes);
  const size_t question = choices.below(kQuestions.size() + 1);  // or else the report
  fs::copy_file(original, file, fs::copy_options::overwrite_existing);
  {
    SQLite::Database database(file.string(), SQLite::OPEN_READWRITE);
    database.exec(
        "PRAGMA ignore_check_constraints = ON; PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF");
    for (int i = 0; i < 20 && !choices.done(); ++i)
      change_cell(database, columns[choices.below(columns.size())], choices);
  }
  // Not of one type alone: programs print any exception in one line, and crashes are looked for here.
  std::optional<memory::Store> store;
  try {
    store.emplace(memory::Store::open_read(file));
  } catch (const std::exception&) {
    throw Error("the memory is refused");
  }
  try {
    if (question < kQuestions.size()) {
      memory::ask(*store, *memory::parse_query(kQuestions[question]));
    } else {
      NoProgress progress;
      memory::memory_report(*store, {}, {}, progress);
    }
  } catch (const std::exception&) {
  }
}

}  // namespace

const std::vector<Target>& targets() {
  static const std::vector<Target> all = {{"bag", bag},
                                          {"canonical_json", canonical_json},
                                          {"catalogue", catalogue},
                                          {"condition", condition},
                                          {"depth", depth},
                                          {"detections", detections},
                                          {"detections_2d", detections_2d},
                                          {"goal", goal},
                                          {"identity", identity},
                                          {"image", image},
                                          {"layout", layout},
                                          {"memory_rows", memory_rows},
                                          {"pcd", pcd},
                                          {"pipeline", pipeline},
                                          {"products", products},
                                          {"question", question},
                                          {"recording", recording},
                                          {"rvl", rvl},
                                          {"scans", scans},
                                          {"scenario", scenario},
                                          {"search_request", search_request},
                                          {"search_response", search_response},
                                          {"sidecar", sidecar},
                                          {"terminal", terminal},
                                          {"type_system", type_system},
                                          {"urdf", urdf},
                                          {"xmi", xmi}};
  return all;
}

const Target* find_target(std::string_view name) {
  for (const Target& target : targets())
    if (name == target.name) return &target;
  return nullptr;
}

}  // namespace loci::fuzz
