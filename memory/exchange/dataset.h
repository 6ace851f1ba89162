#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "mapping/base/error.h"
#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"
#include "mapping/sensor/frame.h"
#include "memory/catalogue/object_description.h"
#include "memory/store/store.h"

namespace loci::memory {

struct DatasetOptions {
  bool by_object = false;    ///< each object is a class of its own: to recognise it again
  bool keep_people = false;  ///< faces in frames, which are blurred otherwise
  /// The frame that a scene was made from, for its full depth and colour; unset = what the memory has.
  std::function<std::optional<mapping::RgbdFrame>(const SceneRow&)> frame_of = {};
  std::vector<std::filesystem::path> inputs = {};  ///< what frame_of reads; never replaced
};

struct DatasetResult {
  size_t scenes = 0, objects = 0;
  size_t left_out = 0;                    ///< scenes without depth, masks or pose, or of another camera
  std::map<std::string, size_t> classes;  ///< objects of each; "" = unknown

  std::string summary() const;
  Json report() const;
};

/// The class of an observation: its label by people, else that of its object.
ObjectClass class_of(const Store& store, const ObservationRow& observation, Id object);

/// Writes the observations of a memory as a folder of training data: a recording of its scenes (frame index =
/// scene), a label image beside each depth image, objects.csv (what each label is), and crops/CLASS with
/// image and mask of each object. `loci-perceive train` reads it. Depth is that of the thumbnails unless
/// frames are given. Error when nothing of the memory can be labelled.
DatasetResult export_dataset(const Store& store, const std::filesystem::path& folder,
                             const DatasetOptions& options, Progress& progress);

}  // namespace loci::memory
