// A program outside of loci: where FILE.loci [OBJECT] answers a question and lists the last views of the
// object.

#include <iostream>

#include "mapping/base/error.h"
#include "memory/questions/question.h"
#include "memory/questions/snapshot.h"
#include "memory/store/store.h"

int main(int argc, char** argv) {
  using namespace loci;
  if (argc < 2) {
    std::cerr << "usage: where FILE.loci [OBJECT]\n";
    return 2;
  }
  try {
    const memory::Store store = memory::Store::open_read(argv[1]);
    const std::string object = argc > 2 ? argv[2] : "";
    const memory::Answer answer = ask(
        store, object.empty() ? memory::Query{"objects", {}} : memory::Query{"where", {{"object", object}}});
    std::cout << answer.to_text(memory::TimeWriter(store));
    if (object.empty()) return 0;
    for (const memory::Id id : memory::Snapshot(store, {}).find_objects(object))
      for (const memory::ObjectObservation& seen : store.observations_of(id))
        std::cout << format_time(seen.time) << "  scene " << seen.observation.scene << "\n";
  } catch (const Error& error) {
    std::cerr << "where: " << error.what() << "\n";
    return 1;
  }
}
