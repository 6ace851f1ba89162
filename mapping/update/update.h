#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mapping/base/options.h"
#include "mapping/base/progress.h"
#include "mapping/base/text/json.h"
#include "mapping/interpretation/interpretation.h"
#include "mapping/sensor/scan.h"
#include "mapping/world/free_standing.h"
#include "mapping/world/semantic_map.h"
#include "mapping/world/world.h"

namespace loci::mapping {

struct UpdateOptions {
  double position_error_m = 0.3;                    ///< expected (σ) of the new scans in the map frame
  double yaw_error_deg = 10;                        ///< expected (σ)
  double min_move_m = kFurnitureMotion.min_move_m;  ///< furniture that moved and turned less has not moved
  double min_move_deg = kFurnitureMotion.min_move_deg;
  double min_probability = 0.5;  ///< of a change that is reported
  int threads = 0;  ///< 0 = all cores; not declared as an option: the result is the same on any number

  void declare(OptionTable& table);
};

/// One difference between a map and new scans of the same room. Lengths in metres, map frame.
struct MapChange {
  enum class Kind {
    moved,      ///< a piece of furniture stands elsewhere
    gone,       ///< rays pass through where it stood, and it is nowhere else
    came,       ///< a new piece, in space that was free
    opened,     ///< a joint of the map is in another state
    seen_first  ///< a piece in space that the map's scans did not see
  };
  Kind kind = Kind::moved;
  std::string name;        ///< of the piece, or of the front that moved
  std::string class_name;  ///< as in the sidecar, or "chair", "stool", "piece" of other furniture
  double probability = 0;
  Isometry3d now_from_before = Isometry3d::Identity();  ///< motion of a piece that moved, map frame
  Vector3d centre = Vector3d::Zero();                   ///< of the piece before; of a piece that came, now
  double joint_position = 0;                            ///< of a joint: metres or radians from closed
  bool prismatic = false;                               ///< of a joint
  std::vector<Vector2d> outline_before, outline_now;    ///< on the floor plan; empty where it is not there
  double height = 0;                                    ///< of its highest point
  std::vector<std::string> links;                       ///< of the map that belong to it
  std::vector<std::string> scans;                       ///< new ones that show the change
  std::string reason;                                   ///< the numbers behind the probability

  /// Shift of the centre in the floor plan (metres) and rotation about z (degrees).
  double distance() const;
  double turn_deg() const;
  /// "table_1 moved 0.42 m and turned 12°".
  std::string text() const;
  Json to_json() const;
};
const char* to_text(MapChange::Kind kind);

/// A free-standing piece of furniture, in the map or not, that the new scans show unchanged or not at all.
struct UnchangedPiece {
  std::string name;
  std::vector<Vector2d> outline;
  bool seen = false;  ///< the new scans show it in its place
};

struct UpdateResult {
  /// The map as it is now. In the sidecar, `extra.pieces` names furniture that is not a link.
  InterpretedMap map;
  ScanSet scans;  ///< that show the room as it is now: the earlier ones without what moved, then the new ones
  std::vector<MapChange> changes;
  std::vector<UnchangedPiece> unchanged;
  Isometry3d map_from_new = Isometry3d::Identity();  ///< correction of the new scans' poses
  double overlap = 0;                                ///< of the new surface with the map's, after it
  std::vector<std::string> notes;
  double seconds = 0;

  /// One line per change, or that nothing changed.
  std::string text() const;
  Json report() const;
};

/// Compares new scans with a map and the scans that it was made from (§10.1, life-long mapping): registers
/// the new scans against the surfaces of the old ones, where what did not move decides; segments
/// free-standing furniture; searches the new surface for every piece; and compares fronts with
/// articulate(). Pieces keep their names, unchanged links their geometry, with the evidence of both.
/// `before` and `now` are levelled, have known rays and at least one scan; the frame is the map's. Error when
/// the new scans do not fit the map.
UpdateResult update(const World& world, const SemanticMap& semantics, const ScanSet& before,
                    const ScanSet& now, const UpdateOptions& options, Progress& progress);

/// Floor plan of a map with the outlines of what changed: before dashed, now filled. SVG.
std::string change_plan_svg(const UpdateResult& result);

}  // namespace loci::mapping
