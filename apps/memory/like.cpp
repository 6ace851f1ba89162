#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"

namespace loci::apps {

Command like_command() {
  return {"like",
          "Which objects look like an object or an image",
          {"loci-memory like red -m demo-output/memory.loci",
           "loci-memory like red -m demo-output/memory.loci --json"},
          [](ArgumentTable& table) {
            struct Arguments {
              MemoryArguments memory;
              std::vector<std::string> subject;
              std::string image;
            };
            auto arguments = std::make_shared<Arguments>();
            arguments->memory.declare(table);
            table.positional("[OBJECT...]", &arguments->subject,
                             "object_12, a name, a colour, a size, \"on table_1\"");
            table.option("--image", &arguments->image, "A PNG or JPEG that the thing fills",
                         {.excludes = {"OBJECT"}});
            return [arguments](Session& session) {
              if (arguments->subject.empty() && arguments->image.empty())
                throw Error("nothing to compare with", {}, "name an object, or give --image FILE");
              const memory::Store store = memory::Store::open_read(arguments->memory.memory);
              memory::LikeQuestion question{.subject = joined(arguments->subject), .image = arguments->image};
              question.as_of = arguments->memory.as_of(store);
              answer_question(session, store, question);
            };
          }};
}

}  // namespace loci::apps
