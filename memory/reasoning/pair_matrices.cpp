#include "memory/reasoning/pair_matrices.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "mapping/base/text/json.h"
#include "memory/belief/evidence/similarity.h"
#include "memory/recorder/scene_reasoning.h"

namespace loci::memory {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

template <class Stored, class Value>
PairTable table_of(const belief::SceneMatrices& kept, const std::vector<Stored>& stored, Value value) {
  PairTable table(static_cast<Eigen::Index>(kept.rows), static_cast<Eigen::Index>(kept.keys.size()));
  for (Eigen::Index i = 0; i < table.size(); ++i) table.data()[i] = value(stored.at(static_cast<size_t>(i)));
  return table;
}

double value_of(uint8_t stored, double step) {
  return stored == belief::SceneMatrices::kNone8 ? kNothing : stored * step;
}

void read_outcomes(const belief::Decisions& decisions, const belief::SceneMatrices& kept,
                   PairMatrices& matrices) {
  matrices.is.setZero(static_cast<Eigen::Index>(kept.rows), static_cast<Eigen::Index>(kept.keys.size()));
  for (size_t k = 0; k < matrices.rows.size(); ++k) {
    const belief::ObservationDecision& decision = decisions.observations.at(k);
    PairMatrices::Row& row = matrices.rows[k];
    row.appear = decision.appear;
    row.clutter = decision.clutter;
    row.outcome = to_text(decision.explanation);
    for (size_t o = 0; o < kept.keys.size(); ++o) {
      for (const belief::Candidate& candidate : decision.candidates)
        if (candidate.key == kept.keys[o])
          matrices.is(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(o)) = candidate.probability();
      if (decision.key != kept.keys[o]) continue;
      row.column = o;
      matrices.columns[o].outcome = row.outcome;
    }
  }
  for (size_t o = 0; o < kept.keys.size(); ++o) {
    PairMatrices::Column& column = matrices.columns[o];
    column.unseen = std::clamp(1 - matrices.is.col(static_cast<Eigen::Index>(o)).sum(), 0.0, 1.0);
    for (const belief::ObjectDecision& unseen : decisions.unobserved)
      if (unseen.key == kept.keys[o]) column.outcome = to_text(unseen.explanation);
  }
}

std::string cell(double value, int decimals) {
  return std::isnan(value) ? "-" : fmt::format("{:.{}f}", value, decimals);
}

std::string table_text(const std::string& title, const PairMatrices& matrices, const PairTable& table,
                       int decimals) {
  std::string text = fmt::format("{:16}", title);
  for (const PairMatrices::Column& column : matrices.columns) text += fmt::format(" {:>10}", column.name);
  for (Eigen::Index k = 0; k < table.rows(); ++k) {
    text += fmt::format("\n  observation {:2}", k);
    for (Eigen::Index o = 0; o < table.cols(); ++o)
      text += fmt::format(" {:>10}", cell(table(k, o), decimals));
  }
  return text + "\n";
}

Json table_json(const PairTable& table) {
  Json rows = Json::array();
  for (Eigen::Index k = 0; k < table.rows(); ++k) {
    Json row = Json::array();
    for (Eigen::Index o = 0; o < table.cols(); ++o)
      row.push_back(std::isnan(table(k, o)) ? Json() : Json(std::round(table(k, o) * 1e4) / 1e4));
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

std::optional<PairMatrices> pair_matrices(const Store& store, Id scene) {
  const std::vector<ObservationRow> observations = store.observations(store.scene(scene).id);
  const std::optional<SceneReasoning> reasoning = load_reasoning(store, scene);
  if (!reasoning) return std::nullopt;
  const belief::SceneMatrices& kept = reasoning->matrices;
  if (kept.rows != observations.size() || kept.rows == 0) return std::nullopt;
  PairMatrices matrices;
  for (const ObservationRow& observation : observations) matrices.rows.push_back({observation.id});
  for (size_t o = 0; o < kept.keys.size(); ++o)
    matrices.columns.push_back({kept.objects[o], kept.objects[o] != 0 ? object_name(kept.objects[o])
                                                                      : fmt::format("(#{})", kept.keys[o])});
  for (size_t i = 0; i < kept.kinds.size(); ++i) {
    PairMatrices::Kind kind{kept.kinds[i], {}, {}};
    kind.distance = table_of(kept, kept.distances[i],
                             [](uint8_t v) { return value_of(v, belief::SceneMatrices::kDistanceStep); });
    kind.similarity = kind.distance;
    if (const belief::Comparison* comparison = belief::find_comparison(kind.name))
      for (double& value : kind.similarity.reshaped())
        value = belief::gaussian_similarity(value, comparison->sigma);
    matrices.kinds.push_back(std::move(kind));
  }
  matrices.similar = table_of(kept, kept.similarity, [](uint8_t v) { return value_of(v, 1.0 / 254); });
  matrices.distance = table_of(kept, kept.offsets, [](uint16_t v) {
    return v == belief::SceneMatrices::kNone16 ? kNothing : v * 0.001;
  });
  read_outcomes(reasoning->decisions, kept, matrices);
  return matrices;
}

std::string to_text(const PairMatrices& matrices) {
  if (matrices.columns.empty()) return {};
  std::string text = table_text("similar", matrices, matrices.similar, 2);
  for (const PairMatrices::Kind& kind : matrices.kinds)
    text += table_text("  " + kind.name, matrices, kind.similarity, 2);
  return text + table_text("distance, m", matrices, matrices.distance, 2) +
         table_text("is", matrices, matrices.is, 2);
}

Json to_json(const PairMatrices& matrices) {
  Json json = {{"observations", Json::array()}, {"objects", Json::array()}, {"annotations", Json::object()}};
  for (const PairMatrices::Row& row : matrices.rows)
    json["observations"].push_back(
        {{"id", row.observation},
         {"appear", row.appear},
         {"clutter", row.clutter},
         {"outcome", row.outcome},
         {"object", row.column ? Json(matrices.columns[*row.column].name) : Json()}});
  for (const PairMatrices::Column& column : matrices.columns)
    json["objects"].push_back(
        {{"name", column.name}, {"unseen", column.unseen}, {"outcome", column.outcome}});
  for (const PairMatrices::Kind& kind : matrices.kinds)
    json["annotations"][kind.name] = {{"distance", table_json(kind.distance)},
                                      {"similarity", table_json(kind.similarity)}};
  json["similar"] = table_json(matrices.similar);
  json["distance_m"] = table_json(matrices.distance);
  json["is"] = table_json(matrices.is);
  return json;
}

}  // namespace loci::memory
