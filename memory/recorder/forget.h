#pragma once

#include "memory/store/store.h"

namespace loci::memory {

/// Store::forget(), and the belief that is carried on forgets it too. Error when an object is not known.
ForgetResult forget(Store& store, const ForgetRequest& request, Id run);

}  // namespace loci::memory
