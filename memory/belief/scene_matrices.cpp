#include "memory/belief/scene_matrices.h"

#include <algorithm>
#include <cmath>

namespace loci::memory::belief {
namespace {

uint8_t rounded(double value, double step) {
  if (!std::isfinite(value)) return SceneMatrices::kNone8;
  return static_cast<uint8_t>(std::clamp(std::round(value / step), 0.0, 254.0));
}

uint16_t millimetres(double metres) {
  const double mm = std::round(1000 * metres);
  return mm < SceneMatrices::kNone16 ? static_cast<uint16_t>(mm) : SceneMatrices::kNone16;
}

std::vector<Eigen::Index> columns_of(const BeliefUpdate& update, const Decisions& decisions) {
  std::vector<Eigen::Index> columns;
  for (size_t o = 0; o < update.objects.size(); ++o) {
    const ObjectOutcome& outcome = update.objects[o];
    const bool considered =
        std::ranges::any_of(decisions.observations, [&](const ObservationDecision& decision) {
          return std::ranges::any_of(decision.candidates,
                                     [&](const Candidate& c) { return c.key == outcome.key; });
        });
    if (considered || outcome.visibility.out_of_view < 0.99) columns.push_back(static_cast<Eigen::Index>(o));
  }
  return columns;
}

}  // namespace

SceneMatrices matrices_of(const BeliefUpdate& update, const Decisions& decisions) {
  SceneMatrices matrices;
  const PairEvidence& evidence = update.evidence;
  const std::vector<Eigen::Index> columns = columns_of(update, decisions);
  matrices.rows = static_cast<uint32_t>(update.observations.size());
  for (const Eigen::Index o : columns) {
    matrices.keys.push_back(update.objects[static_cast<size_t>(o)].key);
    matrices.objects.push_back(update.objects[static_cast<size_t>(o)].object);
  }
  for (const PairEvidence::Distances& d : evidence.distances) {
    matrices.kinds.push_back(d.kind);
    std::vector<uint8_t>& table = matrices.distances.emplace_back();
    for (Eigen::Index k = 0; k < evidence.offset.cols(); ++k)
      for (const Eigen::Index o : columns)
        table.push_back(rounded(d.distance(o, k), SceneMatrices::kDistanceStep));
  }
  for (Eigen::Index k = 0; k < evidence.offset.cols(); ++k)
    for (const Eigen::Index o : columns) {
      matrices.offsets.push_back(millimetres(evidence.offset(o, k)));
      matrices.closeness.push_back(rounded(evidence.closeness(o, k), 1.0 / 254));
    }
  return matrices;
}

}  // namespace loci::memory::belief
