#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "mapping/base/files.h"
#include "mapping/base/math/random.h"
#include "memory/identity/solution.h"
#include "tests/support/mln/markov_logic.h"

namespace loci::memory::test {
namespace {

IdentityProblem random_problem(size_t m, size_t n, Random& random) {
  IdentityProblem problem;
  problem.old_count = m;
  problem.new_count = n;
  for (size_t o = 0; o < m; ++o) {
    auto& similar = problem.similar.emplace_back();
    auto& proximity = problem.proximity.emplace_back();
    for (size_t k = 0; k < n; ++k) {
      similar.emplace_back(random.uniform(0.02, 0.98));
      proximity.emplace_back(random.uniform(0.02, 0.98));
    }
    problem.out_of_view.push_back(random.index(3) == 0 ? 1.0 : random.uniform());
  }
  return problem;
}

std::string domain(const std::string& name, char letter, size_t count) {
  std::string text = name + " = {";
  for (size_t i = 0; i < count; ++i) text += fmt::format("{}{}{}", i > 0 ? ", " : "", letter, i);
  return text + "}\n";
}

mln::Marginals by_the_network(const IdentityProblem& problem) {
  mln::Network network;
  const std::filesystem::path file =
      std::filesystem::path(LOCI_SOURCE_DIR) / "tests/support/mln/object_identity.mln";
  network.read(read_file(file), file.string());
  std::string evidence =
      domain("oldCluster", 'O', problem.old_count) + domain("newCluster", 'N', problem.new_count);
  for (size_t o = 0; o < problem.old_count; ++o) {
    for (size_t k = 0; k < problem.new_count; ++k) {
      evidence += fmt::format("{:.17f} similar(O{},N{})\n", *problem.similar[o][k], o, k);
      evidence += fmt::format("{:.17f} proximity(O{},N{})\n", *problem.proximity[o][k], o, k);
    }
    evidence += fmt::format("{:.17f} outOfView(O{})\n", problem.out_of_view[o], o);
  }
  network.read_evidence(evidence);
  return mln::enumerate(mln::ground(network));
}

void expect_same(const IdentityProblem& problem) {
  const IdentitySolution solution = solve(problem);
  const mln::Marginals marginals = by_the_network(problem);
  EXPECT_NEAR(solution.log_evidence, marginals.log_z, 1e-9);
  const auto expect = [&](double value, const std::string& atom) {
    EXPECT_NEAR(value, marginals.of(atom), 1e-9) << atom;
  };
  for (size_t o = 0; o < problem.old_count; ++o) {
    const auto row = static_cast<Eigen::Index>(o);
    for (size_t k = 0; k < problem.new_count; ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      expect(solution.stay(row, column), fmt::format("is(O{},N{},stay)", o, k));
      expect(solution.move(row, column), fmt::format("is(O{},N{},move)", o, k));
      expect(solution.newview(row, column), fmt::format("is(O{},N{},newview)", o, k));
      expect(solution.none(row, column), fmt::format("is(O{},N{},not)", o, k));
    }
    expect(solution.disappear[o], fmt::format("disappear(O{})", o));
    expect(solution.hidden[o], fmt::format("hidden(O{})", o));
    expect(solution.out_of_view_posterior[o], fmt::format("outOfView(O{})", o));
  }
  for (size_t k = 0; k < problem.new_count; ++k) expect(solution.appear[k], fmt::format("appear(N{})", k));
}

TEST(MarkovLogic, ProvesTheSpecialSolverRightOnTable61) {
  Random random(61);
  for (const auto& [m, n] : {std::pair<size_t, size_t>{1, 1}, {1, 3}, {2, 1}, {2, 2}, {3, 2}, {2, 3}, {3, 3}})
    for (int repeat = 0; repeat < 3; ++repeat) expect_same(random_problem(m, n, random));
}

TEST(MarkovLogic, WeighsWorldsByTheirTrueSoftFormulas) {
  mln::Network network;
  network.read(
      "smokes(person)\nfriends(person, person)\n0.7 smokes(x)\n1.1 friends(x,y) ^ smokes(x) => smokes(y)\n");
  network.read_evidence("person = {A, B}\nfriends(A,B)\n!friends(B,A)\n!friends(A,A)\n!friends(B,B)\n");
  const mln::Marginals marginals = mln::enumerate(mln::ground(network));
  // Four worlds of smokes; the implication holds four times but in "A smokes, B does not" three times.
  const double a = std::exp(0.7), f = std::exp(1.1);
  const double z = f + a + a * f + a * a * f;  // none, A, B, both, divided by f³
  EXPECT_NEAR(marginals.of("smokes(A)"), (a + a * a * f) / z, 1e-12);
  EXPECT_NEAR(marginals.of("smokes(B)"), (a * f + a * a * f) / z, 1e-12);
  EXPECT_EQ(marginals.worlds, 4U);
}

TEST(MarkovLogic, NamesLineAndReasonOfWhatItDoesNotUnderstand) {
  const auto message = [](const std::string& text) {
    try {
      mln::Network().read(text, "x.mln");
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_NE(message("p(d)\nq(x) => p(x).").find("x.mln:2"), std::string::npos);
  EXPECT_NE(message("p(d)\np(x) ^ q(x).").find("no predicate 'q'"), std::string::npos);
  EXPECT_NE(message("p(d)\np(x,y).").find("takes 1 arguments"), std::string::npos);
  EXPECT_NE(message("p(d)\n1.5 p(x) & p(y)").find("unknown character '&'"), std::string::npos);
  EXPECT_NE(message("p(d!, e!)").find("only one argument"), std::string::npos);
}

TEST(MarkovLogic, RefusesWhatHasNoWorldOrTooMany) {
  mln::Network network;
  network.read("p(d)\np(x).\n");
  network.read_evidence("d = {A}\n!p(A)\n");
  EXPECT_THROW(mln::enumerate(mln::ground(network)), Error);
  mln::Network large;
  large.read("d = {A,B,C,D,E,F,G,H}\np(d)\n0.5 p(x)\n");
  EXPECT_THROW(mln::enumerate(mln::ground(large), 100), Error);
}

}  // namespace
}  // namespace loci::memory::test
