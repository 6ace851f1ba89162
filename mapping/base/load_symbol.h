#pragma once

namespace loci {

/// A function of a module that is loaded when it is needed, found through the program's RUNPATH. Error
/// "WHAT: ..." that says what to install.
void* load_symbol(const char* module, const char* symbol, const char* what, const char* install);

}  // namespace loci
