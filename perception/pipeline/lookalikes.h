#pragma once

#include <list>
#include <memory>
#include <optional>

#include "mapping/base/options.h"
#include "perception/types/geometry.h"
#include "perception/types/scene_cas.h"

namespace loci::perception {

/// When a cluster counts as unchanged.
struct AlikeOptions {
  int bits = 8;
  double color = 8;
  double place_m = 0.05;
  double growth = 1.3;
  int remembered = 500;

  void declare(OptionTable& table);
};

/// What was said about clusters, by where they are and what they look like: change detection that can be put
/// before any annotator (§5.4.5). Every look is compared with the one that was annotated, so that slow
/// changes do not creep in. Looks are the `phash` and `cell_colors` of regions.
class Lookalikes {
 public:
  explicit Lookalikes(const AlikeOptions& options) : options_(options) {}

  /// Gives the cluster the annotations of the most alike one, marked with the frame that they were said about
  /// (`taken_from`), their regions moved to its own. False when nothing known is alike.
  bool take_over(const types::Cluster& cluster) const;

  /// Remembers the annotations of the cluster with ids above `known`, none counts as well. Those that refer
  /// to older structures would not be true elsewhere: the cluster is asked about again.
  void remember(const types::Cluster& cluster, size_t known, int64_t frame);

 private:
  struct Look {
    uint64_t hash = 0;
    std::vector<float> colors;
    Vector3d place;
    double x = 0, y = 0, width = 0, height = 0;  ///< region of the image, px
  };
  struct Entry {
    Look look;
    int64_t frame = 0;
    std::unique_ptr<cas::Cas> cas;  ///< holds the annotations
    std::vector<types::Annotation> annotations;
  };
  static std::optional<Look> look_at(const types::Cluster& cluster);
  /// How many bits of the hash differ; nothing when it is another thing.
  std::optional<int> difference(const Look& now, const Look& then) const;

  AlikeOptions options_;
  std::list<Entry> entries_;  ///< the newest first
};

}  // namespace loci::perception
