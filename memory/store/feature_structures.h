#pragma once

#include <memory>

#include "memory/store/scene_transaction.h"
#include "perception/cas/cas.h"

namespace loci::memory {

/// Puts feature structures of any type, users' own included, into the memory: canonical JSON, large arrays as
/// blobs that are stored once per content, and the type system beside them.
class FeatureStructureWriter {
 public:
  /// Structures are kept with this scene; unset = with none.
  FeatureStructureWriter(SceneTransaction& transaction, std::optional<Id> scene)
      : transaction_(transaction), scene_(scene) {}

  /// Adds the structure, which must not be null, with everything that it refers to. Its type system is added
  /// when it is new.
  Id add(const perception::cas::FeatureStructure& root, std::optional<Id> observation = {});

 private:
  SceneTransaction& transaction_;
  std::optional<Id> scene_;
  std::shared_ptr<const perception::cas::TypeSystem> type_system_;  ///< of the structure before
  Id type_system_row_ = 0;
};

/// A type system that feature structures of the memory were written with.
std::shared_ptr<const perception::cas::TypeSystem> read_type_system(const Store& store, Id id);

/// Brings a feature structure back, identical to the one that was added. The CAS must have a type system that
/// knows its types, e.g. that of read_type_system(). Error when it does not fit.
perception::cas::FeatureStructure read_feature_structure(const Store& store, Id id,
                                                         perception::cas::Cas& cas);

/// All types that are not built in, as one UIMA typeSystemDescription; equal type systems give equal text.
std::string type_system_xml(const perception::cas::TypeSystem& type_system);

}  // namespace loci::memory
