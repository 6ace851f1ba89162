#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/options.h"
#include "mapping/exchange/map_structure.h"

namespace loci::mapping {

struct ComparisonOptions {
  double height_tolerance_m = 0.05;
  double min_outline_overlap = 0.25;
  double wall_tolerance_m = 0.10;
  double wall_angle_deg = 10;
  double handle_tolerance_m = 0.10;
  double observable_height_m = 10;  ///< tops of higher ones were out of the sensor's sight
  std::string region;

  void declare(OptionTable& table);
};

/// How a front moves in the map and in the truth.
struct ComparedJoint {
  std::string map_type;                  ///< "prismatic", "revolute", "rigid"; "" where the map says nothing
  std::string truth_type;                ///< the same
  std::string evidence;                  ///< of the map: "prior", "interaction", …
  std::optional<double> axis_error_deg;  ///< between the axes, 0 to 90; of joints of one type
  bool other_way = false;                ///< the map's opens against the true direction
  std::optional<double> hinge_error;     ///< between the hinges, at the height or place of the front, metres
  bool right() const { return map_type == truth_type; }
};

/// One element of the map, of the truth, or of both.
struct ComparedElement {
  std::string kind;  ///< "support", "wall", "floor", "opening", "front", "handle" (and knobs)
  /// "matched", "missed", "extra", "minor" (found, though not among the main elements), "not observable" (a
  /// support that is not in the map because no sensor pose could show its top)
  std::string verdict;
  std::string map_name, truth_name;       ///< empty where there is none
  std::optional<double> height_error;     ///< map minus truth, metres
  std::optional<double> overlap;          ///< intersection over union of the outlines
  std::optional<double> offset_error;     ///< of a wall's or front's plane, metres
  std::optional<double> angle_error_deg;  ///< of a wall's or front's normal, of a handle's bar
  std::optional<double> centre_error;     ///< of a handle, metres
  std::optional<ComparedJoint> joint;     ///< of a front that moves in the truth
  /// Map minus truth, metres. Of a support: u min, u max, v min, v max in the truth's axes; of an opening:
  /// left, right, bottom, top, as seen from the room.
  std::array<double, 4> edge_errors{};
};

struct Comparison {
  std::vector<ComparedElement> elements;
  std::string map_source, truth_source;

  struct Counts {
    size_t matched = 0, missed = 0, extra = 0, minor = 0, not_observable = 0;
    std::optional<double> precision() const;  ///< unset where the map has none of the kind
    std::optional<double> recall() const;     ///< unset where the truth has none of the kind
  };
  Counts counts(const std::string& kind) const;
  /// Joints of the matched fronts: how many the truth has, and how many of them are of the right type.
  struct Joints {
    size_t asked = 0, right = 0, other_way = 0;
    double rate() const;
  };
  Joints joints() const;
  /// A figure of all matched elements of a kind, absolute, those that have it.
  std::vector<double> errors(const std::string& kind, std::optional<double> ComparedElement::*figure) const;
  /// Absolute errors of the edges of all matched elements of a kind.
  std::vector<double> edge_errors(const std::string& kind) const;
  std::vector<double> joint_errors(std::optional<double> ComparedJoint::*figure) const;
  /// A table per kind and a line of counts per kind.
  std::string text() const;
  Json report() const;
};

/// Supports match by height and overlap, best overlap first, each once; walls by angle, offset and shared
/// length, several pieces of a map may belong to one true wall; handles and knobs by the distance of their
/// centres, nearest first; fronts by their matched handles, then by overlap; openings by overlap, where the
/// truth lists them. With a region, only elements of
/// the truth in it are asked for, and furniture of the map outside of it is no mistake.
Comparison compare(const MapStructure& map, const MapStructure& truth, const ComparisonOptions& options);

/// Intersection over union of two patches, rastered at 5 mm.
double overlap_of(const SurfacePatch& a, const SurfacePatch& b);

}  // namespace loci::mapping
