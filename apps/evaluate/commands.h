#pragma once

#include "apps/cli/program.h"

namespace loci::apps {

Command articulation_command();
Command changes_command();
Command days_command();
Command detection_command();
Command mapping_command();
Command description_command();
Command filter_command();
Command fleet_command();
Command identity_command();
Command registration_command();
Command segmentation_command();
Command nbv_command();
Command normals_command();
Command occupancy_command();
Command questions_command();
Command memory_command();
Command mesh_command();
Command placement_command();
Command system_command();
Command tracking_command();
Command update_command();

}  // namespace loci::apps
