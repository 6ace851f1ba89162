#pragma once

#include <memory>
#include <set>

#include "memory/store/store.h"
#include "perception/pipeline/annotator.h"

namespace loci::memory {

/// A memory whose scenes are processed again (§5.2): a resource of the pipeline.
struct MemorySource {
  explicit MemorySource(Store opened) : store(std::move(opened)) {}

  Store store;
  /// What these annotators have annotated already is left as it is, and clusters that all of them have
  /// annotated are hidden; empty = everything is annotated again.
  std::set<std::string> annotated_by;
  /// The scene that was read last: its observations in the order of its clusters, and the structures of its
  /// CAS.
  struct Current {
    Id scene = 0;
    std::vector<Id> observations;
    size_t structures = 0;
  };
  Current current;
};

/// Reads the scenes of a memory: clusters with their images and points (a depth image in which nothing
/// else was measured), supports, and their annotations.
class MemoryReader : public perception::Reader {
 public:
  perception::AnnotatorDescriptor descriptor() const override;
  void start(perception::Context& context) override;
  size_t count() const override { return scenes_.size(); }
  size_t position() const override { return position_; }
  perception::FrameId upcoming() const override;
  void read_next(perception::cas::Cas& cas, perception::Context& context) override;
  void skip(size_t frames) override { position_ += frames; }

 private:
  MemorySource* memory_ = nullptr;
  std::vector<SceneRow> scenes_;
  size_t position_ = 0;
  std::set<std::string> unknown_;  ///< types with a warning
};

/// Adds new annotations of the clusters of the scene read last, and their relations, to their observations,
/// in one transaction. Nothing is stored twice: what is there in the same words is left out, and with
/// `annotated_by` whatever one of these annotators said of a cluster that it has annotated already. Returns
/// their number.
size_t store_new_annotations(MemorySource& memory, perception::cas::Cas& cas, Id run);

}  // namespace loci::memory
