#pragma once

#include "memory/store/scene_transaction.h"
#include "perception/cas/cas.h"

namespace loci {

/// Keeps feature structures of any type with a scene: canonical JSON, large arrays as blobs, and the type
/// system that they were written with.
class StructureWriter {
 public:
  StructureWriter(SceneTransaction& transaction, Id scene) : transaction_(transaction), scene_(scene) {}

  /// Returns the row. The structure must not be null.
  Id write(const cas::FeatureStructure& structure, std::optional<Id> observation);

 private:
  SceneTransaction& transaction_;
  Id scene_;
  const cas::TypeSystem* type_system_ = nullptr;
  Id type_system_row_ = 0;
};

/// Brings a stored feature structure back into a CAS whose type system has its type.
cas::FeatureStructure read_structure(const Store& store, const FeatureStructureRow& row, cas::Cas& cas);

/// A type system (without what UIMA brings along) in UIMA's XML format: what comes back when it is loaded is
/// the same.
std::string type_system_xml(const cas::TypeSystem& types);

}  // namespace loci
