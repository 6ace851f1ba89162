#pragma once

#include <string>

#include "memory/questions/routines/digest.h"
#include "memory/store/store.h"

namespace loci::memory {

/// A digest as a page in one file, with the last image of each object that it names, as far as images are
/// stored.
std::string digest_page(const Store& store, const DigestAnswer& digest);

}  // namespace loci::memory
