#include "memory/store/erasure/forgotten_tokens.h"

#include <algorithm>
#include <bit>

#include "mapping/base/files.h"
#include "mapping/base/text/hash.h"
#include "mapping/base/text/json.h"
#include "mapping/base/time.h"
#include "memory/store/database.h"
#include "memory/store/erasure/erased_images.h"
#include "memory/store/rows/table_rows.h"

namespace loci::memory {
namespace {

constexpr int kTokensVersion = 1;

/// A number as SQLite stores it (most significant byte first), or as an archive does.
std::string number_bytes(double number, bool most_significant_first) {
  const auto bits = std::bit_cast<uint64_t>(number);
  std::string bytes(8, '\0');
  for (size_t i = 0; i < 8; ++i)
    bytes[most_significant_first ? 7 - i : i] = static_cast<char>(bits >> (8 * i) & 0xff);
  return bytes;
}

/// A sequence of bytes to look for, and what the report calls it.
struct Pattern {
  std::string bytes, name;
};

std::string name_of(const std::string& text) {
  return fmt::format("the text '{}'", text);
}

std::string name_of(double number) {
  return fmt::format("the number {}", number);
}

std::vector<Pattern> patterns_of(const ForgottenTokens& tokens) {
  std::vector<Pattern> patterns;
  for (const std::string& text : tokens.texts)
    if (!text.empty()) patterns.push_back({text, name_of(text)});
  for (const std::string& hash : tokens.hashes)
    if (!hash.empty()) patterns.push_back({hash, fmt::format("the hash {:.12}…", hash)});
  for (const double number : tokens.numbers)
    for (const bool first : {false, true}) patterns.push_back({number_bytes(number, first), name_of(number)});
  return patterns;
}

class Finder {
 public:
  explicit Finder(const ForgottenTokens& tokens) : tokens_(tokens), patterns_(patterns_of(tokens)) {}

  void search(std::string_view bytes, const std::string& where) {
    for (const Pattern& pattern : patterns_)
      if (bytes.find(pattern.bytes) != std::string_view::npos)
        found_.insert(pattern.name + " is in " + where);
  }

  /// Columns of the tables. What is found here is not searched for in the bytes of the file: what is found
  /// there, then, is in free space.
  void search_columns(SQLite::Database& database) {
    SQLite::Statement columns(
        database,
        "SELECT t.name, c.name, c.type FROM sqlite_schema t, pragma_table_info(t.name) c WHERE t.type = "
        "'table' AND t.sql NOT LIKE 'CREATE VIRTUAL%' AND c.type IN ('REAL', 'TEXT')");
    while (columns.executeStep()) {
      const std::string table = columns.getColumn(0).getString(), column = columns.getColumn(1).getString();
      const bool numbers = columns.getColumn(2).getString() == "REAL";
      const std::string value = sql_name(column);
      SQLite::Statement has(database,
                            fmt::format("SELECT 1 FROM {} WHERE {} LIMIT 1", sql_name(table),
                                        numbers ? value + " = ?" : fmt::format("instr({}, ?) > 0", value)));
      const auto report_if_found = [&](const auto& token, const std::string& name) {
        has.bind(1, token);
        if (has.executeStep()) {
          found_.insert(fmt::format("{} is in column {} of table {}", name, column, table));
          std::erase_if(patterns_, [&](const Pattern& pattern) { return pattern.name == name; });
        }
        has.reset();
      };
      if (numbers)
        for (const double number : tokens_.numbers) report_if_found(number, name_of(number));
      else
        for (const std::string& text : tokens_.texts)
          if (!text.empty()) report_if_found(text, name_of(text));
    }
  }

  void search_blob(const BlobRow& blob) {
    const std::string where = fmt::format("blob {}", blob.id);
    search(blob.bytes, where);
    if (std::ranges::find(tokens_.hashes, content_hash(blob.bytes)) != tokens_.hashes.end())
      found_.insert(where + " is one that was erased");
  }

  /// The image of a scene; what the scene observed there is another object.
  void search_image(const Store& store, const SceneRow& scene) {
    if (tokens_.images.empty()) return;
    const std::optional<cv::Mat> image = stored_image(store, scene);
    if (!image) return;
    for (const ImageSignature& signature : tokens_.images)
      if (shows(*image, signature) && !observes(store, scene, signature)) {
        found_.insert(fmt::format("the image of scene {}, of {}, shows a region that was erased", scene.id,
                                  format_time(scene.time)));
        break;
      }
  }

  void report(const std::string& line) { found_.insert(line); }
  std::vector<std::string> take() { return {found_.begin(), found_.end()}; }

