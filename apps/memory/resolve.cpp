#include <algorithm>

#include "apps/memory/commands.h"
#include "mapping/base/json.h"
#include "mapping/base/stopwatch.h"
#include "memory/identity/vector_file.h"

namespace loci::apps {

Command resolve_command() {
  return {"resolve",
          "Solves one identity problem exactly",
          {"loci-memory resolve tests/data/identity/two_by_two.json",
           "loci-memory resolve tests/data/identity/two_by_two.json --best 3"},
          [](ArgumentTable& table) {
            struct Arguments {
              std::string file;
              int best = 5;
            };
            auto arguments = std::make_shared<Arguments>();
            table.positional("FILE", &arguments->file, "Problem, JSON");
            table.option("--best", &arguments->best, "Ranked matchings to list", {.min = 0, .max = 10000});
            return [arguments](Session& session) {
              memory::IdentityVector vector =
                  memory::identity_vector_from_json(read_json(arguments->file), arguments->file);
              vector.options.best = arguments->best;
              const Stopwatch watch;
              const memory::IdentitySolution solution = solve(vector.problem, vector.options);
              session.timing("resolve", watch.seconds());
              if (solution.gate_bound > std::max(1e-6, 2 * vector.options.gate))
                session.warnings().add(
                    "probabilities are approximate: the problem is too large to solve without dropping pairs",
                    {arguments->file, 0, {}});
              const Json answer = to_json(solution);
              session.answer(answer.dump(), answer);
            };
          }};
}

}  // namespace loci::apps
