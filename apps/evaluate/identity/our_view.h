#pragma once

#include <vector>

#include "apps/evaluate/identity/model.h"
#include "memory/belief/likelihood.h"

namespace loci::apps::identity_experiment {

/// The tables cut into cells, side by side: the sensor sees all of a table's depth.
class Cells {
 public:
  static constexpr double kTable = 1.0;  ///< metres, both sides
  static constexpr size_t kStripes = 50;
  static constexpr double kArea = kTable * kTable / kStripes;

  explicit Cells(int tables) : tables_(tables) {}
  size_t count() const { return kStripes * static_cast<size_t>(tables_); }
  static size_t first(int table) { return kStripes * static_cast<size_t>(table); }
  double total_area() const { return tables_ * kTable * kTable; }

 private:
  int tables_;
};

/// Variances of what is measured.
struct Noise {
  double position = 0, color = 0;
};

/// What a scene shows, apart from all rates: likelihood ratios and what of the tables was in view.
struct ViewEvidence {
  memory::PairTable log_similar, log_proximity;
  std::vector<double> in_view;                 ///< per believed object: probability that its place is
  std::vector<double> cells;                   ///< share of each cell that is in view
  std::vector<std::vector<double>> from_cell;  ///< per measurement: probability of coming from the cell

  /// Density per square metre, where a measurement comes from, of what is spread over the cells.
  double density(size_t measurement, const std::vector<double>& in_cells) const;
  /// Part of it that is in view.
  double visible_part(const std::vector<double>& in_cells) const;
};

ViewEvidence evidence_of(const View& view, const Cells& cells, const Noise& noise,
                         const std::vector<Entry>& old, const std::vector<Measurement>& seen);

}  // namespace loci::apps::identity_experiment
