#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mapping/recording/association.h"

namespace loci::mapping {

/// Frames that move against each other, as tf tells it: a tree whose edges have poses over time.
class TransformTree {
 public:
  /// Static transforms hold at all times. A frame that gets another parent keeps the last one.
  void add(const std::string& parent, const std::string& child, const StampedPose& parent_from_child,
           bool is_static);
  /// To be called when all were added.
  void finish();

  /// The frame above all others that `frame` hangs on; itself when it hangs on nothing.
  std::string root_of(const std::string& frame) const;
  /// Unset where an edge on the way has no pose near the time.
  std::optional<Isometry3d> root_from(const std::string& frame, TimeNs time_ns) const;
  /// target_from_source; what moves above both does not matter. Unset for frames of different trees.
  std::optional<Isometry3d> between(const std::string& target, const std::string& source,
                                    TimeNs time_ns) const;

 private:
  struct Edge {
    std::string parent;
    bool is_static = false;
    std::vector<StampedPose> poses;
  };
  /// The frame and all above it, up to the root.
  std::vector<std::string> chain(const std::string& frame) const;
  std::optional<Isometry3d> up_to(const std::string& ancestor, const std::string& frame,
                                  TimeNs time_ns) const;

  std::map<std::string, Edge> edges_;  ///< by child
};

}  // namespace loci::mapping
