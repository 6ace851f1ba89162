#pragma once

#include <memory>

#include "memory/store/scene_transaction.h"
#include "perception/cas/cas.h"

namespace loci::memory {

/// Stores feature structures of any type, including users' own, as canonical JSON, with large arrays as blobs
/// and the type system beside them.
class FeatureStructureWriter {
 public:
  /// `scene`: of the structures; unset = none.
  FeatureStructureWriter(SceneTransaction& transaction, std::optional<Id> scene)
      : transaction_(transaction), scene_(scene) {}

  /// Adds a structure, which must not be null, with everything that it refers to, and its type system when
  /// that is new.
  Id add(const perception::cas::FeatureStructure& root, std::optional<Id> observation = {});

 private:
  SceneTransaction& transaction_;
  std::optional<Id> scene_;
  std::shared_ptr<const perception::cas::TypeSystem> type_system_;  ///< of the last structure
  Id type_system_row_ = 0;
};

/// A type system of stored feature structures.
std::shared_ptr<const perception::cas::TypeSystem> read_type_system(const Store& store, Id id);

/// Reads a feature structure into a CAS, identical to the one that was added. The CAS must have a type system
/// with its types, e.g. that of read_type_system(); otherwise Error.
perception::cas::FeatureStructure read_feature_structure(const Store& store, Id id,
                                                         perception::cas::Cas& cas);

/// All types that are not built in, as one UIMA typeSystemDescription; equal type systems have equal text.
std::string type_system_xml(const perception::cas::TypeSystem& type_system);

}  // namespace loci::memory
