#include "mapping/base/load_symbol.h"

#include <dlfcn.h>

#include <string>

#include "mapping/base/error.h"

namespace loci {

void* load_symbol(const char* module, const char* symbol, const char* what, const char* install) {
  void* library = dlopen(module, RTLD_NOW | RTLD_LOCAL);
  void* found = library != nullptr ? dlsym(library, symbol) : nullptr;
  if (found == nullptr) throw Error(std::string(what) + ": " + dlerror(), {}, install);
  return found;
}

}  // namespace loci
