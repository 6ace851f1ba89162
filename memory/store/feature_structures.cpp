#include "memory/store/feature_structures.h"

#include <fmt/format.h>

#include "mapping/base/text/hash.h"
#include "mapping/base/text/json.h"
#include "perception/cas/json.h"

namespace loci::memory {
namespace {

class TransactionSink : public perception::cas::BlobSink {
 public:
  explicit TransactionSink(SceneTransaction& transaction) : transaction_(transaction) {}
  std::string put(std::string_view bytes) override {
    blobs_.push_back(transaction_.add_blob(bytes, "application/octet-stream"));
    return content_hash(bytes);
  }
  std::vector<Id> take() { return std::move(blobs_); }

 private:
  SceneTransaction& transaction_;
  std::vector<Id> blobs_;
};

class StoreSource : public perception::cas::BlobSource {
 public:
  explicit StoreSource(const Store& store) : store_(store) {}
  Bytes get(const std::string& key) override {
    const auto id = store_.find_blob(key);
    if (!id) throw store_.error("the memory has no blob " + key);
    auto bytes = std::make_shared<const std::string>(store_.blob(*id).bytes);
    const std::string_view view = *bytes;
    return {std::move(bytes), view};
  }

 private:
  const Store& store_;
};

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      default:
        result += c;
    }
  return result;
}

std::string element(const char* name, const std::string& text) {
  return fmt::format("<{0}>{1}</{0}>", name, escaped(text));
}

std::string feature_xml(const perception::cas::Feature& feature) {
  std::string xml = "<featureDescription>" + element("name", feature.name()) +
                    element("description", feature.description()) +
                    element("rangeTypeName", feature.range().name());
  if (feature.has_element_type()) xml += element("elementType", feature.element_type().name());
  if (feature.multiple_references_allowed()) xml += element("multipleReferencesAllowed", "true");
  return xml + "</featureDescription>\n";
}

/// A type as far as it is not built into UIMA; empty = nothing.
std::string type_xml(const perception::cas::Type& type) {
  const auto builtin = perception::cas::TypeSystem::builtin()->find(type.name());
  std::string features;
  for (const perception::cas::Feature& feature : type.own_features())
    if (!builtin || !builtin->find_feature(feature.name())) features += feature_xml(feature);
  if (builtin && features.empty()) return {};
  std::string xml = "<typeDescription>" + element("name", type.name()) +
                    element("description", type.description()) +
                    element("supertypeName", type.supertype() ? type.supertype().name() : "") + "\n";
  if (!features.empty()) xml += "<features>\n" + features + "</features>\n";
  if (!type.allowed_values().empty()) {
    xml += "<allowedValues>\n";
    for (const std::string& value : type.allowed_values())
      xml += "<value>" + element("string", value) + "</value>\n";
    xml += "</allowedValues>\n";
  }
  return xml + "</typeDescription>\n";
}

}  // namespace

std::string type_system_xml(const perception::cas::TypeSystem& type_system) {
  std::string xml =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<typeSystemDescription xmlns=\"http://uima.apache.org/resourceSpecifier\">\n<types>\n";
  for (const perception::cas::Type& type : type_system.types()) xml += type_xml(type);
  return xml + "</types>\n</typeSystemDescription>\n";
}

Id FeatureStructureWriter::add(const perception::cas::FeatureStructure& root, std::optional<Id> observation) {
  if (const auto& types = root.cas().shared_type_system(); types != type_system_) {
    type_system_row_ = transaction_.add_type_system(type_system_xml(*types));
    type_system_ = types;
  }
  TransactionSink sink(transaction_);
  FeatureStructureRow row;
  row.scene = scene_;
  row.observation = observation;
  row.type = root.type().name();
  row.type_system = type_system_row_;
  row.json = perception::cas::to_json(root, &sink).dump();
  row.blobs = sink.take();
  return transaction_.add_feature_structure(row);
}

std::shared_ptr<const perception::cas::TypeSystem> read_type_system(const Store& store, Id id) {
  return perception::cas::TypeSystem::load(
      {{store.name() + ": type system " + std::to_string(id), store.type_system(id)}}, {}, {});
}

perception::cas::FeatureStructure read_feature_structure(const Store& store, Id id,
                                                         perception::cas::Cas& cas) {
  const FeatureStructureRow row = store.feature_structure(id);
  StoreSource source(store);
  return perception::cas::from_json(cas, parse_json(row.json, store.name()), &source);
}

}  // namespace loci::memory
