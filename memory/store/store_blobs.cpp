// What is stored as bytes: images, checkpoints, reasons, feature structures.

#include "memory/store/reading.h"

namespace loci::memory {

std::optional<std::string> Store::reasoning(Id scene) const {
  const auto& path = implementation_->path;
  auto rows = all<std::string>(*implementation_, "SELECT encoding, content FROM reasoning WHERE scene = ?",
                               {sql(scene)}, [&](const SqlRow& row) {
                                 return decode_bytes(row.bytes("content"), row.integer("encoding"), -1, path);
                               });
  return rows.empty() || rows[0].empty() ? std::nullopt : std::optional(std::move(rows[0]));
}

bool Store::reasoning_discarded(Id scene) const {
  return !all<bool>(*implementation_, "SELECT 1 FROM reasoning WHERE scene = ? AND length(content) = 0",
                    {sql(scene)}, [](const SqlRow&) { return true; })
              .empty();
}

std::optional<Store::Checkpoint> Store::checkpoint(const std::string& name) const {
  const auto& path = implementation_->path;
  auto rows = all<Checkpoint>(
      *implementation_, "SELECT * FROM checkpoint WHERE name = ?", {sql(name)}, [&](const SqlRow& row) {
        return Checkpoint{row.optional_integer("scene"),
                          decode_bytes(row.bytes("content"), row.integer("encoding"), -1, path)};
      });
  return rows.empty() ? std::nullopt : std::optional(std::move(rows[0]));
}

BlobRow Store::blob(Id id) const {
  const auto& path = implementation_->path;
  return one<BlobRow>(*implementation_, "blob", id, [&](const SqlRow& row) {
    return BlobRow{row.integer("id"), row.text("hash"), row.text("media"),
                   decode_bytes(row.bytes("content"), row.integer("encoding"), row.integer("size"), path)};
  });
}

std::optional<Id> Store::find_blob(const std::string& hash) const {
  const auto rows = all<Id>(*implementation_, "SELECT id FROM blob WHERE hash = ?", {sql(hash)},
                            [](const SqlRow& row) { return row.integer("id"); });
  return rows.empty() ? std::nullopt : std::optional(rows[0]);
}

std::map<std::string, Store::Checkpoint> Store::checkpoints(const std::string& prefix) const {
  const auto& path = implementation_->path;
  std::map<std::string, Checkpoint> result;
  implementation_->guarded([&] {
    implementation_->query("SELECT * FROM checkpoint WHERE substr(name, 1, length(?1)) = ?1", {sql(prefix)},
                           [&](const SqlRow& row) {
                             result[row.text("name")] = {
                                 row.optional_integer("scene"),
                                 decode_bytes(row.bytes("content"), row.integer("encoding"), -1, path)};
                           });
  });
  return result;
}

namespace {

FeatureStructureRow feature_structure_row(const SqlRow& row, const std::filesystem::path& path) {
  FeatureStructureRow result;
  result.id = row.integer("id");
  result.scene = row.optional_integer("scene");
  result.observation = row.optional_integer("observation");
  result.type = row.text("type");
  result.type_system = row.integer("type_system");
  result.json = decode_bytes(row.bytes("content"), row.integer("encoding"), -1, path);
  return result;
}

}  // namespace

FeatureStructureRow Store::feature_structure(Id id) const {
  auto& s = *implementation_;
  auto result = one<FeatureStructureRow>(
      s, "feature_structure", id, [&](const SqlRow& row) { return feature_structure_row(row, s.path); });
  result.blobs =
      all<Id>(s, "SELECT blob FROM feature_structure_blob WHERE feature_structure = ? ORDER BY blob",
              {sql(id)}, [](const SqlRow& row) { return row.integer("blob"); });
  return result;
}

std::vector<FeatureStructureRow> Store::feature_structures(Id scene, const std::string& type) const {
  std::vector<SqlValue> values = {sql(scene)};
  std::string text = "SELECT id FROM feature_structure WHERE scene = ?1";
  if (!type.empty()) {
    text += " AND type = ?2";
    values.push_back(sql(type));
  }
  std::vector<FeatureStructureRow> result;
  for (const Id id : all<Id>(*implementation_, text + " ORDER BY id", values,
                             [](const SqlRow& row) { return row.integer("id"); }))
    result.push_back(feature_structure(id));
  return result;
}

std::string Store::type_system(Id id) const {
  const Id content =
      one<Id>(*implementation_, "type_system", id, [](const SqlRow& row) { return row.integer("content"); });
  return blob(content).bytes;
}

}  // namespace loci::memory
