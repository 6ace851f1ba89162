#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "memory/identity/problem.h"

namespace loci::memory {
namespace {

[[noreturn]] void bad_shape(const std::string& file, const std::string& where, const std::string& what) {
  throw Error("invalid_shape: " + what, {file, 0, where});
}

[[noreturn]] void bad_value(const std::string& file, const std::string& where, double value,
                            const std::string& wanted = "a number in [0,1]") {
  throw Error(fmt::format("invalid_value: {} is not {}", value, wanted), {file, 0, where});
}

bool in_unit(double value) {
  return value >= 0 && value <= 1;
}

void check_options(const IdentityOptions& options, const std::string& file) {
  const auto unit = [&](const char* name, double value) {
    if (!in_unit(value)) bad_value(file, fmt::format("params.{}", name), value);
  };
  unit("prior_similar", options.prior_similar);
  unit("prior_proximity", options.prior_proximity);
  if (!(options.eps > 0 && options.eps < 1)) bad_value(file, "params.eps", options.eps, "in (0,1)");
  if (!(options.floor >= 0 && options.floor <= 1 - options.eps))
    bad_value(file, "params.floor", options.floor, "in [0, 1 - eps]");
  if (!(options.gate >= 0 && options.gate < 1)) bad_value(file, "params.gate", options.gate, "in [0,1)");
  const ExplanationPriors& p = options.priors;
  const std::pair<const char*, double> priors[] = {{"b_stay", p.stay},       {"b_move", p.move},
                                                   {"b_newview", p.newview}, {"b_appear", p.appear},
                                                   {"b_clutter", p.clutter}, {"b_disappear", p.disappear},
                                                   {"b_missed", p.missed},   {"b_hidden", p.hidden}};
  for (const auto& [name, value] : priors)
    if (std::isnan(value) || value > 700 || (value < -700 && value != kNever))
      bad_value(file, fmt::format("params.{}", name), value, "a log-odds of at most 700");
}

using Rows = std::vector<std::vector<std::optional<double>>>;

void check_evidence(const std::string& file, const std::string& name, const Rows& rows, size_t m, size_t n) {
  if (rows.size() != m)
    bad_shape(file, name, fmt::format("{} rows, but there are {} old objects", rows.size(), m));
  for (size_t o = 0; o < m; ++o) {
    if (rows[o].size() != n)
      bad_shape(file, fmt::format("{}[{}]", name, o),
                fmt::format("{} entries, but there are {} new observations", rows[o].size(), n));
    for (size_t k = 0; k < n; ++k)
      if (rows[o][k] && !in_unit(*rows[o][k]))
        bad_value(file, fmt::format("{}[{}][{}]", name, o, k), *rows[o][k]);
  }
}

void check_view(const std::string& file, const std::vector<double>& view, size_t m) {
  if (view.size() != m)
    bad_shape(file, "out_of_view", fmt::format("{} entries, but there are {} old objects", view.size(), m));
  for (size_t o = 0; o < m; ++o)
    if (!in_unit(view[o])) bad_value(file, fmt::format("out_of_view[{}]", o), view[o]);
}

/// Sum of the logs of many factors in (0,1] with few calls of log.
class LogProduct {
 public:
  void multiply(double factor) {
    product_ *= factor;
    if (product_ < 1e-200) flush();
  }
  double log() {
    flush();
    return sum_;
  }

