#include "apps/evaluate/commands.h"
#include "apps/evaluate/questions/judge.h"
#include "mapping/base/files.h"
#include "mapping/base/temporary_folder.h"
#include "mapping/base/text/json.h"

namespace loci::apps {
namespace {

struct Arguments {
  std::vector<std::string> tables;
  std::string samples = "apps/samples", days = "tests/data/questions/days", keep;
  bool all = false;
};

void run(const Arguments& arguments, Session& session) {
  const TemporaryFolder temporary("loci-evaluate-questions");
  const std::filesystem::path folder =
      arguments.keep.empty() ? temporary.path() : std::filesystem::path(arguments.keep);
  make_folder(folder);
  std::map<std::string, std::vector<questions::AskedQuestion>> by_memory;
  for (const std::string& table : arguments.tables)
    for (questions::AskedQuestion& asked : questions::read_table(table))
      by_memory[asked.memory].push_back(std::move(asked));
  questions::QuestionFigures figures;
  double done = 0;
  for (const auto& [name, asked] : by_memory) {
    const double share = 1 / static_cast<double>(by_memory.size());
    PartialProgress progress(session.progress(), done, done + share);
    done += share;
    const questions::AskedMemory memory =
        questions::asked_memory(name, folder, {arguments.samples, arguments.days}, session.flags().threads,
                                progress, session.warnings());
    const memory::Store store = memory::Store::open_read(memory.file);
    for (const questions::AskedQuestion& one : asked)
      figures.answers.push_back(judge(one, store, memory.names, memory.twins));
  }
  session.answer(text_of(figures, arguments.all), json_of(figures));
}

}  // namespace

Command questions_command() {
  return {"questions",
          "Everyday questions in words against the truth of simulated days",
          {"loci-evaluate questions tests/data/questions/everyday_tuning.yaml -o demo-output/questions",
           "loci-evaluate questions tests/data/questions/held_out.yaml -o demo-output/questions --json"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<Arguments>();
            table.positional("TABLE...", &arguments->tables, "Questions with their answers, as YAML");
            table.flag("--all", arguments->all, "Print every answer, not only those that are not right");
            table.option("--samples FOLDER", &arguments->samples, "Folder of the sample day");
            table.option("--days FOLDER", &arguments->days,
                         "Folder of the scenarios that a table names as memories");
            table.option("-o,--output FOLDER", &arguments->keep,
                         "Keep recordings and memories in this folder; what is there is used again");
            return [arguments](Session& session) { run(*arguments, session); };
          }};
}

}  // namespace loci::apps
