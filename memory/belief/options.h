#pragma once

#include "mapping/base/options.h"
#include "memory/belief/evidence/visibility.h"

namespace loci::memory::belief {

/// Parameters of the belief. Probabilities are per object and view unless stated otherwise.
struct BeliefOptions {
  // Noise of an observation's centre, one standard deviation.
  double noise_m = 0.002;
  double noise_per_m2 = 0.001;
  double noise_per_size = 0.01;
  double pose_noise_m = 0.02;
  double view_bias = 0.1;
  double noise_spread = 0.7;
  double area_m2 = 1.0;

  // Changes between views.
  double move_time_s = 1200;
  double move_cap = 0.8;
  double watched = 0.1;
  double nudge_m = 0.1;
  double newview = 0.1;
  double appear = 0.45;
  double reappear = 0.2;

  // Detectors.
  double detection = 0.9;
  double clutter = 0.05;
  double repeat_clutter = 0.3;
  double empty_if_there = 0.003;
  double appearance_weight = 0.8;
  bool settle = true;

  // Reporting and storage.
  double snapshot_gap_s = 5;
  double confirm = 0.95;
  double first_sight = 0.7;
  double gone = 0.8;
  int views = 6;
  int gone_kept = 50;

  VisibilityOptions visibility;

  void declare(OptionTable& table);
};

}  // namespace loci::memory::belief
