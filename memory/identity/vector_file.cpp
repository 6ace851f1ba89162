#include "memory/identity/vector_file.h"

#include <fmt/format.h>

#include <cmath>

#include "mapping/base/text/json.h"

namespace loci::memory {
namespace {

class Reader {
 public:
  Reader(const Json& json, std::string file) : json_(json), file_(std::move(file)) {
    if (!json.is_object()) shape("", "an object was expected");
  }

  size_t count(const char* key) const {
    const Json& value = require(key);
    if (!value.is_number_integer() || value.get<double>() < 0) shape(key, "a count was expected");
    return value.get<size_t>();
  }

  const Json& array(const char* key, size_t size) const {
    const Json& value = require(key);
    check_size(value, size, key);
    return value;
  }

  void check_size(const Json& value, size_t size, const std::string& where) const {
    if (!value.is_array()) shape(where, "a list was expected");
    if (value.size() != size) shape(where, fmt::format("{} entries instead of {}", value.size(), size));
  }

  double number(const Json& value, const std::string& where) const {
    if (value.is_number()) return value.get<double>();
    // JSON has no NaN and no infinities; they come as text and are refused by value like any other.
    if (value.is_string()) {
      const auto& text = value.get_ref<const std::string&>();
      if (text == "nan" || text == "NaN") return std::nan("");
      if (text == "inf" || text == "Infinity") return -kNever;
      if (text == "-inf" || text == "-Infinity") return kNever;
    }
    throw Error("invalid_value: not a number", {file_, 0, where});
  }

  [[noreturn]] void shape(const std::string& where, const std::string& what) const {
    throw Error("invalid_shape: " + what, {file_, 0, where});
  }

  const Json& require(const char* key) const {
    const auto found = json_.find(key);
    if (found == json_.end()) shape(key, "missing");
    return *found;
  }

  void parameter(const char* key, double& value) const {
    const auto found = json_.find(key);
    if (found != json_.end()) value = number(*found, fmt::format("params.{}", key));
  }

  /// A log weight; null = weight zero.
  void prior(const char* key, double& value) const {
    const auto found = json_.find(key);
    if (found != json_.end())
      value = found->is_null() ? kNever : number(*found, fmt::format("params.{}", key));
  }

 private:
  const Json& json_;
  std::string file_;
};

std::vector<std::vector<std::optional<double>>> evidence(const Reader& reader, const char* key, size_t m,
                                                         size_t n) {
  const Json& rows = reader.array(key, m);
  std::vector<std::vector<std::optional<double>>> result(m);
  for (size_t o = 0; o < m; ++o) {
    reader.check_size(rows[o], n, fmt::format("{}[{}]", key, o));
    for (size_t k = 0; k < n; ++k) {
      const Json& value = rows[o][k];
      if (value.is_null())
        result[o].emplace_back();
      else
        result[o].emplace_back(reader.number(value, fmt::format("{}[{}][{}]", key, o, k)));
    }
  }
  return result;
}

IdentityOptions parameters(const Json& json, const std::string& file) {
  const Reader reader(json, file);
  IdentityOptions options;
  options.gate = 0;
  reader.parameter("eps", options.eps);
  reader.parameter("floor", options.floor);
  reader.parameter("prior_similar", options.prior_similar);
  reader.parameter("prior_proximity", options.prior_proximity);
  reader.parameter("gate", options.gate);
  reader.prior("b_stay", options.priors.stay);
  reader.prior("b_move", options.priors.move);
  reader.prior("b_newview", options.priors.newview);
  reader.prior("b_appear", options.priors.appear);
  reader.prior("b_clutter", options.priors.clutter);
  reader.prior("b_disappear", options.priors.disappear);
  reader.prior("b_missed", options.priors.missed);
  reader.prior("b_hidden", options.priors.hidden);
  return options;
}

Json rows_of(const PairTable& table) {
  Json rows = Json::array();
  for (Eigen::Index o = 0; o < table.rows(); ++o) {
    Json row = Json::array();
    for (Eigen::Index k = 0; k < table.cols(); ++k) row.push_back(table(o, k));
    rows.push_back(std::move(row));
  }
  return rows;
}

Json to_json(const Matching& matching) {
  Json pairs = Json::array();
  for (const auto& [o, k] : matching.pairs) pairs.push_back({o, k});
  return {
      {"pairs", pairs}, {"log_weight", matching.log_weight}, {"log_probability", matching.log_probability}};
}

}  // namespace

IdentityVector identity_vector_from_json(const Json& json, const std::string& file) {
  const Reader reader(json, file);
  IdentityVector vector;
  const size_t m = vector.problem.old_count = reader.count("old");
  const size_t n = vector.problem.new_count = reader.count("new");
  vector.problem.similar = evidence(reader, "similar", m, n);
  vector.problem.proximity = evidence(reader, "proximity", m, n);
  const Json& view = reader.array("out_of_view", m);
  for (size_t o = 0; o < m; ++o)
    vector.problem.out_of_view.push_back(reader.number(view[o], fmt::format("out_of_view[{}]", o)));
  const auto params = json.find("params");
  vector.options = parameters(params == json.end() ? Json::object() : *params, file);
  weights_of(vector.problem, vector.options, file);  // Refuses bad values with the file's name.
  return vector;
}

Json to_json(const IdentitySolution& solution) {
  Json json;
  json["stay"] = rows_of(solution.stay);
  json["move"] = rows_of(solution.move);
  json["newview"] = rows_of(solution.newview);
  json["not"] = rows_of(solution.none);
  json["appear"] = solution.appear;
  json["clutter"] = solution.clutter;
  json["disappear"] = solution.disappear;
  json["missed"] = solution.missed;
  json["hidden"] = solution.hidden;
  json["log_z"] = solution.log_z;
  json["log_evidence"] = solution.log_evidence;
  json["map"] = to_json(solution.map);
  json["map"]["unique"] = solution.map_unique;
  json["best"] = Json::array();
  for (const Matching& matching : solution.best) json["best"].push_back(to_json(matching));
  json["out_of_view"] = solution.out_of_view_posterior;
  json["gate_error_bound"] = solution.gate_bound;
  return json;
}

}  // namespace loci::memory
