#include "memory/recorder/stored_structures.h"

#include <fmt/format.h>

#include "mapping/base/hash.h"
#include "perception/cas/json.h"

namespace loci {
namespace {

class TransactionSink : public cas::BlobSink {
 public:
  explicit TransactionSink(SceneTransaction& transaction) : transaction_(transaction) {}
  std::string put(std::string_view bytes) override {
    blobs.push_back(transaction_.add_blob(bytes, "application/octet-stream"));
    return content_hash(bytes);
  }
  std::vector<Id> blobs;

 private:
  SceneTransaction& transaction_;
};

class StoreSource : public cas::BlobSource {
 public:
  explicit StoreSource(const Store& store) : store_(store) {}
  Bytes get(const std::string& key) override {
    const std::optional<Id> id = store_.find_blob(key);
    if (!id) throw Error("the memory has no blob " + key, {store_.path().string(), 0, {}});
    const auto bytes = std::make_shared<const std::string>(store_.blob(*id).bytes);
    return {bytes, *bytes};
  }

 private:
  const Store& store_;
};

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else
      out += c;
  }
  return out;
}

std::string feature_xml(const cas::Feature& feature) {
  std::string xml = fmt::format(
      "<featureDescription><name>{}</name><description>{}</description><rangeTypeName>{}"
      "</rangeTypeName>",
      feature.name(), escaped(feature.description()), feature.range().name());
  if (feature.has_element_type()) xml += "<elementType>" + feature.element_type().name() + "</elementType>";
  if (feature.multiple_references_allowed())
    xml += "<multipleReferencesAllowed>true</multipleReferencesAllowed>";
  return xml + "</featureDescription>";
}

}  // namespace

std::string type_system_xml(const cas::TypeSystem& types) {
  std::string xml =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<typeSystemDescription "
      "xmlns=\"http://uima.apache.org/resourceSpecifier\"><types>\n";
  for (const cas::Type& type : types.types()) {
    if (type.is_builtin()) continue;
    xml += fmt::format(
        "<typeDescription><name>{}</name><description>{}</description><supertypeName>{}</supertypeName>",
        type.name(), escaped(type.description()), type.supertype().name());
    if (!type.own_features().empty()) {
      xml += "<features>";
      for (const cas::Feature& feature : type.own_features()) xml += feature_xml(feature);
      xml += "</features>";
    }
    if (!type.allowed_values().empty()) {
      xml += "<allowedValues>";
      for (const std::string& value : type.allowed_values())
        xml += "<value><string>" + escaped(value) + "</string></value>";
      xml += "</allowedValues>";
    }
    xml += "</typeDescription>\n";
  }
  return xml + "</types></typeSystemDescription>\n";
}

Id StructureWriter::write(const cas::FeatureStructure& structure, std::optional<Id> observation) {
  const cas::TypeSystem& types = structure.cas().type_system();
  if (type_system_ != &types) {
    type_system_row_ = transaction_.add_type_system(type_system_xml(types));
    type_system_ = &types;
  }
  TransactionSink sink(transaction_);
  FeatureStructureRow row;
  row.scene = scene_;
  row.observation = observation;
  row.type = structure.type().name();
  row.type_system = type_system_row_;
  row.json = cas::to_json(structure, &sink).dump();
  row.blobs = sink.blobs;
  return transaction_.add_feature_structure(row);
}

cas::FeatureStructure read_structure(const Store& store, const FeatureStructureRow& row, cas::Cas& cas) {
  StoreSource source(store);
  return cas::from_json(cas, parse_json(row.json, store.path().string()), &source);
}

}  // namespace loci