 private:
  void flush() {
    sum_ += std::log(product_);
    product_ = 1;
  }
  double product_ = 1;
  double sum_ = 0;
};

IdentityWeights empty_weights(size_t m, size_t n) {
  IdentityWeights weights;
  const auto rows = static_cast<Eigen::Index>(m);
  const auto columns = static_cast<Eigen::Index>(n);
  for (PairTable* table : {&weights.stay, &weights.move, &weights.newview, &weights.total})
    table->setConstant(rows, columns, kNever);
  return weights;
}

void fill_alone(IdentityWeights& weights, const std::vector<double>& view, size_t n,
                const ExplanationPriors& priors) {
  weights.out_of_view = view;
  weights.appear.assign(n, priors.appear);
  weights.clutter.assign(n, priors.clutter);
  for (const double v : view) {
    weights.disappear.push_back(std::log1p(-v) + priors.disappear);
    weights.missed.push_back(std::log1p(-v) + priors.missed);
    weights.hidden.push_back(std::log(v) + priors.hidden);
  }
}

void add_to(std::vector<double>& weights, const std::vector<double>& added, const char* name) {
  if (added.empty()) return;
  if (added.size() != weights.size())
    bad_shape({}, name, fmt::format("{} entries instead of {}", added.size(), weights.size()));
  for (size_t i = 0; i < added.size(); ++i) {
    if (std::isnan(added[i]) || added[i] > 700)
      bad_value({}, fmt::format("{}[{}]", name, i), added[i], "a log-odds");
    weights[i] += added[i];
  }
}

void check_table(const PairTable& table, const PairTable& like, const char* name) {
  if (table.rows() != like.rows() || table.cols() != like.cols())
    bad_shape(
        {}, name,
        fmt::format("{} x {} instead of {} x {}", table.rows(), table.cols(), like.rows(), like.cols()));
  for (Eigen::Index o = 0; o < table.rows(); ++o)
    for (Eigen::Index k = 0; k < table.cols(); ++k)
      if (std::isnan(table(o, k)) || table(o, k) == -kNever)
        bad_value({}, fmt::format("{}[{}][{}]", name, o, k), table(o, k), "a log-odds");
}

}  // namespace

double log_add(double a, double b) {
  if (a < b) std::swap(a, b);
  return b == kNever ? a : a + std::log1p(std::exp(b - a));
}

void IdentityOptions::declare(OptionTable& table) {
  table.number("eps", eps, "", "Similarity and proximity are clamped to at most one minus this.", 1e-12, 0.5);
  table.number("floor", floor, "", "Similarity and proximity are clamped to at least this.", 0, 0.5);
  table.number("prior_similar", prior_similar, "", "Stands in for a missing similarity.", 0, 1);
  table.number("prior_proximity", prior_proximity, "", "Stands in for a missing proximity.", 0, 1);
  table.number("gate", gate, "", "Total variation that may be given up to split the problem.", 0, 0.1);
  table.integer("best", best, "", "Ranked matchings to list.", 0, 10000);
}

IdentityWeights weights_of(const IdentityProblem& problem, const IdentityOptions& options,
                           const std::string& file) {
  const size_t m = problem.old_count, n = problem.new_count;
  check_options(options, file);
  check_evidence(file, "similar", problem.similar, m, n);
  check_evidence(file, "proximity", problem.proximity, m, n);
  check_view(file, problem.out_of_view, m);

  IdentityWeights weights = empty_weights(m, n);
  fill_alone(weights, problem.out_of_view, n, options.priors);
  const double stay_prior = std::exp(options.priors.stay), move_prior = std::exp(options.priors.move),
               newview_prior = std::exp(options.priors.newview);
  LogProduct reference;
  for (size_t o = 0; o < m; ++o) {
    const double in_view = 1 - problem.out_of_view[o];
    const double log_in_view = std::log1p(-problem.out_of_view[o]);
    for (size_t k = 0; k < n; ++k) {
      const double s =
          std::clamp(problem.similar[o][k].value_or(options.prior_similar), options.floor, 1 - options.eps);
      const double p = std::clamp(problem.proximity[o][k].value_or(options.prior_proximity), options.floor,
                                  1 - options.eps);
      reference.multiply(1 - s);
      reference.multiply(1 - p);
      const double sigma = s / (1 - s), pi = p / (1 - p);
      const double total =
          in_view * sigma * pi * stay_prior + sigma * move_prior + in_view * pi * newview_prior;
      if (!(total > 0)) continue;
      const auto row = static_cast<Eigen::Index>(o), column = static_cast<Eigen::Index>(k);
      const double log_sigma = std::log(sigma), log_pi = std::log(pi);
      weights.stay(row, column) = log_in_view + log_sigma + log_pi + options.priors.stay;
      weights.move(row, column) = log_sigma + options.priors.move;
      weights.newview(row, column) = log_in_view + log_pi + options.priors.newview;
      weights.total(row, column) = std::log(total);
    }
  }
  weights.log_reference = reference.log();
  return weights;
}

IdentityWeights weights_of(const LogOddsProblem& problem, const IdentityOptions& options) {
  const PairTable& like = problem.log_similar;
  const auto m = static_cast<size_t>(like.rows()), n = static_cast<size_t>(like.cols());
  check_options(options, {});
  check_table(like, like, "log_similar");
  check_table(problem.log_proximity, like, "log_proximity");
  for (const auto& [table, name] :
       {std::pair{&problem.stay_prior, "stay_prior"}, std::pair{&problem.move_prior, "move_prior"},
        std::pair{&problem.newview_prior, "newview_prior"}})
    if (table->size() > 0) check_table(*table, like, name);
  check_view({}, problem.out_of_view, m);

  IdentityWeights weights = empty_weights(m, n);
  fill_alone(weights, problem.out_of_view, n, options.priors);
  add_to(weights.appear, problem.appear_prior, "appear_prior");
  add_to(weights.clutter, problem.clutter_prior, "clutter_prior");
  add_to(weights.disappear, problem.disappear_prior, "disappear_prior");
  add_to(weights.missed, problem.missed_prior, "missed_prior");
  add_to(weights.hidden, problem.hidden_prior, "hidden_prior");

  // Only where doubles end: products over many pairs are kept in range part by part (components.cpp), and
  // strong evidence against a pair is what lets the problem fall into parts.
  const auto limited = [](double value) {
    return value == kNever ? value : std::clamp(value, -700.0, 700.0);
  };
  const auto prior = [](const PairTable& table, Eigen::Index o, Eigen::Index k, double common) {
    return common + (table.size() > 0 ? table(o, k) : 0.0);
  };
  for (Eigen::Index o = 0; o < like.rows(); ++o) {
    const double log_in_view = std::log1p(-problem.out_of_view[static_cast<size_t>(o)]);
    for (Eigen::Index k = 0; k < like.cols(); ++k) {
      const double log_sigma = limited(like(o, k)), log_pi = limited(problem.log_proximity(o, k));
      weights.stay(o, k) =
          log_in_view + log_sigma + log_pi + prior(problem.stay_prior, o, k, options.priors.stay);
      weights.move(o, k) = log_sigma + prior(problem.move_prior, o, k, options.priors.move);
      weights.newview(o, k) =
          log_in_view + log_pi + prior(problem.newview_prior, o, k, options.priors.newview);
      weights.total(o, k) = log_add(log_add(weights.stay(o, k), weights.move(o, k)), weights.newview(o, k));
      weights.log_reference -= log_add(0, log_sigma) + log_add(0, log_pi);
    }
  }
  return weights;
}

}  // namespace loci::memory
