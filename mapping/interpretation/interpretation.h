#pragma once

#include "mapping/base/options.h"
#include "mapping/base/progress.h"
#include "mapping/interpretation/face_photo.h"
#include "mapping/interpretation/fronts/furniture_face.h"
#include "mapping/sensor/scan.h"
#include "mapping/world/furniture.h"
#include "mapping/world/semantic_map.h"
#include "mapping/world/world.h"

namespace loci::mapping {

struct InterpretationOptions {
  double min_support_area_m2 = 0.05;
  double min_support_side_m = 0.15;
  double max_support_height_m = 2.0;
  double min_wall_area_m2 = 0.5;
  double min_wall_top_m = 1.2;
  double plane_tolerance_m = 0.02;
  double slab_thickness_m = 0.04;
  double table_height_m = 0.75;
  int threads = 0;  ///< 0 = all cores; not declared as an option: the result is the same on any number

  void declare(OptionTable& table);
};

struct StageTime {
  std::string stage;
  double seconds = 0;
};

/// The map that an interpretation yields, with evidence and notes about what was not recognised.
struct InterpretedMap {
  World world;                       ///< floor, walls, supports as links with visual, collision and inertia
  std::vector<Front> fronts;         ///< furniture fronts with fixtures and joints, as in their links
  std::vector<FurnitureFace> faces;  ///< vertical planes that may be furniture, with or without fronts
  std::vector<FacePhoto> photos;     ///< of faces that the frames of a recording show
  std::vector<Fixture> ribs;         ///< bars in rows, as of radiators: no handles
  double room_yaw = 0;               ///< of the room's main directions in the map, radians
  std::vector<Link> whole_supports;  ///< supports before room for fronts was cut out of them
  SemanticMap semantics;             ///< class, geometry, confidence, evidence of each link
  std::vector<std::string> notes;    ///< e.g. "no free-space evidence: the input is a bare cloud"
  Json configuration;                ///< the effective options
  std::vector<StageTime> times;

  /// Whether anything was recognised; otherwise the notes say why not.
  bool usable() const { return !semantics.links.empty(); }
  std::string summary() const;
  /// Links by class, notes, configuration.
  Json report() const;
};

/// Floor, walls, horizontal supports (counter, table, shelf) with outlines, and furniture fronts with their
/// fixtures and the joints that their shape suggests, from a scan set (§7.4). Every link names the scans and
/// the number of points that support it. Input that is not levelled is levelled by its floor
/// (semantics.map_from_input). Error for a scan set without points.
InterpretedMap interpret(const ScanSet& scans, const InterpretationOptions& options, Progress& progress);

}  // namespace loci::mapping
