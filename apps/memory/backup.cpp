// Copies of a memory that are verified.

#include <fmt/format.h>

#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"
#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "memory/store/memory_file.h"

namespace loci::apps {
namespace {

void answer(Session& session, const std::string& done, const memory::BackupResult& result,
            const std::string& file) {
  int64_t scenes = 0;
  for (const auto& [table, count] : result.report.counts)
    if (table == "scene") scenes = count;
  session.answer(fmt::format("{} {}: {}, {} bytes, verified.", done, file, counted(size_t(scenes), "scene"),
                             result.bytes),
                 {{"file", file}, {"scenes", scenes}, {"bytes", result.bytes}, {"ok", true}});
}

}  // namespace

Command backup_command() {
  return {"backup",
          "Copy a memory, also while a program writes to it, and verify the copy",
          {"loci-memory backup -m demo-output/memory.loci -o demo-output/backup.loci",
           "loci-memory backup -m demo-output/memory.loci -o demo-output/second_backup.loci --json"},
          [](ArgumentTable& table) {
            struct Arguments {
              std::string memory, output;
            };
            auto arguments = std::make_shared<Arguments>();
            table.memory(arguments->memory);
            table.output("BACKUP", &arguments->output, "The copy, a file that is not there yet");
            return [arguments](Session& session) {
              answer(session, "Backed up to",
                     memory::backup_memory(memory_file(arguments->memory, session), arguments->output,
                                           session.progress()),
                     arguments->output);
            };
          }};
}

Command restore_command() {
  return {"restore",
          "Verify a backup and make it the memory",
          {"loci-memory restore demo-output/memory.loci -o demo-output/restored.loci",
           "loci-memory restore demo-output/memory.loci -o demo-output/restored.loci --force --json"},
          [](ArgumentTable& table) {
            struct Arguments {
              std::string backup, output;
              bool force = false;
            };
            auto arguments = std::make_shared<Arguments>();
            table.positional("BACKUP", &arguments->backup, "What loci-memory backup wrote");
            table.output("MEMORY", &arguments->output, "The memory to make");
            table.flag("--force", arguments->force,
                       "Replace a memory that is there and that no program has open");
            return [arguments](Session& session) {
              const Replace replace = arguments->force ? Replace::anything : Replace::nothing;
              answer(
                  session, "Restored",
                  memory::restore_memory(arguments->backup, arguments->output, replace, session.progress()),
                  arguments->output);
            };
          }};
}

}  // namespace loci::apps
