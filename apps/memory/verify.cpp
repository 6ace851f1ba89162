#include <fmt/format.h>

#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"
#include "mapping/base/json.h"

namespace loci {
namespace {

Json report_json(const VerifyReport& report) {
  Json json = {{"ok", report.problems.empty()}, {"format", fmt::format("{}.{}", report.major, report.minor)}};
  json["problems"] = report.problems;
  json["rows"] = Json::object();
  for (const auto& [table, count] : report.counts) json["rows"][table] = count;
  return json;
}

std::string report_text(const VerifyReport& report) {
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
          "Checks a memory file",
          {"loci-memory verify -m demo-output/memory.loci",
           "loci-memory verify -m demo-output/memory.loci --json"},
          [](CLI::App& app) {
            auto memory = std::make_shared<std::string>();
            app.add_option("-m,--memory", *memory, "The memory, *.loci")->required();
            return [memory](Session& session) {
              const VerifyReport report = Store::open_read(*memory).verify(session.progress());
              session.answer(report_text(report), report_json(report));
              if (!report.problems.empty())
                throw Error(fmt::format("{} problems found", report.problems.size()), {*memory, 0, {}},
                            "restore it from a copy");
            };
          }};
}

}  // namespace loci
