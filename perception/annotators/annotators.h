#pragma once

#include <string>

#include "perception/pipeline/registry.h"

namespace loci::perception {

/// Adds the readers and annotators of this module.
void add_annotators(AnnotatorRegistry& registry);

/// The pipeline that is run when none is given, as YAML.
const std::string& default_pipeline();

}  // namespace loci::perception