 private:
  /// Whether a remaining observation covers the middle of the region.
  static bool observes(const Store& store, const SceneRow& scene, const ImageSignature& signature) {
    if (!scene.camera) return false;
    const auto& [x, y, width, height] = signature.region;
    const double u = (x + 0.5 * width) / signature.width * scene.camera->width,
                 v = (y + 0.5 * height) / signature.height * scene.camera->height;
    return std::ranges::any_of(store.observations(scene.id), [&](const ObservationRow& row) {
      if (!row.roi) return false;
      const auto& [left, top, columns, rows] = *row.roi;
      const double margin = 0.02 * scene.camera->width;
      return u >= left - margin && u <= left + columns + margin && v >= top - margin &&
             v <= top + rows + margin;
    });
  }

  const ForgottenTokens& tokens_;
  std::vector<Pattern> patterns_;
  std::set<std::string> found_;
};

/// Everything that is stored in an encoding.
constexpr std::pair<const char*, const char*> kEncodedTables[] = {
    {"feature_structure", "id"}, {"checkpoint", "name"}, {"reasoning", "scene"}};

}  // namespace

Json to_json(const ForgottenTokens& tokens) {
  Json images = Json::array();
  for (const ImageSignature& image : tokens.images)
    images.push_back(
        {{"size", {image.width, image.height}}, {"region", image.region}, {"means", image.means}});
  return {{"version", kTokensVersion},
          {"texts", tokens.texts},
          {"hashes", tokens.hashes},
          {"numbers", tokens.numbers},
          {"images", images}};
}

ForgottenTokens tokens_from_json(const Json& json, const std::string& name) {
  const auto refuse = [&](const std::string& what) {
    return Error("is no file of tokens: " + what, {name, 0, {}}, "loci-memory forget --tokens writes one");
  };
  try {
    if (json.at("version").get<int>() != kTokensVersion) throw refuse("its version is not known");
    ForgottenTokens tokens;
    json.at("texts").get_to(tokens.texts);
    json.at("hashes").get_to(tokens.hashes);
    json.at("numbers").get_to(tokens.numbers);
    for (const Json& one : json.at("images")) {
      ImageSignature image{one.at("size").at(0).get<int>(), one.at("size").at(1).get<int>(), {}, {}};
      one.at("region").get_to(image.region);
      one.at("means").get_to(image.means);
      const auto& [x, y, width, height] = image.region;
      if (x < 0 || y < 0 || width < 1 || height < 1 || width > image.width || height > image.height ||
          x > image.width - width || y > image.height - height)
        throw refuse("a region lies outside its image");
      tokens.images.push_back(image);
    }
    return tokens;
  } catch (const Json::exception& error) {
    throw refuse(error.what());
  }
}

std::vector<std::string> find_forgotten(const std::filesystem::path& memory, const ForgottenTokens& tokens,
                                        Progress& progress) {
  Finder finder(tokens);
  {
    // Opening sets up the log of a memory that nobody has open; closing removes it.
    const Store store = Store::open_read(memory);
    SQLite::Database database(memory.string(), SQLite::OPEN_READONLY);
    database.setBusyTimeout(5000);
    SQLite::Statement blobs(database, "SELECT id FROM blob ORDER BY id");
    while (blobs.executeStep()) {
      progress.check(0, "searching blobs");
      finder.search_blob(store.blob(blobs.getColumn(0).getInt64()));
    }
    for (const SceneRow& scene : store.scenes()) {
      progress.check(0.5, "searching images");
      finder.search_image(store, scene);
    }
    for (const auto& [table, key] : kEncodedTables) {
      SQLite::Statement rows(database, fmt::format("SELECT {}, encoding, content FROM {}", key, table));
      while (rows.executeStep()) {
        const SQLite::Column content = rows.getColumn(2);
        finder.search(decode_bytes({static_cast<const char*>(content.getBlob()), size_t(content.getBytes())},
                                   rows.getColumn(1).getInt64(), -1, memory),
                      fmt::format("{} {}", table, rows.getColumn(0).getString()));
      }
    }
    finder.search_columns(database);
  }
  finder.search(read_file(memory), "the bytes of the file");
  for (const char* end : {"-wal", "-journal"}) {
    std::error_code none;
    const std::filesystem::path log = memory.string() + end;
    if (!std::filesystem::exists(log, none) || std::filesystem::file_size(log, none) == 0) continue;
    finder.report(
        fmt::format("{} lies beside the file: another program has the memory open", log.filename().string()));
    finder.search(read_file(log), log.filename().string());
  }
  return finder.take();
}

}  // namespace loci::memory
