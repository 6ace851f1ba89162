#include "memory/edits/edit_run.h"

#include <fmt/format.h>

#include <map>

#include "mapping/base/text/json.h"
#include "memory/questions/names/map_names.h"
#include "memory/reasoning/reason.h"
#include "memory/store/run_configuration.h"

namespace loci::memory {

EditRun::EditRun(Store& store, const Json& configuration)
    : store_(store), change_(store), id_(store.begin_run(kEditProgram, configuration.dump())) {}

Edit EditRun::finish() {
  store_.finish_run(id_);
  Edit made = edit_of(store_, id_);
  change_.commit();
  return made;
}

Edit edit_of(const Store& store, Id run) {
  for (const RunRow& row : store.runs())
    if (row.id == run) {
      const Json configuration = configuration_of(row, store.path());
      return {run, row.started, configuration.value("text", row.program), {}};
    }
  throw store.error(fmt::format("no run {}", run));
}

KnownIdentities known_identities(const Store& store, const std::vector<Edit>& list) {
  KnownIdentities known;
  std::map<Id, RunRow> runs;
  for (const RunRow& run : store.runs()) {
    if (run.program == kReasonProgram)  // that came along from the memory that was reasoned about
      read_identities(configuration_of(run, store.path()), known);
    runs[run.id] = run;
  }
  for (const Edit& edit : list) read_identities(configuration_of(runs.at(edit.run), store.path()), known);
  return known;
}

[[noreturn]] void refuse(const Store& store, const std::string& what, const std::string& hint) {
  throw store.error(what, hint);
}

}  // namespace loci::memory
