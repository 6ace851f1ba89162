#include <algorithm>

#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"

namespace loci {
namespace {

/// "X on PLACE", "X in PLACE", "X PLACE" or "X" alone.
void read_words(std::vector<std::string> words, WasQuestion& question) {
  const auto preposition = std::find_if(words.begin(), words.end(),
                                        [](const std::string& word) { return word == "on" || word == "in"; });
  if (preposition != words.end() && preposition != words.begin() && preposition + 1 != words.end()) {
    question.place = joined({preposition + 1, words.end()});
    words.erase(preposition, words.end());
  } else if (words.size() > 1) {
    question.place = words.back();
    words.pop_back();
  }
  question.subject = joined(words);
}

}  // namespace

Command was_command() {
  return {"was",
          "Was X there between two times: yes, no, or not observed",
          {"loci-memory was red on table_1 --between 08:00 09:00 -m demo-output/memory.loci",
           "loci-memory was object_1 in drawer_1 --between 08:00 18:00 -m demo-output/memory.loci --json"},
          [](CLI::App& app) {
            struct Arguments {
              MemoryArguments memory;
              SpanArguments span;
              std::vector<std::string> words;
            };
            auto arguments = std::make_shared<Arguments>();
            arguments->memory.declare(app);
            arguments->span.declare(app);
            app.add_option("words", arguments->words, "X [on|in] PLACE")->required();
            return [arguments](Session& session) {
              const Store store = Store::open_read(arguments->memory.memory);
              const auto scenes = store.scenes();
              WasQuestion question;
              question.as_of = arguments->memory.as_of(store);
              // Without times: over all that the memory has.
              question.from = arguments->span.first(store).value_or(scenes.empty() ? 0 : scenes.front().time);
              question.to = arguments->span.last(store).value_or(scenes.empty() ? 0 : scenes.back().time);
              read_words(arguments->words, question);
              answer_question(session, store, question);
            };
          }};
}

}  // namespace loci
