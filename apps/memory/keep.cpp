// What is done with the file itself: its size, forgetting.

#include <fmt/format.h>

#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"
#include "mapping/base/json.h"
#include "memory/recorder/forget.h"
#include "memory/store/memory_file.h"

namespace loci::apps {
Command stat_command() {
  return {
      "stat",
      "Rows and bytes of the file by table",
      {"loci-memory stat -m demo-output/memory.loci", "loci-memory stat -m demo-output/memory.loci --json"},
      [](ArgumentTable& table) {
        auto memory = std::make_shared<std::string>();
        table.memory(*memory);
        return [memory](Session& session) {
          std::string text = fmt::format("{:24} {:>12} {:>14}\n", "table, with its indexes", "rows", "bytes");
          Json tables = Json::object();
          int64_t bytes = 0;
          for (const memory::Store::TableSize& size : memory::Store::open_read(*memory).statistics()) {
            text += fmt::format("{:24} {:12} {:14}\n", size.table, size.rows, size.bytes);
            tables[size.table] = {{"rows", size.rows}, {"bytes", size.bytes}};
            bytes += size.bytes;
          }
          text += fmt::format("{:24} {:>12} {:14}", "all", "", bytes);
          session.answer(text, {{"bytes", bytes}, {"tables", tables}});
        };
      }};
}

Command forget_command() {
  return {
      "forget",
      "Removes an object, or everything of a time, from the file for good",
      {"loci-memory forget object_1 -m demo-output/memory.loci -o demo-output/remaining.loci",
       "loci-memory forget --between 08:00 08:30 -m demo-output/memory.loci -o demo-output/remaining.loci "
       "--json"},
      [](ArgumentTable& table) {
        struct Arguments {
          std::string memory, object, output;
          SpanArguments span;
        };
        auto arguments = std::make_shared<Arguments>();
        table.memory(arguments->memory);
        table.positional("[OBJECT]", &arguments->object, "object_12");
        table.option("-o,--output", &arguments->output, "Forget in a copy and leave the memory as it is");
        arguments->span.declare(table);
        return [arguments](Session& session) {
          memory::ForgetRequest request;
          {
            const memory::Store store = memory::Store::open_read(arguments->memory);
            request.from = arguments->span.first(store);
            request.to = arguments->span.last(store);
          }
          const bool interval = request.from && request.to;
          if (!arguments->object.empty()) request.object = memory::object_id(arguments->object);
          if (request.object.has_value() == interval || (!request.object && !arguments->object.empty()))
            throw Error("either one object or two times are forgotten", {},
                        "loci-memory forget object_12, or --between A B");
          if (!arguments->output.empty()) memory::copy_memory(arguments->memory, arguments->output);
          memory::Store store =
              memory::Store::open_write(arguments->output.empty() ? arguments->memory : arguments->output);
          const memory::Id run = store.begin_run("loci-memory forget", "{}");
          const memory::ForgetResult result = forget(store, request, run);
          store.finish_run(run);
          session.answer(fmt::format("Forgotten: {} objects, {} observations, the images of {} scenes.",
                                     result.objects, result.observations, result.scenes),
                         {{"objects", result.objects},
                          {"observations", result.observations},
                          {"scenes", result.scenes}});
        };
      }};
}

}  // namespace loci::apps
