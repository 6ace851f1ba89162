#include <fmt/format.h>

#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"
#include "mapping/base/json.h"

namespace loci::apps {
namespace {

Json report_json(const memory::VerifyReport& report) {
  Json json = {{"ok", report.problems.empty()}, {"format", fmt::format("{}.{}", report.major, report.minor)}};
  json["problems"] = report.problems;
  json["rows"] = Json::object();
  for (const auto& [table, count] : report.counts) json["rows"][table] = count;
  return json;
}

std::string report_text(const memory::VerifyReport& report) {
  std::string text =
      fmt::format("The memory is {}, format {}.{}:", report.problems.empty() ? "sound" : "NOT sound",
                  report.major, report.minor);
  for (const auto& [table, count] : report.counts)
    if (count > 0) text += fmt::format(" {} {},", count, table);
  text.back() = '.';
  for (const std::string& problem : report.problems) text += "\n  " + problem;
  return text;
}

}  // namespace

Command verify_command() {
  return {"verify",
          "Checks a memory file, and makes anew what follows from other rows",
          {"loci-memory verify -m demo-output/memory.loci",
           "loci-memory verify --repair -m demo-output/memory.loci --json"},
          [](ArgumentTable& table) {
            struct Arguments {
              std::string memory;
              bool repair = false;
            };
            auto arguments = std::make_shared<Arguments>();
            table.memory(arguments->memory);
            table.flag("--repair", arguments->repair,
                       "Where stays, words or marks of objects are not what the rows say, make them anew");
            return [arguments](Session& session) {
              memory::VerifyReport report =
                  memory::Store::open_read(arguments->memory).verify(session.progress());
              const size_t repaired = arguments->repair ? report.derived_problems.size() : 0;
              if (repaired > 0) {
                memory::Store store = memory::Store::open_write(arguments->memory);
                const memory::Id run = store.begin_run("loci-memory verify --repair", "{}");
                store.derive();
                store.finish_run(run);
                report = store.verify(session.progress());
              }
              Json json = report_json(report);
              std::string text = report_text(report);
              if (arguments->repair) {
                json["repaired"] = repaired;
                text = fmt::format("{} problems repaired. ", repaired) + text;
              }
              session.answer(text, json);
              if (!report.problems.empty())
                throw Error(fmt::format("{} problems found", report.problems.size()),
                            {arguments->memory, 0, {}},
                            report.derived_problems.size() == report.problems.size()
                                ? "loci-memory verify --repair makes them good"
                                : "restore it from a copy");
            };
          }};
}

}  // namespace loci::apps
