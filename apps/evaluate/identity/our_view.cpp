#include "apps/evaluate/identity/our_view.h"

#include <algorithm>
#include <cmath>

namespace loci::apps::identity_experiment {
namespace {

using memory::belief::Domain;
using memory::belief::Measured;

constexpr double kTiny = 1e-12;
constexpr double kWidth = Cells::kTable / Cells::kStripes;

double log_color(const Entry& entry, const Measurement& seen, double variance) {
  double sum = 0;
  for (int i = 0; i < 3; ++i)
    sum += memory::belief::log_same({entry.fused.color[i], variance / entry.color_looks}, {0, 1},
                                    {seen.color[i], variance}, {0, 1});
  return sum;
}

double log_position(const Entry& entry, const Measurement& seen, double variance, const Domain& visible) {
  const Domain table{0, Cells::kTable};
  double sum = 0;
  for (int i = 0; i < 2; ++i)
    sum += memory::belief::log_same({entry.fused.position[i], variance / entry.position_looks}, table,
                                    {seen.position[i], variance}, i == 0 ? visible : table);
  return sum;
}

std::vector<double> cells_in_view(const View& view, const Cells& cells, const Domain& visible) {
  std::vector<double> shares(cells.count(), 0.0);
  for (size_t i = 0; i < Cells::kStripes; ++i) {
    const double low = static_cast<double>(i) * kWidth;
    const double inside = std::min(visible.high, low + kWidth) - std::max(visible.low, low);
    shares[Cells::first(view.table) + i] = std::clamp(inside / kWidth, 0.0, 1.0);
  }
  return shares;
}

std::vector<double> origin_of(const Measurement& seen, int table, const std::vector<double>& in_view,
                              double variance) {
  std::vector<double> shares(in_view.size(), 0.0);
  double sum = 0;
  for (size_t i = 0; i < Cells::kStripes; ++i) {
    const size_t cell = Cells::first(table) + i;
    if (in_view[cell] == 0) continue;
    const double distance = (static_cast<double>(i) + 0.5) * kWidth - seen.position.x();
    shares[cell] = kTiny + in_view[cell] * std::exp(-0.5 * distance * distance / variance);
    sum += shares[cell];
  }
  for (double& share : shares) share /= sum;
  return shares;
}

}  // namespace

double ViewEvidence::density(size_t measurement, const std::vector<double>& in_cells) const {
  double sum = 0;
  for (size_t i = 0; i < in_cells.size(); ++i) sum += from_cell[measurement][i] * in_cells[i];
  return sum / Cells::kArea;
}

double ViewEvidence::visible_part(const std::vector<double>& in_cells) const {
  double sum = 0;
  for (size_t i = 0; i < in_cells.size(); ++i) sum += cells[i] * in_cells[i];
  return sum;
}

ViewEvidence evidence_of(const View& view, const Cells& cells, const Noise& noise,
                         const std::vector<Entry>& old, const std::vector<Measurement>& seen) {
  const Domain visible{std::max(0.0, view.centre - view.half),
                       std::min(Cells::kTable, view.centre + view.half)};
  ViewEvidence evidence;
  evidence.cells = cells_in_view(view, cells, visible);
  for (const Measurement& measurement : seen)
    evidence.from_cell.push_back(origin_of(measurement, view.table, evidence.cells, noise.position));
  const auto m = static_cast<Eigen::Index>(old.size()), n = static_cast<Eigen::Index>(seen.size());
  evidence.log_similar.setZero(m, n);
  evidence.log_proximity.setConstant(m, n, memory::kNever);
  for (Eigen::Index o = 0; o < m; ++o) {
    const Entry& entry = old[static_cast<size_t>(o)];
    const bool same_table = entry.last.table == view.table;
    const Measured x{entry.fused.position.x(), noise.position / entry.position_looks};
    const double in_view =
        same_table ? std::clamp(mass(x, visible) / mass(x, {0, Cells::kTable}), kTiny, 1 - kTiny) : kTiny;
    evidence.in_view.push_back(in_view);
    for (Eigen::Index k = 0; k < n; ++k) {
      const Measurement& measurement = seen[static_cast<size_t>(k)];
      evidence.log_similar(o, k) = log_color(entry, measurement, noise.color);
      if (same_table)
        evidence.log_proximity(o, k) =
            log_position(entry, measurement, noise.position, visible) - std::log(in_view);
    }
  }
  return evidence;
}

}  // namespace loci::apps::identity_experiment
