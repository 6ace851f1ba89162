#pragma once

#include <map>
#include <string>
#include <vector>

#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"
#include "mapping/sensor/scan.h"
#include "memory/questions/objects.h"
#include "memory/store/store.h"

namespace loci {
class OptionTable;
}  // namespace loci

namespace loci::memory {

struct ObjectModelOptions {
  int views = 12;                  ///< at most; those with most points, from as many sides as there are
  double position_error_m = 0.03;  ///< of a view against the others (σ)
  double yaw_error_deg = 20;       ///< likewise; an object that was rotated further is not registered
  double voxel_m = 0.006;          ///< of the registration

  void declare(OptionTable& table);
};

/// One view of an object that is part of its model.
struct ObjectView {
  Id scene = 0;
  TimeNs time = 0;
  size_t stay = 0;   ///< views with one number show the object unmoved
  std::string side;  ///< from where it was seen, as of the first view: front, left, back, right, top
  size_t points = 0;
  bool registered = false;  ///< a chain of trusted alignments leads to the first view
  std::string placed;       ///< in words: how it got its pose
};

/// What the observations of an object add up to (§10.1). The frame is that of the first view: z up, origin
/// where the object was believed to be, axes of the map then.
struct ObjectModel {
  Id object = 0;
  mapping::ScanSet cloud;                   ///< one scan per view, in the object's frame; coloured
  std::vector<ObjectView> views;            ///< in the order of the scans
  std::map<std::string, Id> best_crop;      ///< by side: blob of the largest image
  std::vector<AnnotationSupport> evidence;  ///< most often first, by type
  size_t observations = 0;

  std::string summary() const;
  Json report() const;
};

/// Error when the object is unknown or nothing of its surface is stored (no depth, masks or poses).
ObjectModel model_of(const Store& store, Id object, const ObjectModelOptions& options, Progress& progress,
                     const AsOf& as_of = {});

}  // namespace loci::memory
