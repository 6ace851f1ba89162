#include "memory/exchange/object_model.h"

#include <fmt/format.h>

#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"
#include "mapping/base/files.h"
#include "mapping/exchange/ply.h"
#include "memory/questions/snapshot.h"

namespace loci::apps {
namespace {

/// The object that words mean; Error when they mean several.
memory::Id one_object(const memory::Store& store, const std::string& words, const memory::AsOf& as_of) {
  const memory::Snapshot snapshot(store, as_of);
  const std::vector<memory::Id> found = snapshot.find_objects(words);
  if (found.size() == 1) return found.front();
  throw Error(fmt::format("'{}' means {} objects", words, found.size()), {store.path().string(), 0, {}},
              fmt::format("{} is the most probable one", memory::object_name(found.front())));
}

}  // namespace

Command model_command() {
  return {
      "model",
      "What the observations of an object add up to: cloud, best images, evidence",
      {"loci-memory model object_1 -m demo-output/memory.loci -o demo-output/object_1.ply",
       "loci-memory model object_1 -m demo-output/memory.loci -o demo-output/object_1.ply --views 4 --json"},
      [](ArgumentTable& table) {
        struct Arguments {
          MemoryArguments memory;
          std::vector<std::string> subject;
          std::string output;
          memory::ObjectModelOptions options;
        };
        auto arguments = std::make_shared<Arguments>();
        arguments->memory.declare(table);
        table.positional("OBJECT...", &arguments->subject, "object_12, or words that mean one object");
        table.option("-o,--output", &arguments->output,
                     "PLY for the cloud; the best image per side is written beside it", {.required = true});
        table.options(table_of(arguments->options));
        return [arguments](Session& session) {
          table_of(arguments->options).validate();
          const memory::Store store = memory::Store::open_read(arguments->memory.memory);
          const memory::AsOf as_of = arguments->memory.as_of(store);
          const memory::ObjectModel model =
              model_of(store, one_object(store, joined(arguments->subject), as_of), arguments->options,
                       session.progress(), as_of);
          write_file_atomically(arguments->output, ply_text(model.cloud));
          Json json = model.report();
          json["cloud"] = arguments->output;
          json["images"] = Json::object();
          std::filesystem::path base = arguments->output;
          base.replace_extension();
          for (const auto& [side, crop] : model.best_crop) {
            const memory::BlobRow image = store.blob(crop);
            const std::string file =
                fmt::format("{}_{}.{}", base.string(), side, image.media == "image/png" ? "png" : "jpg");
            write_file_atomically(file, image.bytes);
            json["images"][side] = file;
          }
          session.answer(model.summary() + "Written to " + arguments->output + ".", json);
        };
      }};
}

}  // namespace loci::apps
