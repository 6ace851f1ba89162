#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/options.h"
#include "mapping/exchange/map_structure.h"

namespace loci {

struct ComparisonOptions {
  double height_tolerance_m = 0.05;
  double overlap_min = 0.25;
  double wall_tolerance_m = 0.10;
  double wall_angle_deg = 10;
  std::string region;

  void declare(OptionTable& table);
};

/// One thing of the map, of the truth, or of both.
struct ComparedThing {
  std::string kind;     ///< "support", "wall", "floor"
  std::string verdict;  ///< "matched", "missed", "extra", "minor" (found, though not among the main things)
  std::string map_name, truth_name;       ///< empty where there is none
  std::optional<double> height_error;     ///< map minus truth, metres
  std::optional<double> overlap;          ///< intersection over union of the outlines
  std::optional<double> offset_error;     ///< of a wall's plane, metres
  std::optional<double> angle_error_deg;  ///< of a wall's normal
  std::array<double, 4>
      edge_errors{};  ///< of a support: u min, u max, v min, v max in the truth's axes, metres
};

struct Comparison {
  std::vector<ComparedThing> things;
  std::string map_source, truth_source;

  struct Counts {
    size_t matched = 0, missed = 0, extra = 0, minor = 0;
    double precision() const;
    double recall() const;
  };
  Counts counts(const std::string& kind) const;
  std::string text() const;
  Json report() const;
};

/// Supports match by height and overlap, best overlap first, each once; walls by angle, offset and shared
/// length, several pieces of a map may belong to one true wall. With a region, only things of the truth in it
/// are asked for.
Comparison compare(const MapStructure& map, const MapStructure& truth, const ComparisonOptions& options);

/// Intersection over union of two patches, rastered at 5 mm.
double overlap_of(const SurfacePatch& a, const SurfacePatch& b);

}  // namespace loci
