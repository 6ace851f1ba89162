#pragma once

#include "perception/pipeline/registry.h"

namespace loci {

/// Every annotator and reader that this program knows: where rooms add theirs.
AnnotatorRegistry all_annotators();

}  // namespace loci
